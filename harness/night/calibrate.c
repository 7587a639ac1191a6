/* SPDX-License-Identifier: MIT */
#include "harness/night/calibrate.h"

#include "base/clock.h"
#include "base/threads.h"
#include "metrics/statistics.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

enum { SIDE = 96, RAYS_PER_ROW = 64, ROWS = 96, STEPS = 192, TRIES = 5 };

struct work {
    float *density; /* SIDE cubed: more than a cache of the second level holds */
    double *sums;   /* one per row: that the work is done shows in them */
};

/* Rays through a grid: a voxel, an exponential and some products a step. */
static void march_row(int row, void *context)
{
    struct work *work = context;
    double sum = 0.0;
    for (int ray = 0; ray < RAYS_PER_ROW; ray++) {
        double transmittance = 1.0;
        for (int step = 0; step < STEPS; step++) {
            const int x = (row + step) % SIDE, y = (ray * 7 + step * 3) % SIDE,
                      z = (row * 5 + ray + step * 11) % SIDE;
            const double density = work->density[((size_t)z * SIDE + (size_t)y) * SIDE + (size_t)x];
            sum += transmittance * density;
            transmittance *= exp(-0.01 * density);
        }
    }
    work->sums[row] = sum;
}

enum neph_status neph_calibrate(double *seconds, struct neph_diag *diag)
{
    const size_t count = (size_t)SIDE * SIDE * SIDE;
    struct work work = {malloc(count * sizeof(*work.density)), calloc(ROWS, sizeof(*work.sums))};
    enum neph_status status = work.density && work.sums ? NEPH_OK : neph_fail_memory(diag);
    uint32_t noise = 1;
    for (size_t i = 0; !status && i < count; i++) {
        noise = noise * 1664525u + 1013904223u;
        work.density[i] = (float)(noise >> 8) * 0x1p-24f;
    }
    double times[TRIES];
    for (int i = 0; i < TRIES && !status; i++) {
        const double start_s = neph_wall_s();
        for (int k = 0; k < 4 && !status; k++)
            status = neph_parallel_rows(ROWS, march_row, &work, diag);
        times[i] = neph_wall_s() - start_s;
    }
    free(work.density);
    free(work.sums);
    if (!status)
        *seconds = neph_percentile(times, TRIES, 0.5);
    return status;
}
