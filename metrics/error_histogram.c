/* SPDX-License-Identifier: MIT */
#include "metrics/error_histogram.h"

#include "base/threads.h"
#include "metrics/metric.h"
#include "metrics/vector_math.h"

#include <math.h>
#include <stdlib.h>

static const double floor_share = 1e-4; /* as relative_floor_share of the extractor `error` */

static const double edges[NEPH_HISTOGRAM_EDGES] = {-10.0,
                                                   -3.1622776601683795,
                                                   -1.0,
                                                   -3.1622776601683795e-1,
                                                   -1e-1,
                                                   -3.1622776601683795e-2,
                                                   -1e-2,
                                                   -3.1622776601683795e-3,
                                                   -1e-3,
                                                   -3.1622776601683795e-4,
                                                   -1e-4,
                                                   1e-4,
                                                   3.1622776601683795e-4,
                                                   1e-3,
                                                   3.1622776601683795e-3,
                                                   1e-2,
                                                   3.1622776601683795e-2,
                                                   1e-1,
                                                   3.1622776601683795e-1,
                                                   1.0,
                                                   3.1622776601683795,
                                                   10.0};

double neph_histogram_edge(int i)
{
    return edges[i];
}

uint64_t neph_histogram_count(const struct neph_error_histogram *histogram, int first, int last)
{
    const uint64_t from = first < 0 ? histogram->count : histogram->at_least[first];
    return from - (last < NEPH_HISTOGRAM_EDGES ? histogram->at_least[last] : 0);
}

struct work {
    const float *reference[3], *test[3];
    size_t width;
    double floor;
    struct neph_error_histogram *rows; /* one for each row */
};

enum { PIECE_PX = 256 };

/* The relative errors of `count` samples; NaN: not finite. Returns the number of finite ones. */
NEPH_VECTOR static uint64_t compare(const float *restrict reference, const float *restrict test,
                                    size_t count, double least, double *restrict errors)
{
    uint64_t finite = 0;
    for (size_t i = 0; i < count; i++) {
        const double r = (double)reference[i], d = (double)test[i] - r;
        const double size = fabs(r) > least ? fabs(r) : least;
        const bool is_finite = d - d == 0.0;
        const double e = d == 0.0 ? 0.0 : d / size;
        errors[i] = is_finite ? e : (double)NAN;
        finite += is_finite;
    }
    return finite;
}

NEPH_VECTOR static uint64_t count_at_least(const double *errors, size_t count, double edge)
{
    uint64_t found = 0;
    for (size_t i = 0; i < count; i++)
        found += errors[i] >= edge;
    return found;
}

static void add_row(int row, void *context)
{
    const struct work *work = context;
    struct neph_error_histogram *sums = &work->rows[row];
    const size_t first = (size_t)row * work->width;
    double errors[PIECE_PX];
    for (int c = 0; c < 3; c++)
        for (size_t done = 0; done < work->width; done += PIECE_PX) {
            const size_t at = first + done;
            const size_t piece = work->width - done < PIECE_PX ? work->width - done : PIECE_PX;
            const uint64_t finite = compare(work->reference[c] + at, work->test[c] + at, piece,
                                            work->floor, errors);
            sums->count += finite;
            sums->not_finite += piece - finite;
            for (int i = 0; i < NEPH_HISTOGRAM_EDGES; i++)
                sums->at_least[i] += count_at_least(errors, piece, edges[i]);
        }
}

enum neph_status neph_histogram_add(struct neph_error_histogram *histogram,
                                    const struct neph_image *reference,
                                    const struct neph_image *test, struct neph_diag *diag)
{
    const struct neph_quantity *radiance = neph_quantity_find("radiance");
    struct work work = {.width = (size_t)reference->width_px};
    if (!neph_quantity_planes(radiance, reference, work.reference) ||
        !neph_quantity_planes(radiance, test, work.test))
        return NEPH_OK;
    const double mean = neph_quantity_mean(radiance, work.reference, reference->width_px,
                                           reference->height_px);
    work.floor = isnan(mean) ? 0.0 : floor_share * mean;
    work.rows = calloc((size_t)reference->height_px, sizeof(*work.rows));
    if (!work.rows)
        return neph_fail_memory(diag);
    const enum neph_status status = neph_parallel_rows(reference->height_px, add_row, &work, diag);
    for (int y = 0; y < reference->height_px && !status; y++) {
        histogram->count += work.rows[y].count;
        histogram->not_finite += work.rows[y].not_finite;
        for (int i = 0; i < NEPH_HISTOGRAM_EDGES; i++)
            histogram->at_least[i] += work.rows[y].at_least[i];
    }
    free(work.rows);
    return status;
}
