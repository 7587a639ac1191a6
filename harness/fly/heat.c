/* SPDX-License-Identifier: MIT */
#include "harness/fly/heat.h"

#include "base/arena.h"
#include "metrics/display.h"
#include "metrics/extractors/display_luma.h"
#include "metrics/extractors/flicker_spectrum.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- error ----------------------------------------------------------------------------------- */

static enum neph_status find_radiance_planes(const struct neph_image *image,
                                             const struct neph_image *like, float *planes[3],
                                             struct neph_diag *diag)
{
    if (image->width_px != like->width_px || image->height_px != like->height_px)
        return neph_fail(diag, NEPH_ERR_ENGINE, "frames of %dx%d and %dx%d", image->width_px,
                         image->height_px, like->width_px, like->height_px);
    if (!neph_image_rgb(image, NULL, planes))
        return neph_fail(diag, NEPH_ERR_ENGINE, "a frame has no radiance");
    return NEPH_OK;
}

enum neph_status neph_heat_error(const struct neph_image *reference, const struct neph_image *test,
                                 double exposure_ev, double white_share,
                                 struct neph_relative_error *error, uint8_t *rgb,
                                 struct neph_diag *diag)
{
    float *r[3], *t[3];
    const size_t count = neph_image_pixel_count(test);
    enum neph_status status = find_radiance_planes(reference, test, r, diag);
    if (!status)
        status = find_radiance_planes(test, reference, t, diag);
    if (!status)
        status = neph_display_difference((const float *const[]){r[0], r[1], r[2]},
                                         (const float *const[]){t[0], t[1], t[2]}, 3, count,
                                         white_share * exp2(-exposure_ev), rgb, diag);
    if (!status)
        *error = neph_relative_error_compute((const float *const[]){r[0], r[1], r[2]},
                                             (const float *const[]){t[0], t[1], t[2]}, 3, count);
    return status;
}

/* ---- flicker --------------------------------------------------------------------------------- */

/* Number of pixels that are analysed in a few hundredths of a second. */
enum { PIXELS_MAX = 40000, CYCLES_MAX = NEPH_HEAT_FRAMES / NEPH_FLICKER_CYCLE };

struct neph_heat_flicker {
    int width_px, height_px; /* of the frames */
    int step;                /* step of the grid of analysed pixels, odd */
    int columns, rows;       /* size of that grid */
    int padded;              /* columns, padded as in flicker_sums.h */
    int frame_count;         /* since the last reset; not limited to the ring's size */
    double *lumas;           /* index: frame in the ring, row, column */
    float *gathered[3];      /* a row of the grid, linear */
    struct neph_arena arena;
};

void neph_heat_flicker_destroy(struct neph_heat_flicker *flicker)
{
    if (!flicker)
        return;
    neph_arena_finish(&flicker->arena);
    free(flicker);
}

static size_t frame_size(const struct neph_heat_flicker *flicker)
{
    return (size_t)flicker->padded * (size_t)flicker->rows;
}

enum neph_status neph_heat_flicker_create(int width_px, int height_px,
                                          struct neph_heat_flicker **flicker,
                                          struct neph_diag *diag)
{
    struct neph_heat_flicker *made = calloc(1, sizeof(*made));
    if (!made)
        return neph_fail_memory(diag);
    made->width_px = width_px;
    made->height_px = height_px;
    made->step = 1;
    while ((width_px / made->step) * (height_px / made->step) > PIXELS_MAX)
        made->step += 2;
    made->columns = (width_px + made->step - 1) / made->step;
    made->rows = (height_px + made->step - 1) / made->step;
    made->padded = neph_flicker_padded(made->columns);
    made->lumas = neph_arena_allocate(&made->arena, NEPH_HEAT_FRAMES * frame_size(made),
                                      sizeof(*made->lumas));
    for (int c = 0; c < 3; c++)
        made->gathered[c] = neph_arena_allocate(&made->arena, (size_t)made->columns, sizeof(float));
    if (made->arena.is_short) {
        neph_heat_flicker_destroy(made);
        return neph_fail_memory(diag);
    }
    *flicker = made;
    return NEPH_OK;
}

void neph_heat_flicker_forget(struct neph_heat_flicker *flicker)
{
    flicker->frame_count = 0;
}

static double *luma_row(const struct neph_heat_flicker *flicker, int frame, int row)
{
    return flicker->lumas + (size_t)(frame % NEPH_HEAT_FRAMES) * frame_size(flicker) +
           (size_t)row * (size_t)flicker->padded;
}

static void add_row(struct neph_heat_flicker *flicker, float *const planes[3], int row, double gain)
{
    const size_t first = (size_t)row * (size_t)flicker->step * (size_t)flicker->width_px;
    for (int c = 0; c < 3; c++)
        for (int x = 0; x < flicker->columns; x++)
            flicker->gathered[c][x] = planes[c][first + (size_t)(x * flicker->step)];
    neph_display_luma(
        (const float *const[]){flicker->gathered[0], flicker->gathered[1], flicker->gathered[2]},
        (size_t)flicker->columns, gain, luma_row(flicker, flicker->frame_count, row), NULL);
}

