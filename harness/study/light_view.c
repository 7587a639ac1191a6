/* SPDX-License-Identifier: MIT
 *
 * Optical depths and scaled single scattering along a view ray.
 */
#include "harness/study/light_view.h"

#include "scenes/media.h"
#include "scenes/solids.h"

/* Enough steps that their error does not affect a fit of coefficients to a few percent. */
enum { STEPS = 128, BISECTIONS = 40 };

struct ray {
    const struct neph_scene *scene;
    struct neph_vec3 origin_m, direction;
    double hit_m; /* distance of the first solid */
};

static double depth_between(const struct ray *ray, double t0_m, double t1_m)
{
    return neph_scene_optical_depth(ray->scene, ray->origin_m, ray->direction, t0_m, t1_m).g;
}

/* ---- distances along the ray ----------------------------------------------------------------- */

/* A finite distance that contains all but a millionth of `depth`. */
static double find_ray_end(const struct ray *ray, double depth)
{
    double end_m = 1.0;
    if (isfinite(ray->hit_m))
        return ray->hit_m;
    while (end_m < 1e9 && depth_between(ray, 0.0, end_m) < (1.0 - 1e-6) * depth)
        end_m *= 2.0;
    return end_m;
}

/* The distance at which the optical depth is `depth`, by bisection. */
static double find_distance_at_depth(const struct ray *ray, double depth, double end_m)
{
    double low_m = 0.0, high_m = end_m;
    for (int i = 0; i < BISECTIONS; i++) {
        const double middle_m = 0.5 * (low_m + high_m);
        if (depth_between(ray, 0.0, middle_m) < depth)
            low_m = middle_m;
        else
            high_m = middle_m;
    }
    return high_m;
}

static double sun_depth_at(const struct ray *ray, double t_m)
{
    const struct neph_vec3 point_m = neph_vec3_along(ray->origin_m, ray->direction, t_m);
    if (!neph_scene_is_sun_visible(ray->scene, point_m))
        return INFINITY;
    return neph_scene_optical_depth(ray->scene, point_m, ray->scene->sun.direction, 0.0, INFINITY)
        .g;
}

/* ---- light ----------------------------------------------------------------------------------- */

double neph_light_scale(int k)
{
    return k < NEPH_LIGHT_SCALES - 1 ? pow(2.0, -k) : 0.0;
}

static void add_step(double before, double step_depth, double sun_depth,
                     double lit[NEPH_LIGHT_SCALES])
{
    if (!isfinite(sun_depth))
        return;
    for (int k = 0; k < NEPH_LIGHT_SCALES; k++) {
        const double scale = neph_light_scale(k);
        lit[k] += exp(-scale * (before + sun_depth)) * step_depth * neph_phi(scale * step_depth);
    }
}

/* Integrates with equal steps and the sun's optical depth at the middle of each. */
static void light_ray(const struct ray *ray, double depth, double end_m,
                      double lit[NEPH_LIGHT_SCALES])
{
    const double start_m = find_distance_at_depth(ray, 1e-4 * fmin(depth, 1.0), end_m);
    const double stop_m = find_distance_at_depth(ray, (1.0 - 1e-4) * depth, end_m);
    const double step_m = (stop_m - start_m) / STEPS;
    double before = 0.0;
    for (int i = 0; i < STEPS; i++) {
        const double t_m = start_m + i * step_m;
        const double step_depth = depth_between(ray, t_m, t_m + step_m);
        add_step(before, step_depth, sun_depth_at(ray, t_m + 0.5 * step_m), lit);
        before += step_depth;
    }
}

double neph_light_interpolate_lit(const double lit[NEPH_LIGHT_SCALES], double scale)
{
    const double place = -log(fmax(scale, 1e-300)) / M_LN2; /* k in scale = 2^-k */
    const int last = NEPH_LIGHT_SCALES - 2, k = (int)fmin(place, last);
    if (k == last) /* near a scale of 0 the integral is linear in the scale */
        return lit[last + 1] + (lit[last] - lit[last + 1]) * scale / neph_light_scale(last);
    return lit[k] > 0.0 ? lit[k] * pow(lit[k + 1] / lit[k], place - k) : lit[k + 1] * (place - k);
}

/* ---- the view ray of a pixel ----------------------------------------------------------------- */

struct neph_light_view neph_light_view_compute(const struct neph_scene *scene,
                                               const struct neph_pixel_ray *pixel, bool with_lit)
{
    const struct ray ray = {scene, pixel->origin_m, pixel->direction,
                            neph_scene_hit(scene, pixel->origin_m, pixel->direction).t_m};
    const double depth = depth_between(&ray, 0.0, ray.hit_m);
    struct neph_light_view view = {.eye_depth = depth, .sun_depth = NAN};
    view.angle_rad = acos(
        fmin(fmax(neph_vec3_dot(pixel->direction, scene->sun.direction), -1.0), 1.0));
    for (int k = 0; k < NEPH_LIGHT_SCALES; k++)
        view.lit[k] = with_lit ? 0.0 : NAN;
    if (!(depth > 0.0))
        return view;
    const double end_m = find_ray_end(&ray, depth);
    const double half = -log1p(0.5 * expm1(-depth)); /* optical depth at which half of 1 - e^-depth
                                                        has been lost */
    view.sun_depth = sun_depth_at(&ray, find_distance_at_depth(&ray, half, end_m));
    if (with_lit)
        light_ray(&ray, depth, end_m, view.lit);
    return view;
}
