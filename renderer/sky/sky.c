/* SPDX-License-Identifier: MIT */
#include "renderer/sky/sky.h"

#include "scenes/radial.h"

#include <math.h>
#include <stdlib.h>

struct neph_sky {
    struct neph_sky_air air;
    struct neph_sky_sun_table sun;
    struct neph_sky_field field;
    struct neph_sky_sources sources;
    struct neph_sky_view_params view;
    struct neph_sky_view_table views; /* of a place, where there is one */
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
        status = neph_fail(diag, NEPH_ERR_UNSUPPORTED, "engine sky has no tables for %s", reason);
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

struct neph_sky_light neph_sky_see(const struct neph_sky *sky, struct neph_vec3 origin_m,
                                   struct neph_vec3 direction)
{
    const struct neph_vec3 up = vertical_at(sky, origin_m);
    struct neph_sky_ray ray = {.altitude_m = altitude_of(sky, origin_m),
                               .cosine = neph_vec3_dot(direction, up),
                               .sun_cosine = neph_vec3_dot(sky->sun_direction, up),
                               .toward_sun = neph_vec3_dot(direction, sky->sun_direction)};
    neph_sky_find_phases(&sky->air, &ray);
    struct neph_sky_light light = sky->views.nodes
                                      ? neph_sky_view(&sky->air, &sky->views, &ray)
                                      : neph_sky_walk(&sky->air, &sky->sources, &ray, sky->steps);
    for (int c = 0; c < 3; c++) {
        light.radiance[c] *= sky->irradiance[c];
        light.volume[c] *= sky->irradiance[c];
    }
    return light;
}
