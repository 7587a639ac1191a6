/* SPDX-License-Identifier: MIT
 *
 * Engine `tracer`: the unbiased path tracer on a Vulkan device; device and environment variables as
 * of engine `march`.
 */
#include "harness/engines/engines.h"
#include "harness/engines/vulkan_device.h"

#include "harness/engines/process_cost.h"
#include "renderer/tracer.h"

#include <math.h>

enum { OPTION_SAMPLES, OPTION_TARGET_ERROR, OPTION_TIME_LIMIT, OPTION_SAMPLER, OPTION_SUN_TABLE };

static const char *const samplers[] = {"random", "sobol", NULL};

static const struct neph_option options[] = {
    [OPTION_SAMPLES] = {"samples", NEPH_OPTION_INTEGER, 256, 2, NEPH_TRACER_SAMPLES_MAX, NULL,
                        "paths per pixel, rounded up to whole batches; the most with a target"},
    [OPTION_TARGET_ERROR] = {"target_error", NEPH_OPTION_REAL, 0, 0, 1e3, NULL,
                             "stop at this rms standard error / rms volume radiance; 0: never"},
    [OPTION_TIME_LIMIT] = {"time_limit", NEPH_OPTION_REAL, 0, 0, 1e9, NULL,
                           "stop in this time [s]; 0: never"},
    [OPTION_SAMPLER] = {"sampler", NEPH_OPTION_CHOICE, 0, 0, 0, samplers,
                        "numbers of a sample: random, or Sobol's with Owen's scrambling for its "
                        "first collision, its first direction and its next free path; the variance "
                        "of a pixel then comes from only two sequences"},
    [OPTION_SUN_TABLE] = {"sun_table", NEPH_OPTION_INTEGER, NEPH_TRACER_SUN_NODES, 0,
                          NEPH_TRACER_SUN_NODES_MAX, NULL,
                          "maximum nodes of a table of the arriving sunlight, for all orders in "
                          "colourless clouds with known optical depth; a resampling weight turns "
                          "its error into noise; 0: a sun ray for each event, as elsewhere"},
    {.name = NULL},
};

static enum neph_status label(struct neph_image *frame, const struct neph_tracer_stats *stats,
                              struct neph_diag *diag)
{
    const struct {
        const char *name;
        uint64_t value;
    } counts[] = {
        {"neph.tracer.samples", (uint64_t)stats->samples},
        {"neph.tracer.collisions", stats->collisions},
        {"neph.tracer.density_lookups", stats->lookups},
        {"neph.tracer.closed_forms", stats->closed_forms},
    };
    enum neph_status status = neph_image_set_attribute(frame, "neph.tracer.error", diag, "%.6g",
                                                       stats->error);
    for (size_t i = 0; !status && i < sizeof(counts) / sizeof(counts[0]); i++)
        status = neph_image_set_attribute(frame, counts[i].name, diag, "%llu",
                                          (unsigned long long)counts[i].value);
    return status ? status : neph_doubt_label(frame, &stats->doubt, diag);
}

static enum neph_status render(const struct neph_shot *shot, struct neph_image **frame,
                               struct neph_cost *cost, struct neph_diag *diag)
{
    const struct neph_stopwatch start = neph_stopwatch_start();
    const double *values = shot->settings.values;
    const struct neph_tracer_params params = {
        .width_px = shot->width_px,
        .height_px = shot->height_px,
        .frame = shot->frame,
        .seed = shot->seed,
        .sobol = values[OPTION_SAMPLER] != 0.0,
        .sun_nodes = (int)values[OPTION_SUN_TABLE],
        .samples = (int)values[OPTION_SAMPLES],
        .target_error = values[OPTION_TARGET_ERROR],
        .time_limit_s = values[OPTION_TIME_LIMIT] > 0.0 ? values[OPTION_TIME_LIMIT] : INFINITY,
        .checkpoint = shot->checkpoint,
    };
    struct neph_open_device *device = NULL;
    struct neph_image *image = NULL;
    struct neph_tracer_stats stats = {.wall_s = NAN};
    enum neph_status status = neph_device_acquire(shot->device, &device, diag);
    if (!status)
        status = neph_tracer_render(device->vulkan, shot->scene, &params, &image, &stats, diag);
    if (!status)
        status = label(image, &stats, diag);
    neph_device_release(device);
    return neph_finish_process_frame(status, image, start, stats.wall_s, frame, cost);
}

static bool can_render(const struct neph_scene *scene, const struct neph_settings *settings,
                       char *reason, size_t reason_size)
{
    (void)settings;
    return neph_tracer_can_render(scene, reason, reason_size);
}

const struct neph_engine neph_engine_tracer = {
    .name = "tracer",
    .summary = "our Vulkan path tracer: all orders of scattering, without bias, with its variance",
    .rung = NEPH_LEVEL_TRACER,
    .typical_s = 8.0,
    .side_max_px = NEPH_TRACER_SIDE_MAX_PX,
    .can_checkpoint = true,
    .stochastic = true,
    .bias = "none; in a procedural cloud within a medium without end, single scattering against "
            "the sun at optical depths above 10 has a larger error than the frame's variance",
    .options = options,
    .version = 12, /* 12: says whether its variances are to be trusted */
    .probe = neph_vulkan_probe,
    .can_render = can_render,
    .render = render,
};
