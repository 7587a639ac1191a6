/* SPDX-License-Identifier: MIT
 *
 * Each preset is a list of differences from the defaults, `fixed`. All march one ray in 16 pixels
 * and use the anti-aliasing of Unreal Engine 4.26. Below, "guess" marks a choice without a source.
 * In all presets the distance that is kept with a ray is ours: the mean over the light that the ray
 * collects.
 *
 * seed   the article on the frame split as written, with its faults:
 *        - The depths of rays are limited, the depths of texels are not: geometry beyond 15 km
 *          counts as sky. The sky is 20 km away where the article writes that, elsewhere where
 *          Unreal's depth buffer has its 0.
 *        - All tiles override at once, each as if the others kept their scheduled slots.
 *        - The neighbourhood clamp with a single accepted ray erases the history, and the tile's
 *          own ray is left out of the clamp.
 *        - The last tiles, split views, and sizes that are not multiples of 4 are wrong.
 *        - The history is reprojected with the distance of the tile's own ray, used as an eye
 *          depth. Wind, invalid history and cuts are ignored.
 *        - Both shifts of the upscale come from one number.
 *        - The jitter repeats after 8 frames, twice the period of the slots, and shifts the depth
 *          map.
 *        The weight 0.5 of its fresh rays follows a return, so it has no effect and is left out.
 *        From Unreal only: the distance of a depth of 0, 1000 km, and that the matrices include the
 *        jitter. Guesses: amount and law of the upscale's shift, its slice of the mask, the
 *        quantity of which the tolerance is 25 %, the mask of the rays' dither. Left out: marching
 *        from the end of the froxels, cirrus, aerial perspective. Neighbours beyond the side of a
 *        split view are clamped to the side.
 * ue     after Unreal Engine 5's volumetric render target, mode 0, without its second trace. This
 *        is the branch that compares history with the half-resolution texel's own depth (10 %) and
 *        falls back to the nearest of the eight rays around. The other branch, for devices with
 *        compute shaders, traces each tile to its nearest and to its farthest depth and keeps two
 *        layers; its rules (2000 m between scenes, 1000 m between nearest depths of a tile) are not
 *        implemented. Guesses: the noises of shift and ray; no acceptance of noisy taps (Unreal's
 *        20); history is compared with the depth map of the frame before and not with the depth of
 *        the ray that it came from.
 * c52e   after c52e/SkyRendering: fresh rays have weight 1/5, are blended and clamped in
 *        tone-mapped colour; the clamp accepts similar opacities; the upscale uses depth where
 *        opacity has contrast. Guesses: the original has no jitter, here it is Unreal's; rays
 *        beyond the sides of the frame are black in the original, here clamped to the sides.
 * unity  after HDRP's volumetric clouds with ghosting reduction (a neighbourhood clamp, off by
 *        default there): a running mean of at most 16 rays, clamped to the rays that end as the
 *        texel does, in the sky or on solids; invalid where the depth has changed by 20 %;
 *        bilateral upscale from 3x3 half-resolution texels. Guesses: the noise; the far plane, 1
 *        km, to which its depth tolerance is relative; the tiles of the other colour are the ones
 *        that are ahead.
 * ours1  `fixed`, but static history is clamped only where a ray finds that the light has changed,
 *        and is invalid where the scene behind it has changed. The upscale has no dither, so that
 *        the anti-aliasing can be fast. docs/realtime.md has its measurements.
 * ours2  the second generation: rays that are marched twice separate change from noise. Static
 *        pixels are the mean of all their frames, at half resolution and in the anti-aliasing, and
 *        that mean follows slow light. Elsewhere the anti-aliasing is fast and follows the medium.
 * ours   the third generation, for motion. In `ours2` most of the flicker in motion comes from the
 *        anti-aliasing (docs/motion.md): after a change it starts a new mean, so that edges blink
 *        in front of clouds that drift. Now a mean keeps 19 frames, and a change counts in
 *        proportion over a wider range.
 * fsr2   after AMD's FidelityFX Super Resolution 2, and
 * svgf   after Schied et al., HPG 2017: docs/realtime.md lists the differences from the originals.
 */
#include "renderer/realtime/options.h"

#include <stddef.h>

