/* SPDX-License-Identifier: MIT
 *
 * A double precision version of the march in renderer/shaders/march.glsl, without its
 * optimisations, for the estimate of the step bias.
 *
 * With I_n the result of n steps, the error of a rule of order p is I_n - I = 2^p / (2^p - 1) (I_n
 * - I_2n): 4/3 (I_n - I_2n) for second order, 2 (I_n - I_2n) for first order. With steps so long
 * that the bias may reach 10 % the march has no asymptotic order yet, so the estimate uses the
 * larger factor, 2.
 */
#include "harness/report/step_bias.h"

#include "base/files.h"
#include "base/threads.h"
#include "harness/report/marched_scene.h"
#include "renderer/march_params.h"
#include "scenes/emission.h"
#include "scenes/lights.h"
#include "scenes/media.h"
#include "scenes/medium_bounds.h"
#include "scenes/motion.h"
#include "scenes/solids.h"

#include <math.h>
#include <string.h>

/* Compiles only when this file handles every kind. */
_Static_assert(NEPH_MARCH_LIGHTING_COUNT == 8, "a new kind");
_Static_assert(NEPH_MARCH_MODE_COUNT == 2, "a new kind");
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");

enum { RAYS_MAX = 160, RAYS_LEAST = 40, STEPS_MAX = 50000, OPEN_STEPS = 16 };

/* Limit of the work: steps of RAYS_LEAST rays, including the steps towards lights; about 0.3 s. */
static const double work_max = 1e6;

static const double order_factor = 2.0;

/* The constants THIN and OPAQUE of renderer/shaders/fog.glsl. */
static const double thin_depth = 1e-7, opaque_depth = 16.0;

/* Parameters of a march. */
struct march {
    const struct neph_scene *scene;
    bool marches_view, marches_sun; /* optical depths are sums over steps, not closed forms */
    int steps, sun_steps;
    double growth;
    struct neph_octaves octaves; /* a count of one: single scattering */
};

struct way {
    struct neph_vec3 origin_m, direction;
    double length_m;
};

struct stretch {
    double t0_m, t1_m;
};

static double mean(struct neph_rgb c)
{
    return (c.r + c.g + c.b) / 3.0;
}

static struct neph_vec3 point_on(const struct way *way, double t_m)
{
    return neph_vec3_along(way->origin_m, way->direction, t_m);
}

/* ---- marched interval of a ray ---- ---------------------------------------------------------- */

static double largest_channel(struct neph_rgb color)
{
    return fmax(color.r, fmax(color.g, color.b));
}

static double least_positive(struct neph_rgb color)
{
    double least = INFINITY;
    least = color.r > 0.0 ? fmin(least, color.r) : least;
    least = color.g > 0.0 ? fmin(least, color.g) : least;
    return color.b > 0.0 ? fmin(least, color.b) : least;
}

/* The distance at which the optical depth left in a layer falls below `thin` on a ray that leaves
 * it. */
static double thin_end_m(const struct neph_fog_layer *layer, double y_m, double k_y, double thin)
{
    const double rate_per_m = layer->falloff_per_m * k_y;
    if (!(rate_per_m > 0.0))
        return INFINITY;
    return (log(layer->extinction_per_m / (rate_per_m * thin)) -
            layer->falloff_per_m * (y_m - layer->height_m)) /
           rate_per_m;
}

static void include_layer(const struct neph_fog_layer *layer, struct neph_rgb color,
                          const struct way *way, struct stretch inside, struct stretch *hull,
                          double *opaque_m)
{
    const double k_y = way->direction.y, y_m = way->origin_m.y + inside.t0_m * k_y;
    const double thin = thin_depth / largest_channel(color);
    if (layer->extinction_per_m == 0.0)
        return;
    const double start_m = layer->falloff_per_m * k_y < 0.0
                               ? inside.t0_m + neph_fog_layer_distance_m(layer, y_m, k_y, thin)
                               : inside.t0_m;
    const double dark_m = inside.t0_m + neph_fog_layer_distance_m(
                                            layer, y_m, k_y, opaque_depth / least_positive(color));
    const double end_m = fmin(fmin(inside.t1_m, inside.t0_m + thin_end_m(layer, y_m, k_y, thin)),
                              dark_m);
    if (dark_m < inside.t1_m && color.r > 0.0 && color.g > 0.0 && color.b > 0.0)
        *opaque_m = fmin(*opaque_m, dark_m);
    if (start_m < end_m) {
        hull->t0_m = fmin(hull->t0_m, start_m);
        hull->t1_m = fmax(hull->t1_m, end_m);
    }
}

