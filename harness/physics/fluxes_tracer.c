/* SPDX-License-Identifier: MIT
 *
 * Starts are counted batch by batch, in a batch flux by flux and column by column. A frame of the
 * tracer has the next starts as its pixels, whichever batches they belong to.
 */
#include "harness/physics/fluxes_tracer.h"

#include "base/clock.h"
#include "base/threads.h"
#include "renderer/tracer.h"
#include "scenes/media.h"
#include "truth/directions.h"
#include "truth/random.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    FRAME_WIDTH = 1024, /* pixels */
    FRAME_ROWS = 512,   /* at most */
    CANDIDATES = 8,     /* points of which one is chosen by absorption */
};

/* Height of the bottom level above the ground, as a part of the height: float32 separates them. */
static const double hair = 1e-5;

/* The starts of a flux. */
static const struct camera {
    enum neph_flux flux;
    int side;                   /* 1: upwards, -1: downwards, 0: any direction */
    bool is_at_top, is_diffuse; /* by the cosine law; else vertical */
} cameras[] = {
    {NEPH_FLUX_REFLECTED, -1, true, true}, {NEPH_FLUX_TRANSMITTED, 1, false, true},
    {NEPH_FLUX_UPWARD, -1, false, true},   {NEPH_FLUX_ABSORBED, 0, false, false},
    {NEPH_FLUX_NADIR, -1, true, false},    {NEPH_FLUX_ZENITH, 1, false, false},
};
enum { CAMERAS = sizeof(cameras) / sizeof(cameras[0]) };

/* A ray, and how its radiance becomes a value: radiance * weight + direct, per channel. */
struct start {
    enum neph_flux flux;
    int column;
    double weight[3], direct[3];
};

struct work {
    struct neph_vulkan *vulkan;
    struct neph_scene scene; /* of neph_flux_scene(), with a camera */
    struct neph_camera_key key;
    const struct neph_fluxes_params *params;
    struct neph_flux_domain domain;
    int channels;
    const struct camera *used[CAMERAS];
    int used_count;
    int batches, starts; /* of a batch, flux and column */
    size_t batch_starts; /* of a batch in all */
    size_t first;        /* start of the frame */
    double rays[FRAME_WIDTH * FRAME_ROWS][6];
    struct start list[FRAME_WIDTH * FRAME_ROWS];
    double *values; /* of the present batch */
};

/* ---- starts ---- */

static struct neph_vec3 point_in_column(const struct work *work, int column, double y_m,
                                        struct neph_random *random)
{
    const struct neph_bounds *box = &work->domain.box;
    const int nx = work->domain.columns_x, nz = work->domain.columns_z;
    const double u = neph_random_uniform(random), v = neph_random_uniform(random);
    return (struct neph_vec3){
        box->min_m.x + (box->max_m.x - box->min_m.x) * (column % nx + u) / nx, y_m,
        box->min_m.z + (box->max_m.z - box->min_m.z) * (column / nx + v) / nz};
}

static struct neph_rgb find_absorption_per_m(const struct neph_scene *scene,
                                             struct neph_vec3 point_m)
{
    struct neph_rgb sum = {0, 0, 0};
    for (int m = 0; m < scene->medium_count; m++) {
        const struct neph_medium *medium = &scene->media[m];
        const struct neph_rgb w = medium->albedo;
        const struct neph_rgb lost = {1.0 - w.r, 1.0 - w.g, 1.0 - w.b};
        sum = neph_rgb_add(sum, neph_rgb_scale(neph_rgb_mul(medium->extinction_color, lost),
                                               neph_medium_extinction_per_m(medium, point_m)));
    }
    return sum;
}

/* Choose a point of a column by absorption; returns the absorption coefficient there over the
 * probability density of the point, times the column's area [1]. */
