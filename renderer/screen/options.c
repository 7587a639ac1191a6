/* SPDX-License-Identifier: MIT
 *
 * The table of settings, in the order of the passes. The default ambient occlusion follows the
 * article on Unreal Engine's post-processing. Presets are differences from the defaults; `ours` is
 * the most accurate at a cost that a frame allows.
 */
#include "renderer/screen/options.h"

#include "base/option_rows.h"

#include <stddef.h>

static const char *const switches[] = {"off", "on", NULL};
static const char *const occlusions[] = {"off", "ssao", "unreal", "gtao", NULL};
static const char *const resolutions[] = {"full", "half", NULL};
static const char *const pixels[] = {"first", "turning", NULL};
static const char *const slicings[] = {"ray", "axis", NULL};
static const char *const places[] = {"pixel", "plane", NULL};
static const char *const ways_to_sum[] = {"ratio", "mean", NULL};
static const char *const metals[] = {"relit", "camera", NULL};
static const char *const bounces[] = {"one", "all", NULL};
static const char *const formats[] = {"float32", "float16", NULL};

const struct neph_option neph_screen_options[SCREEN_SETTING_COUNT + 1] = {
    [SCREEN_AO] = CHOICE("ao", SCREEN_AO_UNREAL, occlusions,
                         "ambient occlusion: points in a hemisphere, Unreal's pairs of angles, or "
                         "horizons of slices"),
    [SCREEN_AO_RESOLUTION] = CHOICE("ao_resolution", SCREEN_FULL, resolutions,
                                    "of occlusion and its blur; half: the first of 2x2 pixels, "
                                    "then upsampled within a surface"),
    [SCREEN_AO_RADIUS_M] = REAL("ao_radius_m", 2, 1e-3, 1e6,
                                "maximum distance of occluding surfaces [m]"),
    [SCREEN_AO_FALLOFF] = REAL(
        "ao_falloff", 0, 0, 1,
        "gtao: last fraction of the radius, over which occlusion fades; 0: as rays of that length"),
    [SCREEN_AO_DIRECTIONS] = WHOLE(
        "ao_directions", 6, 1, 64,
        "slices of gtao, pairs of unreal; ssao takes directions times steps points"),
    [SCREEN_AO_STEPS] = WHOLE("ao_steps", 3, 1, 128, "samples along each side of a direction"),
    [SCREEN_AO_STEP_POWER] = REAL("ao_step_power", 2, 1, 4,
                                  "gtao: step k of n is at (k / n)^ao_step_power of the radius"),
    [SCREEN_AO_THICKNESS] = REAL("ao_thickness", 0, 0, 1,
                                 "gtao: fraction by which samples below the horizon lower it, as "
                                 "for thin occluders; 0: thick occluders"),
    [SCREEN_AO_SLICES] = CHOICE(
        "ao_slices", SCREEN_SLICES_RAY, slicings,
        "gtao: uniform around the view ray, or around the camera's axis as in the paper"),
    [SCREEN_AO_NOISE] = CHOICE("ao_noise", 1, switches,
                               "each of 4x4 pixels has its own directions and steps"),
    [SCREEN_AO_BIAS] = REAL(
        "ao_bias", 1e-3, 0, 0.1,
        "ssao: fraction of its depth by which a point must be behind the depth buffer"),
    [SCREEN_AO_BLUR_PX] = WHOLE(
        "ao_blur_px", 2, 0, 8,
        "radius of the mean over pixels in the same plane; 2 covers the 4x4 noise"),
    [SCREEN_AO_POWER] = REAL("ao_power", 2, 0.1, 8, "exponent of the open fraction: non-physical"),
    [SCREEN_AO_INTENSITY] = REAL("ao_intensity", 0.5, 0, 1,
                                 "factor of the occlusion: non-physical"),
    [SCREEN_AO_PLACES] = CHOICE("ao_places", SCREEN_PLACES_PIXEL, places,
                                "position of a sample: its pixel's centre, or the intersection of "
                                "its own view ray with the pixel's plane"),
    [SCREEN_AO_SUM] = CHOICE(
        "ao_sum", SCREEN_SUM_RATIO, ways_to_sum,
        "gtao: sum of slices relative to unoccluded slices, or their mean as in the paper"),
    [SCREEN_RAY_THICKNESS_M] = REAL(
        "ray_thickness_m", 0.25, 0, 1e6,
        "thickness of surfaces: rays farther behind them pass [m]; 0: infinite"),
    [SCREEN_RAY_REFINE] = WHOLE("ray_refine", 4, 0, 16,
                                "bisections of the step in which a ray went behind a surface"),
    [SCREEN_RAY_STEP_POWER] = REAL(
        "ray_step_power", 1, 1, 4,
        "step k of n is at (k / n)^ray_step_power of the ray's length on the screen"),
    [SCREEN_RAY_METAL] = CHOICE("ray_metal", SCREEN_METAL_RELIT, metals,
                                "light of metal hit by a ray: sun and lights reflected into the "
                                "ray, or its reflection to the camera"),
    [SCREEN_RAY_NOISE] = CHOICE("ray_noise", 1, switches,
                                "each ray has its own offset of the first step"),
    [SCREEN_RAY_PIXEL] = CHOICE(
        "ray_pixel", SCREEN_PIXEL_FIRST, pixels,
        "at half resolution, the pixel of 2x2 that has the rays: the first, or in turn if there is "
        "a history, which is then resampled in each frame and so blurred"),

    [SCREEN_GI] = CHOICE("gi", 1, switches,
                         "indirect light on diffuse surfaces by rays, including the sky; off: only "
                         "the sky, by ambient occlusion"),
    [SCREEN_GI_RESOLUTION] = CHOICE(
        "gi_resolution", SCREEN_FULL, resolutions,
        "of rays, mean and smoothing; half: one of 2x2 pixels, then upsampled within a surface"),
    [SCREEN_GI_RAYS] = WHOLE("gi_rays", 4, 1, 256, "rays per pixel and frame"),
    [SCREEN_GI_STEPS] = WHOLE("gi_steps", 24, 1, 1024, "steps of a ray, at most one per pixel"),
    [SCREEN_GI_REACH_M] = REAL("gi_reach_m", 0, 0, 1e6,
                               "length of a ray [m]; 0: to the edge of the frame"),
    [SCREEN_GI_BOUNCES] = CHOICE("gi_bounces", SCREEN_BOUNCES_ALL, bounces,
                                 "light at the hit point of a ray: only sun, lights and sky, or "
                                 "also its indirect light of the previous frame"),
    [SCREEN_GI_HISTORY] = WHOLE("gi_history", 16, 0, 1024,
                                "previous frames in the mean over frames"),
    [SCREEN_GI_SMOOTH] = WHOLE("gi_smooth", 3, 0, 6,
                               "passes of the smoothing, with 5x5 pixels 2^k apart"),

    [SCREEN_SSR] = CHOICE("ssr", 1, switches, "reflections of metal by rays"),
    [SCREEN_SSR_RESOLUTION] = CHOICE("ssr_resolution", SCREEN_FULL, resolutions,
                                     "of rays, mean and smoothing, as gi_resolution"),
    [SCREEN_SSR_RAYS] = WHOLE("ssr_rays", 4, 1, 256, "rays per pixel and frame; 1 for a mirror"),
    [SCREEN_SSR_STEPS] = WHOLE("ssr_steps", 64, 1, 4096, "steps of a ray, at most one per pixel"),
    [SCREEN_SSR_ROUGHEST] = REAL("ssr_roughest", 1, 0, 1,
                                 "rougher metal has no rays: it reflects the sky where it is open"),
    [SCREEN_SSR_HISTORY] = WHOLE("ssr_history", 16, 0, 1024,
                                 "previous frames in the mean over frames"),
    [SCREEN_SSR_SMOOTH] = WHOLE("ssr_smooth", 2, 0, 6,
                                "passes of the smoothing; its radius depends on roughness"),

    [SCREEN_TARGETS] = CHOICE("targets", SCREEN_FLOAT16, formats,
                              "format of all targets except depth, which has 32 bits"),
    [SCREEN_WARM_UP] = WHOLE("warm_up", 31, 0, 4096,
                             "frames before the first, as if the sequence had begun earlier"),
    {.name = NULL},
};

