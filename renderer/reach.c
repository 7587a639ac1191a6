/* SPDX-License-Identifier: MIT */
#include "renderer/reach.h"

#include "scenes/grid.h"
#include "scenes/horizon.h"
#include "scenes/media.h"

#include <math.h>
#include <stdio.h>

/* Of extinction times distance. An opaque box with sunlight scattered once, against closed forms:
 * pixels are off by 0.7 % rms and their mean by 0.05 % at 1e5, by 7 % and 0.4 % at 9e5, by 68 % and
 * 17 % at 9e6. Blobs and voxels whose edges are soft are good to 0.05 % even there. */
static const double reach_max = 1e5;

static double largest_extinction_per_m(const struct neph_medium *medium)
{
    if (medium->kind == NEPH_MEDIUM_GRID)
        return medium->extinction_per_m * (double)medium->grid->maximum;
    if (medium->kind == NEPH_MEDIUM_HORIZON)
        return medium->extinction_per_m * fmax(1.0, 2.0 * medium->horizon->params.density);
    return medium->extinction_per_m;
}

/* Where density rises from 0 in proportion to a way, as far as `rise_m`, what one sees of it has
 * this extinction: optical depth 1 is reached at sqrt(2 rise / extinction). */
static double ramp_per_m(double extinction_per_m, double rise_m)
{
    return fmin(extinction_per_m, sqrt(2.0 * extinction_per_m / rise_m));
}

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

/* The extinction of what one sees of a medium from outside [1/m]. */
static double skin_per_m(const struct neph_medium *medium)
{
    const double extinction_per_m = largest_extinction_per_m(medium);
    if (is_cut(medium))
        return extinction_per_m;
    if (medium->kind == NEPH_MEDIUM_GAUSSIAN) { /* where extinction x w^2 / r is 1 */
        const double width_m = medium->gaussian.width_m;
        const double depth = fmax(extinction_per_m * width_m, exp(0.5));
        return fmin(extinction_per_m, sqrt(2.0 * log(depth)) / width_m);
    }
    if (medium->kind == NEPH_MEDIUM_SHELL)
        return fmin(extinction_per_m, 1.0 / medium->shell.scale_height_m);
    if (medium->kind == NEPH_MEDIUM_GRID) {
        const struct neph_vec3 spacing_m = medium->grid->spacing_m;
        return ramp_per_m(extinction_per_m, fmin(spacing_m.x, fmin(spacing_m.y, spacing_m.z)));
    }
    return extinction_per_m;
}

static double between(double low, double high, double value)
{
    return fmin(fmax(value, low), high);
}

/* Of a point from a box; 0 inside. */
static double distance_m(const struct neph_bounds *box, struct neph_vec3 point_m)
{
    const struct neph_vec3 nearest_m = {between(box->min_m.x, box->max_m.x, point_m.x),
                                        between(box->min_m.y, box->max_m.y, point_m.y),
                                        between(box->min_m.z, box->max_m.z, point_m.z)};
    return neph_vec3_length(neph_vec3_sub(nearest_m, point_m));
}

/* Extinction times distance of a layer of fog. From above one sees it where it grows by a factor e
 * within a mean free path, unless it ends before. */
static double layer_reach(const struct neph_fog_layer *layer, const struct neph_bounds *box,
                          struct neph_vec3 camera_m, double *extinction_per_m)
{
    const double b_per_m = layer->falloff_per_m;
    *extinction_per_m = layer->extinction_per_m;
    if (layer->extinction_per_m <= 0.0)
        return 0.0;
    if (b_per_m <= 0.0)
        return layer->extinction_per_m * distance_m(box, camera_m);
    const double skin_y_m = layer->height_m + log(layer->extinction_per_m / b_per_m) / b_per_m;
    const double face_per_m = layer->extinction_per_m *
                              exp(-b_per_m * (box->min_m.y - layer->height_m));
    *extinction_per_m = isfinite(box->min_m.y) ? fmax(b_per_m, fmin(face_per_m, 1e20)) : b_per_m;
    if (skin_y_m < box->min_m.y) /* thin down to its end */
        return face_per_m * distance_m(box, camera_m);
    return fmax(*extinction_per_m * distance_m(box, camera_m),
                b_per_m * fmax(0.0, camera_m.y - skin_y_m));
}

/* Extinction times distance of a medium from the camera. */
static double medium_reach(const struct neph_medium *medium, struct neph_vec3 camera_m,
                           double *extinction_per_m)
{
    const struct neph_bounds box = neph_medium_support(medium);
    if (medium->layer_count == 0) {
        *extinction_per_m = skin_per_m(medium);
        return *extinction_per_m * distance_m(&box, camera_m);
    }
    double largest = 0.0;
    for (int i = 0; i < medium->layer_count; i++) {
        double layer_per_m;
        const double reach = layer_reach(&medium->layers[i], &box, camera_m, &layer_per_m);
        if (i == 0 || reach > largest) {
            largest = reach;
            *extinction_per_m = layer_per_m;
        }
    }
    return largest;
}

bool neph_float32_reaches(const struct neph_scene *scene, char *reason, size_t reason_size)
{
    for (int m = 0; m < scene->medium_count; m++)
        if (scene->media[m].kind == NEPH_MEDIUM_PLUME) {
            snprintf(reason, reason_size, "a %s, for which there is no shader",
                     neph_medium_facts(NEPH_MEDIUM_PLUME)->name);
            return false;
        }
    for (int k = 0; k < scene->camera_key_count; k++)
        for (int m = 0; m < scene->medium_count; m++) {
            double extinction_per_m;
            const double reach = medium_reach(&scene->media[m], scene->camera_keys[k].position_m,
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
