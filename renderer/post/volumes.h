/* SPDX-License-Identifier: MIT
 *
 * Volumes of a scene in which the picture chain is set otherwise.
 */
#ifndef NEPH_RENDERER_POST_VOLUMES_H
#define NEPH_RENDERER_POST_VOLUMES_H

#include "base/vec3.h"
#include "renderer/post/options.h"

#include <stdbool.h>

#define NEPH_POST_VOLUMES_MAX 64

/* Some of the settings. */
struct neph_post_changes {
    double values[POST_SETTING_COUNT];
    bool is_given[POST_SETTING_COUNT];
};

struct neph_post_box {
    bool present; /* else it is everywhere */
    struct neph_vec3 minimum_m, maximum_m;
};

struct neph_post_volume {
    char *name; /* owned by who has the volume */
    double priority, weight, blend_radius_m;
    struct neph_post_box box;
    struct neph_post_changes changes;
};

void neph_post_change(const struct neph_post_changes *changes, struct neph_settings *settings);

/* How much of a volume's settings count at a place: its weight inside, which falls to 0 linearly
 * over the blend radius outside. */
double neph_post_volume_weight(const struct neph_post_volume *volume, struct neph_vec3 place_m);

/* Settings at a place: volumes one after the other by priority, of equal ones the first first, each
 * moving the numbers towards its own by its weight. Choices and whole numbers are taken over from
 * any weight above 0 on, as Unreal does. At most NEPH_POST_VOLUMES_MAX. */
void neph_post_blend(const struct neph_post_volume *volumes, int count, struct neph_vec3 place_m,
                     struct neph_settings *settings);

#endif
