/* SPDX-License-Identifier: MIT
 *
 * Engine `surfaces`: light between solids in clear air, split into the parts that screen-space
 * methods use, in double precision on the CPU, with the variance of every pixel (variance.*).
 */
#include "harness/engines/engines.h"

#include "harness/engines/own_cost.h"
#include "truth/surfaces.h"

#include <math.h>
#include <stdio.h>

static const struct neph_option options[] = {
    {.name = "samples",
     .kind = NEPH_OPTION_INTEGER,
     .default_value = 256,
     .minimum = 2,
     .maximum = 1 << 30,
     .help = "paths per pixel"},
    {.name = "bounces",
     .kind = NEPH_OPTION_INTEGER,
     .default_value = NEPH_ALL_BOUNCES,
     .minimum = 0,
     .maximum = NEPH_ALL_BOUNCES,
     .help = "surfaces that light meets before the visible one: 0: direct light; 1: the indirect "
             "light that screen-space methods can compute; the maximum: no limit"},
    {.name = "ao_distance_m",
     .kind = NEPH_OPTION_REAL,
     .default_value = 0,
     .minimum = 0,
     .maximum = 1e6,
     .help = "layer ao: farther solids do not occlude [m]; 0: no limit"},
    {.name = NULL},
};

static bool can_render(const struct neph_scene *scene, const struct neph_settings *settings,
                       char *reason, size_t reason_size)
{
    (void)settings;
    if (scene->solid_count > 0)
        return neph_reflected_can(scene, reason, reason_size);
    snprintf(reason, reason_size, "a scene without solids");
    return false;
}

static enum neph_status render(const struct neph_shot *shot, struct neph_image **frame,
                               struct neph_cost *cost, struct neph_diag *diag)
{
    const struct neph_stopwatch start = neph_stopwatch_start();
    const struct neph_settings *settings = &shot->settings;
    const double distance_m = neph_setting(&neph_engine_surfaces, settings, "ao_distance_m");
    const struct neph_surfaces_params params = {
        .width_px = shot->width_px,
        .height_px = shot->height_px,
        .frame = shot->frame,
        .seed = shot->seed,
        .samples = (int)neph_setting(&neph_engine_surfaces, settings, "samples"),
        .limits = {.bounces = (int)neph_setting(&neph_engine_surfaces, settings, "bounces"),
                   .ao_distance_m = distance_m > 0.0 ? distance_m : INFINITY},
    };
    const enum neph_status status = neph_surfaces_render(shot->scene, &params, frame, diag);
    *cost = neph_own_cost(start, NAN);
    return status;
}

static void probe(const struct neph_engine *engine, struct neph_shared_device *device,
                  struct neph_engine_info *info)
{
    (void)engine, (void)device;
    *info = (struct neph_engine_info){.available = true};
    snprintf(info->version, sizeof(info->version), "light between surfaces, revision %u",
             (unsigned)neph_engine_surfaces.version);
    snprintf(info->device, sizeof(info->device), "CPU, double precision");
}

const struct neph_engine neph_engine_surfaces = {
    .name = "surfaces",
    .summary =
        "light between solids in clear air on the CPU, in parts and with its noise per pixel",
    .rung = NEPH_RUNG_TRACER,
    .is_narrow = true,
    .typical_s = 30.0,
    .stochastic = true,
    .options = options,
    .version = 1,
    .probe = probe,
    .can_render = can_render,
    .render = render,
};