static struct neph_rgb choose_absorbing_point(const struct work *work, int column,
                                              struct neph_random *random, struct neph_vec3 *point_m)
{
    const struct neph_bounds *box = &work->domain.box;
    const double height_m = box->max_m.y - box->min_m.y;
    struct neph_rgb chosen = {0, 0, 0};
    double sum = 0.0, weight = 0.0;
    for (int i = 0; i < CANDIDATES; i++) {
        const double y_m = box->min_m.y + height_m * (i + neph_random_uniform(random)) / CANDIDATES;
        const struct neph_vec3 at_m = point_in_column(work, column, y_m, random);
        const struct neph_rgb per_m = find_absorption_per_m(&work->scene, at_m);
        const double own = per_m.r + per_m.g + per_m.b;
        sum += own;
        if (own > 0.0 && neph_random_uniform(random) * sum < own) {
            chosen = per_m;
            weight = own;
            *point_m = at_m;
        }
    }
    return neph_rgb_scale(chosen, weight > 0.0 ? height_m * sum / (CANDIDATES * weight) : 0.0);
}

static struct neph_vec3 choose_direction(const struct camera *camera, struct neph_random *random)
{
    const struct neph_vec3 vertical = {0.0, camera->side, 0.0};
    if (camera->is_diffuse)
        return neph_cosine_sample(vertical, random);
    if (camera->side != 0)
        return vertical;
    const double y = 2.0 * neph_random_uniform(random) - 1.0;
    return neph_direction_around((struct neph_vec3){0, 1, 0}, acos(y), random);
}

static struct neph_rgb find_sunlight(const struct work *work, struct neph_vec3 point_m)
{
    const struct neph_rgb depth = neph_scene_optical_depth(
        &work->scene, point_m, work->scene.sun.direction, 0.0, INFINITY);
    return (struct neph_rgb){exp(-depth.r), exp(-depth.g), exp(-depth.b)};
}

static void set_rgb(double values[3], struct neph_rgb rgb, double scale)
{
    values[0] = scale * rgb.r;
    values[1] = scale * rgb.g;
    values[2] = scale * rgb.b;
}

/* Fill the start of a pixel. */
static void place_start(struct work *work, int pixel)
{
    const size_t number = work->first + (size_t)pixel, of_batch = number % work->batch_starts;
    const size_t columns = (size_t)work->domain.columns_x * (size_t)work->domain.columns_z;
    const struct camera *camera = work->used[of_batch / ((size_t)work->starts * columns)];
    const int column = (int)(of_batch / (size_t)work->starts % columns);
    const struct neph_bounds *box = &work->domain.box;
    const double bottom_m = box->min_m.y + hair * (box->max_m.y - box->min_m.y),
                 per_sun = 1.0 / work->scene.sun.direction.y;
    struct neph_random random = neph_random_stream(work->params->seed, number, 0);
    struct neph_rgb weight = {M_PI, M_PI, M_PI}, direct = {0, 0, 0};
    struct neph_vec3 from_m = point_in_column(work, column,
                                              camera->is_at_top ? box->max_m.y : bottom_m, &random);
    struct start *start = &work->list[pixel];
    *start = (struct start){.flux = camera->flux, .column = column};
    if (camera->flux == NEPH_FLUX_ABSORBED) {
        const struct neph_rgb per_area = choose_absorbing_point(work, column, &random, &from_m);
        weight = neph_rgb_scale(per_area, 4.0 * M_PI);
        direct = neph_rgb_mul(per_area, find_sunlight(work, from_m));
    } else if (camera->flux == NEPH_FLUX_TRANSMITTED) {
        direct = neph_rgb_scale(find_sunlight(work, from_m), work->scene.sun.direction.y);
    }
    set_rgb(start->weight, weight, per_sun);
    set_rgb(start->direct, direct, per_sun);
    const struct neph_vec3 direction = choose_direction(camera, &random);
    memcpy(work->rays[pixel],
           (const double[6]){from_m.x, from_m.y, from_m.z, direction.x, direction.y, direction.z},
           sizeof(work->rays[pixel]));
}