/* As clip_medium() of renderer/shaders/media.glsl: to the support and to turned bounds. */
static bool clip_medium(const struct neph_medium *medium, const struct way *way,
                        struct stretch *inside)
{
    const struct neph_bounds support = neph_medium_support(medium);
    return neph_bounds_clip(&support, way->origin_m, way->direction, &inside->t0_m,
                            &inside->t1_m) &&
           neph_medium_clip(medium, way->origin_m, way->direction, &inside->t0_m, &inside->t1_m);
}

/* As scene_stretch() of renderer/shaders/scene.glsl; media other than fogs contribute their
 * bounds. */
static struct stretch find_marched_interval(const struct neph_scene *scene, const struct way *way)
{
    struct stretch hull = {INFINITY, 0.0};
    double opaque_m = way->length_m;
    for (int m = 0; m < scene->medium_count; m++) {
        const struct neph_medium *medium = &scene->media[m];
        struct stretch inside = {0.0, way->length_m};
        if (!clip_medium(medium, way, &inside))
            continue;
        for (int l = 0; l < medium->layer_count; l++)
            include_layer(&medium->layers[l], medium->extinction_color, way, inside, &hull,
                          &opaque_m);
        if (medium->layer_count == 0) {
            hull.t0_m = fmin(hull.t0_m, inside.t0_m);
            hull.t1_m = fmax(hull.t1_m, inside.t1_m);
        }
    }
    hull.t1_m = fmin(hull.t1_m, opaque_m);
    return hull;
}

/* ---- optical depths ---- */

/* Extinction at a point times a length. */
static struct neph_rgb depth_at(const struct neph_medium *medium, struct neph_vec3 point_m,
                                double length_m)
{
    return neph_rgb_scale(medium->extinction_color,
                          neph_medium_extinction_per_m(medium, point_m) * length_m);
}

/* The optical depth along a ray segment. `is_marched`: a sum over equal steps for all media;
 * otherwise closed forms, and a sum only for media without one. */
static struct neph_rgb depth_on(const struct march *march, const struct way *way, bool is_marched,
                                int steps)
{
    struct neph_rgb sum = {0, 0, 0};
    const struct stretch stretch = is_marched ? find_marched_interval(march->scene, way)
                                              : (struct stretch){0.0, way->length_m};
    for (int m = 0; m < march->scene->medium_count; m++) {
        const struct neph_medium *medium = &march->scene->media[m];
        if (!is_marched && neph_medium_has_closed_form(medium)) {
            sum = neph_rgb_add(sum, neph_rgb_attenuation(medium->extinction_color,
                                                         neph_medium_optical_depth(
                                                             medium, way->origin_m, way->direction,
                                                             0.0, way->length_m)));
            continue;
        }
        struct stretch part = stretch;
        if (!is_marched && !clip_medium(medium, way, &part))
            continue;
        const double step_m = (part.t1_m - part.t0_m) / steps;
        for (int i = 0; i < steps && step_m > 0.0; i++)
            sum = neph_rgb_add(
                sum, depth_at(medium, point_on(way, part.t0_m + (i + 0.5) * step_m), step_m));
    }
    return sum;
}

static struct neph_rgb through(struct neph_rgb depth)
{
    return (struct neph_rgb){exp(-depth.r), exp(-depth.g), exp(-depth.b)};
}

