/* SPDX-License-Identifier: MIT */
#include "harness/report/step_depth.h"

#include "base/files.h"
#include "base/threads.h"
#include "harness/report/marched_scene.h"
#include "scenes/media.h"
#include "scenes/medium_bounds.h"
#include "scenes/motion.h"
#include "scenes/solids.h"

#include <math.h>
#include <string.h>

enum { COLUMNS = 32, ROWS = 18, PLACES_MAX = 64 };

/* Engines with a fixed number of steps for each ray. */
static const struct {
    const char *option; /* the setting with the number of steps */
    bool shared;        /* steps span all media together and end at an opaque fog; otherwise each
                           medium */
} marchers[] = {
    {"steps", true},      /* march */
    {"intervals", false}, /* POV-Ray: in each medium's container */
};

/* The constant OPAQUE of renderer/shaders/fog.glsl. */
static const double opaque_optical_depth = 16.0;

struct ray {
    const struct neph_scene *scene;
    const struct neph_bounds *containers; /* of the media */
    struct neph_vec3 origin_m, direction;
    double end_m;
    bool shared; /* as in marchers */
};

/* POV-Ray gets turned bounds as voxels in the box around them, except those of fogs. */
static bool clip(const struct ray *ray, int medium, double *t0_m, double *t1_m)
{
    const struct neph_medium *own = &ray->scene->media[medium];
    const bool is_turned = ray->shared || neph_medium_is_fog(own);
    *t0_m = 0.0;
    *t1_m = ray->end_m;
    return neph_bounds_clip(&ray->containers[medium], ray->origin_m, ray->direction, t0_m, t1_m) &&
           (!is_turned || neph_medium_clip(own, ray->origin_m, ray->direction, t0_m, t1_m));
}

static double brightest(struct neph_rgb color)
{
    return fmax(color.r, fmax(color.g, color.b));
}

/* The largest optical depth of a step on an interval, for media first .. last. Stops at an optical
 * depth of 4: only e^-4 of the light from beyond arrives, so long steps are harmless there. */
static double find_deepest_step(const struct ray *ray, int first, int last, double t0_m,
                                double t1_m, int steps)
{
    const int places = steps < PLACES_MAX ? steps : PLACES_MAX;
    const double faint_depth = 4.0;
    double most = 0.0, depth = 0.0;
    for (int i = 0; i < places && depth < faint_depth; i++) {
        const struct neph_vec3 at_m = neph_vec3_along(ray->origin_m, ray->direction,
                                                      t0_m + (t1_m - t0_m) * (i + 0.5) / places);
        double extinction_per_m = 0.0;
        for (int m = first; m <= last; m++)
            extinction_per_m += brightest(ray->scene->media[m].extinction_color) *
                                neph_medium_extinction_per_m(&ray->scene->media[m], at_m);
        most = fmax(most, extinction_per_m * (t1_m - t0_m) / steps);
        depth += extinction_per_m * (t1_m - t0_m) / places;
    }
    return most;
}

/* The distance at which a fog becomes opaque; the marcher stops there. */
static double opaque_end_m(const struct ray *ray, const struct neph_medium *medium, double t0_m)
{
    const double y_m = ray->origin_m.y + t0_m * ray->direction.y;
    double end_m = INFINITY;
    for (int l = 0; l < medium->layer_count; l++)
        end_m = fmin(end_m,
                     t0_m + neph_fog_layer_distance_m(&medium->layers[l], y_m, ray->direction.y,
                                                      opaque_optical_depth));
    return end_m;
}

static double find_deepest_shared_step(const struct ray *ray, int steps)
{
    double low_m = INFINITY, high_m = -INFINITY, opaque_m = INFINITY, t0_m, t1_m;
    for (int m = 0; m < ray->scene->medium_count; m++)
        if (clip(ray, m, &t0_m, &t1_m)) {
            low_m = fmin(low_m, t0_m);
            high_m = fmax(high_m, t1_m);
            opaque_m = fmin(opaque_m, opaque_end_m(ray, &ray->scene->media[m], t0_m));
        }
    high_m = fmin(high_m, opaque_m);
    return low_m < high_m
               ? find_deepest_step(ray, 0, ray->scene->medium_count - 1, low_m, high_m, steps)
               : 0.0;
}

