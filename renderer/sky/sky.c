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
    neph_sky_field_destroy(&sky->field);
    neph_sky_sun_table_destroy(&sky->sun);
    free(sky);
}

struct neph_sky_light neph_sky_see(const struct neph_sky *sky, struct neph_vec3 origin_m,
                                   struct neph_vec3 direction)
{
    const struct neph_vec3 from_center_m = neph_vec3_sub(origin_m, sky->air.center_m);
    const struct neph_vec3 up = neph_vec3_normalize(from_center_m);
    const double altitude_m = (double)(neph_radial_distance_m(sky->air.center_m, origin_m) -
                                       (long double)sky->air.radius_m);
    const struct neph_sky_ray ray = {fmax(0.0, altitude_m), neph_vec3_dot(direction, up),
                                     neph_vec3_dot(sky->sun_direction, up),
                                     neph_vec3_dot(direction, sky->sun_direction)};
    struct neph_sky_light light = neph_sky_walk(&sky->air, &sky->sources, &ray, sky->steps);
    for (int c = 0; c < 3; c++) {
        light.radiance[c] *= sky->irradiance[c];
        light.volume[c] *= sky->irradiance[c];
    }
    return light;
}
