/* SPDX-License-Identifier: MIT
 *
 * Engines `march`, `march_octaves` and `march_horizon`: our Vulkan ray marcher at full resolution,
 * one engine for each of its lighting models. The device is the first CPU device
 * (lavapipe) unless NEPH_VULKAN_DEVICE names part of another's name; NEPH_VULKAN_VALIDATION=1
 * turns the validation layers on, and then any message fails the frame.
 */
#include "harness/engines/engines.h"
#include "harness/engines/vulkan_device.h"

#include "base/clock.h"
#include "harness/frame_stats.h"
#include "renderer/march.h"

#include <math.h>
#include <sys/resource.h>

static const char *const modes[] = {"exact", "marched", NULL};

enum { OPTION_STEPS, OPTION_TRANSMITTANCE, OPTION_SUN, OPTION_SUN_STEPS };

static const struct neph_option options[] = {
    [OPTION_STEPS] = {"steps", NEPH_OPTION_INTEGER, 64, 1, NEPH_MARCH_STEPS_MAX, NULL,
                      "steps per view ray"},
    [OPTION_TRANSMITTANCE] =
        {"transmittance", NEPH_OPTION_CHOICE, NEPH_MARCH_EXACT, 0, 1, modes,
         "optical depth of view rays: closed form (but for Horizon clouds), or summed over the "
         "steps"},
    [OPTION_SUN] =
        {"sun", NEPH_OPTION_CHOICE, NEPH_MARCH_EXACT, 0, 1, modes,
         "optical depth towards the sun: closed form (but for Horizon clouds), or marched"},
    [OPTION_SUN_STEPS] = {"sun_steps", NEPH_OPTION_INTEGER, 16, 1, NEPH_MARCH_STEPS_MAX, NULL,
                          "steps per marched sun ray"},
    {.name = NULL},
};

static enum neph_status label(struct neph_image *frame, const struct neph_march_stats *stats,
                              struct neph_diag *diag)
{
    const double pixels = (double)neph_image_pixel_count(frame);
    const struct {
        const char *name;
        double value;
    } numbers[] = {
        {"density_evaluations", (double)stats->density_evaluations},
        {"density_evaluations_per_pixel", (double)stats->density_evaluations / pixels},
        {"closed_forms", (double)stats->closed_forms},
        {"rays", pixels},
        {"view_steps", (double)stats->view_steps},
        {"gpu_ms", 1e3 * stats->gpu_s},
        {"wall_ms", 1e3 * stats->wall_s},
    };
    enum neph_status status = NEPH_OK;
    for (size_t i = 0; i < sizeof(numbers) / sizeof(numbers[0]) && !status; i++)
        status = neph_frame_stats_set(frame, numbers[i].name, numbers[i].value, diag);
    return status;
}

static enum neph_status render(enum neph_march_lighting lighting, const struct neph_shot *shot,
                               struct neph_image **frame, struct neph_cost *cost,
                               struct neph_diag *diag)
{
    const double wall_start_s = neph_wall_s(), cpu_start_s = neph_cpu_s();
    const struct neph_vulkan_params device = neph_vulkan_device_params();
    const double *values = shot->settings.values;
    const struct neph_march_params params = {
        .width_px = shot->width_px,
        .height_px = shot->height_px,
        .frame = shot->frame,
        .steps = (int)values[OPTION_STEPS],
        .transmittance = (enum neph_march_mode)values[OPTION_TRANSMITTANCE],
        .sun = (enum neph_march_mode)values[OPTION_SUN],
        .lighting = lighting,
        .sun_steps = (int)values[OPTION_SUN_STEPS],
    };
    struct neph_vulkan *vulkan = NULL;
    struct neph_image *image = NULL;
    struct neph_march_stats stats = {.gpu_s = NAN};
    enum neph_status status = neph_vulkan_create(&device, &vulkan, diag);
    if (!status)
        status = neph_march_render(vulkan, shot->scene, &params, &image, &stats, diag);
    if (!status)
        status = label(image, &stats, diag);
    neph_vulkan_destroy(vulkan);
    if (status) {
        neph_image_destroy(image);
        return status;
    }
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    *cost = (struct neph_cost){
        .render_s = isfinite(stats.gpu_s) ? stats.gpu_s : stats.wall_s,
        .wall_s = neph_wall_s() - wall_start_s,
        .cpu_s = neph_cpu_s() - cpu_start_s,
        .peak_memory_bytes = (int64_t)usage.ru_maxrss * 1024,
    };
    *frame = image;
    return NEPH_OK;
}