static double find_deepest_medium_step(const struct ray *ray, int steps)
{
    double most = 0.0, t0_m, t1_m;
    for (int m = 0; m < ray->scene->medium_count; m++)
        if (clip(ray, m, &t0_m, &t1_m))
            most = fmax(most, find_deepest_step(ray, m, m, t0_m, t1_m, steps));
    return most;
}

/* The frame under evaluation, row by row. */
struct frame {
    const struct neph_shot *shot;
    const struct neph_scene *scene;
    struct neph_camera camera;
    struct neph_bounds containers[NEPH_SCENE_MEDIA_MAX];
    bool shared;
    int steps;
    double most[ROWS]; /* one for each row */
};

/* The rays go through pixel centres of the frame, so that its aspect ratio counts. */
static void measure_row_depth(int row, void *context)
{
    struct frame *frame = context;
    const int width_px = frame->shot->width_px, height_px = frame->shot->height_px;
    frame->most[row] = 0.0;
    for (int column = 0; column < COLUMNS; column++) {
        const struct neph_pixel_ray seen = neph_camera_ray(
            &frame->camera, width_px, height_px, (2 * column + 1) * width_px / (2 * COLUMNS),
            (2 * row + 1) * height_px / (2 * ROWS));
        struct ray ray = {.scene = frame->scene,
                          .containers = frame->containers,
                          .origin_m = seen.origin_m,
                          .direction = seen.direction,
                          .shared = frame->shared};
        ray.end_m = neph_scene_hit(frame->scene, ray.origin_m, ray.direction).t_m;
        frame->most[row] = fmax(frame->most[row],
                                frame->shared ? find_deepest_shared_step(&ray, frame->steps)
                                              : find_deepest_medium_step(&ray, frame->steps));
    }
}

/* NAN after an interruption. */
static double measure_frame_depth(const struct neph_shot *shot, const struct neph_scene *scene,
                                  bool shared, int steps)
{
    struct frame frame = {.shot = shot,
                          .scene = scene,
                          .camera = neph_scene_camera(scene, shot->frame),
                          .shared = shared,
                          .steps = steps};
    double most = 0.0, cut_error;
    for (int m = 0; m < scene->medium_count; m++)
        frame.containers[m] = neph_medium_container(scene, &scene->media[m], &cut_error);
    if (neph_parallel_rows(ROWS, measure_row_depth, &frame, NULL))
        return NAN;
    for (int row = 0; row < ROWS; row++)
        most = fmax(most, frame.most[row]);
    return most;
}

static double measure_shot_depth(const struct neph_shot *shot, const struct neph_engine *engine,
                                 bool shared)
{
    const int steps = (int)neph_setting(engine, &shot->settings, engine->step.option);
    struct neph_marched_scene marched;
    if (!neph_marched_scene_init(shot, engine, &marched))
        return NAN;
    const double most = measure_frame_depth(shot, marched.scene, shared, steps);
    neph_marched_scene_finish(&marched);
    return most;
}

double neph_step_depth(const struct neph_shot *shot, const struct neph_engine *engine)
{
    for (size_t i = 0; engine->step.option && i < sizeof(marchers) / sizeof(marchers[0]); i++)
        if (strcmp(engine->step.option, marchers[i].option) == 0)
            return measure_shot_depth(shot, engine, marchers[i].shared);
    return NAN;
}

char *neph_step_depth_warning(double depth, const struct neph_engine *engine)
{
    if (!(depth > NEPH_STEP_DEPTH_MAX))
        return NULL;
    return neph_format("a step of %s spans an optical depth of up to %.3g, and changes within a "
                       "step are lost: raise its %s",
                       engine->name, depth, engine->step.option);
}
