/* SPDX-License-Identifier: MIT */
#include "harness/fit/pixels.h"

#include "base/image_window.h"
#include "base/sort.h"
#include "scenes/solids.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_FIT_QUANTITY_COUNT == 2, "a new quantity");

enum { PIXELS_MIN = 16 };

/* Depths that differ by less are of the same surface. */
static const double depth_tolerance = 0.01;

/* Within a pixel without an edge depths differ by less. */
static const double edge_tolerance = 0.1;

/* Channels of a frame. */
struct channels {
    const float *samples[NEPH_FIT_QUANTITY_COUNT][3]; /* NULL: none */
    const float *depth;
    bool is_alpha; /* transmittance is 1 - alpha */
};

struct work {
    const struct neph_fit_source *source;
    struct channels channels;
    struct neph_window window;
    struct neph_camera camera;
    struct neph_fit_pixels *pixels;
    /* For each pixel of the list: distance to the scene's solid, depth over distance. */
    double *hit_m, *cosines;
    int *at; /* index in the image */
};

/* ---- channels -------------------------------------------------------------------------------- */

static enum neph_status find_named(struct work *work, const char *name, struct neph_diag *diag)
{
    struct channels *channels = &work->channels;
    float *rgb[3];
    channels->is_alpha = strcmp(name, "A") == 0;
    if (!neph_image_rgb(work->source->image, name, rgb))
        rgb[0] = rgb[1] = rgb[2] = neph_image_channel(work->source->image, name);
    if (!rgb[0]) {
        neph_fail(diag, NEPH_ERR_INPUT, "the frame has no channel '%s', and no layer %s.R G B",
                  name, name);
        neph_hint(diag, "--transmittance names a channel or a layer; A is 1 - alpha");
        return NEPH_ERR_INPUT;
    }
    for (int c = 0; c < 3; c++)
        channels->samples[NEPH_FIT_TRANSMITTANCE][c] = rgb[c];
    snprintf(work->pixels->transmittance, sizeof(work->pixels->transmittance), "%s", name);
    return NEPH_OK;
}

static enum neph_status find_channels(struct work *work, struct neph_diag *diag)
{
    const struct neph_image *image = work->source->image;
    float *rgb[3];
    for (int c = 0; neph_image_rgb(image, NULL, rgb) && c < 3; c++)
        work->channels.samples[NEPH_FIT_RADIANCE][c] = rgb[c];
    work->channels.depth = neph_image_channel(image, "Z");
    if (work->source->transmittance)
        return find_named(work, work->source->transmittance, diag);
    return neph_image_rgb(image, "transmittance", rgb) ? find_named(work, "transmittance", diag)
                                                       : NEPH_OK;
}

/* The value of a channel, as transmittance where it is alpha. */
static double read_value(const struct work *work, enum neph_fit_quantity q, int channel, size_t at)
{
    const double value = work->channels.samples[q][channel][at];
    return q == NEPH_FIT_TRANSMITTANCE && work->channels.is_alpha ? 1.0 - value : value;
}

/* The mean of 5 x 5 pixels: its noise biases the fit little. */
static double blur(const struct work *work, enum neph_fit_quantity q, int channel, int x, int y)
{
    const struct neph_image *image = work->source->image;
    double sum = 0.0;
    int count = 0;
    for (int j = y - 2; j <= y + 2; j++)
        for (int i = x - 2; i <= x + 2; i++)
            if (i >= 0 && j >= 0 && i < image->width_px && j < image->height_px) {
                sum += read_value(work, q, channel,
                                  (size_t)j * (size_t)image->width_px + (size_t)i);
                count++;
            }
    return fmax(sum / count, 0.0);
}

/* ---- rays ------------------------------------------------------------------------------------ */

static struct neph_pixel_ray find_ray(const struct work *work, double x, double y)
{
    const struct neph_window *window = &work->window;
    return neph_camera_ray(&work->camera, (int)window->display_px[0], (int)window->display_px[1],
                           x + (double)window->min_px[0], y + (double)window->min_px[1]);
}

