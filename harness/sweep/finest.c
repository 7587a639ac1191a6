/* SPDX-License-Identifier: MIT
 *
 * Convergence of steps: errors against the series' own finest point.
 */
#include "harness/sweep/finest.h"

#include "base/exr.h"
#include "harness/sweep/point.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool has_steps(const struct neph_sweep_point *point)
{
    return point->series->varied && strcmp(point->series->varied, "steps") == 0 &&
           !point->missing[0] && point->frame_key[0] && !neph_sweep_is_sequence(point);
}

/* The number in "steps=...". */
static int step_count(const struct neph_sweep_point *point)
{
    return atoi(point->label + strcspn(point->label, "=") + 1);
}

const struct neph_sweep_point *neph_sweep_finest(const struct neph_sweep *sweep,
                                                 const struct neph_sweep_series *series)
{
    const struct neph_sweep_point *finest = NULL;
    int count = 0;
    for (int i = 0; i < sweep->point_count; i++) {
        const struct neph_sweep_point *point = &sweep->points[i];
        if (point->series != series || !has_steps(point))
            continue;
        count++;
        if (!finest || step_count(point) > step_count(finest))
            finest = point;
    }
    return count > 1 ? finest : NULL;
}

const struct neph_sweep_point *neph_sweep_converged(const struct neph_sweep *sweep,
                                                    const struct neph_sweep_series *series,
                                                    double error)
{
    const struct neph_sweep_point *best = NULL;
    int most_above = 0; /* steps of the finest point above the error */
    for (int i = 0; i < sweep->point_count; i++) {
        const struct neph_sweep_point *point = &sweep->points[i];
        if (point->series == series && point->to_finest.value > error &&
            step_count(point) > most_above)
            most_above = step_count(point);
    }
    for (int i = 0; i < sweep->point_count; i++) {
        const struct neph_sweep_point *point = &sweep->points[i];
        if (point->series == series && point->to_finest.value <= error &&
            step_count(point) > most_above && (!best || step_count(point) < step_count(best)))
            best = point;
    }
    return best;
}

static enum neph_status read_frame(struct neph_store *store, const struct neph_sweep_point *point,
                                   struct neph_image **image, struct neph_diag *diag)
{
    char *path = NULL;
    json_t *record = NULL;
    enum neph_status status = NEPH_OK;
    *image = NULL;
    if (neph_store_find(store, point->frame_key, &path, &record))
        status = neph_exr_read(path, image, diag);
    json_decref(record);
    free(path);
    return status;
}

/* Measures the other points of the series of `finest`. */
static enum neph_status measure_series(struct neph_sweep *sweep,
                                       const struct neph_sweep_point *finest,
                                       const struct neph_sweep_truth *truth,
                                       struct neph_store *store, struct neph_diag *diag)
{
    struct neph_sweep_truth limit = {.mask = truth->mask};
    enum neph_status status = read_frame(store, finest, &limit.image, diag);
    for (int i = 0; i < sweep->point_count && !status && limit.image; i++) {
        struct neph_sweep_point *point = &sweep->points[i];
        char *path = NULL;
        json_t *record = NULL;
        if (point->series == finest->series && point != finest && has_steps(point) &&
            neph_store_find(store, point->frame_key, &path, &record))
            status = neph_sweep_truth_error(&limit, path, &point->to_finest, diag);
        json_decref(record);
        free(path);
    }
    neph_sweep_truth_finish(&limit);
    return status;
}

enum neph_status neph_sweep_measure_finest(struct neph_sweep *sweep,
                                           const struct neph_sweep_truth *truth,
                                           struct neph_store *store, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int s = 0; s < sweep->plan->series_count && !status; s++) {
        const struct neph_sweep_point *finest = neph_sweep_finest(sweep, &sweep->plan->series[s]);
        if (finest)
            status = measure_series(sweep, finest, truth, store, diag);
    }
    return status;
}