/* ---- frames ---- */

static void place_row(int row, void *context)
{
    struct work *work = context;
    for (int i = 0; i < FRAME_WIDTH; i++)
        place_start(work, row * FRAME_WIDTH + i);
}

/* Add the value of a pixel to its batch, and the batch to the fluxes after its last start. */
static void add_pixel(struct work *work, int pixel, float *const radiance[3],
                      struct neph_fluxes *fluxes)
{
    const struct start *start = &work->list[pixel];
    const size_t columns = (size_t)work->domain.columns_x * (size_t)work->domain.columns_z;
    const size_t place = ((size_t)start->flux * columns + (size_t)start->column) *
                         (size_t)work->channels,
                 direct = ((size_t)NEPH_FLUX_DIRECT * columns + (size_t)start->column) *
                          (size_t)work->channels;
    for (int c = 0; c < work->channels; c++) {
        work->values[place + (size_t)c] +=
            (start->weight[c] * (double)radiance[c][pixel] + start->direct[c]) / work->starts;
        if (start->flux == NEPH_FLUX_TRANSMITTED)
            work->values[direct + (size_t)c] += start->direct[c] / work->starts;
    }
    if ((work->first + (size_t)pixel + 1) % work->batch_starts > 0)
        return;
    neph_fluxes_add_batch(fluxes, work->values);
    memset(work->values, 0,
           NEPH_FLUX_COUNT * columns * (size_t)work->channels * sizeof(*work->values));
}

static enum neph_status trace_frame(struct work *work, int frame, size_t count,
                                    struct neph_fluxes *fluxes, struct neph_diag *diag)
{
    const int rows = (int)((count + FRAME_WIDTH - 1) / FRAME_WIDTH);
    struct neph_image *image = NULL;
    float *radiance[3];
    enum neph_status status = neph_parallel_rows(rows, place_row, work, diag);
    const struct neph_tracer_params params = {.width_px = FRAME_WIDTH,
                                              .height_px = rows,
                                              .rays = work->rays[0],
                                              .seed = work->params->seed + (uint64_t)frame,
                                              .samples = NEPH_TRACER_BATCH_SAMPLES,
                                              .time_limit_s = INFINITY};
    if (!status)
        status = neph_tracer_render(work->vulkan, &work->scene, &params, &image, NULL, diag);
    if (!status && !neph_image_rgb(image, NULL, radiance))
        status = neph_fail(diag, NEPH_ERR_INTERNAL, "a frame of the tracer without R, G, B");
    for (size_t pixel = 0; pixel < count && !status; pixel++)
        add_pixel(work, (int)pixel, radiance, fluxes);
    neph_image_destroy(image);
    return status;
}

static enum neph_status trace_frames(struct work *work, struct neph_fluxes *fluxes,
                                     struct neph_diag *diag)
{
    const struct neph_fluxes_params *params = work->params;
    const size_t all = (size_t)work->batches * work->batch_starts,
                 most = (size_t)FRAME_WIDTH * FRAME_ROWS;
    enum neph_status status = NEPH_OK;
    for (int frame = 0; work->first < all && !status; frame++) {
        const size_t left = all - work->first, count = left < most ? left : most;
        status = trace_frame(work, frame, count, fluxes, diag);
        work->first += count;
        if (!status && params->progress)
            params->progress(params->context, (double)work->first / (double)all);
    }
    return status;
}

/* ---- set-up ---- */

static bool absorbs(const struct neph_scene *scene)
{
    for (int m = 0; m < scene->medium_count; m++) {
        const struct neph_rgb albedo = scene->media[m].albedo;
        if (albedo.r < 1.0 || albedo.g < 1.0 || albedo.b < 1.0)
            return true;
    }
    return false;
}