static struct neph_hit find_hit(const struct work *work, double x, double y)
{
    const struct neph_pixel_ray ray = find_ray(work, x, y);
    return neph_scene_hit(work->source->scene, ray.origin_m, ray.direction);
}

/* Whether the corners of a pixel see another solid than its centre, or much nearer or farther: the
 * pixel is a mixture. */
static bool has_edge(const struct work *work, struct neph_hit hit, int x, int y)
{
    for (int corner = 0; corner < 4; corner++) {
        const struct neph_hit other = find_hit(work, x + (corner & 1 ? 0.49 : -0.49),
                                               y + (corner & 2 ? 0.49 : -0.49));
        if (other.solid != hit.solid ||
            (hit.solid && fabs(other.t_m / hit.t_m - 1.0) > edge_tolerance))
            return true;
    }
    return false;
}

/* Until finish_weights(), weights are means of pixels, and -1 where there is no value. */
static const double no_weights[NEPH_FIT_VALUES] = {-1, -1, -1, -1, -1, -1};

static void add_pixel(struct work *work, int x, int y)
{
    const struct neph_image *image = work->source->image;
    struct neph_fit_pixels *pixels = work->pixels;
    struct neph_fit_pixel *pixel = &pixels->list[pixels->count];
    const struct neph_hit hit = find_hit(work, x, y);
    const size_t at = (size_t)y * (size_t)image->width_px + (size_t)x;
    if (has_edge(work, hit, x, y)) {
        pixels->edge_count++;
        return;
    }
    *pixel = (struct neph_fit_pixel){.ray = find_ray(work, x, y)};
    memcpy(pixel->weights, no_weights, sizeof(no_weights));
    pixel->tile = x * NEPH_FIT_TILES / image->width_px +
                  NEPH_FIT_TILES * (y * NEPH_FIT_TILES / image->height_px);
    for (int q = 0; q < NEPH_FIT_QUANTITY_COUNT; q++)
        for (int c = 0; c < 3 && work->channels.samples[q][c]; c++) {
            if (q == NEPH_FIT_TRANSMITTANCE && work->channels.is_alpha && hit.solid)
                continue; /* alpha of a solid is 1 */
            pixel->values[3 * q + c] = read_value(work, (enum neph_fit_quantity)q, c, at);
            pixel->weights[3 * q + c] = blur(work, (enum neph_fit_quantity)q, c, x, y);
            pixels->has[q] = true;
        }
    work->hit_m[pixels->count] = hit.t_m;
    work->cosines[pixels->count] = neph_vec3_dot(pixel->ray.direction, work->camera.forward);
    work->at[pixels->count++] = (int)at;
}

/* ---- depth ----------------------------------------------------------------------------------- */

/* The median of the frame's depths over those of the scene; NaN: no pixel has both. */
static double find_depth_factor(const struct work *work, bool is_distance, double *room)
{
    size_t count = 0;
    for (int i = 0; i < work->pixels->count; i++) {
        const double scene_m = work->hit_m[i] * (is_distance ? 1.0 : work->cosines[i]);
        const double depth = work->channels.depth[work->at[i]];
        if (isfinite(scene_m) && isfinite(depth))
            room[count++] = depth / scene_m;
    }
    neph_sort_doubles(room, count);
    return count ? room[count / 2] : NAN;
}

static bool has_depth_of_scene(const struct work *work, int i, bool is_distance, double factor)
{
    const double scene_m = work->hit_m[i] * (is_distance ? 1.0 : work->cosines[i]);
    const double depth = work->channels.depth[work->at[i]];
    if (isinf(scene_m) || isinf(depth))
        return isinf(scene_m) && isinf(depth);
    return fabs(depth / (factor * scene_m) - 1.0) <= depth_tolerance;
}

