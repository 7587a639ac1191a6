/* SPDX-License-Identifier: MIT
 *
 * The light study compares the lighting models of the ray marcher with the tracer's multiple
 * scattering, over clouds, suns, phase functions, albedos and densities. A cell is one combination
 * of these. All numbers are of the radiance of media only, averaged over the channels, under a sun
 * of 1 W/m2 and no other light (scenes/relit.h).
 *
 * light.c has the options and the run, light_measure.c measures cells, light_results.c writes the
 * results, light_plot.c draws them, light_fit.c fits octaves to them.
 */
#ifndef NEPH_HARNESS_EXPERIMENTS_LIGHT_H
#define NEPH_HARNESS_EXPERIMENTS_LIGHT_H

#include "base/arena.h"
#include "harness/experiment/experiment.h"
#include "harness/physics/light_laws.h"
#include "harness/progress.h"
#include "harness/study/light_models.h"
#include "harness/study/light_suites.h"
#include "harness/study/light_sums.h"
#include "harness/study/light_view.h"
#include "renderer/octaves_fitted.h"

enum { NEPH_LIGHT_WHY_SIZE = 200 };

/* A pixel with a smaller transmittance is dense. */
#define NEPH_LIGHT_DENSE_TRANSMITTANCE 0.1

struct neph_light_request {
    struct neph_cli_shared shared; /* operands: scenes */
    struct neph_cli_list models;   /* as for neph_light_model_parse() */
    const char *suite, *fit;
    struct neph_cli_list suns, g, albedo, density; /* values for all scenes */
    int steps;                                     /* steps of every view ray; a model's own setting
                                                      overrides it */
    double noise;                                  /* noise limit of a frame of the tracer: its
                                                      target_error */
    int samples;                                   /* sample limit of the tracer */
    double sun_speed_deg_per_s; /* for engines with a history: speed at which the sun sinks to its
                                   position */
    bool laws;
    struct neph_arena arena; /* for the entries */
    struct neph_light_entry *entries;
    int entry_count;
    int only_cell; /* render only this cell, for the store; -1: all, with measurements */
};

/* The data of a pixel for a fit. */
struct neph_light_pixel {
    struct neph_light_view view;
    double first, second; /* radiance by the tracer, two seeds */
};

/* The error of a model in a cell. */
struct neph_light_gap {
    struct neph_light_sums dense, all; /* pixels of transmittance below a tenth; all pixels with
                                          media */
    double render_s;
    bool once;                         /* it rendered single scattering */
    char because[NEPH_LIGHT_WHY_SIZE]; /* reason for a missing result; "" otherwise */
};

struct neph_light_cell {
    const char *scene;         /* name of the scene; allocated in the study's arena */
    struct neph_relight light; /* actual values, of the first medium */
    double optical_depth;      /* 90th percentile over the view rays with media */
    double noise;              /* of one frame of the tracer (run/noise.h) */
    double tracer_s;           /* render time of both frames */
    struct neph_light_gap gaps[NEPH_LIGHT_MODELS_MAX];
    struct neph_light_pixel *pixels; /* owned; NULL without a fit */
    int pixel_count;
    char left_out[NEPH_LIGHT_WHY_SIZE]; /* reason for a missing measurement; "" otherwise */
};

/* A model's pixels of all cells, binned along two axes. */
struct neph_light_map {
    struct neph_light_sums bins[NEPH_LIGHT_BINS][NEPH_LIGHT_BINS];
};

struct neph_light_study {
    const struct neph_light_request *request;
    const struct neph_experiment_run *run;
    struct neph_progress progress;
    struct neph_arena arena;
    struct neph_light_model tracer, models[NEPH_LIGHT_MODELS_MAX];
    struct neph_light_cell *cells; /* owned */
    int cell_count;
    struct neph_light_map eye_sun[NEPH_LIGHT_MODELS_MAX], eye_angle[NEPH_LIGHT_MODELS_MAX];
    int failed_count;            /* failed models and tracers; their cells have the reason */
    struct neph_light_laws laws; /* if requested */
};

/* ---- measurement ----------------------------------------------------------------------------- */