static const struct neph_engine_step step = {
    .option = "steps", .coarsest = 16, .refine = 2, .level_count = 5, .order = 2};

static bool can_render_single(const struct neph_scene *scene, const struct neph_settings *settings,
                              char *reason, size_t reason_size)
{
    (void)settings;
    return neph_march_can_render(scene, NEPH_MARCH_SINGLE, reason, reason_size);
}

static enum neph_status render_single(const struct neph_shot *shot, struct neph_image **frame,
                                      struct neph_cost *cost, struct neph_diag *diag)
{
    return render(NEPH_MARCH_SINGLE, shot, frame, cost, diag);
}

const struct neph_engine neph_engine_march = {
    .name = "march",
    .summary = "our Vulkan ray marcher: full resolution, fixed steps, single scattering",
    .rung = NEPH_RUNG_MODEL,
    .typical_s = 2.0,
    .bias = "step error of order 2 where the scene is smooth, of order 1 at the edges of shadows",
    .options = options,
    .version = 3, /* no fused fraction of a voxel */
    .step = step,
    .probe = neph_vulkan_probe,
    .can_render = can_render_single,
    .render = render_single,
};

static bool can_render_octaves(const struct neph_scene *scene, const struct neph_settings *settings,
                               char *reason, size_t reason_size)
{
    (void)settings;
    return neph_march_can_render(scene, NEPH_MARCH_OCTAVES, reason, reason_size);
}

static enum neph_status render_octaves(const struct neph_shot *shot, struct neph_image **frame,
                                       struct neph_cost *cost, struct neph_diag *diag)
{
    return render(NEPH_MARCH_OCTAVES, shot, frame, cost, diag);
}

const struct neph_engine neph_engine_march_octaves = {
    .name = "march_octaves",
    .summary = "the same with multiple scattering as a sum of octaves: a look, not physics",
    .rung = NEPH_RUNG_MODEL,
    .typical_s = 2.0,
    .look = true,
    .bias = "a sum of octaves saturates with optical depth and does not conserve energy",
    .options = options,
    .version = 3, /* no fused fraction of a voxel */
    .step = step,
    .probe = neph_vulkan_probe,
    .can_render = can_render_octaves,
    .render = render_octaves,
};

static bool can_render_horizon(const struct neph_scene *scene, const struct neph_settings *settings,
                               char *reason, size_t reason_size)
{
    (void)settings;
    return neph_march_can_render(scene, NEPH_MARCH_HORIZON, reason, reason_size);
}

static enum neph_status render_horizon(const struct neph_shot *shot, struct neph_image **frame,
                                       struct neph_cost *cost, struct neph_diag *diag)
{
    return render(NEPH_MARCH_HORIZON, shot, frame, cost, diag);
}

const struct neph_engine neph_engine_march_horizon = {
    .name = "march_horizon",
    .summary = "the same with the light of Horizon's clouds: a look, not physics",
    .rung = NEPH_RUNG_MODEL,
    .typical_s = 2.0,
    .look = true,
    .bias = "floored Beer, lobes that do not integrate to 1, light where there is no density",
    .options = options,
    .version = 3, /* no fused fraction of a voxel */
    .step = step,
    .probe = neph_vulkan_probe,
    .can_render = can_render_horizon,
    .render = render_horizon,
};