static struct neph_rgb lost(struct neph_rgb depth)
{
    return (struct neph_rgb){-expm1(-depth.r), -expm1(-depth.g), -expm1(-depth.b)};
}

/* The optical depth of a step of the view ray, or of a part of it. */
static struct neph_rgb view_depth(const struct march *march, const struct way *way, double t0_m,
                                  double t1_m)
{
    const struct way step = {point_on(way, t0_m), way->direction, t1_m - t0_m};
    struct neph_rgb sum = {0, 0, 0};
    if (!march->marches_view)
        return depth_on(march, &step, false, 1);
    for (int m = 0; m < march->scene->medium_count; m++)
        sum = neph_rgb_add(sum, depth_at(&march->scene->media[m],
                                         point_on(&step, 0.5 * step.length_m), step.length_m));
    return sum;
}

static struct neph_rgb light_depth(const struct march *march, struct neph_vec3 point_m,
                                   struct neph_vec3 direction, double length_m)
{
    const struct way way = {point_m, direction, length_m};
    return depth_on(march, &way, march->marches_sun,
                    march->marches_sun ? march->sun_steps : OPEN_STEPS);
}

/* ---- light ---- */

static double quotient(double a, double b)
{
    return b > 0.0 ? a / b : 0.0;
}

/* Scattered radiance at a point per optical depth and irradiance. `part` scales the asymmetry g. */
static struct neph_rgb scattered_per_depth(const struct neph_scene *scene, struct neph_vec3 point_m,
                                           double cosine, double part)
{
    struct neph_rgb scattered = {0, 0, 0}, extinction = {0, 0, 0};
    for (int m = 0; m < scene->medium_count; m++) {
        const struct neph_medium *medium = &scene->media[m];
        struct neph_phase phase = medium->phase;
        phase.g *= part;
        if (part < 1.0 && !neph_phase_is_in_shaders(phase.kind)) /* as shaders/phase.glsl */
            phase = (struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN,
                                        part * neph_phase_mean_cosine(&medium->phase)};
        const struct neph_rgb own = depth_at(medium, point_m, 1.0);
        extinction = neph_rgb_add(extinction, own);
        scattered = neph_rgb_add(scattered, neph_rgb_scale(neph_rgb_mul(medium->albedo, own),
                                                           neph_phase_per_sr(&phase, cosine)));
    }
    return (struct neph_rgb){quotient(scattered.r, extinction.r),
                             quotient(scattered.g, extinction.g),
                             quotient(scattered.b, extinction.b)};
}

static struct neph_rgb sunlight(const struct march *march, const struct way *way,
                                struct neph_vec3 point_m)
{
    const struct neph_sun *sun = &march->scene->sun;
    struct neph_rgb sum = {0, 0, 0};
    if (!sun->present || !neph_scene_is_sun_visible(march->scene, point_m))
        return sum;
    const double cosine = neph_vec3_dot(way->direction, sun->direction);
    const struct neph_rgb depth = light_depth(march, point_m, sun->direction, INFINITY);
    double contribution = 1.0, attenuation = 1.0, part = 1.0;
    for (int i = 0; i < march->octaves.count; i++) {
        const struct neph_rgb light = through(neph_rgb_scale(depth, attenuation));
        sum = neph_rgb_add(
            sum, neph_rgb_scale(
                     neph_rgb_mul(scattered_per_depth(march->scene, point_m, cosine, part), light),
                     contribution));
        contribution *= march->octaves.contribution;
        attenuation *= march->octaves.attenuation;
        part *= march->octaves.eccentricity;
    }
    return neph_rgb_mul(sum, sun->irradiance_w_per_m2);
}

static struct neph_rgb glow_at(const struct neph_scene *scene, struct neph_vec3 point_m)
{
    struct neph_rgb glow = {0, 0, 0}, extinction = {0, 0, 0};
    for (int m = 0; m < scene->medium_count; m++) {
        const struct neph_rgb own = depth_at(&scene->media[m], point_m, 1.0);
        extinction = neph_rgb_add(extinction, own);
        glow = neph_rgb_add(glow, neph_rgb_mul(neph_medium_glow(&scene->media[m]), own));
    }
    return (struct neph_rgb){quotient(glow.r, extinction.r), quotient(glow.g, extinction.g),
                             quotient(glow.b, extinction.b)};
}