const struct neph_preset neph_rt_presets[] = {
    {"off", "every pixel, every frame, no history: `march` itself",
     "split=none taa=off ray_dither=none warm_up=0", NEPH_RT_STRESS_FULL},
    {"seed", "the Red Dead Redemption 2 frame split as in the article, with its faults",
     "depth_map=reversed override=parallel sky_m=20000 ray_depth_max_m=10000 "
     "clamp_pixel_depth=off edge_tiles=dropped gather=normalised tile_origin=buffer "
     "jittered_depth=on ray_dither=blue box_centre=off reproject_depth=tile reproject_measure=eye "
     "reproject_jitter=on wind=off validity=off cut_reset=off upscale_dither=slice "
     "upscale_pair=shared taa_jitter_length=8",
     NEPH_RT_STRESS | NEPH_RT_FLICKER | NEPH_RT_CONVERGENCE | NEPH_RT_REPORT},
    {"fixed", "the article's frame split with its faults corrected: the defaults", "",
     NEPH_RT_STRESS | NEPH_RT_FLICKER | NEPH_RT_PICK},
    {"ue", "after Unreal Engine 5's volumetric render target, mode 0, with one trace",
     "slot_order=anticlockwise slot_checkerboard=off override=none jittered_depth=on "
     "ray_dither=interleaved fallback=bilinear fallback_rejected=around box=none "
     "reproject_depth=tile reproject_measure=eye wind=off reject_depth=0.1 reject_around=off "
     "upscale=inverse upscale_depth=0.1 upscale_dither=white upscale_law=constant "
     "upscale_amount_px=0.5 taa_jitter_length=8",
     NEPH_RT_STRESS_FULL | NEPH_RT_FLICKER | NEPH_RT_CONVERGENCE},
    {"c52e", "after c52e/SkyRendering, an open implementation of the article",
     "override=parallel jittered_depth=on ray_dither=blue fresh_weight=0.2 fresh_space=channels "
     "fallback=tile box_depth=0.3 box_transmittance=0.2 contrast=opacity box_space=channels "
     "reproject_depth=tile upscale_depth=0.1 upscale_contrast=0.2 upscale_dither=none "
     "taa_jitter_length=8",
     NEPH_RT_STRESS_FULL | NEPH_RT_FLICKER},
    {"unity", "after Unity HDRP's volumetric clouds",
     "depth_map=nearest override=none jittered_depth=on ray_dither=white history_age_max=16 "
     "history_fade=0.95 fallback=bilateral fallback_rejected=bilateral box_depth=1000000 "
     "box_same_kind=on box_hold=clip box_age=0.5 reproject_depth=tile wind=off reject_depth=0.2 "
     "reject_around=off upscale=square upscale_tolerance_m=0.01 upscale_same_kind=on "
     "upscale_dither=none taa_jitter_length=8",
     NEPH_RT_STRESS_FULL | NEPH_RT_FLICKER},
    {"ours1", "no clamp for static pixels in constant light; fast anti-aliasing",
     "reject_depth=0.1 box_motion_px=0.05 box_change=0.1 upscale_dither=none taa_alpha=0.1 "
     "taa_box=variance taa_sigma=1",
     0},
    {"ours2", "static pixels are the mean of their frames; a gradient separates change from noise",
     "reject_depth=0.1 reject_around=moved gradient=on relight=0.1 change_hold=0.75 "
     "change_strobe=on override_wake=32 box_motion_px=0.05 box_change=0.1 history_age_max=32 "
     "box_age=0 fallback=bilateral fallback_rejected=bilateral taa_medium=on taa_age_max=256 "
     "taa_change=0.1 taa_alpha=0.1 taa_box=variance taa_sigma=1 taa_pre_exposure=on "
     "upscale=bilateral upscale_dither=none",
     0},
    {"ours", "`ours2`, whose anti-aliasing keeps frames after a change; for motion",
     "reject_depth=0.1 reject_around=moved gradient=on relight=0.1 change_hold=0.75 "
     "change_strobe=on override_wake=32 box_motion_px=0.05 box_change=0.1 history_age_max=32 "
     "box_age=0 fallback=bilateral fallback_rejected=bilateral taa_medium=on taa_age_max=256 "
     "taa_age_least=19 taa_change=0.1 taa_change_full=0.6 taa_alpha=0.1 taa_box=variance "
     "taa_sigma=1 taa_pre_exposure=on upscale=bilateral upscale_dither=none",
     NEPH_RT_STRESS | NEPH_RT_FLICKER | NEPH_RT_CONVERGENCE | NEPH_RT_REPORT | NEPH_RT_PICK},
    {"fsr2", "`fixed`, upsampled from 67 % after AMD's FSR 2: locks, disocclusion, Lanczos",
     "screen_percent=67 taa=locks taa_jitter=halton taa_jitter_length=8 taa_motion=square "
     "taa_box=variance taa_sigma=1 taa_age_max=8 taa_responsive=medium "
     "taa_pre_exposure=on upscale_dither=none",
     NEPH_RT_STRESS_FULL},
    {"svgf", "after SVGF: a mean of five rays, filtered by depth and luma, clamped by variance",
     "history_age_max=5 box=none reject_depth=0.1 fallback=bilateral "
     "fallback_rejected=bilateral atrous=on upscale=bilateral upscale_dither=none "
     "taa_box=variance taa_sigma=1",
     NEPH_RT_STRESS_FULL},
    {.name = NULL},
};
