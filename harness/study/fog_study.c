/* SPDX-License-Identifier: MIT
 *
 * The fog study: exact rays, error of each fog control, steps over distance.
 */
#include "harness/study/fog_study.h"

#include "base/threads.h"
#include "scenes/fog_translation.h"
#include "scenes/media.h"
#include "truth/fog_look.h"
#include "truth/transport.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Fails to compile when a kind is added, as compute_series_switch_m() knows the series of each
 * model. */
_Static_assert(NEPH_FOG_MODEL_COUNT == 2, "a new kind");

static double mean(struct neph_rgb rgb)
{
    return (rgb.r + rgb.g + rgb.b) / 3.0;
}

/* ---- exact rays ------------------------------------------------------------------------------ */

/* A ray from the camera. near_*: its physical fog before the fog model's start distance. */
struct view {
    struct neph_vec3 origin_m, direction;
    double hit_m, behind;
    double radiance, volume, transmittance;
    double near_volume, near_transmittance;
};

struct work {
    struct neph_fog_study *study;
    double start_m; /* start distance of the fog model; 0: at the camera */
    int picture_count, view_count;
    struct view *views; /* owned: the frame's rays, then those over the sphere */
};

enum { VIEWS_OF_A_TASK = 256 };

/* Radiance of the surface that a ray hits, evaluated so close that no fog lies in between. */
static double compute_radiance_behind(const struct neph_scene *scene, const struct view *view)
{
    if (isinf(view->hit_m))
        return mean(scene->background_w_per_m2_sr);
    const double near = 1.0 - 1e-9;
    return mean(neph_transport_ray(
                    scene, neph_vec3_along(view->origin_m, view->direction, near * view->hit_m),
                    view->direction)
                    .radiance);
}

/* Fog before `start_m`: the whole ray minus the part beyond `start_m`. */
static void find_near(const struct neph_scene *scene, double start_m, struct view *view)
{
    view->near_volume = view->volume;
    view->near_transmittance = view->transmittance;
    if (start_m >= view->hit_m)
        return;
    const struct neph_vec3 from_m = neph_vec3_along(view->origin_m, view->direction, start_m);
    const struct neph_ray_light rest = neph_transport_ray(scene, from_m, view->direction);
    const double rest_depth =
        neph_scene_optical_depth(scene, view->origin_m, view->direction, 0.0, start_m).r;
    view->near_transmittance = exp(-rest_depth);
    view->near_volume = view->volume - view->near_transmittance * mean(rest.volume);
}

static void trace_exact_rays(int task, void *context)
{
    struct work *work = context;
    const struct neph_scene *scene = work->study->params->scene;
    const int end = (task + 1) * VIEWS_OF_A_TASK;
    for (int i = task * VIEWS_OF_A_TASK; i < end && i < work->view_count; i++) {
        struct view *view = &work->views[i];
        const struct neph_ray_light light = neph_transport_ray(scene, view->origin_m,
                                                               view->direction);
        view->hit_m = light.hit_m;
        view->radiance = mean(light.radiance);
        view->volume = mean(light.volume);
        view->transmittance = mean(light.transmittance);
        view->behind = compute_radiance_behind(scene, view);
        if (work->start_m > 0.0)
            find_near(scene, work->start_m, view);
    }
}

/* Directions with equal solid angles: a spiral of golden angles (R. Swinbank, R. J. Purser,
 * "Fibonacci grids", Q. J. R. Meteorol. Soc. 132, 2006). */
static struct neph_vec3 direction_over_sphere(int index, int count)
{
    const double turn_rad = M_PI * (3.0 - sqrt(5.0));
    const double y = 1.0 - (2.0 * index + 1.0) / count, across = sqrt(1.0 - y * y);
    return (struct neph_vec3){across * cos(turn_rad * index), y, across * sin(turn_rad * index)};
}

static enum neph_status find_exact(struct work *work, struct neph_diag *diag)
{
    const struct neph_fog_study_params *params = work->study->params;
    const int width_px = params->width_px, height_px = params->height_px;
    const struct neph_camera camera = neph_scene_camera(params->scene, 0.0);
    work->picture_count = width_px * height_px;
    work->view_count = work->picture_count + params->directions;
    work->views = calloc((size_t)work->view_count, sizeof(*work->views));
    if (!work->views)
        return neph_fail_memory(diag);
    for (int i = 0; i < work->view_count; i++) {
        const struct neph_pixel_ray ray = neph_camera_ray(&camera, width_px, height_px,
                                                          i % width_px, i / width_px);
        const int of_sphere = i - work->picture_count;
        work->views[i] = (struct view){
            .origin_m = camera.position_m,
            .direction = of_sphere < 0 ? ray.direction
                                       : direction_over_sphere(of_sphere, params->directions)};
    }
    return neph_parallel_rows((work->view_count + VIEWS_OF_A_TASK - 1) / VIEWS_OF_A_TASK,
                              trace_exact_rays, work, diag);
}

