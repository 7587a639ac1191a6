/* SPDX-License-Identifier: MIT */
#include "metrics/depth_edge.h"

#include "base/arena.h"
#include "metrics/vector_math.h"

#include <stdlib.h>
#include <string.h>

/* ---- steps ----------------------------------------------------------------------------------- */

/* Mark the pixels of a row at a depth step to a 4-neighbour. It uses the ratios farthest / here and
 * here / closest of the neighbours, without divisions, so that depth 0 and the sky work. The
 * comparison of the two ratios is false for NaN (infinity against infinity), so they count as
 * equal. */
NEPH_VECTOR static void mark_steps(const float *here, const float *up, const float *down,
                                   const float *left, const float *right, size_t count,
                                   double ratio, uint8_t *restrict near, uint8_t *restrict far)
{
    for (size_t x = 0; x < count; x++) {
        float a = up[x] < down[x] ? up[x] : down[x], b = left[x] < right[x] ? left[x] : right[x];
        float c = up[x] > down[x] ? up[x] : down[x], d = left[x] > right[x] ? left[x] : right[x];
        double closest = (double)(a < b ? a : b), farthest = (double)(c > d ? c : d);
        double depth = (double)here[x];
        int is_nearer = farthest > ratio * depth, is_farther = depth > ratio * closest;
        int is_steeper_behind = farthest * closest < depth * depth;
        near[x] = (uint8_t)(is_nearer & !(is_farther & is_steeper_behind));
        far[x] = (uint8_t)(is_farther & !(is_nearer & !is_steeper_behind));
    }
}

void neph_edge_steps(const float *depth_m, int width_px, int height_px, double ratio, uint8_t *near,
                     uint8_t *far)
{
    size_t width = (size_t)width_px, height = (size_t)height_px;
    for (size_t y = 0; y < height; y++) {
        const float *row = depth_m + y * width;
        const float *up = y > 0 ? row - width : row, *down = y + 1 < height ? row + width : row;
        uint8_t *near_row = near + y * width, *far_row = far + y * width;
        const size_t last = width - 1;
        if (width > 2)
            mark_steps(row + 1, up + 1, down + 1, row, row + 2, width - 2, ratio, near_row + 1,
                       far_row + 1);
        mark_steps(row, up, down, row, row + (width > 1), 1, ratio, near_row, far_row);
        mark_steps(row + last, up + last, down + last, row + last - (width > 1), row + last, 1,
                   ratio, near_row + last, far_row + last);
    }
}

/* ---- distances ------------------------------------------------------------------------------- */

enum {
    REACH = NEPH_EDGE_DISTANCE_MAX_PX,
    NOWHERE = 100, /* larger than every distance in use */
};

/* Distance along the row to the nearest mark. `padded`: 0 at a mark, NOWHERE elsewhere, with REACH
 * more bytes of NOWHERE on either side. */
NEPH_VECTOR static void spread_sideways(const uint8_t *restrict padded, size_t count,
                                        uint8_t *restrict distance)
{
    memset(distance, NOWHERE, count);
    for (int k = 0; k <= 2 * REACH; k++) {
        const uint8_t *from = padded + k;
        const uint8_t steps = (uint8_t)(k < REACH ? REACH - k : k - REACH);
        for (size_t x = 0; x < count; x++) {
            uint8_t length = (uint8_t)(from[x] + steps);
            distance[x] = length < distance[x] ? length : distance[x];
        }
    }
}

NEPH_VECTOR static void spread_downwards(const uint8_t *restrict row, uint8_t steps, size_t count,
                                         uint8_t *restrict distance)
{
    for (size_t x = 0; x < count; x++) {
        uint8_t length = row[x] > steps ? row[x] : steps;
        distance[x] = length < distance[x] ? length : distance[x];
    }
}

/* Chessboard distance to the nearest mark: first within each row, then over the rows. `sideways`
 * has the size of the image, `padded` a row and twice REACH. */
static void measure_distances(const uint8_t *marks, size_t width, size_t height, uint8_t *sideways,
                              uint8_t *padded, uint8_t *distance)
{
    memset(padded, NOWHERE, width + 2 * REACH);
    for (size_t y = 0; y < height; y++) {
        for (size_t x = 0; x < width; x++)
            padded[REACH + x] = marks[y * width + x] ? 0 : NOWHERE;
        spread_sideways(padded, width, sideways + y * width);
    }
    memset(distance, NOWHERE, width * height);
    for (size_t y = 0; y < height; y++) {
        size_t first = y > REACH ? y - REACH : 0;
        for (size_t from = first; from < height && from <= y + REACH; from++)
            spread_downwards(sideways + from * width, (uint8_t)(from < y ? y - from : from - y),
                             width, distance + y * width);
    }
}

