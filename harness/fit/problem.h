/* SPDX-License-Identifier: MIT
 *
 * The least-squares problem of a fit, for all parts of it.
 *
 * A residual is (prediction - value) * weight (harness/fit/pixels.h) over the scale of its
 * quantity, the rms of all such residuals: noisy radiance does not blur what a transmittance says.
 */
#ifndef NEPH_HARNESS_FIT_PROBLEM_H
#define NEPH_HARNESS_FIT_PROBLEM_H

#include "harness/fit/model.h"

/* Relative error of radiance and optical depth that a frame may have beside its noise, of a sign
 * that all pixels share, or neighbours: half floats round by 5e-4, and renderers integrate to 1e-3.
 * It is part of all intervals, and no scale is below its rms. */
#define NEPH_FIT_MODEL_ERROR 1e-3

/* Wider intervals are "not determined": a factor between both ends, and a difference of g. */
#define NEPH_FIT_WIDEST_FACTOR 2.0
#define NEPH_FIT_WIDEST_ASYMMETRY 0.3

/* An unknown, or a combination: a factor, or g. */
struct neph_fit_estimate {
    double value, low, high; /* 95 %; of what is held fixed all three are the same */
    bool is_free, is_determined;
};

/* The best values of some unknowns. */
struct neph_fit_estimates {
    struct neph_fit_point point;
    double squares; /* sum of the squared residuals */
    double noise;   /* variance of a residual that counts as independent */
    struct neph_fit_estimate list[NEPH_FIT_UNKNOWN_COUNT];
    struct neph_fit_estimate scattering; /* extinction * albedo */
};

/* Start from {0} and neph_fit_solve() (harness/fit/fit.h); free with neph_fit_finish(). */
struct neph_fit {
    const struct neph_scene *scene;
    const struct neph_fit_pixels *pixels;
    struct neph_fit_model *model; /* owned */
    bool is_free[NEPH_FIT_UNKNOWN_COUNT];
    enum neph_fit_transfer transfer;              /* that explains the frame best */
    bool is_transfer_sure;                        /* no other does nearly as well */
    double transfer_rms[NEPH_FIT_TRANSFER_COUNT]; /* of radiance; NaN: not tried */
    struct neph_fit_estimates best;
    /* If that does not determine some unknowns: the best with those of them held at the scene's
     * values that explain the frame as well, first falloff, then asymmetry, then albedo. */
    bool is_held[NEPH_FIT_UNKNOWN_COUNT];
    struct neph_fit_estimates held;        /* a copy of `best` if none is */
    double extinction_min, extinction_max; /* factors that explain the frame as well as `held`, if
                                              that does not determine them; 0, infinity: no end */
    double rms[NEPH_FIT_QUANTITY_COUNT];   /* relative residuals */
    int outlier_count;                     /* pixels left out: far from all others */
    /* Working memory, of pixels->count x NEPH_FIT_QUANTITY_COUNT x 3. */
    double *weights, *predicted;            /* weights are over scales; owned */
    int stride;                             /* one of so many pixels has weight */
    double floors[NEPH_FIT_QUANTITY_COUNT]; /* smallest scales: the rms of NEPH_FIT_MODEL_ERROR */
};

/* Standard deviation of a weak prior: what the data do not tell stays near the scene's value, in g
 * and in the logarithms of factors. Extinction has none: of a pair that is not determined, it takes
 * the difference from the scene. */
#define NEPH_FIT_PRIOR_DEVIATION 10.0

/* A least-squares problem over some of the unknowns. */
struct neph_fit_problem {
    struct neph_fit *fit;
    const struct neph_fit_base *base;
    struct neph_fit_point point; /* with the values of unknowns that are held fixed */
    int unknowns[NEPH_FIT_UNKNOWN_COUNT], count;
};

/* Values of all pixels; and residuals: one of each value, and one of the prior of each unknown. */
int neph_fit_count_values(const struct neph_fit *fit);
int neph_fit_count_residuals(const struct neph_fit *fit);

/* The quantity of a value, by its index. */
int neph_fit_quantity_at(int value);

/* The change of a value by a relative error of 1 of radiance, or of the optical depth. */
double neph_fit_sensitivity(double value, int quantity);

/* Residuals and their slopes by the unknowns at `x`, for neph_least_squares_solve(); `context` is a
 * struct neph_fit_problem. */
enum neph_status neph_fit_find_residuals(void *context, const double *x, double *residuals,
                                         struct neph_diag *diag);
enum neph_status neph_fit_find_slopes(void *context, const double *x, const double *residuals,
                                      double *const *slopes, struct neph_diag *diag);

/* Ranges of unknowns; an unknown with equal ends is held fixed there. */
struct neph_fit_range {
    struct neph_fit_point low, high;
};

/* The widest range, with all unknowns that are not free at the scene's values. */
struct neph_fit_range neph_fit_whole_range(const struct neph_fit *fit);

/* The best point within a range from a start, for media changed by `base`; or the first with a sum
 * of squares of at most `enough`. */
enum neph_status neph_fit_minimise(struct neph_fit *fit, const struct neph_fit_base *base,
                                   const struct neph_fit_range *range, double enough,
                                   struct neph_fit_point *point, double *squares,
                                   struct neph_diag *diag);

/* The largest sum of squares that is no worse than that of the best fit by more than noise, at 95
 * %, for this number of restricted unknowns (1 or 2). */
double neph_fit_limit(const struct neph_fit *fit, int restricted);

#endif
