/* SPDX-License-Identifier: MIT
 *
 * Adds up paths in rounds, row by row, with each pixel's samples in order: the sums depend neither
 * on the threads nor on where a render was interrupted.
 */
#include "truth/oracle.h"

#include "base/checkpoint.h"
#include "base/clock.h"
#include "base/files.h"
#include "base/interrupt.h"
#include "base/threads.h"
#include "scenes/media.h"
#include "scenes/surfaces.h"
#include "scenes/trapped_light.h"
#include "truth/moments.h"
#include "truth/path.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Raise it if the same scene and params give other bits, or other sums. */
static const int estimator_version = 5;

enum {
    ROUND_SAMPLES = 64,  /* every round sets up the rays of a row's pixels again */
    TARGET_SAMPLES = 16, /* fewer samples cannot estimate their error */
    SAMPLES_MAX = 1 << 30,
    ROW_NUMBERS = 3, /* per row in a checkpoint: samples, collisions, lookups */
};

static const double checkpoint_interval_s = 10.0;

/* Sums over the samples of a pixel; only doubles, for the checkpoint. */
struct sums {
    double light[3];   /* volume and surface */
    double squares[3]; /* of `light`, per sample */
    double volume[3];
    double order1[3];
    struct neph_moments grey; /* of the mean of `light` over the channels, per sample */
};
enum { SUMS_NUMBERS = sizeof(struct sums) / sizeof(double) };

struct kept_view {
    struct neph_view view;
    bool is_known;
};

struct render {
    const struct neph_scene *scene;
    const struct neph_oracle_params *params;
    struct neph_camera camera;
    struct neph_tracker *tracker; /* owned */
    double *numbers;              /* owned: the checkpoint, ROW_NUMBERS per row, then the sums */
    char *identity;               /* owned: the identity of the checkpoint's job */
    bool has_flights;             /* first collisions are sampled from tables */
    bool has_coverage;            /* views are random, and so is their unscattered light */
    /* Owned: the views of all pixels if optical depths are slow, valid if `is_known`; NULL:
     * recomputed in every round. */
    struct kept_view *views;
    int round_end; /* samples of every pixel after the current round */
    double start_s, saved_s;
};

static size_t number_count(const struct neph_oracle_params *params)
{
    const size_t rows = (size_t)params->height_px, columns = (size_t)params->width_px;
    return ROW_NUMBERS * rows + SUMS_NUMBERS * rows * columns;
}

static double *row_numbers(const struct render *render, int row)
{
    return render->numbers + (size_t)ROW_NUMBERS * (size_t)row;
}

static struct sums load_sums(const struct render *render, size_t pixel)
{
    struct sums sums;
    memcpy(&sums,
           render->numbers + ROW_NUMBERS * (size_t)render->params->height_px + SUMS_NUMBERS * pixel,
           sizeof(sums));
    return sums;
}

static void save_sums(struct render *render, size_t pixel, const struct sums *sums)
{
    memcpy(render->numbers + ROW_NUMBERS * (size_t)render->params->height_px + SUMS_NUMBERS * pixel,
           sums, sizeof(*sums));
}

/* ---- scenes that can be rendered ---- */

bool neph_oracle_can_render(const struct neph_scene *scene, char *reason, size_t reason_size)
{
    const char *cannot = neph_metal_obstacle(scene);
    if (neph_scene_traps_light(scene))
        cannot = neph_trapped_light_reason;
    if (cannot)
        snprintf(reason, reason_size, "%s", cannot);
    return !cannot;
}

static enum neph_status check_params(const struct neph_oracle_params *params,
                                     struct neph_diag *diag)
{
    if (params->width_px < 1 || params->width_px > NEPH_IMAGE_SIDE_MAX_PX ||
        params->height_px < 1 || params->height_px > NEPH_IMAGE_SIDE_MAX_PX)
        return neph_fail(diag, NEPH_ERR_USAGE, "a frame of %d x %d pixels: each side must be 1..%d",
                         params->width_px, params->height_px, NEPH_IMAGE_SIDE_MAX_PX);
    if (params->samples < 2 || params->samples > SAMPLES_MAX)
        return neph_fail(diag, NEPH_ERR_USAGE, "%d samples: must be 2..%d", params->samples,
                         SAMPLES_MAX);
    if (!(params->target_error >= 0.0))
        return neph_fail(diag, NEPH_ERR_USAGE, "a target error of %g: must be 0 or more",
                         params->target_error);
    if (!(params->time_limit_s > 0.0))
        return neph_fail(diag, NEPH_ERR_USAGE, "a time limit of %g s: must be above 0",
                         params->time_limit_s);
    return NEPH_OK;
}