void neph_edge_field_finish(struct neph_edge_field *field)
{
    free(field->near_px);
    free(field->far_px);
    *field = (struct neph_edge_field){0};
}

enum neph_status neph_edge_field_create(const float *depth_m, int width_px, int height_px,
                                        double ratio, struct neph_edge_field *field,
                                        struct neph_diag *diag)
{
    size_t width = (size_t)width_px, height = (size_t)height_px, count = width * height;
    struct neph_edge_field made = {.near_px = malloc(count), .far_px = malloc(count)};
    struct neph_arena memory = {.is_short = !made.near_px || !made.far_px};
    uint8_t *near = neph_arena_allocate(&memory, count, 1),
            *far = neph_arena_allocate(&memory, count, 1);
    uint8_t *sideways = neph_arena_allocate(&memory, count, 1);
    uint8_t *padded = neph_arena_allocate(&memory, width + 2 * REACH, 1);
    const enum neph_status status = neph_arena_check(&memory, diag);
    if (status) {
        neph_edge_field_finish(&made);
    } else {
        neph_edge_steps(depth_m, width_px, height_px, ratio, near, far);
        measure_distances(near, width, height, sideways, padded, made.near_px);
        measure_distances(far, width, height, sideways, padded, made.far_px);
        *field = made;
    }
    neph_arena_finish(&memory);
    return status;
}

/* ---- thin objects ---------------------------------------------------------------------------- */

NEPH_VECTOR static void keep_farther(const float *restrict row, size_t count, float *restrict kept)
{
    for (size_t x = 0; x < count; x++)
        kept[x] = row[x] > kept[x] ? row[x] : kept[x];
}

NEPH_VECTOR static void keep_nearer(const float *restrict row, size_t count, float *restrict kept)
{
    for (size_t x = 0; x < count; x++)
        kept[x] = row[x] < kept[x] ? row[x] : kept[x];
}

NEPH_VECTOR static void mark_nearer(const float *restrict depth, const float *restrict opened,
                                    size_t count, double ratio, uint8_t *restrict thin)
{
    for (size_t x = 0; x < count; x++)
        thin[x] = (uint8_t)((double)opened[x] > ratio * (double)depth[x]);
}

/* The farthest depth in each square, stored at its top left corner; only squares inside the
 * image. */
static void farthest_of_squares(const float *depth_m, size_t width, size_t height, size_t across,
                                size_t down, float *row, float *squares)
{
    size_t columns = width - across + 1;
    for (size_t y = 0; y + down <= height; y++) {
        memcpy(row, depth_m + y * width, width * sizeof(*row));
        for (size_t k = 1; k < down; k++)
            keep_farther(depth_m + (y + k) * width, width, row);
        memcpy(squares + y * width, row, columns * sizeof(*row));
        for (size_t k = 1; k < across; k++)
            keep_farther(row + k, columns, squares + y * width);
    }
}

enum neph_status neph_mark_thin(const float *depth_m, int width_px, int height_px, double ratio,
                                uint8_t *thin, struct neph_diag *diag)
{
    size_t width = (size_t)width_px, height = (size_t)height_px;
    const size_t side = NEPH_THIN_SIDE_PX;
    size_t across = width < side ? width : side, down = height < side ? height : side;
    size_t columns = width - across + 1, rows = height - down + 1;
    float *squares = malloc(width * height * sizeof(*squares));
    float *row = malloc(width * sizeof(*row)), *opened = malloc(width * sizeof(*opened));
    enum neph_status status = squares && row && opened ? NEPH_OK : neph_fail_memory(diag);
    if (status)
        goto done;
    farthest_of_squares(depth_m, width, height, across, down, row, squares);
    for (size_t y = 0; y < height; y++) {
        size_t first = y + 1 > down ? y + 1 - down : 0, end = y < rows ? y + 1 : rows;
        memcpy(row, squares + first * width, columns * sizeof(*row));
        for (size_t from = first + 1; from < end; from++)
            keep_nearer(squares + from * width, columns, row);
        for (size_t x = 0; x < width; x++)
            opened[x] = INFINITY;
        for (size_t k = 0; k < across; k++)
            keep_nearer(row, columns, opened + k);
        mark_nearer(depth_m + y * width, opened, width, ratio, thin + y * width);
    }
done:
    free(squares);
    free(row);
    free(opened);
    return status;
}
