/* SPDX-License-Identifier: MIT
 *
 * Engines `march` and `march_...`: the Vulkan ray marcher at full resolution, one engine for each
 * lighting model. The device is the first CPU device (lavapipe), or the first device with a name
 * that contains NEPH_VULKAN_DEVICE. NEPH_VULKAN_VALIDATION=1 turns the validation layers on; then
 * any message fails the frame.
 */
#include "harness/engines/engines.h"

#include "base/option_rows.h"
#include "harness/engines/frame_stats.h"
#include "harness/engines/gpu_frames.h"
#include "harness/engines/vulkan_device.h"
#include "renderer/march_average.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_MARCH_LIGHTING_COUNT == 8, "a new kind");

/* Generated: the tables of options, and the functions that read them into march parameters. */
#include "settings/march_table.inc"

/* ---- sequences ------------------------------------------------------------------------------- */

static enum neph_status create(struct neph_vulkan *vulkan, const struct neph_engine *engine,
                               const struct neph_shot *shot, void **renderer,
                               struct neph_diag *diag)
{
    const enum neph_march_lighting lighting = (enum neph_march_lighting)engine->lighting;
    struct neph_march *march = NULL;
    const double *values = shot->settings.values;
    struct neph_march_params params = {
        .width_px = shot->width_px,
        .height_px = shot->height_px,
        .frame = shot->frame,
        .lighting = lighting,
    };
    read_march(values, &params);
    if (lighting == NEPH_MARCH_TRACED) {
        params.light = (struct neph_light_paths){.memory = 1, .seed = (uint32_t)shot->seed};
        read_traced(values, &params); /* frames are independent of each other */
    }
    if (lighting == NEPH_MARCH_DIFFUSED)
        read_diffused(values, &params);
    const enum neph_status status = neph_march_create(vulkan, shot->scene, &params, &march, diag);
    *renderer = march;
    return status;
}

static void destroy(void *renderer)
{
    neph_march_destroy(renderer);
}

static enum neph_status frame(void *renderer, const struct neph_shot *shot,
                              struct neph_image **image, double *render_s, struct neph_diag *diag)
{
    const int rays_per_px = 1 << (int)shot->settings.values[OPTION_RAYS_PER_PX];
    struct neph_march_stats march = {.gpu_s = NAN};
    const enum neph_status status = neph_march_average(renderer, shot->scene, shot->frame,
                                                       rays_per_px, image, &march, diag);
    if (status)
        return status;
    const double pixels = (double)neph_image_pixel_count(*image);
    const struct neph_frame_stat stats[] = {
        {"density_evaluations", (double)march.density_evaluations},
        {"density_evaluations_per_pixel", (double)march.density_evaluations / pixels},
        {"closed_forms", (double)march.closed_forms},
        {"rays", (double)march.rays},
        {"view_steps", (double)march.view_steps},
        {"gpu_ms", 1e3 * march.gpu_s},
        {"wall_ms", 1e3 * march.wall_s},
    };
    *render_s = isfinite(march.gpu_s) ? march.gpu_s : march.wall_s;
    return neph_frame_stats_set_all(*image, stats, sizeof(stats) / sizeof(stats[0]), diag);
}

static enum neph_status submit(void *renderer, const struct neph_shot *shot,
                               struct neph_flight_cost *cost, struct neph_diag *diag)
{
    (void)cost;
    if (shot->settings.values[OPTION_RAYS_PER_PX] != 0.0)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "rays are averaged on the CPU: frames in flight need rays_per_px=1");
    return neph_march_frame(renderer, shot->scene, shot->frame, NULL, NULL, NULL, diag);
}

/* One pass besides the tables of the sky; the memory traffic of grids is unknown. */
static enum neph_status collect(void *renderer, struct neph_flight_cost *cost,
                                struct neph_diag *diag)
{
    const enum neph_status status = neph_march_home(renderer, &cost->gpu_s, diag);
    if (status)
        return status;
    const struct neph_sky_times sky = neph_march_home_sky(renderer);
    neph_flight_cost_add(cost, "march", cost->gpu_s - neph_sky_gpu_s(&sky), NAN);
    neph_flight_cost_add_sky(cost, &sky);
    return NEPH_OK;
}

static const struct neph_gpu_renderer gpu = {
    .create = create, .destroy = destroy, .frame = frame, .submit = submit, .collect = collect};

/* ---- the engines ----------------------------------------------------------------------------- */

static struct neph_march_veils veils_of(const struct neph_settings *settings)
{
    return (struct neph_march_veils){settings->values[OPTION_SKY] != 0.0,
                                     neph_fog_for_march((int)settings->values[OPTION_FOG])};
}

/* Whether this lighting can render the scene. If single scattering is not enough, the reason names
 * the engines with more. */
static bool can_render(enum neph_march_lighting lighting, const struct neph_scene *scene,
                       const struct neph_settings *settings, char *reason, size_t reason_size)
{
    struct neph_march_veils veils = {.sky = false};
    char ignored[256];
    if (settings)
        veils = veils_of(settings);
    if (neph_march_can_render_under(scene, veils, lighting, reason, reason_size))
        return true;
    const size_t used = strlen(reason);
    if (lighting == NEPH_MARCH_SINGLE &&
        neph_march_can_render_under(scene, veils, NEPH_MARCH_OCTAVES, ignored, sizeof(ignored)))
        snprintf(reason + used, reason_size - used, "; march_octaves could");
    return false;
}