/* Light of a point or spot light scattered in a part of a step. s0_m and s1_m are distances along
 * the ray from the foot of the perpendicular from the light; height_m is the length of the
 * perpendicular. */
static struct neph_rgb lamp_part(const struct march *march, const struct way *way,
                                 const struct neph_light *light, double foot_m, double height_m,
                                 double s0_m, double s1_m)
{
    const double d0_m = hypot(height_m, s0_m), d1_m = hypot(height_m, s1_m);
    const double length_m = s1_m - s0_m;
    const struct neph_vec3 point_m = point_on(way,
                                              foot_m + s0_m + length_m * (d0_m / (d0_m + d1_m)));
    const struct neph_lit lit = neph_light_at(light, point_m);
    const double inverse_square = atan2(height_m * length_m, height_m * height_m + s0_m * s1_m) /
                                  (height_m * length_m);
    const double falloff = neph_light_falloff(light, neph_vec3_scale(lit.direction, -1.0));
    if (falloff == 0.0 || !neph_scene_is_visible(march->scene, point_m, light->position_m))
        return (struct neph_rgb){0, 0, 0};
    const struct neph_rgb arriving = neph_rgb_mul(
        neph_rgb_scale(light->intensity_w_per_sr, falloff * inverse_square),
        through(light_depth(march, point_m, lit.direction, lit.distance_m)));
    return neph_rgb_mul(arriving,
                        scattered_per_depth(march->scene, point_m,
                                            neph_vec3_dot(way->direction, lit.direction), 1.0));
}

/* As equiangular_position() and lamp_step_light() of renderer/shaders/march_lamp_steps.glsl. */
static double equiangular_position(double slope)
{
    const double end = 1e9;
    return asinh(fmax(-end, fmin(slope, end)));
}

static struct neph_rgb lamp_light(const struct march *march, const struct way *way,
                                  const struct neph_light *light, double t0_m, double t1_m)
{
    const struct neph_vec3 way_m = neph_vec3_sub(light->position_m, way->origin_m);
    const double foot_m = neph_vec3_dot(way_m, way->direction);
    const double away_m = neph_vec3_length(way_m);
    const double height_m = fmax(neph_vec3_length(neph_vec3_along(way_m, way->direction, -foot_m)),
                                 1e-6 * away_m + 1e-12);
    const double end_m = t1_m - foot_m, first = equiangular_position((t0_m - foot_m) / height_m);
    const double extent = equiangular_position(end_m / height_m) - first;
    const double part = M_PI / 8.0 * fmin(1.0, 64.0 / march->steps);
    const int parts = 1 + (int)(extent / part);
    struct neph_rgb sum = {0, 0, 0}, depth = {0, 0, 0};
    double s0_m = t0_m - foot_m;
    for (int i = 1; i <= parts; i++) {
        const double s1_m = i == parts ? end_m : height_m * sinh(first + extent * i / parts);
        if (!(s1_m > s0_m))
            continue;
        const struct neph_rgb own = view_depth(march, way, foot_m + s0_m, foot_m + s1_m);
        sum = neph_rgb_add(sum, neph_rgb_mul(neph_rgb_mul(lamp_part(march, way, light, foot_m,
                                                                    height_m, s0_m, s1_m),
                                                          through(depth)),
                                             lost(own)));
        depth = neph_rgb_add(depth, own);
        s0_m = s1_m;
    }
    return sum;
}

/* Distance at which step i of an interval begins. */
static double step_start_m(const struct march *march, const struct stretch *stretch, int i)
{
    const double growth = march->growth;
    const double part = growth > 1.0 ? (pow(growth, i) - 1.0) / (pow(growth, march->steps) - 1.0)
                                     : (double)i / march->steps;
    return stretch->t0_m + (stretch->t1_m - stretch->t0_m) * part;
}

