/* SPDX-License-Identifier: MIT
 *
 * The flicker budget of a pixel: its variance, split into one part per period, drift, noise, and
 * the overlap of parts that are not orthogonal in this number of frames. Mean, line and all waves
 * are fitted in one least-squares fit, so that a line cannot be mistaken for a cycle or a cycle for
 * a line.
 */
#ifndef NEPH_METRICS_EXTRACTORS_CYCLE_FIT_H
#define NEPH_METRICS_EXTRACTORS_CYCLE_FIT_H

#include "metrics/extractors/cycle_frames.h"
#include "metrics/extractors/cycle_search.h"

/* Parts of a pixel's variance [luma^2], each computed separately: all A_P^2, drift, noise and
 * overlap add up to it. A_P^2 and drift are squares of the model minus their mean noise, and may be
 * negative. */
enum neph_cycle_part {
    NEPH_CYCLE_VARIANCE, /* population variance */
    NEPH_CYCLE_NOISE,    /* all noise: residual and the noise part of the fit */
    NEPH_CYCLE_DRIFT,    /* of the linear trend */
    NEPH_CYCLE_OVERLAP,
    NEPH_CYCLE_SQUARES, /* A_P^2, in the order of the periods */
};

struct neph_cycle_model {
    int frame_count, column_count; /* the line, then cosine and sine of each wave, without their
                                    * means */
    double *orthonormal;           /* column_count rows of frame_count */
    double *triangle;              /* columns = `triangle` (transposed) of the orthonormal ones */
    double *shared;         /* dot products of columns / frame_count, minus the squares below */
    double *squares;        /* factor of each squared coefficient in its part */
    double *noise_share;    /* noise variance in that square, relative to the noise */
    int *part;              /* enum neph_cycle_part of each column */
    int *periods;           /* ascending, in frames */
    double *period_scatter; /* for each period, the root of the sum of the squared noise shares of
                             * its waves */
    int period_count;
};

/* Set up the model, with its arrays in the arena. NEPH_ERR_MEMORY. */
enum neph_status neph_cycle_model_begin(struct neph_cycle_model *model, int frame_count,
                                        const struct neph_cycle_findings *findings,
                                        struct neph_arena *memory, struct neph_diag *diag);

/* Compute all parts for the pixels of a row: parts[i] receives width_px values, i as in enum
 * neph_cycle_part. `scratch` has neph_cycle_scratch_count() doubles. */
void neph_cycle_fit_row(const struct neph_cycle_model *model,
                        const struct neph_cycle_frames *frames, int row, double *scratch,
                        double *const *parts);

size_t neph_cycle_scratch_count(const struct neph_cycle_model *model);

#endif