static void choose_cameras(struct work *work)
{
    const bool has_ground = work->scene.solid_count > 0, has_loss = absorbs(&work->scene);
    for (int i = 0; i < CAMERAS; i++)
        if ((cameras[i].flux != NEPH_FLUX_UPWARD || has_ground) &&
            (cameras[i].flux != NEPH_FLUX_ABSORBED || has_loss))
            work->used[work->used_count++] = &cameras[i];
}

/* Positions in float32 count from the camera. */
static void place_camera(struct work *work)
{
    const struct neph_bounds *box = &work->domain.box;
    const struct neph_vec3 middle_m = neph_vec3_scale(neph_vec3_add(box->min_m, box->max_m), 0.5);
    work->key = (struct neph_camera_key){.position_m = middle_m,
                                         .look_at_m = {middle_m.x, middle_m.y - 1.0, middle_m.z}};
    work->scene.camera_key_count = 1;
    work->scene.camera_keys = &work->key;
    work->scene.camera_up = (struct neph_vec3){0, 0, -1};
    work->scene.vertical_fov_rad = 0.0;
    work->scene.orthographic_height_m = box->max_m.y - box->min_m.y;
}

static void count_starts(struct work *work)
{
    const int samples = NEPH_TRACER_BATCH_SAMPLES;
    const int starts = (work->params->paths + samples - 1) / samples;
    const int wanted = starts < 2 ? 2 : starts;
    work->starts = (wanted + NEPH_FLUX_BATCHES - 1) / NEPH_FLUX_BATCHES;
    work->batches = (wanted + work->starts - 1) / work->starts;
    work->batch_starts = (size_t)work->used_count * (size_t)work->starts *
                         (size_t)work->domain.columns_x * (size_t)work->domain.columns_z;
}

static enum neph_status check_media(const struct neph_scene *scene, struct neph_diag *diag)
{
    for (int m = 0; m < scene->medium_count; m++)
        if (!neph_medium_has_closed_form(&scene->media[m]))
            return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                             "fluxes by the tracer need a closed form of optical depth, which a %s "
                             "has not; -e oracle",
                             neph_medium_facts(scene->media[m].kind)->name);
    return NEPH_OK;
}

static enum neph_status prepare(struct work *work, const struct neph_scene *scene,
                                struct neph_fluxes *made, struct neph_diag *diag)
{
    enum neph_status status = neph_flux_domain_find(scene, work->params, &work->domain, diag);
    if (!status)
        status = check_media(scene, diag);
    if (status)
        return status;
    work->scene = neph_flux_scene(scene);
    place_camera(work);
    choose_cameras(work);
    count_starts(work);
    status = neph_fluxes_create(&work->scene, &work->domain, made, diag);
    if (status)
        return status;
    work->channels = made->channel_count;
    made->paths = work->batches * work->starts * NEPH_TRACER_BATCH_SAMPLES;
    work->values = calloc((size_t)NEPH_FLUX_COUNT * (size_t)work->domain.columns_x *
                              (size_t)work->domain.columns_z * (size_t)work->channels,
                          sizeof(*work->values));
    return work->values ? neph_scene_hash(&work->scene, diag) : neph_fail_memory(diag);
}

enum neph_status neph_fluxes_trace_on_device(struct neph_vulkan *vulkan,
                                             const struct neph_scene *scene,
                                             const struct neph_fluxes_params *params,
                                             struct neph_fluxes *fluxes, struct neph_diag *diag)
{
    const double start_s = neph_wall_s();
    struct neph_fluxes made = {.sums = NULL};
    struct work *work = calloc(1, sizeof(*work));
    if (!work)
        return neph_fail_memory(diag);
    work->vulkan = vulkan;
    work->params = params;
    enum neph_status status = prepare(work, scene, &made, diag);
    if (!status)
        status = trace_frames(work, &made, diag);
    free(work->values);
    free(work);
    if (status) {
        neph_fluxes_finish(&made);
        return status;
    }
    made.wall_s = neph_wall_s() - start_s;
    *fluxes = made;
    return NEPH_OK;
}
