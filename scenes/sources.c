/* SPDX-License-Identifier: MIT */
#include "scenes/sources.h"

#include "scenes/emission.h"

#include <math.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");

static const double differs_by = 8.0;

static struct neph_rgb sunlight(const struct neph_scene *scene)
{
    const struct neph_rgb none = {0, 0, 0};
    return scene->sun.present ? neph_rgb_scale(scene->sun.irradiance_w_per_m2, 1.0 / (4.0 * M_PI))
                              : none;
}

/* Incident light without direct sunlight. With all orders of scattering, media light one another by
 * their emission and by scattered sunlight, which is estimated as the same amount again; a light is
 * assumed to be one metre away. */
static struct neph_rgb incident_light(const struct neph_scene *scene)
{
    struct neph_rgb light = {0, 0, 0};
    if (scene->environment_light)
        light = scene->background_w_per_m2_sr;
    if (scene->scattering != NEPH_SCATTERING_MULTIPLE)
        return light;
    light = neph_rgb_add(light, sunlight(scene));
    for (int m = 0; m < scene->medium_count; m++)
        light = neph_rgb_add(light, neph_medium_glow(&scene->media[m]));
    for (int l = 0; l < scene->light_count; l++)
        light = neph_rgb_add(
            light, neph_rgb_scale(scene->lights[l].intensity_w_per_sr, 1.0 / (4.0 * M_PI)));
    return light;
}

/* Sets channels without extinction, which have no collisions, to 0. */
static struct neph_rgb clear_unused_channels(struct neph_rgb color, struct neph_rgb light)
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
    const struct neph_rgb scattered = clear_unused_channels(medium->extinction_color,
                                                            medium->albedo);
    source.ambient = neph_rgb_add(source.ambient, neph_rgb_mul(scattered, incident_light(scene)));
    source.sun = neph_rgb_mul(scattered, sunlight(scene));
    return source;
}

static double get_channel(struct neph_rgb rgb, int channel)
{
    return channel == 0 ? rgb.r : channel == 1 ? rgb.g : rgb.b;
}

/* Channels without extinction in a medium are skipped: it has no collisions there. */
bool neph_scene_sources_differ(const struct neph_scene *scene)
{
    double least[3] = {INFINITY, INFINITY, INFINITY}, most[3] = {0.0, 0.0, 0.0};
    for (int m = 0; m < scene->medium_count; m++) {
        const struct neph_medium *medium = &scene->media[m];
        const struct neph_source source = neph_medium_source(scene, medium);
        const struct neph_rgb all = neph_rgb_add(source.sun, source.ambient);
        for (int j = 0; j < 3; j++) {
            if (!(get_channel(medium->extinction_color, j) > 0.0))
                continue;
            least[j] = fmin(least[j], get_channel(all, j));
            most[j] = fmax(most[j], get_channel(all, j));
        }
    }
    return most[0] > differs_by * least[0] || most[1] > differs_by * least[1] ||
           most[2] > differs_by * least[2];
}
