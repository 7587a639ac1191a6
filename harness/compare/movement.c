/* SPDX-License-Identifier: MIT */
#include "harness/compare/movement.h"

#include "metrics/extractors/display_luma.h"
#include "metrics/metric.h"

#include <math.h>
#include <stdlib.h>

enum { CYCLE = NEPH_MOVEMENT_CYCLE, PIECE_PX = 256 };

static enum neph_status begin(struct neph_movement *movement, size_t pixel_count,
                              struct neph_diag *diag)
{
    movement->pixel_count = pixel_count;
    for (int t = 0; t < CYCLE; t++) {
        movement->luma[t] = malloc(pixel_count * sizeof(double));
        if (!movement->luma[t])
            return neph_fail_memory(diag);
    }
    return NEPH_OK;
}

static void find_luma(const struct neph_movement *movement, const float *const reference[3],
                      const float *const test[3], double *luma)
{
    double of_reference[PIECE_PX];
    for (size_t at = 0; at < movement->pixel_count; at += PIECE_PX) {
        const size_t left = movement->pixel_count - at;
        const size_t count = left < PIECE_PX ? left : PIECE_PX;
        const float *const r[3] = {reference[0] + at, reference[1] + at, reference[2] + at};
        const float *const x[3] = {test[0] + at, test[1] + at, test[2] + at};
        neph_display_luma(r, count, movement->gain, of_reference, NULL);
        neph_display_luma(x, count, movement->gain, luma + at, NULL);
        for (size_t i = 0; i < count; i++)
            luma[at + i] -= of_reference[i];
    }
}

/* Complete a cycle. With d0 .. d3 of a pixel, a4 = |(d0 - d2) - i (d1 - d3)| / 2 and a2 = |d0 - d1
 * + d2 - d3| / 4. */
static enum neph_status close_cycle(struct neph_movement *movement, struct neph_diag *diag)
{
    const int before = movement->frame_count;
    double squares[CYCLE] = {0.0}, cycle = 0.0;
    for (size_t i = 0; i < movement->pixel_count; i++) {
        double d[CYCLE], mean = 0.0;
        for (int t = 0; t < CYCLE; t++) {
            d[t] = movement->luma[t][i];
            mean += d[t] / CYCLE;
        }
        for (int t = 0; t < CYCLE; t++)
            squares[t] += (d[t] - mean) * (d[t] - mean);
        const double a2 = (d[0] - d[1] + d[2] - d[3]) / 4.0;
        cycle += ((d[0] - d[2]) * (d[0] - d[2]) + (d[1] - d[3]) * (d[1] - d[3])) / 8.0 + a2 * a2;
    }
    double *frames = realloc(movement->frames, (size_t)(before + CYCLE) * sizeof(*frames));
    movement->frames = frames ? frames : movement->frames;
    double *cycles = realloc(movement->cycles, (size_t)(before / CYCLE + 1) * sizeof(*cycles));
    movement->cycles = cycles ? cycles : movement->cycles;
    if (!frames || !cycles)
        return neph_fail_memory(diag);
    for (int t = 0; t < CYCLE; t++)
        frames[before + t] = sqrt(squares[t] / (double)movement->pixel_count);
    cycles[before / CYCLE] = sqrt(cycle / (double)movement->pixel_count);
    movement->frame_count += CYCLE;
    movement->kept_count = 0;
    return NEPH_OK;
}

enum neph_status neph_movement_add(struct neph_movement *movement,
                                   const struct neph_image *reference,
                                   const struct neph_image *test, const double *const luma[2],
                                   struct neph_diag *diag)
{
    const struct neph_quantity *radiance = neph_quantity_find("radiance");
    const float *r[3], *x[3];
    enum neph_status status = NEPH_OK;
    if (!neph_quantity_planes(radiance, reference, r) || !neph_quantity_planes(radiance, test, x))
        return NEPH_OK;
    if (movement->pixel_count == 0)
        status = begin(movement, neph_image_pixel_count(test), diag);
    if (status)
        return status;
    double *d = movement->luma[movement->kept_count++];
    for (size_t i = 0; luma && i < movement->pixel_count; i++)
        d[i] = luma[1][i] - luma[0][i];
    if (!luma)
        find_luma(movement, r, x, d);
    return movement->kept_count < CYCLE ? NEPH_OK : close_cycle(movement, diag);
}

void neph_movement_end(struct neph_movement *movement)
{
    for (int t = 0; t < CYCLE; t++) {
        free(movement->luma[t]);
        movement->luma[t] = NULL;
    }
    movement->kept_count = 0;
}

void neph_movement_finish(struct neph_movement *movement)
{
    neph_movement_end(movement);
    free(movement->frames);
    free(movement->cycles);
    *movement = (struct neph_movement){.gain = 0.0};
}