/* Occlusion by slices within a radius of 1 m: the start of our own presets. */
#define RAYS_OF_A_METRE "ao=gtao ao_radius_m=1 ao_places=plane ao_power=1 ao_intensity=1 "

const struct neph_preset neph_screen_presets[] = {
    {"unreal", "the defaults: occlusion of Unreal Engine 4.26, 2 m, squared, at half strength", "",
     0},
    {"ours", "the most accurate at a cost that a frame allows",
     RAYS_OF_A_METRE "ao_directions=3 ao_steps=6 targets=float32", NEPH_SCREEN_STUDY},
    {"fast", "ours with one ray for 2x2 pixels, few steps, and a long mean over frames",
     RAYS_OF_A_METRE "ao_directions=2 ao_steps=3 ao_resolution=half ao_blur_px=1 "
                     "gi_resolution=half gi_rays=1 gi_steps=12 gi_history=32 gi_smooth=1 "
                     "ssr_resolution=half ssr_rays=1 ssr_steps=24 ssr_history=32 ssr_smooth=1 "
                     "targets=float16",
     NEPH_SCREEN_STUDY},
    {"slices", "ours with many slices and steps: the limit of gtao",
     RAYS_OF_A_METRE "ao_directions=32 ao_steps=64 ao_noise=off ao_blur_px=0 targets=float32",
     NEPH_SCREEN_STUDY},
    {"paper", "GTAO as in its paper: one slice a pixel, 4x4 pixels together",
     "ao=gtao ao_radius_m=1 ao_directions=1 ao_steps=6 ao_falloff=0.6 ao_slices=axis "
     "ao_places=pixel ao_thickness=0.1 ao_sum=mean ao_power=1 ao_intensity=1 targets=float16",
     0},
    {.name = NULL},
};