static void sum_exact(const struct work *work)
{
    struct neph_fog_study *study = work->study;
    for (int i = 0; i < work->picture_count; i++)
        study->exact_radiance += work->views[i].radiance / work->picture_count;
    for (int i = work->picture_count; i < work->view_count; i++) {
        study->exact_fog_light += work->views[i].volume / study->params->directions;
        study->exact_all_light += work->views[i].radiance / study->params->directions;
    }
}

/* ---- a row over frame and sphere ------------------------------------------------------------- */

struct fog_ray_result {
    double transmittance, volume, radiance;
};

static struct fog_ray_result evaluate_fog_row(const struct neph_fog_study *study,
                                              const struct neph_fog_row *row,
                                              const struct view *view)
{
    const struct neph_fog_look_light fog = neph_fog_look_ray(
        study->params->scene, &row->look, row->model, view->origin_m, view->direction, view->hit_m);
    struct fog_ray_result fog_ray_result = {fog.transmittance, mean(fog.volume), 0.0};
    if (row->near_by_physics) {
        fog_ray_result.volume = view->near_volume +
                                view->near_transmittance * fog_ray_result.volume;
        fog_ray_result.transmittance *= view->near_transmittance;
    }
    fog_ray_result.radiance = fog_ray_result.volume + fog_ray_result.transmittance * view->behind;
    return fog_ray_result;
}

static void measure_fog_frame(const struct work *work, struct neph_fog_row *row)
{
    const double pixels = work->picture_count, exact = work->study->exact_radiance;
    double radiance = 0.0, squares = 0.0, transmittance = 0.0;
    for (int i = 0; i < work->picture_count; i++) {
        const struct view *view = &work->views[i];
        const struct fog_ray_result fog_ray_result = evaluate_fog_row(work->study, row, view);
        const double off = fog_ray_result.transmittance - view->transmittance;
        transmittance += off;
        row->transmittance_worst = fmax(row->transmittance_worst, fabs(off));
        radiance += fog_ray_result.radiance - view->radiance;
        squares += pow(fog_ray_result.radiance - view->radiance, 2.0);
    }
    row->transmittance_bias = transmittance / pixels;
    row->radiance_bias = radiance / pixels / exact;
    row->radiance_rms = sqrt(squares / pixels) / exact;
}

/* `none` is the row of this model with all controls off: measured before, or `row` itself. */
static void measure_sphere(const struct work *work, const struct neph_fog_row *none,
                           struct neph_fog_row *row)
{
    const struct neph_fog_study *study = work->study;
    double fog = 0.0, all = 0.0;
    for (int i = work->picture_count; i < work->view_count; i++) {
        const struct fog_ray_result fog_ray_result = evaluate_fog_row(study, row, &work->views[i]);
        fog += fog_ray_result.volume / study->params->directions;
        all += fog_ray_result.radiance / study->params->directions;
    }
    row->fog_light = fog / study->exact_fog_light - 1.0;
    row->all_light = all / study->exact_all_light - 1.0;
    row->fog_light_alone = row->fog_light - none->fog_light;
    row->all_light_alone = row->all_light - none->all_light;
}

static void measure_lobe(const struct neph_scene *scene, struct neph_fog_row *row)
{
    const struct neph_rgb sun = scene->sun.irradiance_w_per_m2,
                          albedo = neph_fog_look_find_medium(scene)->albedo;
    const struct neph_rgb scattered = {sun.r * albedo.r, sun.g * albedo.g, sun.b * albedo.b};
    const double sphere_sr = 2.0 * M_PI / (row->look.directional_exponent + 1.0);
    row->lobe_over_sun = NAN;
    if (scene->sun.present && mean(scattered) > 0.0 &&
        neph_fog_control_is_on(&row->look, NEPH_FOG_DIRECTIONAL))
        row->lobe_over_sun = mean(row->look.directional_w_per_m2_sr) * sphere_sr / mean(scattered);
}

/* ---- steps over distance --------------------------------------------------------------------- */

enum { INTERVALS = 100, JUMP_SPHERE = 12 };

/* Transmittance or fog light along a ray, as a function of the hit distance. */
struct ray_profile {
    const struct neph_scene *scene;
    const struct neph_fog_row *row;
    struct neph_vec3 origin_m, direction;
    bool is_light; /* light of the fog; otherwise transmittance */
};

static double evaluate_ray_profile(const struct ray_profile *ray_profile, double distance_m)
{
    const struct neph_fog_look_light light = neph_fog_look_ray(
        ray_profile->scene, &ray_profile->row->look, ray_profile->row->model, ray_profile->origin_m,
        ray_profile->direction, distance_m);
    return ray_profile->is_light ? mean(light.volume) : light.transmittance;
}

