/* SPDX-License-Identifier: MIT
 *
 * A finite box for an unbounded height fog. Three cuts:
 * - top: above it a vertical sun ray or view ray meets less than 1e-8 of optical depth, or the
 *   fog from the eye to the top is e^16 times what lies above it, so that a ray slanted enough to
 *   see the rest is opaque before it gets there;
 * - bottom: where e^-18 of the light from the lowest eye is left;
 * - sides: doubled until the error in transmittance, scanned over the slopes of view rays, is
 *   below 1e-7, or 1000 km are reached.
 */
#include "scenes/media.h"

#include <math.h>

static const double top_optical_depth = 1e-8;
static const double bottom_optical_depth = 18.0;
static const double side_error = 1e-7;
static const double side_max_m = 1e6;

struct eyes {
    double low_m, high_m;          /* heights */
    double x0_m, x1_m, z0_m, z1_m; /* horizontal extent */
};

static struct eyes find_eyes(const struct neph_scene *scene)
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

static double layer_top_m(const struct neph_fog_layer *layer, double sun_y, double eye_m)
{
    const double seen_m = eye_m + 16.0 / layer->falloff_per_m;
    double top_m = fmin(height_of_depth_above(layer, 1.0, top_optical_depth), seen_m);
    if (sun_y > 0.0)
        top_m = fmax(top_m, height_of_depth_above(layer, sun_y, top_optical_depth));
    return fmax(top_m, layer->height_m);
}

/* Below the eye by the depth D with sigma(eye) (e^{bD} - 1) / b = bottom_optical_depth. */
static double layer_bottom_m(const struct neph_fog_layer *layer, double eye_m)
{
    const double b = layer->falloff_per_m;
    const double thin_m = height_of_depth_above(layer, 1.0, bottom_optical_depth);
    if (eye_m - thin_m > 30.0 / b)
        return thin_m; /* from so far above, the eye's own density does not matter */
    const double at_eye_per_m = layer->extinction_per_m * exp(-b * (eye_m - layer->height_m));
    return eye_m - log1p(bottom_optical_depth * b / at_eye_per_m) / b;
}

/* Largest error in transmittance over the slopes of view rays when the sides are `side_m` away. */
static double side_cut_error(const struct neph_medium *medium, const struct neph_bounds *box,
                             double eye_m, double side_m)
{
    double worst = 0.0;
    for (int sign = -1; sign <= 1; sign += 2)
        for (double slope = 1e-6; slope < 1.0; slope *= 1.25) {
            const double k_y = sign * slope, run = sqrt(1.0 - slope * slope);
            const double to_side_m = side_m / run;
            const double edge_m = sign > 0 ? box->max_m.y : box->min_m.y;
            const double to_edge_m = (edge_m - eye_m) / k_y;
            if (to_edge_m <= to_side_m)
                continue; /* leaves by the top or the bottom: those cuts have their own bounds */
            double inside = 0.0, beyond = 0.0;
            for (int i = 0; i < medium->layer_count; i++) {
                inside += neph_fog_layer_optical_depth(&medium->layers[i], eye_m, k_y, to_side_m);
                beyond += neph_fog_layer_optical_depth(&medium->layers[i], eye_m + k_y * to_side_m,
                                                       k_y, to_edge_m - to_side_m);
            }
            worst = fmax(worst, exp(-inside) * -expm1(-beyond));
        }
    return worst;
}

/* Towards the sun the box reaches as far as a sun ray from its lowest eye needs to leave by the
 * top: sunlight must cross the whole fog before it is scattered. */
static void reach_towards_sun(struct neph_bounds *box, const struct neph_sun *sun, double eye_m)
{
    if (!sun->present || sun->direction.y <= 0.0)
        return;
    const double path_m = (box->max_m.y - eye_m) / sun->direction.y;
    const double reach_x_m = sun->direction.x * path_m, reach_z_m = sun->direction.z * path_m;
    box->min_m.x += fmin(0.0, reach_x_m);
    box->max_m.x += fmax(0.0, reach_x_m);
    box->min_m.z += fmin(0.0, reach_z_m);
    box->max_m.z += fmax(0.0, reach_z_m);
}

static struct neph_bounds intersect(struct neph_bounds a, struct neph_bounds b)
{
    return (struct neph_bounds){
        {fmax(a.min_m.x, b.min_m.x), fmax(a.min_m.y, b.min_m.y), fmax(a.min_m.z, b.min_m.z)},
        {fmin(a.max_m.x, b.max_m.x), fmin(a.max_m.y, b.max_m.y), fmin(a.max_m.z, b.max_m.z)}};
}

static bool is_finite(const struct neph_bounds *bounds)
{
    return isfinite(bounds->min_m.x) && isfinite(bounds->min_m.y) && isfinite(bounds->min_m.z) &&
           isfinite(bounds->max_m.x) && isfinite(bounds->max_m.y) && isfinite(bounds->max_m.z);
}

struct neph_bounds neph_medium_container(const struct neph_scene *scene,
                                         const struct neph_medium *medium, double *cut_error)
{
    *cut_error = 0.0;
    if (is_finite(&medium->bounds))
        return medium->bounds;
    const struct eyes eyes = find_eyes(scene);
    struct neph_bounds box = {{0, INFINITY, 0}, {0, -INFINITY, 0}};
    for (int i = 0; i < medium->layer_count; i++) {
        const struct neph_fog_layer *layer = &medium->layers[i];
        if (layer->extinction_per_m <= 0.0 || layer->falloff_per_m <= 0.0)
            continue;
        box.max_m.y = fmax(box.max_m.y, layer_top_m(layer, scene->sun.direction.y, eyes.high_m));
        box.min_m.y = fmin(box.min_m.y, layer_bottom_m(layer, eyes.low_m));
    }
    double side_m = 1.0, error = INFINITY;
    while (side_m < side_max_m && error > side_error) {
        side_m *= 1.25;
        error = fmax(side_cut_error(medium, &box, eyes.low_m, side_m),
                     side_cut_error(medium, &box, eyes.high_m, side_m));
    }
    box.min_m.x = eyes.x0_m - side_m;
    box.max_m.x = eyes.x1_m + side_m;
    box.min_m.z = eyes.z0_m - side_m;
    box.max_m.z = eyes.z1_m + side_m;
    reach_towards_sun(&box, &scene->sun, eyes.low_m);
    *cut_error = error + 2.0 * top_optical_depth + exp(-bottom_optical_depth);
    return intersect(box, medium->bounds);
}
