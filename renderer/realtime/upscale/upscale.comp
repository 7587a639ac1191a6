#version 450
// SPDX-License-Identifier: MIT
//
// The upscale from half to full resolution. A pixel's place in the half-resolution image, shifted
// by dither, lies between four half-resolution texels; of these taps it takes what belongs to its
// own depth: a joint bilateral upsampling (J. Kopf, M. F. Cohen, D. Lischinski, M. Uyttendaele,
// "Joint Bilateral Upsampling", SIGGRAPH 2007).
//
//     o - - - - - - - o
//     :   x       x   :     o  centres of half-resolution texels, the taps
//     :               :     x  centres of the pixels between them without jitter: a thread has
//     :   x       x   :        these four, a quarter and three quarters of the way along each axis
//     o - - - - - - - o
//
// Place: the centre of pixel x lies at (x + 1/2) / 2 - 1/2 texels, which are counted from the
// centre of the first. The jitter of the scene's rays is added where the volume's have none, so
// that TAA, which takes it out again, finds both in the same place.
//
// Shift: up to upscale_amount_px to either side along x and y, by two dither numbers. `shared` is
// the article's way: the second number is that of the pixel (y, x), and both advance by one step a
// frame, for 16 frames. Their difference never changes, so that a pixel's 16 places lie on a line,
// and on the picture's diagonal all on the diagonal. `independent` has two channels and no period.
// A place that stays between the same four texels gives `mean` and `nearest` the same taps: below
// 1/4 texel a shift changes nothing there.
//
// Law of the shift: the article has "more in near dense fog, less on far clouds" and no formula.
// Ours:
//
//   shift = amount (1 - T) max(0, 1 - distance / 4 km)
//
// with transmittance T and cloud distance of the texel that the pixel lies in. It has no division,
// so that every device finds the same taps.
//
// Choice of taps, by the differences |scene - tap| of eye depths:
//
//   nearest    the tap of the least difference; of equal ones that which is nearest in place
//   bilinear   weights of place alone: what leaks over edges
//   mean       the mean of the four if all differences are below upscale_depth * scene, else as
//              nearest
//   bilateral  weights of place times max(0, upscale_depth * scene - difference); if all are 0, as
//              nearest
//   inverse    bilinear if all differences are below upscale_depth * scene, else weights
//              1 / (difference + upscale_tolerance_m) (Unreal Engine 5, upsampling mode 4)
//   square     3x3 texels about the place with weights exp(-d^2) / (difference +
//              upscale_tolerance_m), d the distance in place (Unity HDRP's BilUpColor3x3)
//
// Depths are compared as in the reconstruction, but with a sky at 1000 km: solids end at
// ray_depth_max_m if clamp_pixel_depth is on. Pixel and taps have the same limits, so that no ridge
// is taken for sky because only one of both was limited. Without the limit a ridge within
// upscale_depth of that is. With upscale_same_kind no tap of the sky counts on a solid,
// nor the other way round, as long as there are others.
//
// With upscale_contrast > 0 depth matters only where the transmittances of the taps differ by more
// than this part of the largest (or of the largest opacity: contrast); elsewhere nearest and mean
// take the mean, bilateral and inverse are bilinear, and square goes by place alone.
//
// With validity on, taps that are void or unsound do not count; a pixel without any tap is void.
//
// Without dither a thread's four pixels lie between the same texels, since the jitter is at most
// half a pixel, and one fetch of taps serves all four: pixels 2 k - 1 and 2 k, or 2 k and 2 k + 1
// about one texel (square).
#extension GL_GOOGLE_include_directive : require

#include "renderer/realtime/shared/pass.glsl"
#include "upscale.glsl"

// Clamped to the range of its values: a constant stays the same, and no rounding makes a radiance
// negative.
vec4 weighted_mean(Tap taps[TAPS_MAX], float weights[TAPS_MAX], float total)
{
    vec4 sum = vec4(0.0), least = vec4(FLOAT_MAX), largest = vec4(-FLOAT_MAX);
    [[unroll]] for (int i = 0; i < tap_count(); i++)
        if (weights[i] > 0.0) {
            vec4 value = taps[i].volume;
            sum += weights[i] / total * value;
            least = mix(least, value, lessThan(value, least));
            largest = mix(largest, value, greaterThan(value, largest));
        }
    sum = mix(sum, least, lessThan(sum, least));
    return mix(sum, largest, greaterThan(sum, largest));
}

void main()
{
    ivec2 quad;
    if (own_element(view_size() / 2 + 1, quad))
        upscale(quad);
}
