/* SPDX-License-Identifier: MIT */
#include "renderer/post/volumes.h"

#include <math.h>

/* Does not compile with a new kind: this file then needs a change. */
_Static_assert(NEPH_OPTION_KIND_COUNT == 3, "a new kind");

void neph_post_apply_changes(const struct neph_post_changes *changes,
                             struct neph_settings *settings)
{
    for (int i = 0; i < POST_SETTING_COUNT; i++)
        if (changes->is_given[i])
            settings->values[i] = changes->values[i];
}

static double outside_m(double x, double low, double high)
{
    return fmax(fmax(low - x, x - high), 0.0);
}

double neph_post_volume_weight(const struct neph_post_volume *volume, struct neph_vec3 place_m)
{
    const struct neph_vec3 low = volume->box.minimum_m, high = volume->box.maximum_m;
    if (!volume->box.present)
        return volume->weight;
    const double x_m = outside_m(place_m.x, low.x, high.x);
    const double y_m = outside_m(place_m.y, low.y, high.y);
    const double z_m = outside_m(place_m.z, low.z, high.z);
    const double distance_m = sqrt(x_m * x_m + y_m * y_m + z_m * z_m);
    if (distance_m == 0.0)
        return volume->weight;
    return distance_m < volume->blend_radius_m
               ? volume->weight * (1.0 - distance_m / volume->blend_radius_m)
               : 0.0;
}

static void move_towards(const struct neph_post_changes *changes, double weight,
                         struct neph_settings *settings)
{
    for (int i = 0; i < POST_SETTING_COUNT; i++) {
        const bool is_real = neph_post_options[i].kind == NEPH_OPTION_REAL;
        double *value = &settings->values[i];
        if (changes->is_given[i] && weight > 0.0)
            *value = is_real ? *value + weight * (changes->values[i] - *value) : changes->values[i];
    }
}

/* Insertion sort is stable. */
static void sort(const struct neph_post_volume *volumes, int count, int *order)
{
    for (int i = 0; i < count; i++) {
        int place = i;
        for (; place > 0 && volumes[order[place - 1]].priority > volumes[i].priority; place--)
            order[place] = order[place - 1];
        order[place] = i;
    }
}

void neph_post_blend(const struct neph_post_volume *volumes, int count, struct neph_vec3 place_m,
                     struct neph_settings *settings)
{
    int order[NEPH_POST_VOLUMES_MAX];
    sort(volumes, count, order);
    for (int i = 0; i < count; i++)
        move_towards(&volumes[order[i]].changes,
                     neph_post_volume_weight(&volumes[order[i]], place_m), settings);
}