/* ---- rounds ---- */

static struct neph_view make_view(const struct render *render, const struct neph_scene *scene,
                                  int column, int row)
{
    const struct neph_oracle_params *params = render->params;
    const struct neph_pixel_ray ray = neph_camera_ray(&render->camera, params->width_px,
                                                      params->height_px, column, row);
    return neph_view_create(scene, ray.origin_m, ray.direction);
}

static struct neph_view pixel_view(const struct render *render, int column, int row)
{
    if (!render->views)
        return make_view(render, render->scene, column, row);
    struct kept_view *kept =
        &render->views[(size_t)row * (size_t)render->params->width_px + (size_t)column];
    if (!kept->is_known)
        *kept = (struct kept_view){make_view(render, render->scene, column, row), true};
    return kept->view;
}

static void add_light(struct sums *sums, const struct neph_path_light *light)
{
    const struct neph_rgb all = neph_rgb_add(light->volume, light->surface);
    const double value[3] = {all.r, all.g, all.b};
    const double volume[3] = {light->volume.r, light->volume.g, light->volume.b};
    const double order1[3] = {light->order1.r, light->order1.g, light->order1.b};
    for (int j = 0; j < 3; j++) {
        sums->light[j] += value[j];
        sums->squares[j] += value[j] * value[j];
        sums->volume[j] += volume[j];
        sums->order1[j] += order1[j];
    }
    neph_moments_add(&sums->grey, (value[0] + value[1] + value[2]) / 3.0);
}

static void init_flight(const struct render *render, const struct neph_view *view,
                        struct neph_flight *flight)
{
    const struct neph_ray ray = {view->origin_m, view->direction, view->hit.t_m};
    neph_flight_init(flight, render->scene, &ray);
}

/* One sample of a pixel whose rays meet meshes by chance. `scene` is the row's own. */
static struct neph_path_light sample_coverage(const struct render *render, struct neph_scene *scene,
                                              int column, int row, struct neph_random *random,
                                              struct neph_tracking_cost *cost)
{
    scene->coverage_draw = 1 + (uint64_t)(neph_random_uniform(random) * 0x1p53);
    const struct neph_view view = make_view(render, scene, column, row);
    struct neph_path_light light = neph_path_trace(scene, render->tracker, &view, NULL, random,
                                                   cost);
    light.surface = neph_rgb_add(light.surface, view.unscattered);
    return light;
}

/* Render a row up to the round's end. */
static void render_row(int row, void *context)
{
    struct render *render = context;
    double *numbers = row_numbers(render, row);
    const int first = (int)numbers[0];
    struct neph_tracking_cost cost = {0, 0};
    struct neph_flight flight;
    struct neph_scene drawn = *render->scene;
    for (int column = 0; column < render->params->width_px; column++) {
        const size_t pixel = (size_t)row * (size_t)render->params->width_px + (size_t)column;
        const struct neph_view view = pixel_view(render, column, row);
        struct sums sums = load_sums(render, pixel);
        if (render->has_flights)
            init_flight(render, &view, &flight);
        for (int sample = first; sample < render->round_end; sample++) {
            struct neph_random random = neph_random_stream(render->params->seed, pixel,
                                                           (uint64_t)sample);
            const struct neph_path_light light =
                render->has_coverage
                    ? sample_coverage(render, &drawn, column, row, &random, &cost)
                    : neph_path_trace(render->scene, render->tracker, &view,
                                      render->has_flights ? &flight : NULL, &random, &cost);
            add_light(&sums, &light);
        }
        save_sums(render, pixel, &sums);
    }
    numbers[0] = fmax(first, render->round_end);
    numbers[1] += (double)cost.collisions;
    numbers[2] += (double)cost.lookups;
}

/* Short rounds first, to meet a time limit. The ends do not depend on interruptions, so a target is
 * met at the same one. */
static int next_round_end(int done, int samples)
{
    int end = 2;
    while (end <= done)
        end = end < ROUND_SAMPLES ? 2 * end : (done / ROUND_SAMPLES + 1) * ROUND_SAMPLES;
    return end < samples ? end : samples;
}

/* The samples of a row; rows may differ after an interruption. */
static int row_samples(const struct render *render, int row)
{
    return (int)row_numbers(render, row)[0];
}

static int samples_done(const struct render *render)
{
    int least = row_samples(render, 0);
    for (int row = 1; row < render->params->height_px; row++)
        if (row_samples(render, row) < least)
            least = row_samples(render, row);
    return least;
}

/* The squared standard error of the mean of n samples. */
static double variance_of_mean(double sum, double squares, int n)
{
    const double mean = sum / n;
    return fmax(0.0, squares / n - mean * mean) / (n - 1);
}