static int count_equal_depths(const struct work *work, bool is_distance, double factor)
{
    int count = 0;
    for (int i = 0; i < work->pixels->count; i++)
        count += has_depth_of_scene(work, i, is_distance, factor);
    return count;
}

static enum neph_status refuse_depth(const struct work *work, int equal, struct neph_diag *diag)
{
    neph_fail(diag, NEPH_ERR_INPUT,
              "the depths of the frame are those of the scene in %.0f %% of the pixels only",
              100.0 * equal / work->pixels->count);
    neph_hint(diag, "check the camera and the solids of the scene with `neph render -e exact`; "
                    "--depth names another channel");
    return NEPH_ERR_INPUT;
}

/* Remove pixels of which the frame shows another surface than the scene. */
static void remove_other_depths(struct work *work)
{
    struct neph_fit_pixels *pixels = work->pixels;
    int kept = 0;
    for (int i = 0; i < pixels->count; i++)
        if (has_depth_of_scene(work, i, pixels->depth_is_distance, pixels->depth_factor))
            pixels->list[kept++] = pixels->list[i];
    pixels->depth_count = pixels->count - kept;
    pixels->count = kept;
}

/* Compare depths: in the frame's unit, and along the axis of the camera or along the ray. */
static enum neph_status check_depth(struct work *work, struct neph_diag *diag)
{
    struct neph_fit_pixels *pixels = work->pixels;
    int equal[2];
    double factors[2];
    if (!work->channels.depth || pixels->count == 0)
        return NEPH_OK;
    double *room = calloc((size_t)pixels->count, sizeof(*room));
    if (!room)
        return neph_fail_memory(diag);
    for (int kind = 0; kind < 2; kind++) {
        factors[kind] = find_depth_factor(work, kind == 1, room);
        if (fabs(factors[kind] - 1.0) <= depth_tolerance)
            factors[kind] = 1.0;
        equal[kind] = count_equal_depths(work, kind == 1, factors[kind]);
    }
    free(room);
    pixels->depth_is_distance = equal[1] > equal[0];
    pixels->depth_factor = factors[pixels->depth_is_distance];
    pixels->has_depth = true;
    if (2 * equal[pixels->depth_is_distance] < pixels->count)
        return refuse_depth(work, equal[pixels->depth_is_distance], diag);
    remove_other_depths(work);
    return NEPH_OK;
}

/* ---- weights --------------------------------------------------------------------------------- */

static double mean_weight(const struct neph_fit_pixels *pixels, int q)
{
    double sum = 0.0;
    for (int i = 0; i < pixels->count; i++)
        for (int c = 0; c < 3; c++)
            sum += fmax(pixels->list[i].weights[3 * q + c], 0.0) / 3.0;
    return sum / pixels->count;
}

/* Radiance that is 0 everywhere is left out; a transmittance says that the medium is opaque. */
static void finish_weights(struct neph_fit_pixels *pixels)
{
    static const double least[NEPH_FIT_QUANTITY_COUNT] = {[NEPH_FIT_TRANSMITTANCE] = 1e-3};
    for (int q = 0; q < NEPH_FIT_QUANTITY_COUNT; q++) {
        const double mean = mean_weight(pixels, q) + least[q];
        pixels->has[q] = pixels->has[q] && mean > 0.0;
        for (int i = 0; i < pixels->count; i++)
            for (int c = 0; c < 3; c++) {
                double *weight = &pixels->list[i].weights[3 * q + c];
                *weight = pixels->has[q] && *weight >= 0.0 ? 1.0 / (*weight + mean) : 0.0;
            }
    }
}

static enum neph_status check_transmittance(const struct work *work, struct neph_diag *diag)
{
    const struct neph_fit_pixels *pixels = work->pixels;
    double sum = 0.0;
    for (int i = 0; i < pixels->count; i++)
        sum += pixels->list[i].values[3 * NEPH_FIT_TRANSMITTANCE + 1];
    if (!pixels->has[NEPH_FIT_TRANSMITTANCE] || sum <= 1.01 * pixels->count)
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_INPUT, "'%s' is no transmittance: its mean is %.3g, allowed 0 to 1",
              pixels->transmittance, sum / pixels->count);
    neph_hint(diag, "--transmittance names another channel or layer");
    return NEPH_ERR_INPUT;
}