/* Finds the step within an interval: halves it 52 times towards the half with the larger change.
 * Returns the remaining change; a continuous function leaves none. */
static double jump_within(const struct ray_profile *ray_profile, double near_m, double far_m,
                          double *at_m)
{
    double before = evaluate_ray_profile(ray_profile, near_m),
           after = evaluate_ray_profile(ray_profile, far_m);
    for (int i = 0; i < 52; i++) {
        const double middle_m = 0.5 * (near_m + far_m),
                     middle = evaluate_ray_profile(ray_profile, middle_m);
        const bool is_nearer = fabs(middle - before) > fabs(after - middle);
        *(is_nearer ? &far_m : &near_m) = middle_m;
        *(is_nearer ? &after : &before) = middle;
    }
    *at_m = far_m;
    return fabs(after - before);
}

/* Distance at which a model switches between its series and the closed form. */
static double compute_series_switch_m(const struct ray_profile *ray_profile,
                                      const struct neph_fog_layer *layer)
{
    const bool is_unreal = ray_profile->row->model == NEPH_FOG_UNREAL;
    const struct neph_fog_look *look = &ray_profile->row->look;
    const double level = is_unreal ? NEPH_FOG_UNREAL_LEVEL * M_LN2 : NEPH_FOG_FILAMENT_LEVEL;
    const double start_m = is_unreal ? fmax(look->start_distance_m, look->volumetric_fog_distance_m)
                                     : 0.0;
    return start_m + level / (layer->falloff_per_m * fabs(ray_profile->direction.y));
}

struct jump {
    double size, at_m;
};

static void take_larger(struct jump *jump, double size, double at_m)
{
    if (size > jump->size)
        *jump = (struct jump){size, at_m};
}

/* Finds the largest step along a ray. Steps that exceed the smooth changes are found by halving.
 * The series' switch distances are evaluated directly, as their steps are smaller than the changes
 * around. */
static void find_jump(const struct ray_profile *ray_profile, struct jump *jump)
{
    const double first_m = 0.01, step = pow(1e7, 1.0 / INTERVALS); /* up to 100 km */
    for (int i = 0; i < INTERVALS; i++) {
        double at_m;
        const double size = jump_within(ray_profile, first_m * pow(step, i),
                                        first_m * pow(step, i + 1), &at_m);
        take_larger(jump, size, at_m);
    }
    const struct neph_medium *fog = neph_fog_look_find_medium(ray_profile->scene);
    for (int l = 0; l < fog->layer_count; l++) {
        const double at_m = compute_series_switch_m(ray_profile, &fog->layers[l]), near = 1e-12;
        if (isfinite(at_m))
            take_larger(jump,
                        fabs(evaluate_ray_profile(ray_profile, at_m * (1.0 + near)) -
                             evaluate_ray_profile(ray_profile, at_m * (1.0 - near))),
                        at_m);
    }
}

/* Directions over the sphere, nearly horizontal ones ahead, straight ahead, and into the sun. */
static struct neph_vec3 jump_direction(const struct neph_scene *scene, int index)
{
    static const double rises[] = {1e-4, -1e-4, 1e-3, -1e-3, 1e-2, -1e-2};
    enum { RISES = sizeof(rises) / sizeof(rises[0]) };
    struct neph_vec3 ahead = neph_scene_camera(scene, 0.0).forward;
    if (index < JUMP_SPHERE)
        return direction_over_sphere(index, JUMP_SPHERE);
    if (index == JUMP_SPHERE + RISES)
        return ahead;
    if (index > JUMP_SPHERE + RISES)
        return scene->sun.present ? scene->sun.direction : ahead;
    ahead.y = rises[index - JUMP_SPHERE] * hypot(ahead.x, ahead.z);
    return neph_vec3_normalize(ahead);
}

static void measure_jumps(const struct neph_fog_study *study, struct neph_fog_row *row)
{
    const struct neph_scene *scene = study->params->scene;
    struct ray_profile ray_profile = {scene, row,
                                      .origin_m = neph_scene_camera(scene, 0.0).position_m};
    struct jump transmittance = {0.0, 0.0}, light = {0.0, 0.0};
    for (int i = 0; i < JUMP_SPHERE + 8; i++) {
        ray_profile.direction = jump_direction(scene, i);
        ray_profile.is_light = false;
        find_jump(&ray_profile, &transmittance);
        ray_profile.is_light = true;
        find_jump(&ray_profile, &light);
    }
    row->transmittance_jump = transmittance.size;
    row->transmittance_jump_m = transmittance.at_m;
    row->light_jump = light.size;
    row->light_jump_m = light.at_m;
}

/* ---- rows ------------------------------------------------------------------------------------ */

