#version 450
// SPDX-License-Identifier: MIT
//
// The upscale from half to full resolution. A pixel's place in the half-resolution image, shifted
// by dither, lies between four half-resolution texels, the taps; the pixel uses the taps that match
// its own depth: a joint bilateral upsampling (J. Kopf, M. F. Cohen, D. Lischinski, M. Uyttendaele,
// "Joint Bilateral Upsampling", SIGGRAPH 2007).
//
//     o - - - - - - - o
//     :   x       x   :     o  centres of half-resolution texels, the taps
//     :               :     x  centres of pixels without jitter: a thread computes
//     :   x       x   :        these four, a quarter and three quarters of the way along each axis
//     o - - - - - - - o
//
// Place: the centre of pixel x is at (x + 1/2) / 2 - 1/2 texels from the centre of the first texel.
// The jitter of the scene's rays is added where the volume has none, so that TAA, which removes the
// jitter, finds both in the same place.
//
// Shift: up to upscale_amount_px to either side along x and y, by two dither numbers. `shared` is
// the article's: the second number is the number of pixel (y, x), and both advance by one step a
// frame, for 16 frames. Their difference is constant, so a pixel's 16 places lie on a line, and for
// pixels on the frame's diagonal on the diagonal. `independent` has two channels and no period.
// While a place stays between the same four texels, `mean` and `nearest` get the same taps: a shift
// below 1/4 texel has no effect on them.
//
// Law of the shift: the article states "more in near dense fog, less on far clouds" without a
// formula. Ours:
//
//   shift = amount (1 - T) max(0, 1 - distance / 4 km)
//
// with transmittance T and cloud distance of the texel that contains the pixel. It has no division,
// so every device finds the same taps.
//
// Choice of taps, by the differences |scene - tap| of eye depths:
//
//   nearest    the tap with the least difference; of equal ones the nearest in place
//   bilinear   weights by place only; leaks over edges
//   mean       the mean of the four if all differences are below upscale_depth * scene, else
//              nearest
//   bilateral  weights by place times max(0, upscale_depth * scene - difference); if all are 0,
//              nearest
//   inverse    bilinear if all differences are below upscale_depth * scene, else weights
//              1 / (difference + upscale_tolerance_m) (Unreal Engine 5, upsampling mode 4)
//   square     3x3 texels about the place with weights exp(-d^2) / (difference +
//              upscale_tolerance_m), d the distance in place (Unity HDRP's BilUpColor3x3)
//
// Depths are compared as in the reconstruction, but with a sky at 1000 km: solids end at
// ray_depth_max_m if clamp_pixel_depth is on. Pixel and taps have the same limits, otherwise a
// ridge could match the sky because only one of the two is limited. Without the limit a ridge whose
// distance is within upscale_depth of 1000 km matches the sky. With upscale_same_kind taps of the
// sky are ignored on solids, and taps of solids on the sky, if other taps remain.
//
// With upscale_contrast > 0 depth is used only where the transmittances of the taps differ by more
// than this part of the largest (or of the largest opacity: contrast). Elsewhere nearest and mean
// give the mean, bilateral and inverse are bilinear, and square weighs by place only.
//
// With validity on, invalid taps are ignored; a pixel without valid taps is invalid.
//
// Without dither a thread's four pixels lie between the same texels, because the jitter is at most
// half a pixel. One fetch of taps then serves all four: pixels 2 k - 1 and 2 k, or 2 k and 2 k + 1
// about one texel (square).
#extension GL_GOOGLE_include_directive : require

#include "renderer/realtime/shared/pass.glsl"
#include "upscale.glsl"

// Clamped to the range of its values: a constant stays constant, and rounding makes no radiance
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
    if (find_element(view_size() / 2 + 1, quad))
        upscale(quad);
}
