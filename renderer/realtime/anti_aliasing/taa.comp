#version 450
// SPDX-License-Identifier: MIT
//
// Temporal anti-aliasing as in Unreal Engine 4.26, after B. Karis, "High Quality Temporal
// Supersampling", SIGGRAPH 2014. Each frame's rays have another sub-pixel place, the jitter; a
// pixel is a running mean of the frames:
//
//     1. frame     neighbourhood.glsl  nine samples around the pixel, filtered about its centre,
//                                      and the box of their colours
//     2. motion    motion.glsl         the place of the same point in the frame before
//     3. history   history.glsl        the output of the frame before at that place; invalid in the
//                                      first frame, after a cut, beyond the frame's sides, behind
//                                      the camera, and where it is not finite
//     4. clamp     taa.glsl            the history is clamped to the box, which removes ghosts
//     5. blend     taa.glsl            history + weight (frame - history)
//     6. output    taa.glsl            rounded stochastically to half floats; the next frame's
//                                      history
//
// This is the readable form, one thread a pixel, which check_reference.c mirrors. taa_cpu.comp and
// taa_gpu.comp give the same result faster. Numbers that decide a branch are `precise`, so that C
// makes the same decision.
//
// Functions from other files:
// - shared/view.glsl: fetch_full() and view_size() are in rendered pixels, fetch_output() in
//   output pixels, of which there are more with upsampling (taau.comp, locks.comp). Outside the
//   frame both repeat its border pixels. choice(), setting() and is_set() are the user's settings
//   RT_* (docs/settings.md). view_now and view_before are the cameras, relative to this frame's
//   camera.
// - shared/clamp.glsl: Box and its functions, clamp_between().
// - shared/color_space.glsl: to_space(), from_space() and luma_4(), four times the luma Y.
// - gradient/change.glsl: beyond() is 0 up to a limit and 1 from twice the limit on;
// compute_change_time() is
//   the limit divided by a change.
// - shared/device.glsl: code that is fast on one kind of device, such as first_tap() and
//   last_tap(), the ends of a loop over four taps.
//
// Different from Unreal, besides the differences that these files name in place:
// - Filter and blend are linear: only the box is computed in taa_space, and a history that it does
//   not change keeps its last bit.
// - taa_guard: a colour that is not finite is ignored. Where all nine are ignored the history
//   stays; where that is invalid, too, the pixel is 0. Colours are clamped to 0 .. 65504. Where the
//   history is black the contrast law is off: its 0 / 0 would be NaN in all later frames.
// - taa_responsive uses no stencil, as Unreal does: it applies where media hide the background.
// Off in presets that follow Unreal: with taa_age_max a static pixel in the same light is the mean
// of its frames; with taa_medium the history follows the motion of the medium.
// Left out: the anti-ghosting flag of movers, depth of field, and the unfiltered frame that Unreal
// blends in where a bilinear history blurs.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require

#include "history.glsl"
#include "rounding.glsl"
#include "taa.glsl"

void main()
{
    ivec2 pixel;
    if (!find_element(view_size(), pixel))
        return;
    find_change(pixel / 4);
    find_filter_weights();
    Frame frame = frame_from(fetch_neighbourhood(pixel), !is_unclamped);
    put_pixel(pixel, resolve(pixel, pixel, find_past(pixel, pixel), frame));
}
