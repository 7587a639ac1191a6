/* SPDX-License-Identifier: MIT
 *
 * Each preset is the defaults, `fixed`, with what it does otherwise.
 *
 * seed   the article on the frame split, to the letter, with its faults: one ray at a time is right
 *        only for depths below 10 km (X8), the override sees defaults and not choices (X11), the
 *        box of a lonely ray erases the history (X3), the last tiles, split views and sizes that
 *        are no multiple of 4 are off (X4, X5, X6), reprojection by the tile's own distance taken
 *        for an eye depth (X9), no wind, no validity, no cut (X10), both shifts of the upscale from
 *        one number (X13), a jitter of 8 over a cycle of 4 (X14) that moves the depth map (X15).
 *        Its fresh pixel's blend is dead code (X1) and so is not here. With the anti-aliasing of
 *        Unreal Engine 4.26.
 * ue     after Unreal Engine 5's volumetric render target, mode 0: the same slot everywhere, no
 *        override, no box, history void where the scene behind it has changed, bilateral upscale.
 *        It also marches each tile once more to the nearest depth; we do not.
 * c52e   after c52e/SkyRendering: fresh rays weigh a fifth, the box is taken in tone-mapped
 *        colour and lets similar transmittances in, depth matters in the upscale where the
 *        transmittance has contrast.
 * unity  after HDRP's volumetric clouds: a running mean inside the box of all nine rays, and a
 *        bilateral upscale.
 * ours   `fixed`, but the history of what is at rest is held in the box only where a ray sees that
 *        the light has changed, and voided where the scene behind it has; no dither in the upscale,
 *        so that the anti-aliasing can be quick. docs/realtime.md holds what it was measured at.
 */
#include "renderer/realtime/options.h"

#include <stddef.h>

const struct neph_preset neph_rt_presets[] = {
    {"off", "every pixel, every frame, no history: `march` itself",
     "split=none taa=off ray_dither=none warm_up=0"},
    {"seed", "the Red Dead Redemption 2 frame split as the article has it, faults included",
     "override=parallel sky_m=20000 ray_depth_max_m=10000 clamp_pixel_depth=off edge_tiles=dropped "
     "gather=normalised tile_origin=buffer jittered_depth=on ray_dither=blue box_centre=off "
     "reproject_depth=tile reproject_measure=eye wind=off validity=off cut_reset=off "
     "upscale_dither=blue upscale_pair=shared taa_jitter_length=8"},
    {"fixed", "the same with its faults mended: the defaults", ""},
    {"ue", "after Unreal Engine 5's volumetric render target, mode 0",
     "depth_map=farthest slot_order=diagonal slot_checkerboard=off override=none "
     "jittered_depth=on ray_dither=interleaved box=none reject_scene_m=2000 upscale=bilateral "
     "upscale_dither=white upscale_law=constant upscale_amount_px=0.5 taa_jitter_length=8"},
    {"c52e", "after c52e/SkyRendering, an open implementation of the article",
     "override=parallel jittered_depth=on ray_dither=blue fresh_weight=0.2 box_depth=0.3 "
     "box_transmittance=0.2 box_space=reinhard reproject_depth=tile upscale_depth=0.1 "
     "upscale_contrast=0.2 upscale_dither=none taa_jitter_length=8"},
    {"unity", "after Unity HDRP's volumetric clouds",
     "override=none jittered_depth=on ray_dither=white fresh_weight=0.1 box_depth=10 "
     "upscale=bilateral upscale_dither=none taa_jitter_length=8"},
    {"ours", "no box for what is at rest and in the same light; measures best here",
     "reject_depth=0.1 box_motion_px=0.05 box_change=0.1 upscale_dither=none taa_alpha=0.1 "
     "taa_box=variance taa_sigma=1"},
    {.name = NULL},
};