/* The can_render function of one engine. */
#define FUNCTION_OF(name_, lighting_)                                                              \
    static bool can_render_##name_(const struct neph_scene *scene,                                 \
                                   const struct neph_settings *settings, char *reason,             \
                                   size_t reason_size)                                             \
    {                                                                                              \
        return can_render(lighting_, scene, settings, reason, reason_size);                        \
    }

/* Members that all march engines share. */
#define ROWS_OF(name_, lighting_)                                                                  \
    .rung = NEPH_RUNG_MODEL, .lighting = lighting_,                                                \
    .step = {.option = "steps", .coarsest = 16, .refine = 2, .level_count = 5, .order = 2},        \
    .probe = neph_vulkan_probe, .can_render = can_render_##name_, .sequence = &neph_gpu_sequence,  \
    .side_max_px = NEPH_MARCH_SIDE_MAX_PX, .gpu = &gpu

FUNCTION_OF(single, NEPH_MARCH_SINGLE)
FUNCTION_OF(octaves, NEPH_MARCH_OCTAVES)
FUNCTION_OF(horizon, NEPH_MARCH_HORIZON)
FUNCTION_OF(octaves_fitted, NEPH_MARCH_OCTAVES_FITTED)
FUNCTION_OF(traced, NEPH_MARCH_TRACED)
FUNCTION_OF(diffused, NEPH_MARCH_DIFFUSED)
FUNCTION_OF(similarity, NEPH_MARCH_SIMILARITY)
FUNCTION_OF(slab, NEPH_MARCH_SLAB)

const struct neph_engine neph_engine_march = {
    ROWS_OF(single, NEPH_MARCH_SINGLE),
    .name = "march",
    .summary = "our Vulkan ray marcher: full resolution, fixed steps, single scattering",
    .typical_s = 2.0,
    .bias = "step error of order 2 where the scene is smooth, of order 1 at the edges of shadows",
    .options = options_of_march,
    .version = 5, /* 5: constant step length far from a point light */
};

const struct neph_engine neph_engine_march_octaves = {
    ROWS_OF(octaves, NEPH_MARCH_OCTAVES),
    .name = "march_octaves",
    .summary = "march, and multiple scattering as a sum of octaves; a non-physical model",
    .typical_s = 2.0,
    .look = true,
    .bias = "a sum of octaves saturates with optical depth and does not conserve energy",
    .options = options_of_march,
    .version = 3, /* 3: no fused multiply-add in a voxel's fraction */
};

const struct neph_engine neph_engine_march_horizon = {
    ROWS_OF(horizon, NEPH_MARCH_HORIZON),
    .name = "march_horizon",
    .summary = "march, and the lighting of Horizon's clouds; a non-physical model",
    .typical_s = 2.0,
    .look = true,
    .bias = "floored Beer, lobes that do not integrate to 1, light where there is no density",
    .options = options_of_march,
    .version = 3, /* 3: no fused multiply-add in a voxel's fraction */
};

const struct neph_engine neph_engine_march_octaves_fitted = {
    ROWS_OF(octaves_fitted, NEPH_MARCH_OCTAVES_FITTED),
    .name = "march_octaves_fitted",
    .summary =
        "march, and octaves derived from g and albedo, fitted to the tracer; a non-physical model",
    .typical_s = 2.0,
    .look = true,
    .bias =
        "a sum of octaves knows no sides of a cloud and does not conserve energy; fitted on the "
        "tuning suite of `neph study light`",
    .options = options_of_march,
    .version = 2, /* 2: also fitted to whole images */
};

const struct neph_engine neph_engine_march_traced = {
    ROWS_OF(traced, NEPH_MARCH_TRACED),
    .name = "march_traced",
    .summary = "march, and higher orders of scattering by a few paths per group of pixels",
    .typical_s = 6.0,
    .stochastic = true,
    .bias = "as march, and a blur of the light of higher orders over a few texels; solids are lit "
            "only by the sun",
    .options = options_of_traced,
    .version = 1,
};

const struct neph_engine neph_engine_march_diffused = {
    ROWS_OF(diffused, NEPH_MARCH_DIFFUSED),
    .name = "march_diffused",
    .summary = "march, and higher orders of scattering by P1 diffusion on a coarse grid; a "
               "non-physical model",
    .typical_s = 4.0,
    .look = true,
    .bias = "diffusion is too blunt for thin media and near surfaces; nothing smaller than a cell",
    .options = options_of_diffused,
    .version = 1,
};

const struct neph_engine neph_engine_march_similarity = {
    ROWS_OF(similarity, NEPH_MARCH_SIMILARITY),
    .name = "march_similarity",
    .summary = "march, and fitted octaves of the similar isotropic medium; a non-physical model",
    .typical_s = 2.0,
    .look = true,
    .bias = "as march_octaves_fitted; nothing is left of where light came from",
    .options = options_of_march,
    .version = 1,
};

const struct neph_engine neph_engine_march_slab = {
    ROWS_OF(slab, NEPH_MARCH_SLAB),
    .name = "march_slab",
    .summary = "march, and higher orders of scattering as in a slab across the sunlight; a "
               "non-physical model",
    .typical_s = 2.0,
    .look = true,
    .bias = "a cloud is not a slab: light that leaves through its sides is counted as if it stayed",
    .options = options_of_march,
    .version = 1,
};
