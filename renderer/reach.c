/* SPDX-License-Identifier: MIT */
#include "renderer/reach.h"

#include "renderer/media/kind.h"
#include "renderer/relative.h"
#include "scenes/media.h"

#include <math.h>
#include <stdio.h>

/* The largest extinction times distance. An opaque box with sunlight scattered once, against closed
 * forms: pixels are off by 0.7 % rms and their mean by 0.05 % at 1e5, by 7 % and 0.4 % at 9e5, by
 * 68 % and 17 % at 9e6. Blobs and voxels whose edges are soft are good to 0.05 % even there. */
static const double reach_max = 1e5;

static bool is_same(struct neph_vec3 a, struct neph_vec3 b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

/* Whether its bounds end a medium before its density does. */
static bool is_cut(const struct neph_medium *medium)
{
    struct neph_medium whole = *medium;
    whole.bounds = (struct neph_bounds){{-INFINITY, -INFINITY, -INFINITY},
                                        {INFINITY, INFINITY, INFINITY}};
    const struct neph_bounds cut = neph_medium_support(medium), all = neph_medium_support(&whole);
    return !is_same(cut.min_m, all.min_m) || !is_same(cut.max_m, all.max_m);
}

/* The extinction of what one sees of a shape from outside [1/m]. */
static double skin_per_m(const struct neph_medium *medium)
{
    const struct neph_gpu_kind *kind = neph_gpu_kind_of(medium);
    const double largest_per_m = neph_gpu_largest_per_m(medium);
    if (!kind->skin_per_m || is_cut(medium))
        return largest_per_m;
    return fmin(largest_per_m, kind->skin_per_m(medium, largest_per_m));
}

/* Extinction times distance of a medium from the camera. */
static double eye_reach(const struct neph_medium *medium, struct neph_vec3 camera_m,
                        double *extinction_per_m)
{
    const struct neph_gpu_kind *kind = neph_gpu_kind_of(medium);
    const struct neph_bounds support = neph_medium_support(medium);
    if (kind->reach)
        return kind->reach(medium, &support, camera_m, extinction_per_m);
    *extinction_per_m = skin_per_m(medium);
    return *extinction_per_m * neph_box_distance_m(&support, camera_m);
}

/* Rays of an orthographic camera begin up to half a diagonal from it, which in pictures of 16:9 is
 * their height. What they meet lies as far away at least, even where the camera is in the medium.
 */
static double medium_reach(const struct neph_scene *scene, int m, struct neph_vec3 camera_m,
                           double *extinction_per_m)
{
    const double reach = eye_reach(&scene->media[m], camera_m, extinction_per_m);
    return hypot(reach, *extinction_per_m * scene->orthographic_height_m);
}

static bool are_known(const struct neph_scene *scene, char *reason, size_t reason_size)
{
    for (int m = 0; m < scene->medium_count; m++)
        if (!neph_gpu_kind_of(&scene->media[m])) {
            snprintf(reason, reason_size, "medium %d is a %s, for which there is no shader", m,
                     neph_medium_facts(scene->media[m].kind)->name);
            return false;
        }
    return true;
}

bool neph_float32_reaches(const struct neph_scene *scene, char *reason, size_t reason_size)
{
    if (!are_known(scene, reason, reason_size))
        return false;
    for (int k = 0; k < scene->camera_key_count; k++)
        for (int m = 0; m < scene->medium_count; m++) {
            double extinction_per_m;
            const double reach = medium_reach(scene, m, scene->camera_keys[k].position_m,
                                              &extinction_per_m);
            if (!(reach > reach_max))
                continue;
            snprintf(reason, reason_size,
                     "medium %d is too far for float32: extinction %.3g /m x distance %.3g m = "
                     "%.2g, above %.0e, where places are off by a hundredth of a mean free path; "
                     "exact and oracle reckon in double",
                     m, extinction_per_m, reach / extinction_per_m, reach, reach_max);
            return false;
        }
    return true;
}
