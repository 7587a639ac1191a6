/* SPDX-License-Identifier: MIT */
#include "scenes/sources.h"

#include "scenes/emission.h"

#include <math.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");

static const double differs_by = 8.0;

/* Without the sun's. With all orders, media and lights light one another; a light is taken to be a
 * metre away. */
static struct neph_rgb incident_light(const struct neph_scene *scene)
{
    struct neph_rgb light = {0, 0, 0};
    if (scene->environment_light)
        light = scene->background_w_per_m2_sr;
    if (scene->scattering != NEPH_SCATTERING_MULTIPLE)
        return light;
    for (int m = 0; m < scene->medium_count; m++)
        light = neph_rgb_add(light, neph_medium_glow(&scene->media[m]));
    for (int l = 0; l < scene->light_count; l++)
        light = neph_rgb_add(
            light, neph_rgb_scale(scene->lights[l].intensity_w_per_sr, 1.0 / (4.0 * M_PI)));
    return light;
}

/* Nothing collides in channels that the medium does not attenuate. */
static struct neph_rgb in_channels(struct neph_rgb color, struct neph_rgb light)
{
    return (struct neph_rgb){color.r > 0.0 ? light.r : 0.0, color.g > 0.0 ? light.g : 0.0,
                             color.b > 0.0 ? light.b : 0.0};
}

struct neph_source neph_medium_source(const struct neph_scene *scene,
                                      const struct neph_medium *medium)
{
    struct neph_source source = {{0, 0, 0}, neph_medium_glow(medium)};
    if (scene->scattering == NEPH_SCATTERING_NONE)
        return source;
    const struct neph_rgb scattered = in_channels(medium->extinction_color, medium->albedo);
    source.ambient = neph_rgb_add(source.ambient, neph_rgb_mul(scattered, incident_light(scene)));
    if (scene->sun.present)
        source.sun = neph_rgb_scale(neph_rgb_mul(scattered, scene->sun.irradiance_w_per_m2),
                                    1.0 / (4.0 * M_PI));
    return source;
}

static bool differ(double least, double most)
{
    return most > differs_by * least;
}

bool neph_scene_sources_differ(const struct neph_scene *scene)
{
    struct neph_rgb least = {INFINITY, INFINITY, INFINITY}, most = {0, 0, 0};
    for (int m = 0; m < scene->medium_count; m++) {
        const struct neph_source source = neph_medium_source(scene, &scene->media[m]);
        const struct neph_rgb all = neph_rgb_add(source.sun, source.ambient);
        least = (struct neph_rgb){fmin(least.r, all.r), fmin(least.g, all.g), fmin(least.b, all.b)};
        most = (struct neph_rgb){fmax(most.r, all.r), fmax(most.g, all.g), fmax(most.b, all.b)};
    }
    return scene->medium_count > 1 &&
           (differ(least.r, most.r) || differ(least.g, most.g) || differ(least.b, most.b));
}