/* The reached error, as params.target_error. */
static double relative_error(const struct render *render)
{
    const size_t columns = (size_t)render->params->width_px;
    double variance = 0.0, power = 0.0;
    for (size_t pixel = 0; pixel < columns * (size_t)render->params->height_px; pixel++) {
        const int n = row_samples(render, (int)(pixel / columns));
        const struct sums sums = load_sums(render, pixel);
        for (int j = 0; j < 3; j++) {
            variance += variance_of_mean(sums.light[j], sums.squares[j], n);
            power += sums.volume[j] / n * (sums.volume[j] / n);
        }
    }
    if (variance == 0.0 && power == 0.0 && render->has_flights)
        return INFINITY; /* no light was sampled yet */
    if (variance == 0.0)
        return 0.0;
    return sqrt(variance / power);
}

/* ---- checkpoints ---- */

static char *make_identity(const struct neph_scene *scene, const struct neph_oracle_params *params)
{
    return neph_format("oracle %d, scene %s, %dx%d, frame %.17g, seed %llu", estimator_version,
                       scene->hash, params->width_px, params->height_px, params->frame,
                       (unsigned long long)params->seed);
}

static enum neph_status resume(struct render *render, struct neph_diag *diag)
{
    const char *path = render->params->checkpoint;
    if (!path || !neph_path_exists(path))
        return NEPH_OK;
    return neph_checkpoint_read(path, render->identity, render->numbers,
                                number_count(render->params), diag);
}

static enum neph_status leave_checkpoint(struct render *render, struct neph_diag *diag)
{
    if (!render->params->checkpoint)
        return NEPH_OK;
    render->saved_s = neph_wall_s();
    return neph_checkpoint_write(render->params->checkpoint, render->identity, render->numbers,
                                 number_count(render->params), diag);
}

/* ---- the render ------------------------------------------------------------------------------ */

/* Whether to render another round; `sample_s` is the time of the last sample of all pixels. */
static bool needs_another_round(const struct render *render, int done, double sample_s)
{
    const struct neph_oracle_params *params = render->params;
    if (done >= params->samples)
        return false;
    if (done < 2)
        return true;
    if (params->target_error > 0.0 && done >= TARGET_SAMPLES &&
        relative_error(render) <= params->target_error)
        return false;
    const double round_s = sample_s * (next_round_end(done, params->samples) - done);
    return neph_wall_s() - render->start_s + round_s < params->time_limit_s;
}

static enum neph_status run_rounds(struct render *render, struct neph_diag *diag)
{
    double sample_s = 0.0;
    enum neph_status status = NEPH_OK;
    for (int done = samples_done(render); !status && needs_another_round(render, done, sample_s);) {
        const double start_s = neph_wall_s();
        render->round_end = next_round_end(done, render->params->samples);
        status = neph_parallel_rows(render->params->height_px, render_row, render, diag);
        sample_s = (neph_wall_s() - start_s) / (render->round_end - done);
        done = samples_done(render);
        if (!status && neph_wall_s() - render->saved_s > checkpoint_interval_s)
            status = leave_checkpoint(render, diag);
    }
    if (status && status != NEPH_ERR_INTERRUPTED)
        return status;
    const enum neph_status saved = leave_checkpoint(render, status ? NULL : diag);
    return status ? status : saved;
}

struct layers {
    float *radiance[3], *volume[3], *order1[3], *transmittance[3], *variance[3], *depth;
};

static enum neph_status add_layers(struct neph_image *frame, struct layers *layers,
                                   struct neph_diag *diag)
{
    enum neph_status status = neph_image_add_rgb(frame, NULL, layers->radiance, diag);
    if (!status)
        status = neph_image_add_rgb(frame, "volume", layers->volume, diag);
    if (!status)
        status = neph_image_add_rgb(frame, "order1", layers->order1, diag);
    if (!status)
        status = neph_image_add_rgb(frame, "transmittance", layers->transmittance, diag);
    if (!status)
        status = neph_image_add_rgb(frame, "variance", layers->variance, diag);
    if (!status)
        status = neph_image_add_channel(frame, "Z", &layers->depth, diag);
    return status;
}

struct finish {
    struct render *render;
    struct layers layers;
};

