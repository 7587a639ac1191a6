/* SPDX-License-Identifier: MIT
 *
 * Engine `exact`: the top level of the reference hierarchy. Every pixel is neph_transport_ray() of
 * its centre ray, in double precision. The remaining errors are the rounding to the frame's 32-bit
 * floats and the quadrature error, whose largest estimate is stored as an attribute.
 */
#include "harness/engines/engines.h"

#include "harness/engines/cpu_frame.h"
#include "harness/engines/process_cost.h"

#include <math.h>
#include <stdio.h>

static const struct neph_option no_options[] = {{.name = NULL}};

static struct neph_ray_light see_ray(const void *scene, struct neph_vec3 origin_m,
                                     struct neph_vec3 direction)
{
    return neph_transport_ray(scene, origin_m, direction);
}

static enum neph_status render(const struct neph_shot *shot, struct neph_image **frame,
                               struct neph_cost *cost, struct neph_diag *diag)
{
    const struct neph_stopwatch start = neph_stopwatch_start();
    struct neph_image *image = NULL;
    double error;
    enum neph_status status = neph_cpu_frame(shot, see_ray, shot->scene, &image, &error, diag);
    if (!status)
        status = neph_image_set_attribute(image, "neph.exact.quadrature_error", diag, "%.3g",
                                          error);
    return neph_finish_process_frame(status, image, start, NAN, frame, cost);
}

static void probe(const struct neph_engine *engine, struct neph_shared_device *device,
                  struct neph_engine_info *info)
{
    (void)engine, (void)device;
    *info = (struct neph_engine_info){.available = true};
    snprintf(info->version, sizeof(info->version), "closed forms and quadrature, revision %u",
             (unsigned)neph_engine_exact.version);
    snprintf(info->device, sizeof(info->device), "CPU, double precision");
}

static bool can_render(const struct neph_scene *scene, const struct neph_settings *settings,
                       char *reason, size_t reason_size)
{
    (void)settings;
    return neph_transport_is_exact(scene, reason, reason_size);
}

const struct neph_engine neph_engine_exact = {
    .name = "exact",
    .summary = "closed forms and adaptive quadrature in double precision",
    .rung = NEPH_LEVEL_EXACT,
    .typical_s = 5.0,
    .options = no_options,
    .version = 2, /* 2: coloured media, clouds */
    .probe = probe,
    .can_render = can_render,
    .render = render,
};