static struct neph_fog_row *add_row(struct neph_fog_study *study, enum neph_fog_model model,
                                    const char *name, unsigned controls)
{
    struct neph_fog_row *row = &study->rows[study->row_count++];
    *row = (struct neph_fog_row){
        .model = model,
        .look = neph_fog_look_mask_controls(&study->params->scene->fog_look, controls)};
    snprintf(row->name, sizeof(row->name), "%s", name);
    return row;
}

/* The set of one control; directional_start needs `directional` to have an effect. */
static unsigned single_control_set(enum neph_fog_control control)
{
    return 1u << control |
           (control == NEPH_FOG_DIRECTIONAL_START ? 1u << NEPH_FOG_DIRECTIONAL : 0u);
}

static void add_controls(struct neph_fog_study *study, enum neph_fog_model model)
{
    const struct neph_fog_look *look = &study->params->scene->fog_look;
    for (int c = 0; c < NEPH_FOG_CONTROL_COUNT; c++) {
        const enum neph_fog_control control = (enum neph_fog_control)c;
        const struct neph_fog_control_row *words = &neph_fog_controls()[c];
        if (!neph_fog_control_is_on(look, control) ||
            (model == NEPH_FOG_FILAMENT && !words->filament))
            continue;
        add_row(study, model, words->name, single_control_set(control));
        if (control == NEPH_FOG_HAND_OVER)
            add_row(study, model, "the same, near fog by physics", single_control_set(control))
                ->near_by_physics = true;
    }
}

/* The physical parameters, with the sun as dimmed by the fog at the camera. */
static struct neph_fog_look make_dimmed_sun_parameters(const struct neph_scene *scene)
{
    struct neph_scene dimmed = *scene; /* a shallow copy, which is not freed */
    const double depth = neph_scene_optical_depth(scene, neph_scene_camera(scene, 0.0).position_m,
                                                  scene->sun.direction, 0.0, INFINITY)
                             .r;
    struct neph_rgb *sun = &dimmed.sun.irradiance_w_per_m2;
    *sun = (struct neph_rgb){sun->r * exp(-depth), sun->g * exp(-depth), sun->b * exp(-depth)};
    return neph_fog_look_from_physics(&dimmed, neph_fog_look_find_medium(&dimmed));
}

static void add_model(struct neph_fog_study *study, enum neph_fog_model model)
{
    const struct neph_scene *scene = study->params->scene;
    add_row(study, model, "none", 0);
    add_controls(study, model);
    add_row(study, model, "all", NEPH_FOG_CONTROLS_ALL);
    add_row(study, model, "of physics", 0)->look = neph_fog_look_from_physics(
        scene, neph_fog_look_find_medium(scene));
    add_row(study, model, "of physics, sun as at the camera", 0)->look = make_dimmed_sun_parameters(
        scene);
}

static void measure(const struct work *work)
{
    struct neph_fog_study *study = work->study;
    const struct neph_fog_row *none = NULL;
    for (int i = 0; i < study->row_count; i++) {
        struct neph_fog_row *row = &study->rows[i];
        if (!none || none->model != row->model)
            none = row; /* the first row of its model */
        measure_fog_frame(work, row);
        measure_sphere(work, none, row);
        measure_lobe(study->params->scene, row);
        row->transmittance_jump = row->light_jump = NAN;
        if (!row->near_by_physics)
            measure_jumps(study, row);
    }
}

static enum neph_status check(const struct neph_fog_study_params *params, struct neph_diag *diag)
{
    char reason[256];
    const enum neph_fog_model model = params->model < 0 ? NEPH_FOG_UNREAL
                                                        : (enum neph_fog_model)params->model;
    if (!neph_fog_look_can_model(params->scene, model, reason, sizeof(reason)))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "%s: cannot: %s", params->scene->name, reason);
    if (!neph_transport_is_exact(params->scene, reason, sizeof(reason)))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "%s: exact cannot: %s", params->scene->name,
                         reason);
    return NEPH_OK;
}

enum neph_status neph_fog_study_run(const struct neph_fog_study_params *params,
                                    struct neph_fog_study *study, struct neph_diag *diag)
{
    char reason[256];
    struct work work = {.study = study,
                        .start_m = params->scene->fog_look.volumetric_fog_distance_m};
    enum neph_status status = check(params, diag);
    if (status)
        return status;
    *study = (struct neph_fog_study){.params = params};
    for (int m = 0; m < NEPH_FOG_MODEL_COUNT; m++)
        if ((params->model < 0 || params->model == m) &&
            neph_fog_look_can_model(params->scene, (enum neph_fog_model)m, reason, sizeof(reason)))
            add_model(study, (enum neph_fog_model)m);
    status = find_exact(&work, diag);
    if (!status) {
        sum_exact(&work);
        measure(&work);
    }
    free(work.views);
    return status;
}