static struct neph_rgb ray_light(const struct march *march, const struct way *way)
{
    struct neph_rgb light = {0, 0, 0}, depth = {0, 0, 0};
    const struct stretch stretch = find_marched_interval(march->scene, way);
    if (!(stretch.t0_m < stretch.t1_m) || !isfinite(stretch.t1_m))
        return light;
    const bool scatters = march->scene->scattering != NEPH_SCATTERING_NONE;
    for (int i = 0; i < march->steps; i++) {
        const double t0_m = step_start_m(march, &stretch, i);
        const double t1_m = step_start_m(march, &stretch, i + 1);
        const struct neph_vec3 point_m = point_on(way, 0.5 * (t0_m + t1_m));
        const struct neph_rgb own = view_depth(march, way, t0_m, t1_m);
        struct neph_rgb step = glow_at(march->scene, point_m);
        if (scatters)
            step = neph_rgb_add(step, sunlight(march, way, point_m));
        step = neph_rgb_mul(step, lost(own));
        for (int l = 0; scatters && l < march->scene->light_count; l++)
            step = neph_rgb_add(step, lamp_light(march, way, &march->scene->lights[l], t0_m, t1_m));
        light = neph_rgb_add(light, neph_rgb_mul(step, through(depth)));
        depth = neph_rgb_add(depth, own);
    }
    return light;
}

/* ---- the frame ---- */

/* Ray i of `count` rays through pixels. Rows are spread evenly, because level rays along the
 * horizon have the longest steps; columns follow the golden ratio. */
static struct neph_pixel_ray choose_frame_ray(const struct neph_shot *shot,
                                              const struct neph_camera *camera, int i, int count)
{
    const double golden = 0.61803398874989485, across = i * golden - floor(i * golden);
    return neph_camera_ray(camera, shot->width_px, shot->height_px, (int)(across * shot->width_px),
                           i * shot->height_px / count);
}

/* True when even the smallest number of rays, with the frame's steps and with twice as many,
 * exceeds the limit. */
static bool is_costly(const struct march *march)
{
    const double ray_work = march->marches_sun ? 5.0 * march->steps * march->sun_steps
                                               : 3.0 * march->steps;
    return RAYS_LEAST * ray_work > work_max;
}

/* Rays that are marched with the frame's steps (coarse) and with steps half as long (fine). */
struct twice {
    const struct neph_shot *shot;
    const struct march *coarse, *fine;
    struct neph_camera camera;
    int rays;
    double coarse_light[RAYS_MAX], fine_light[RAYS_MAX];
};

static void march_twice(int i, void *context)
{
    struct twice *twice = context;
    const struct neph_pixel_ray seen = choose_frame_ray(twice->shot, &twice->camera, i,
                                                        twice->rays);
    const struct way way = {
        seen.origin_m, seen.direction,
        neph_scene_hit(twice->coarse->scene, seen.origin_m, seen.direction).t_m};
    twice->coarse_light[i] = mean(ray_light(twice->coarse, &way));
    twice->fine_light[i] = mean(ray_light(twice->fine, &way));
}

/* The bias divided by the light of the media; NAN after an interruption. More steps allow fewer
 * rays. */
static double estimate_media_bias(const struct neph_shot *shot, const struct march *march)
{
    struct march finer = *march;
    finer.steps *= 2;
    finer.sun_steps *= 2;
    finer.growth = sqrt(march->growth);
    struct twice twice = {
        .shot = shot,
        .coarse = march,
        .fine = &finer,
        .camera = neph_scene_camera(march->scene, shot->frame),
        .rays = (int)fmax(RAYS_LEAST, fmin(RAYS_MAX, STEPS_MAX / (3.0 * march->steps))),
    };
    if (neph_parallel_rows(twice.rays, march_twice, &twice, NULL))
        return NAN;
    double difference = 0.0, sum = 0.0;
    for (int i = 0; i < twice.rays; i++) {
        difference += twice.coarse_light[i] - twice.fine_light[i];
        sum += twice.fine_light[i];
    }
    return order_factor * difference / sum;
}

