/* SPDX-License-Identifier: MIT
 *
 * The budget of a pixel: its variance as what each period has, drift, noise, and what those share
 * that are not orthogonal in so many frames. One least-squares fit of mean, line and all waves
 * together, so that neither the line is taken for a cycle nor a cycle for the line.
 */
#ifndef NEPH_METRICS_EXTRACTORS_CYCLE_FIT_H
#define NEPH_METRICS_EXTRACTORS_CYCLE_FIT_H

#include "metrics/extractors/cycle_frames.h"
#include "metrics/extractors/cycle_search.h"

/* Parts of a pixel's variance [luma^2], each worked out by itself: all A_P^2, drift, noise and
 * overlap sum to it. A_P^2 and drift are squares of the model less what noise has in them on
 * average, and may be below 0. */
enum neph_cycle_part {
    NEPH_CYCLE_VARIANCE, /* population variance */
    NEPH_CYCLE_NOISE,    /* all of the noise, in the fit and beside it */
    NEPH_CYCLE_DRIFT,    /* of the line */
    NEPH_CYCLE_OVERLAP,
    NEPH_CYCLE_SQUARES, /* A_P^2, in the order of the periods */
};

struct neph_cycle_model {
    int frame_count, column_count; /* line, then cosine and sine of each wave, less their means */
    double *orthonormal;           /* column_count rows of frame_count */
    double *triangle;       /* the columns are `triangle` of the orthonormal ones, transposed */
    double *shared;         /* products of columns over frame_count, less the squares below */
    double *squares;        /* what the square of each coefficient counts in its part */
    double *noise_share;    /* of the noise variance, in that square */
    int *part;              /* which that is */
    int *periods;           /* ascending; frames */
    double *period_scatter; /* root of the sum of squares of the noise shares of its waves */
    int period_count;
};

/* The arena has its arrays. NEPH_ERR_MEMORY. */
enum neph_status neph_cycle_model_begin(struct neph_cycle_model *model, int frame_count,
                                        const struct neph_cycle_findings *findings,
                                        struct neph_arena *memory, struct neph_diag *diag);

/* All parts of the pixels of a row: parts[i] receives width_px values, i as in enum
 * neph_cycle_part. `scratch` has neph_cycle_scratch_count() doubles. */
void neph_cycle_fit_row(const struct neph_cycle_model *model,
                        const struct neph_cycle_frames *frames, int row, double *scratch,
                        double *const *parts);

size_t neph_cycle_scratch_count(const struct neph_cycle_model *model);

#endif