enum neph_status neph_heat_flicker_add(struct neph_heat_flicker *flicker,
                                       const struct neph_image *frame, double exposure_ev,
                                       struct neph_diag *diag)
{
    float *planes[3];
    const struct neph_image like = {.width_px = flicker->width_px, .height_px = flicker->height_px};
    const enum neph_status status = find_radiance_planes(frame, &like, planes, diag);
    if (status)
        return status;
    for (int row = 0; row < flicker->rows; row++)
        add_row(flicker, planes, row, exp2(exposure_ev));
    flicker->frame_count++;
    return NEPH_OK;
}

static void add_up_row(const struct neph_heat_flicker *flicker, int row, int frame_count,
                       double *const rows[], struct neph_flicker_sums *sums)
{
    struct neph_flicker_weights weights[CYCLES_MAX];
    const int first = flicker->frame_count - frame_count;
    for (int frame = 0; frame < frame_count; frame++)
        memcpy(rows[frame], luma_row(flicker, first + frame, row),
               (size_t)flicker->padded * sizeof(double));
    for (int cycle = 0; cycle < frame_count / NEPH_FLICKER_CYCLE; cycle++)
        weights[cycle] = neph_flicker_weights_make(cycle * NEPH_FLICKER_CYCLE, frame_count);
    for (int frame = frame_count - 1; frame >= 0; frame--) /* the sums are of differences to the
                                                            * oldest frame */
        for (int x = 0; x < flicker->padded; x++)
            rows[frame][x] -= rows[0][x];
    neph_flicker_sums_add(sums, row, frame_count / NEPH_FLICKER_CYCLE, weights,
                          (const double *const *)rows);
}

/* Sums of all analysed pixels; false: memory is short. */
static bool add_up(const struct neph_heat_flicker *flicker, int frame_count,
                   struct neph_arena *arena, struct neph_flicker_sums *sums)
{
    double *rows[NEPH_HEAT_FRAMES];
    for (int frame = 0; frame < NEPH_HEAT_FRAMES; frame++)
        rows[frame] = neph_arena_allocate(arena, (size_t)flicker->padded, sizeof(**rows));
    if (neph_flicker_sums_begin(sums, flicker->columns, flicker->rows, NEPH_FLICKER_VARIANCE_COUNT,
                                arena, NULL) != NEPH_OK)
        return false;
    for (int row = 0; row < flicker->rows; row++)
        add_up_row(flicker, row, frame_count, rows, sums);
    return true;
}

/* Compute a4 of each pixel of the grid, and its mean and share. */
static void find_a4(const struct neph_heat_flicker *flicker, const struct neph_flicker_sums *sums,
                    struct neph_heat_a4 *a4, float *map)
{
    const struct neph_flicker_window window = neph_flicker_window_make(a4->frame_count, true,
                                                                       false);
    double sum = 0.0;
    int above = 0;
    for (int row = 0; row < flicker->rows; row++)
        for (int x = 0; x < flicker->columns; x++) {
            double values[NEPH_FLICKER_SUM_COUNT];
            neph_flicker_sums_read(sums, x, row, values);
            const double amplitude = neph_flicker_spectrum_compute(&window, values).a4;
            map[row * flicker->columns + x] = (float)amplitude;
            sum += amplitude;
            above += amplitude > 1.0 / 255.0;
        }
    a4->mean = sum / (flicker->rows * flicker->columns);
    a4->share_1 = (double)above / (flicker->rows * flicker->columns);
}

/* Enlarge the map: each pixel takes the value of the grid point to its upper left. */
static void spread(const struct neph_heat_flicker *flicker, const uint8_t *small, uint8_t *rgb)
{
    for (int y = 0; y < flicker->height_px; y++)
        for (int x = 0; x < flicker->width_px; x++, rgb += 3)
            memcpy(rgb, small + 3 * (y / flicker->step * flicker->columns + x / flicker->step), 3);
}

static bool draw(const struct neph_heat_flicker *flicker, const struct neph_flicker_sums *sums,
                 struct neph_arena *arena, struct neph_heat_a4 *a4, uint8_t *rgb)
{
    static const double scale = 16.0 / 255.0; /* the scale of the metric's own map */
    const size_t count = (size_t)flicker->rows * (size_t)flicker->columns;
    float *map = neph_arena_allocate(arena, count, sizeof(*map));
    uint8_t *small = neph_arena_allocate(arena, count, 3);
    if (map && small)
        find_a4(flicker, sums, a4, map);
    const bool drawn = map && small &&
                       neph_display_map((const float *const[]){map}, 1, count, false, scale, small,
                                        NULL) == NEPH_OK;
    if (drawn)
        spread(flicker, small, rgb);
    return drawn;
}

bool neph_heat_flicker_show(const struct neph_heat_flicker *flicker, struct neph_heat_a4 *a4,
                            uint8_t *rgb)
{
    const int there = flicker->frame_count < NEPH_HEAT_FRAMES ? flicker->frame_count
                                                              : NEPH_HEAT_FRAMES;
    struct neph_heat_a4 found = {.frame_count = there / NEPH_FLICKER_CYCLE * NEPH_FLICKER_CYCLE};
    if (found.frame_count < NEPH_HEAT_FRAMES_MIN)
        return false;
    struct neph_arena arena = {0};
    struct neph_flicker_sums sums = {.values = NULL};
    const bool drawn = add_up(flicker, found.frame_count, &arena, &sums) &&
                       draw(flicker, &sums, &arena, &found, rgb);
    neph_arena_finish(&arena);
    if (drawn)
        *a4 = found;
    return drawn;
}