static double sum_layer(const struct neph_image *frame, const char *layer)
{
    float *planes[3];
    double sum = 0.0;
    if (!neph_image_rgb(frame, layer, planes))
        return NAN;
    for (size_t i = 0; i < neph_image_pixel_count(frame); i++)
        sum += (double)planes[0][i] + (double)planes[1][i] + (double)planes[2][i];
    return sum;
}

static double setting_or(const struct neph_shot *shot, const struct neph_engine *engine,
                         const char *name, double otherwise)
{
    const int option = neph_option_find(engine->options, name);
    return option < 0 ? otherwise : shot->settings.values[option];
}

/* Read the parameters of a march from an engine's settings. False: the lighting model has no
 * estimate, or the engine has no equal steps. */
static bool read_march_settings(const struct neph_shot *shot, const struct neph_engine *engine,
                                const struct neph_scene *scene, struct march *march)
{
    static const struct {
        const char *engine;
        bool has_octaves;
    } known[] = {{"march", false}, {"march_octaves", true}, {"realtime", false}};
    const int lighting = neph_shot_choice(shot, engine, "lighting");
    *march = (struct march){
        .scene = scene,
        .marches_view = neph_shot_choice(shot, engine, "transmittance") == NEPH_MARCH_MARCHED,
        .marches_sun = neph_shot_choice(shot, engine, "sun") == NEPH_MARCH_MARCHED,
        .steps = (int)setting_or(shot, engine, "steps", 0.0),
        .sun_steps = (int)setting_or(shot, engine, "sun_steps", 1.0),
        .growth = setting_or(shot, engine, "step_growth", 0.0),
        .octaves = {.count = 1},
    };
    for (size_t i = 0; i < sizeof(known) / sizeof(known[0]); i++) {
        if (strcmp(engine->name, known[i].engine) != 0)
            continue;
        if (known[i].has_octaves || lighting == NEPH_MARCH_OCTAVES)
            march->octaves = scene->octaves;
        return march->steps > 0 &&
               (lighting == NEPH_MARCH_SINGLE || lighting == NEPH_MARCH_OCTAVES);
    }
    return false;
}

double neph_step_bias(const struct neph_shot *shot, const struct neph_engine *engine,
                      const struct neph_image *frame)
{
    struct neph_marched_scene marched;
    struct march march;
    double bias = NAN;
    if (!neph_marched_scene_init(shot, engine, &marched))
        return NAN;
    if (read_march_settings(shot, engine, marched.scene, &march) && !is_costly(&march))
        bias = estimate_media_bias(shot, &march) * sum_layer(frame, "volume") /
               sum_layer(frame, NULL);
    neph_marched_scene_finish(&marched);
    return isfinite(bias) ? bias : NAN;
}

char *neph_step_bias_omission(const struct neph_shot *shot, const struct neph_engine *engine)
{
    struct march march;
    if (!read_march_settings(shot, engine, shot->scene, &march) || !is_costly(&march))
        return NULL;
    if (march.marches_sun)
        return neph_format("step bias not estimated: steps times sun_steps is %.0f, at most %.0f "
                           "are marched again",
                           (double)march.steps * march.sun_steps, work_max / (5.0 * RAYS_LEAST));
    return neph_format("step bias not estimated: %d steps, at most %.0f are marched again",
                       march.steps, floor(work_max / (3.0 * RAYS_LEAST)));
}

char *neph_step_bias_warning(double bias, const struct neph_engine *engine)
{
    if (!(fabs(bias) > NEPH_STEP_BIAS_MAX))
        return NULL;
    return neph_format("the steps of %s may make it %.0f %% too %s: raise its steps", engine->name,
                       100.0 * fabs(bias), bias > 0.0 ? "bright" : "dark");
}