static void finish_row(int row, void *context)
{
    struct finish *finish = context;
    const struct render *render = finish->render;
    const struct layers *layers = &finish->layers;
    const int n = row_samples(render, row);
    for (int column = 0; column < render->params->width_px; column++) {
        const size_t pixel = (size_t)row * (size_t)render->params->width_px + (size_t)column;
        const struct neph_view view = pixel_view(render, column, row);
        const struct sums sums = load_sums(render, pixel);
        const struct neph_rgb t = view.transmittance, u = render->has_coverage
                                                              ? (struct neph_rgb){0, 0, 0}
                                                              : view.unscattered;
        const double transmittance[3] = {t.r, t.g, t.b}, unscattered[3] = {u.r, u.g, u.b};
        for (int j = 0; j < 3; j++) {
            layers->radiance[j][pixel] = (float)(unscattered[j] + sums.light[j] / n);
            layers->volume[j][pixel] = (float)(sums.volume[j] / n);
            layers->order1[j][pixel] = (float)(sums.order1[j] / n);
            layers->transmittance[j][pixel] = (float)transmittance[j];
            layers->variance[j][pixel] = (float)variance_of_mean(sums.light[j], sums.squares[j], n);
        }
        layers->depth[pixel] = (float)(view.hit.t_m *
                                       neph_vec3_dot(view.direction, render->camera.forward));
    }
}

static enum neph_status make_frame(struct render *render, struct neph_image **frame,
                                   struct neph_diag *diag)
{
    struct finish finish = {.render = render};
    struct neph_image *image = NULL;
    enum neph_status status = neph_image_create(render->params->width_px, render->params->height_px,
                                                &image, diag);
    if (!status)
        status = add_layers(image, &finish.layers, diag);
    if (!status)
        status = neph_parallel_rows(render->params->height_px, finish_row, &finish, diag);
    if (status) {
        neph_image_destroy(image);
        return status;
    }
    *frame = image;
    return NEPH_OK;
}

static struct neph_oracle_stats make_stats(const struct render *render)
{
    struct neph_oracle_stats stats = {.samples = samples_done(render)};
    stats.error = relative_error(render);
    for (int row = 0; row < render->params->height_px; row++) {
        stats.collisions += (uint64_t)row_numbers(render, row)[1];
        stats.lookups += (uint64_t)row_numbers(render, row)[2];
    }
    const size_t pixels = (size_t)render->params->width_px * (size_t)render->params->height_px;
    for (size_t pixel = 0; pixel < pixels; pixel++) {
        const struct sums sums = load_sums(render, pixel);
        const struct neph_moments_estimate grey = neph_moments_estimate(&sums.grey);
        neph_doubt_add(&stats.doubt, grey.standard_error * grey.standard_error, grey.doubt);
    }
    stats.wall_s = neph_wall_s() - render->start_s;
    return stats;
}

static bool has_slow_media(const struct neph_scene *scene)
{
    for (int m = 0; m < scene->medium_count; m++)
        if (!neph_medium_has_closed_form(&scene->media[m]))
            return true;
    return false;
}

/* Allocate everything that `render` owns. */
static enum neph_status prepare(struct render *render, struct neph_diag *diag)
{
    render->identity = make_identity(render->scene, render->params);
    render->numbers = calloc(number_count(render->params), sizeof(*render->numbers));
    if (!render->identity || !render->numbers)
        return neph_fail_memory(diag);
    const size_t pixels = (size_t)render->params->width_px * (size_t)render->params->height_px;
    if (has_slow_media(render->scene)) {
        render->views = calloc(pixels, sizeof(*render->views));
        if (!render->views)
            return neph_fail_memory(diag);
    }
    return neph_tracker_create(render->scene, &render->tracker, diag);
}

enum neph_status neph_oracle_render(const struct neph_scene *scene,
                                    const struct neph_oracle_params *params,
                                    struct neph_image **frame, struct neph_oracle_stats *stats,
                                    struct neph_diag *diag)
{
    char reason[256];
    enum neph_status status = check_params(params, diag);
    if (status)
        return status;
    if (!neph_oracle_can_render(scene, reason, sizeof(reason)))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "the oracle cannot: %s", reason);
    const bool has_coverage = neph_scene_mesh_looks(scene) & NEPH_LOOK_COVERAGE;
    struct render render = {.scene = scene,
                            .params = params,
                            .camera = neph_scene_camera(scene, params->frame),
                            .has_flights = neph_path_has_volume(scene) && !has_coverage,
                            .has_coverage = has_coverage,
                            .start_s = neph_wall_s(),
                            .saved_s = neph_wall_s()};
    status = prepare(&render, diag);
    if (!status)
        status = resume(&render, diag);
    if (!status)
        status = run_rounds(&render, diag);
    if (!status)
        status = make_frame(&render, frame, diag);
    if (!status && stats)
        *stats = make_stats(&render);
    free(render.identity);
    free(render.numbers);
    free(render.views);
    neph_tracker_destroy(render.tracker);
    return status;
}
