/* SPDX-License-Identifier: MIT
 *
 * Finds scenes in which paths of light have infinite mean length.
 */
#include "scenes/trapped_light.h"

#include "scenes/solids.h"

#include <math.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");

const char neph_trapped_light_reason[] =
    "multiple scattering without absorption in a fog that has no end: paths of infinite mean "
    "length (give it bounds, a ground, or an albedo below 1)";

static bool is_white(struct neph_rgb albedo)
{
    return albedo.r >= 1.0 || albedo.g >= 1.0 || albedo.b >= 1.0;
}

/* Whether light straight down from a camera never meets a solid. */
static bool has_no_ground(const struct neph_scene *scene)
{
    for (int i = 0; i < scene->camera_key_count; i++)
        if (!neph_scene_hit(scene, scene->camera_keys[i].position_m, (struct neph_vec3){0, -1, 0})
                 .solid)
            return true;
    return false;
}

static bool is_cut(double minimum_m, double maximum_m)
{
    return isfinite(minimum_m) && isfinite(maximum_m);
}

/* Light in a half-space without absorption always escapes, but after infinitely many events on
 * average (a recurrent random walk): a path tracer does not terminate. */
static bool is_bottomless(const struct neph_scene *scene, const struct neph_medium *medium)
{
    if (medium->layer_count == 0 || !is_white(medium->albedo))
        return false;
    const struct neph_bounds *b = &medium->bounds;
    if (is_cut(b->min_m.x, b->max_m.x) || is_cut(b->min_m.z, b->max_m.z))
        return false;
    bool thins_out = true;
    for (int l = 0; l < medium->layer_count; l++)
        thins_out = thins_out && medium->layers[l].falloff_per_m > 0.0;
    const bool top = isfinite(b->max_m.y) || thins_out;
    const bool bottom = isfinite(b->min_m.y) || !has_no_ground(scene);
    return !top || !bottom;
}

bool neph_scene_traps_light(const struct neph_scene *scene)
{
    for (int m = 0; m < scene->medium_count; m++)
        if (scene->scattering == NEPH_SCATTERING_MULTIPLE && is_bottomless(scene, &scene->media[m]))
            return true;
    return false;
}