/* The number of cells of a request with entries. */
int neph_light_cell_count(const struct neph_light_request *request);

/* Measure all cells. `study` has its request and run; always free it with
 * neph_light_study_finish(). A scene with missing data, or one that cannot be relit, is left out,
 * as is a model in a scene that it cannot render. NEPH_ERR_INTERRUPTED: finished frames are in the
 * store. */
enum neph_status neph_light_measure(struct neph_light_study *study, struct neph_diag *diag);
void neph_light_study_finish(struct neph_light_study *study);

/* The pixels of a cell that a number covers. */
enum neph_light_part { NEPH_LIGHT_DENSE, NEPH_LIGHT_WHOLE, NEPH_LIGHT_PARTS };

const struct neph_light_sums *neph_light_part_sums(const struct neph_light_gap *gap,
                                                   enum neph_light_part part);

/* True when the pixels suffice for a bias: there are at least NEPH_LIGHT_PIXELS_MIN, with light in
 * them. */
enum { NEPH_LIGHT_PIXELS_MIN = 8 };
bool neph_light_counts(const struct neph_light_sums *sums);

/* The errors of a model over all cells with enough pixels. */
struct neph_light_verdict {
    int cell_count;
    double mean_bias, worst_bias, mean_rms; /* of |bias|; NaN without a cell */
    double mean_signed_bias;                /* negative: too dark; positive: too bright */
    double share_within;                    /* of cells with |bias| <= 5 % */
    double share_near;                      /* of cells with |bias| <= 15 % */
    double share_smooth;                    /* of cells with rms <= 15 % */
};

/* Add a cell to a verdict that started as {0}; compute the means after the last cell. */
void neph_light_verdict_add(struct neph_light_verdict *verdict, const struct neph_light_sums *sums);
void neph_light_verdict_end(struct neph_light_verdict *verdict);

/* The verdict over the cells for which `counts` returns true; NULL: all cells. */
struct neph_light_verdict
neph_light_find_verdict(const struct neph_light_study *study, int model, enum neph_light_part part,
                        bool (*counts)(const struct neph_light_cell *cell, const void *context),
                        const void *context);

/* ---- results --------------------------------------------------------------------------------- */

/* Write the study in the forms that the publication has. */
enum neph_status neph_light_publish(const struct neph_light_study *study,
                                    struct neph_publication *publication, struct neph_diag *diag);

/* Draw model radiance over tracer radiance as SVG. For each model one heat map over the optical
 * depths towards the camera and the sun, and one over the former and the angle to the sun, with
 * pixel counts. */
void neph_light_plot(const struct neph_light_study *study, FILE *out);

/* ---- the fit --------------------------------------------------------------------------------- */

/* Fit of octaves to the tracer over the cells of a study, by damped least squares (D. W. Marquardt
 * 1963). The objective is the sum over cells of the squared bias plus a quarter of the mean squared
 * error, both for the whole frame and for the dense parts. Cells have equal weights, independent of
 * their brightness. No rendering is needed: the light at scaled optical depths is known along each
 * view ray (study/light_view.h). */

/* Radiance of a pixel under a sun of 1 W/m2 by a sum of reciprocal octaves (octaves_fitted.h): the
 * ray marcher's result in the limit of short steps. */
double neph_light_octaves(const struct neph_light_view *view, const struct neph_octaves *octaves,
                          double g, double albedo);

/* Errors of a fit over the cells, as neph_light_find_verdict(). */
struct neph_light_verdict neph_light_fit_verdict(const struct neph_light_study *study,
                                                 const struct neph_octaves_fit *fit,
                                                 enum neph_light_part part);

/* Fit, starting with all factors 1/2. The request must have a fit. NEPH_ERR_USAGE: no cell has
 * media. NEPH_ERR_MEMORY. */
enum neph_status neph_light_fit(const struct neph_light_study *study, struct neph_octaves_fit *fit,
                                struct neph_diag *diag);

/* Print the coefficients as the file that renderer/octaves_fitted.c includes, with the conditions
 * of the fit. */
void neph_light_fit_print(const struct neph_light_study *study, const struct neph_octaves_fit *fit,
                          FILE *out);

#endif
