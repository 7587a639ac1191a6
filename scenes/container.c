/* SPDX-License-Identifier: MIT
 *
 * A finite box for an unbounded medium. Four cuts:
 * - top: where e^-16 of the optical depth above the camera remains, so that a ray which is slanted
 *   enough to see the rest is opaque before it gets there; for a camera in nearly empty space,
 *   where a vertical ray collects less than 1e-8; higher where the sun's rays need it; where a fog
 *   is opaque upwards, not higher than that;
 * - bottom: where e^-18 of the light from the lowest camera remains;
 * - sides: moved outwards until their error in transmittance is below 1e-7, or 1000 km are reached.
 * The error of the box is measured: the largest difference in transmittance over views of all
 * slopes from the camera positions ("eyes" below).
 */
#include "scenes/media.h"
#include "scenes/medium_kind.h"

#include <math.h>

static const double top_optical_depth = 1e-8;
static const double opaque_optical_depth = 18.0;
static const double side_error = 1e-7;
static const double reach_max_m = 1e6;
static const double reach_min_m = 1.0; /* keeps cameras off the faces */

struct eyes {
    double low_m, high_m;          /* heights */
    double x0_m, x1_m, z0_m, z1_m; /* horizontal extent */
};

static struct eyes find_camera_range(const struct neph_scene *scene)
{
    struct eyes eyes = {INFINITY, -INFINITY, INFINITY, -INFINITY, INFINITY, -INFINITY};
    for (int i = 0; i < scene->camera_key_count; i++) {
        const struct neph_vec3 p = scene->camera_keys[i].position_m;
        eyes.low_m = fmin(eyes.low_m, p.y);
        eyes.high_m = fmax(eyes.high_m, p.y);
        eyes.x0_m = fmin(eyes.x0_m, p.x);
        eyes.x1_m = fmax(eyes.x1_m, p.x);
        eyes.z0_m = fmin(eyes.z0_m, p.z);
        eyes.z1_m = fmax(eyes.z1_m, p.z);
    }
    return eyes;
}

/* The height above which the layer's optical depth towards a direction with vertical component
 * k_y is `optical_depth`. */
static double height_of_depth_above(const struct neph_fog_layer *layer, double k_y,
                                    double optical_depth)
{
    return layer->height_m +
           log(layer->extinction_per_m / (layer->falloff_per_m * k_y * optical_depth)) /
               layer->falloff_per_m;
}

/* Distance D at which a vertical ray from height y is opaque: sigma(y) (1 - e^{-b D}) / b = 18,
 * with b < 0 downwards. +inf when it never is. */
static double opaque_distance_m(const struct neph_fog_layer *layer, double y_m, bool upwards)
{
    const double b = layer->falloff_per_m;
    const double at_eye_per_m = layer->extinction_per_m * exp(-b * (y_m - layer->height_m));
    const double bend = opaque_optical_depth * b / at_eye_per_m;
    if (bend < 1e-12)
        return opaque_optical_depth / at_eye_per_m;
    if (upwards)
        return bend < 1.0 ? -log1p(-bend) / b : INFINITY;
    return log1p(bend) / b;
}

static double layer_top_m(const struct neph_fog_layer *layer, double sun_y, double eye_m)
{
    double top_m = INFINITY;
    if (layer->falloff_per_m > 0.0) {
        const double thin_m = height_of_depth_above(layer, 1.0, top_optical_depth);
        top_m = eye_m < thin_m ? eye_m + 16.0 / layer->falloff_per_m : thin_m;
        if (sun_y > 0.0)
            top_m = fmax(top_m, height_of_depth_above(layer, sun_y, top_optical_depth));
    }
    const double reach_m = fmax(reach_min_m, opaque_distance_m(layer, eye_m, true));
    return fmin(fmin(top_m, eye_m + reach_m), fmax(eye_m, layer->height_m) + reach_max_m);
}

static double layer_bottom_m(const struct neph_fog_layer *layer, double eye_m)
{
    const double lowest_m = fmin(eye_m, layer->height_m) - reach_max_m;
    if (layer->falloff_per_m > 0.0) {
        const double thin_m = height_of_depth_above(layer, 1.0, opaque_optical_depth);
        if (eye_m - thin_m > 30.0 / layer->falloff_per_m)
            return fmax(thin_m, lowest_m); /* so far above, the density at the eye is negligible */
    }
    const double reach_m = fmax(reach_min_m, opaque_distance_m(layer, eye_m, false));
    return fmax(eye_m - reach_m, lowest_m);
}

/* Top and bottom for all layers, for the points inside the medium that are nearest to the eyes. */
static void cut_heights(struct neph_bounds *box, const struct neph_scene *scene,
                        const struct neph_medium *medium, const struct eyes *eyes)
{
    const double floor_m = medium->bounds.min_m.y, roof_m = medium->bounds.max_m.y;
    const double low_m = fmin(roof_m, fmax(floor_m, eyes->low_m));
    const double high_m = fmin(roof_m, fmax(floor_m, eyes->high_m));
    box->min_m.y = low_m - reach_min_m;
    box->max_m.y = box->min_m.y + reach_min_m;
    for (int i = 0; i < medium->layer_count; i++) {
        const struct neph_fog_layer *layer = &medium->layers[i];
        if (layer->extinction_per_m <= 0.0)
            continue;
        box->max_m.y = fmax(box->max_m.y, layer_top_m(layer, scene->sun.direction.y, high_m));
        box->min_m.y = fmin(box->min_m.y, layer_bottom_m(layer, low_m));
    }
}

