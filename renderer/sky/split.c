/* SPDX-License-Identifier: MIT */
#include "renderer/sky/split.h"

#include <stdio.h>

/* Does not compile with a new kind: this file then needs a change. */
_Static_assert(NEPH_MEDIUM_KIND_COUNT == 8, "a new kind");
_Static_assert(NEPH_SOLID_KIND_COUNT == 3, "a new kind");

static bool is_around(const struct neph_solid *ground, struct neph_vec3 center_m, double radius_m)
{
    return center_m.x == ground->center_m.x && center_m.y == ground->center_m.y &&
           center_m.z == ground->center_m.z && radius_m == ground->radius_m;
}

/* Whether a medium is a layer around the ground; a layer around anything else counts as a cloud. */
static bool is_air(const struct neph_medium *medium, const struct neph_solid *ground)
{
    if (medium->kind == NEPH_MEDIUM_SHELL)
        return is_around(ground, medium->shell.center_m, medium->shell.radius_m);
    if (medium->kind == NEPH_MEDIUM_TENT)
        return is_around(ground, medium->tent.center_m, medium->tent.radius_m);
    return false;
}

static void keep_media(const struct neph_scene *scene, const struct neph_sky_split *split, bool air,
                       struct neph_scene *kept)
{
    *kept = *scene;
    kept->borrows = true;
    kept->medium_count = 0;
    for (int i = 0; i < scene->medium_count; i++)
        if (split->is_air[i] == air)
            kept->media[kept->medium_count++] = scene->media[i];
}

bool neph_sky_split(const struct neph_scene *scene, struct neph_sky_split *split, char *reason,
                    size_t reason_size)
{
    struct neph_scene alone;
    *split = (struct neph_sky_split){.is_air = {false}};
    if (scene->solid_count == 0 || scene->solids[0].kind != NEPH_SOLID_SPHERE) {
        snprintf(reason, reason_size, "a first solid that is not a sphere, the ground");
        return false;
    }
    for (int i = 0; i < scene->medium_count; i++)
        split->is_air[i] = is_air(&scene->media[i], &scene->solids[0]);
    keep_media(scene, split, true, &alone);
    return neph_sky_read_air(&alone, &split->air, reason, reason_size);
}

struct neph_scene neph_sky_remove_air(const struct neph_scene *scene,
                                      const struct neph_sky_split *split)
{
    struct neph_scene rest;
    keep_media(scene, split, false, &rest);
    if (rest.medium_count == 0)
        rest.scattering = NEPH_SCATTERING_NONE;
    return rest;
}