/* ---- all ------------------------------------------------------------------------------------- */

static enum neph_status check_count(const struct neph_fit_pixels *pixels, struct neph_diag *diag)
{
    if (pixels->count >= PIXELS_MIN)
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_UNSUPPORTED,
              "%d pixels are left to fit, %d are needed: %d have edges of solids, %d another depth "
              "than the scene",
              pixels->count, PIXELS_MIN, pixels->edge_count, pixels->depth_count);
    neph_hint(diag, "a larger frame, or more --pixels");
    return NEPH_ERR_UNSUPPORTED;
}

static enum neph_status check_values(const struct neph_fit_pixels *pixels, struct neph_diag *diag)
{
    if (pixels->has[NEPH_FIT_RADIANCE] || pixels->has[NEPH_FIT_TRANSMITTANCE])
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_UNSUPPORTED, "the frame is black, or has no R G B");
    neph_hint(diag, "--layer names a layer with colour, --transmittance a transmittance");
    return NEPH_ERR_UNSUPPORTED;
}

static enum neph_status take(struct work *work, int step, struct neph_diag *diag)
{
    const struct neph_image *image = work->source->image;
    for (int y = step / 2; y < image->height_px; y += step)
        for (int x = step / 2; x < image->width_px; x += step)
            add_pixel(work, x, y);
    enum neph_status status = check_depth(work, diag);
    if (!status)
        status = check_count(work->pixels, diag);
    if (status)
        return status;
    finish_weights(work->pixels);
    status = check_transmittance(work, diag);
    return status ? status : check_values(work->pixels, diag);
}

static enum neph_status check_aspect(const struct neph_image *image, struct neph_diag *diag)
{
    if (!image->header || image->header->pixel_aspect == 1.0f)
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_INPUT, "the frame's pixels are not square: their aspect is %g",
              (double)image->header->pixel_aspect);
    neph_hint(diag, "resample it, or correct pixelAspectRatio in its header");
    return NEPH_ERR_INPUT;
}

enum neph_status neph_fit_pixels_take(const struct neph_fit_source *source,
                                      struct neph_fit_pixels *pixels, struct neph_diag *diag)
{
    const struct neph_image *image = source->image;
    const double size = (double)image->width_px * image->height_px;
    const int step = (int)fmax(round(sqrt(size / source->count)), 1.0);
    const size_t room = (size_t)(image->width_px / step + 1) *
                        (size_t)(image->height_px / step + 1);
    struct neph_arena arena = {.last = NULL};
    struct work work = {.source = source,
                        .window = neph_image_window(image),
                        .camera = neph_scene_camera(source->scene, 0.0),
                        .pixels = pixels};
    work.hit_m = neph_arena_allocate(&arena, room, sizeof(double));
    work.cosines = neph_arena_allocate(&arena, room, sizeof(double));
    work.at = neph_arena_allocate(&arena, room, sizeof(int));
    *pixels = (struct neph_fit_pixels){.frame_count = (int)size, .depth_factor = NAN};
    pixels->list = calloc(room, sizeof(*pixels->list));
    enum neph_status status = pixels->list ? neph_arena_check(&arena, diag)
                                           : neph_fail_memory(diag);
    if (!status)
        status = check_aspect(image, diag);
    if (!status)
        status = find_channels(&work, diag);
    if (!status)
        status = take(&work, step, diag);
    neph_arena_finish(&arena);
    if (status)
        neph_fit_pixels_finish(pixels);
    return status;
}

void neph_fit_pixels_finish(struct neph_fit_pixels *pixels)
{
    free(pixels->list);
    *pixels = (struct neph_fit_pixels){.list = NULL};
}