static double transmittance(struct neph_medium medium, struct neph_bounds bounds,
                            struct neph_vec3 eye_m, struct neph_vec3 direction)
{
    medium.bounds = bounds;
    return exp(-neph_medium_optical_depth(&medium, eye_m, direction, 0.0, INFINITY));
}

/* Difference between two bounds of one medium in the views that climb `slope` metres per metre to
 * each of the four sides, from the nearest eye. */
static double slope_difference(const struct neph_medium *medium, struct neph_bounds a,
                               struct neph_bounds b, const struct eyes *eyes, double eye_y_m,
                               double slope)
{
    const double run = 1.0 / sqrt(1.0 + slope * slope), rise = run * slope;
    const struct neph_vec3 from_m[4] = {{eyes->x1_m, eye_y_m, eyes->z0_m},
                                        {eyes->x0_m, eye_y_m, eyes->z1_m},
                                        {eyes->x0_m, eye_y_m, eyes->z1_m},
                                        {eyes->x1_m, eye_y_m, eyes->z0_m}};
    const struct neph_vec3 towards[4] = {
        {run, rise, 0}, {-run, rise, 0}, {0, rise, run}, {0, rise, -run}};
    double worst = 0.0;
    for (int i = 0; i < 4; i++)
        worst = fmax(worst, fabs(transmittance(*medium, a, from_m[i], towards[i]) -
                                 transmittance(*medium, b, from_m[i], towards[i])));
    return worst;
}

/* The largest slope_difference() over slopes `ratio` apart and over the eyes' heights. Ends early
 * beyond `enough`. */
static double largest_difference(const struct neph_medium *medium, struct neph_bounds a,
                                 struct neph_bounds b, const struct eyes *eyes, double ratio,
                                 double enough)
{
    const int heights = eyes->high_m > eyes->low_m ? 9 : 1;
    double worst = 0.0;
    for (int i = 0; i < heights; i++) {
        const double eye_m = eyes->low_m + (eyes->high_m - eyes->low_m) * i / 8.0;
        worst = fmax(worst, slope_difference(medium, a, b, eyes, eye_m, 0.0));
        for (double slope = 1e6; slope > 1e-12 && worst <= enough; slope /= ratio)
            for (int sign = -1; sign <= 1; sign += 2)
                worst = fmax(worst, slope_difference(medium, a, b, eyes, eye_m, sign * slope));
    }
    return worst;
}

/* Extends the box towards the sun until a sun ray from its lowest eye leaves through the top:
 * sunlight must cross the whole fog before it is scattered. */
static void reach_towards_sun(struct neph_bounds *box, const struct neph_sun *sun, double eye_m)
{
    if (!sun->present || sun->direction.y <= 0.0)
        return;
    const double path_m = fmin(fmax(box->max_m.y - eye_m, 0.0) / sun->direction.y, reach_max_m);
    const double reach_x_m = sun->direction.x * path_m, reach_z_m = sun->direction.z * path_m;
    box->min_m.x += fmin(0.0, reach_x_m);
    box->max_m.x += fmax(0.0, reach_x_m);
    box->min_m.z += fmin(0.0, reach_z_m);
    box->max_m.z += fmax(0.0, reach_z_m);
}

static bool is_finite(const struct neph_bounds *bounds)
{
    return isfinite(bounds->min_m.x) && isfinite(bounds->min_m.y) && isfinite(bounds->min_m.z) &&
           isfinite(bounds->max_m.x) && isfinite(bounds->max_m.y) && isfinite(bounds->max_m.z);
}

static void set_sides(struct neph_bounds *box, const struct eyes *eyes, double side_m)
{
    box->min_m.x = eyes->x0_m - side_m;
    box->max_m.x = eyes->x1_m + side_m;
    box->min_m.z = eyes->z0_m - side_m;
    box->max_m.z = eyes->z1_m + side_m;
}

struct neph_bounds neph_fog_container(const struct neph_scene *scene,
                                      const struct neph_medium *medium, double *cut_error)
{
    *cut_error = 0.0;
    /* Parallel rays start anywhere: there is no eye to measure from. */
    if (is_finite(&medium->bounds) || scene->orthographic_height_m > 0.0)
        return medium->bounds;
    const struct eyes eyes = find_camera_range(scene);
    struct neph_bounds box;
    cut_heights(&box, scene, medium, &eyes);
    set_sides(&box, &eyes, INFINITY);
    const struct neph_bounds without_sides = neph_bounds_intersect(box, medium->bounds);

    double side_m = reach_min_m, error = INFINITY;
    while (side_m < reach_max_m && error > side_error) {
        side_m = fmin(1.25 * side_m, reach_max_m);
        set_sides(&box, &eyes, side_m);
        error = largest_difference(medium, without_sides,
                                   neph_bounds_intersect(box, medium->bounds), &eyes, 1.25,
                                   side_error);
    }
    reach_towards_sun(&box, &scene->sun, eyes.low_m);
    for (int i = 0; i < scene->light_count; i++) {
        const struct neph_vec3 at_m = scene->lights[i].position_m;
        box = neph_bounds_hull(box, (struct neph_bounds){at_m, at_m});
    }
    box = neph_bounds_intersect(box, medium->bounds);
    /* A tenth more than the maximum over steps of 3 % in slope, and the rounding of T. */
    const double found = largest_difference(medium, medium->bounds, box, &eyes, 1.03, 1.0);
    *cut_error = fmin(1.0, 1e-15 + 1.1 * found);
    return box;
}
