/* SPDX-License-Identifier: MIT */
#include "renderer/sky/sky.h"

#include "scenes/radial.h"
#include "scenes/solids.h"

#include <math.h>
#include <stdlib.h>

/* Does not compile with a new kind: this file then needs a change. */
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");

struct neph_sky {
    const struct neph_scene *scene; /* borrowed */
    struct neph_sky_air air;
    struct neph_sky_sun_table sun;
    struct neph_sky_field field;
    struct neph_sky_sources sources;
    struct neph_sky_view_params view;
    struct neph_sky_view_table views; /* of one position, if filled */
    struct neph_vec3 sun_direction;
    double irradiance[3];
    int steps;
};

static enum neph_status fill(struct neph_sky *sky, const struct neph_scene *scene,
                             const struct neph_sky_params *params, struct neph_diag *diag)
{
    enum neph_status status = neph_sky_sun_table_create(&sky->air, params->sun_altitudes,
                                                        params->sun_cosines, &sky->sun, diag);
    sky->sources = (struct neph_sky_sources){
        .sun = &sky->sun, .media_scatter = scene->scattering != NEPH_SCATTERING_NONE};
    if (status || scene->scattering != NEPH_SCATTERING_MULTIPLE)
        return status;
    sky->sources.field = &sky->field;
    return neph_sky_solve(&sky->air, &sky->sun, &params->field, &sky->field, diag);
}

enum neph_status neph_sky_create(const struct neph_scene *scene,
                                 const struct neph_sky_params *params, struct neph_sky **sky,
                                 struct neph_diag *diag)
{
    char reason[200];
    struct neph_sky *made = calloc(1, sizeof(*made));
    if (!made)
        return neph_fail_memory(diag);
    made->scene = scene;
    made->steps = params->steps;
    made->view = params->view;
    made->sun_direction = scene->sun.direction;
    if (scene->sun.present) {
        made->irradiance[0] = scene->sun.irradiance_w_per_m2.r;
        made->irradiance[1] = scene->sun.irradiance_w_per_m2.g;
        made->irradiance[2] = scene->sun.irradiance_w_per_m2.b;
    }
    enum neph_status status = NEPH_OK;
    if (!neph_sky_air_of(scene, &made->air, reason, sizeof(reason)))
        status = neph_fail(diag, NEPH_ERR_UNSUPPORTED, "engine sky does not support %s", reason);
    if (!status)
        status = fill(made, scene, params, diag);
    if (status)
        neph_sky_destroy(made);
    else
        *sky = made;
    return status;
}

void neph_sky_destroy(struct neph_sky *sky)
{
    if (!sky)
        return;
    neph_sky_view_table_destroy(&sky->views);
    neph_sky_field_destroy(&sky->field);
    neph_sky_sun_table_destroy(&sky->sun);
    free(sky);
}

static double altitude_of(const struct neph_sky *sky, struct neph_vec3 point_m)
{
    const long double radius_m = neph_radial_distance_m(sky->air.center_m, point_m);
    return fmax(0.0, (double)(radius_m - (long double)sky->air.radius_m));
}

static struct neph_vec3 vertical_at(const struct neph_sky *sky, struct neph_vec3 point_m)
{
    return neph_vec3_normalize(neph_vec3_sub(point_m, sky->air.center_m));
}

enum neph_status neph_sky_stand(struct neph_sky *sky, struct neph_vec3 eye_m,
                                struct neph_diag *diag)
{
    if (!sky->view.is_table)
        return NEPH_OK;
    neph_sky_view_table_destroy(&sky->views);
    return neph_sky_view_table_create(
        &sky->air, &sky->sources, &sky->view, sky->steps, altitude_of(sky, eye_m),
        neph_vec3_dot(sky->sun_direction, vertical_at(sky, eye_m)), &sky->views, diag);
}

static bool is_ground(const struct neph_sky *sky, const struct neph_hit *hit)
{
    return hit->solid == &sky->scene->solids[0];
}

/* Add the light that a solid reflects, attenuated by the air in front of it: sunlight, with shadows
 * of solids, and light of sky and ground, without occlusion by the solid itself. */
static void add_solid(const struct neph_sky *sky, const struct neph_hit *hit,
                      struct neph_vec3 point_m, struct neph_sky_light *light)
{
    const struct neph_vec3 sun = sky->sun_direction, up = vertical_at(sky, point_m);
    const double sun_cosine = neph_vec3_dot(sun, up);
    const struct neph_vec3 over = neph_vec3_along(sun, up, -sun_cosine);
    const double across = neph_vec3_length(over); /* 0: the sun is at the zenith, so the direction
                                                     is arbitrary */
    const struct neph_vec3 ahead = neph_vec3_scale(over, 1.0 / fmax(across, 1e-12));
    const struct neph_vec3 normal = {neph_vec3_dot(hit->normal, ahead), 0.0,
                                     neph_vec3_dot(hit->normal, up)};
    const double albedo[3] = {hit->solid->albedo.r, hit->solid->albedo.g, hit->solid->albedo.b};
    double irradiance[3];
    neph_sky_irradiance(&sky->air, &sky->sources, altitude_of(sky, point_m), sun_cosine, normal,
                        neph_scene_sees_sun(sky->scene, neph_hit_outside_m(hit, point_m)),
                        irradiance);
    for (int c = 0; c < 3; c++)
        light->radiance[c] += light->transmittance[c] * albedo[c] / M_PI * irradiance[c];
}

/* The table of views contains no solids and none of their shadows. */
static struct neph_sky_light see_past_solids(const struct neph_sky *sky, struct neph_sky_ray *ray,
                                             struct neph_vec3 origin_m, struct neph_vec3 direction)
{
    const struct neph_hit hit = neph_scene_hit(sky->scene, origin_m, direction);
    const struct neph_vec3 point_m = neph_vec3_along(origin_m, direction, hit.t_m);
    if (!hit.solid)
        return sky->views.nodes ? neph_sky_view(&sky->air, &sky->views, ray)
                                : neph_sky_walk(&sky->air, &sky->sources, ray, sky->steps);
    if (is_ground(sky, &hit))
        ray->shaded = !neph_scene_sees_sun(sky->scene, neph_hit_outside_m(&hit, point_m));
    else
        ray->stop_m = hit.t_m;
    struct neph_sky_light light = neph_sky_walk(&sky->air, &sky->sources, ray, sky->steps);
    if (!is_ground(sky, &hit))
        add_solid(sky, &hit, point_m, &light);
    return light;
}

struct neph_sky_light neph_sky_see(const struct neph_sky *sky, struct neph_vec3 origin_m,
                                   struct neph_vec3 direction)
{
    const struct neph_vec3 up = vertical_at(sky, origin_m);
    struct neph_sky_ray ray = {.altitude_m = altitude_of(sky, origin_m),
                               .cosine = neph_vec3_dot(direction, up),
                               .sun_cosine = neph_vec3_dot(sky->sun_direction, up),
                               .toward_sun = neph_vec3_dot(direction, sky->sun_direction)};
    struct neph_sky_light light;
    neph_sky_find_phases(&sky->air, &ray);
    if (sky->scene->solid_count > 1)
        light = see_past_solids(sky, &ray, origin_m, direction);
    else if (sky->views.nodes)
        light = neph_sky_view(&sky->air, &sky->views, &ray);
    else
        light = neph_sky_walk(&sky->air, &sky->sources, &ray, sky->steps);
    for (int c = 0; c < 3; c++) {
        light.radiance[c] *= sky->irradiance[c];
        light.volume[c] *= sky->irradiance[c];
    }
    return light;
}
