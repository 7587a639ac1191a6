/* SPDX-License-Identifier: MIT
 *
 * Volumes of a scene with their own settings of the post-processing chain.
 */
#ifndef NEPH_RENDERER_POST_VOLUMES_H
#define NEPH_RENDERER_POST_VOLUMES_H

#include "base/vec3.h"
#include "renderer/post/options.h"

#include <stdbool.h>

#define NEPH_POST_VOLUMES_MAX 64

/* A subset of the settings. */
struct neph_post_changes {
    double values[POST_SETTING_COUNT];
    bool is_given[POST_SETTING_COUNT];
};

struct neph_post_box {
    bool present; /* false: everywhere */
    struct neph_vec3 minimum_m, maximum_m;
};

struct neph_post_volume {
    char *name; /* owned by the owner of the volume */
    double priority, weight, blend_radius_m;
    struct neph_post_box box;
    struct neph_post_changes changes;
};

void neph_post_apply_changes(const struct neph_post_changes *changes,
                             struct neph_settings *settings);

/* The weight of a volume at a position: its own weight inside, falling linearly to 0 over the blend
 * radius outside. */
double neph_post_volume_weight(const struct neph_post_volume *volume, struct neph_vec3 place_m);

/* The settings at a position. Volumes are applied in order of priority, equal ones in the given
 * order; each interpolates the numbers towards its own by its weight. Choices and whole numbers are
 * replaced at any weight above 0, as in Unreal Engine. At most NEPH_POST_VOLUMES_MAX volumes. */
void neph_post_blend(const struct neph_post_volume *volumes, int count, struct neph_vec3 place_m,
                     struct neph_settings *settings);

#endif
