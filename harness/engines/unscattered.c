/* SPDX-License-Identifier: MIT
 *
 * Engine `unscattered`: what exact has of a scene whose media only attenuate, of any scene. Against
 * a reference with scattering it shows what scattering adds.
 */
#include "harness/engines/engines.h"

#include "harness/engines/cpu_frame.h"
#include "harness/engines/own_cost.h"

#include <math.h>
#include <stdio.h>

static const struct neph_option no_options[] = {{.name = NULL}};

static struct neph_scene without_scattering(const struct neph_scene *scene)
{
    struct neph_scene made = *scene;
    made.scattering = NEPH_SCATTERING_NONE;
    return made;
}

static struct neph_ray_light see_ray(const void *scene, struct neph_vec3 origin_m,
                                     struct neph_vec3 direction)
{
    return neph_transport_ray(scene, origin_m, direction);
}

static enum neph_status render(const struct neph_shot *shot, struct neph_image **frame,
                               struct neph_cost *cost, struct neph_diag *diag)
{
    const struct neph_stopwatch start = neph_stopwatch_start();
    const struct neph_scene scene = without_scattering(shot->scene);
    struct neph_image *image = NULL;
    double error;
    const enum neph_status status = neph_cpu_frame(shot, see_ray, &scene, &image, &error, diag);
    return neph_own_frame(status, image, start, NAN, frame, cost);
}

static void probe(const struct neph_engine *engine, struct neph_shared_device *device,
                  struct neph_engine_info *info)
{
    (void)engine, (void)device;
    *info = (struct neph_engine_info){.available = true};
    snprintf(info->version, sizeof(info->version), "closed forms and quadrature");
    snprintf(info->device, sizeof(info->device), "CPU, double precision");
}

static bool can_render(const struct neph_scene *scene, const struct neph_settings *settings,
                       char *reason, size_t reason_size)
{
    (void)settings;
    const struct neph_scene made = without_scattering(scene);
    return neph_transport_is_exact(&made, reason, reason_size);
}

const struct neph_engine neph_engine_unscattered = {
    .name = "unscattered",
    .summary = "attenuation alone, in double precision: what scattering adds is missing",
    .bias = "no light is scattered",
    .rung = NEPH_RUNG_MODEL,
    .typical_s = 5.0,
    .look = true,
    .is_narrow = true,
    .options = no_options,
    .version = 1,
    .probe = probe,
    .can_render = can_render,
    .render = render,
};
