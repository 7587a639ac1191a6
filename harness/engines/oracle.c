/* SPDX-License-Identifier: MIT
 *
 * Engine `oracle`: the unbiased path tracer in double precision on the CPU, with the variance of
 * every pixel (variance.*).
 */
#include "harness/engines/engines.h"

#include "harness/engines/process_cost.h"
#include "truth/oracle.h"

#include <math.h>
#include <stdio.h>

static const struct neph_option options[] = {
    {.name = "samples",
     .kind = NEPH_OPTION_INTEGER,
     .default_value = 64,
     .minimum = 2,
     .maximum = 1 << 30,
     .help = "paths per pixel; the most when there is a target or a limit"},
    {.name = "target_error",
     .kind = NEPH_OPTION_REAL,
     .default_value = 0,
     .minimum = 0,
     .maximum = 1,
     .help = "stop when the rms standard error of the pixels, relative to the rms radiance of "
             "volume light, is below this; 0: never"},
    {.name = "time_limit",
     .kind = NEPH_OPTION_REAL,
     .default_value = 0,
     .minimum = 0,
     .maximum = 1e9,
     .help = "stop after this time with the samples so far [s]; 0: no limit (needed for equal "
             "results on all machines)"},
    {.name = NULL},
};

static bool can_render(const struct neph_scene *scene, const struct neph_settings *settings,
                       char *reason, size_t reason_size)
{
    (void)settings;
    return neph_oracle_can_render(scene, reason, reason_size);
}

static enum neph_status label(struct neph_image *frame, const struct neph_oracle_stats *stats,
                              struct neph_diag *diag)
{
    enum neph_status status = neph_image_set_attribute(frame, "neph.oracle.samples", diag, "%d",
                                                       stats->samples);
    if (!status)
        status = neph_image_set_attribute(frame, "neph.oracle.error", diag, "%.3g", stats->error);
    if (!status)
        status = neph_image_set_attribute(frame, "neph.oracle.collisions", diag, "%llu",
                                          (unsigned long long)stats->collisions);
    return status ? status : neph_doubt_label(frame, &stats->doubt, diag);
}

static enum neph_status render(const struct neph_shot *shot, struct neph_image **frame,
                               struct neph_cost *cost, struct neph_diag *diag)
{
    const struct neph_stopwatch start = neph_stopwatch_start();
    const struct neph_settings *settings = &shot->settings;
    const double limit_s = neph_setting(&neph_engine_oracle, settings, "time_limit");
    const struct neph_oracle_params params = {
        .width_px = shot->width_px,
        .height_px = shot->height_px,
        .frame = shot->frame,
        .seed = shot->seed,
        .samples = (int)neph_setting(&neph_engine_oracle, settings, "samples"),
        .target_error = neph_setting(&neph_engine_oracle, settings, "target_error"),
        .time_limit_s = limit_s > 0.0 ? limit_s : INFINITY,
        .checkpoint = shot->checkpoint,
    };
    struct neph_image *image = NULL;
    struct neph_oracle_stats stats = {.wall_s = NAN};
    enum neph_status status = neph_oracle_render(shot->scene, &params, &image, &stats, diag);
    if (!status)
        status = label(image, &stats, diag);
    return neph_finish_process_frame(status, image, start, stats.wall_s, frame, cost);
}

static void probe(const struct neph_engine *engine, struct neph_shared_device *device,
                  struct neph_engine_info *info)
{
    (void)engine, (void)device;
    *info = (struct neph_engine_info){.available = true};
    snprintf(info->version, sizeof(info->version), "path tracer, revision %u",
             (unsigned)neph_engine_oracle.version);
    snprintf(info->device, sizeof(info->device), "CPU, double precision");
}

const struct neph_engine neph_engine_oracle = {
    .name = "oracle",
    .summary = "unbiased path tracer in double precision on the CPU, with its noise per pixel",
    .rung = NEPH_LEVEL_TRACER,
    .typical_s = 60.0,
    .can_checkpoint = true,
    .stochastic = true,
    .options = options,
    .version = 3, /* 3: says whether its variances are to be trusted */
    .probe = probe,
    .can_render = can_render,
    .render = render,
};
