#version 450
// SPDX-License-Identifier: MIT
//
// Temporal anti-aliasing as in Unreal Engine 4.26, after B. Karis, "High Quality Temporal
// Supersampling", SIGGRAPH 2014. Each frame's rays have another sub-pixel place, the jitter; a
// pixel is a running mean of the frames:
//
//     1. frame     neighbourhood.glsl  nine samples around the pixel, filtered about its centre,
//                                      and the box of their colours
//     2. motion    motion.glsl         where the frame before showed the same thing
//     3. history   history.glsl        the output of the frame before at that place; invalid in the
//                                      first frame, after a cut, beyond the frame's sides, behind
//                                      the camera, and where it is not finite
//     4. clamp     taa.glsl            the history into the box, so that nothing stays that is gone
//     5. blend     taa.glsl            history + weight (frame - history)
//     6. output    taa.glsl            rounded stochastically to half floats; the next frame's
//                                      history
//
// This is the readable form, one thread a pixel, which check_reference.c mirrors. taa_cpu.comp and
// taa_gpu.comp give the same result faster. Where a number decides something it is `precise`, so
// that C makes the same decision.
//
// From shared/view.glsl: fetch_full() and view_size() are of the rendered pixels, fetch_picture()
// of the pixels that come out, which are more with upsampling (taau.comp, locks.comp). Outside of
// the frame both repeat its border pixels. choice(), setting() and is_set() are the user's settings
// RT_*, as docs/settings.md lists them; view_now and view_before are the cameras, relative to the
// one of this frame. From shared/clamp.glsl: Box and what acts on it, and clamp_between(). From
// shared/color_space.glsl: to_space(), from_space() and luma_4(), four times the luma Y. From
// gradient/change.glsl, for limits: beyond() is 0 up to the limit and 1 from twice the limit on;
// lasting() is how many times a change goes into the limit. From shared/device.glsl: what is fast
// on a kind of device, such as first_tap() and last_tap(), the ends of a loop over four taps.
//
// Different from Unreal, beside what these files say at its place:
// - Filter and blend are linear: only the box is taken in taa_space, and a history that it does not
//   move keeps its last bit.
// - taa_guard: a colour that is not finite does not count. Where none of the nine does the history
//   stays; where that is invalid, too, the pixel is 0. Colours are clamped to 0 .. 65504. Where the
//   history is black the contrast law is off: its 0 / 0 would be NaN for ever after.
// - taa_responsive has no stencil, which Unreal has for it: it acts where media hide what is behind
//   them.
// Off in presets that follow Unreal: with taa_age_max a static pixel in the same light is the mean
// of its frames; with taa_medium its history is read where the medium was.
// Left out: the anti-ghosting flag of movers, depth of field, and the unfiltered frame that is
// mixed in where a bilinear history blurs.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require

#include "history.glsl"
#include "rounding.glsl"
#include "taa.glsl"

void main()
{
    ivec2 pixel;
    if (!own_element(view_size(), pixel))
        return;
    find_change(pixel / 4);
    find_filter_weights();
    Frame frame = frame_from(fetch_neighbourhood(pixel), !is_unclamped);
    put_pixel(pixel, resolve(pixel, pixel, frame));
}
