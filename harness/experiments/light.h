/* SPDX-License-Identifier: MIT
 *
 * A light study: lighting models of the ray marcher side by side with the tracer's multiple
 * scattering, over clouds, suns, phase functions, albedos and densities. A cell is one of each. All
 * numbers are of the radiance of media alone, channels averaged, under a sun of 1 W/m2 and nothing
 * else (scenes/relit.h).
 *
 * light.c has the options and the run, light_measure.c measures cells, light_results.c writes what
 * was found, light_plot.c draws it, light_fit.c fits octaves to it.
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

/* Less than this of what lies behind comes through a dense pixel. */
#define NEPH_LIGHT_DENSE_TRANSMITTANCE 0.1

struct neph_light_request {
    struct neph_cli_shared shared; /* operands: scenes */
    struct neph_cli_list models;   /* of neph_light_model_parse() */
    const char *suite, *fit;
    struct neph_cli_list suns, g, albedo, density; /* of all scenes */
    int steps;                                     /* of every view ray, unless a model says so */
    double noise;                                  /* of a frame of the tracer: its target_error */
    int samples;                                   /* its most */
    double sun_speed_deg_per_s; /* before engines that keep frames the sun sinks so to its place */
    bool laws;
    struct neph_arena arena; /* of the entries */
    struct neph_light_entry *entries;
    int entry_count;
    int only_cell; /* that is rendered for the store, nothing is measured of it; -1: all */
};

/* What a fit needs of a pixel. */
struct neph_light_pixel {
    struct neph_light_view view;
    double first, second; /* radiance by the tracer */
};

/* A model in a cell. */
struct neph_light_gap {
    struct neph_light_sums dense, all; /* pixels of transmittance below a tenth; that hold media */
    double render_s;
    bool once;                         /* it was given the scene with light scattered once */
    char because[NEPH_LIGHT_WHY_SIZE]; /* why it has none; "" when it has */
};

struct neph_light_cell {
    const char *scene;         /* its name, of the study's arena */
    struct neph_relight light; /* as it is, of the first medium */
    double optical_depth;      /* of a view ray: a tenth of the pixels with media have more */
    double noise;              /* of one of the tracer's frames (run/noise.h) */
    double tracer_s;           /* of both, when they were rendered */
    struct neph_light_gap gaps[NEPH_LIGHT_MODELS_MAX];
    struct neph_light_pixel *pixels; /* owned; NULL unless there is a fit */
    int pixel_count;
    char left_out[NEPH_LIGHT_WHY_SIZE]; /* why nothing was measured; "" when it was */
};

/* A model's pixels of all cells, by two axes. */
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
    int failed_count;            /* models and tracers that broke; their cells say why */
    struct neph_light_laws laws; /* where the request has them */
};

/* ---- measures -------------------------------------------------------------------------------- */

/* Cells of a request that has entries. */
int neph_light_cell_count(const struct neph_light_request *request);

/* Into a study that begins with its request and run; for _finish in any case. A scene whose data is
 * not on this machine, or that cannot be lit anew, is left out, and so is a model where it cannot
 * render the scene. NEPH_ERR_INTERRUPTED: what is finished stays in the store. */
enum neph_status neph_light_measure(struct neph_light_study *study, struct neph_diag *diag);
void neph_light_study_finish(struct neph_light_study *study);

/* Which pixels of a cell count. */
enum neph_light_part { NEPH_LIGHT_DENSE, NEPH_LIGHT_WHOLE, NEPH_LIGHT_PARTS };

const struct neph_light_sums *neph_light_part_of(const struct neph_light_gap *gap,
                                                 enum neph_light_part part);

/* Whether there are enough of them, and light in them, for a bias to be said. */
enum { NEPH_LIGHT_PIXELS_MIN = 8 };
bool neph_light_counts(const struct neph_light_sums *sums);

/* How a model does over the cells of which a part counts. */
struct neph_light_verdict {
    int cell_count;
    double mean_bias, worst_bias, mean_rms; /* of |bias|; NaN without a cell */
    double mean_signed_bias;                /* whether a model is too dark or too bright */
    double share_within;                    /* of cells with |bias| <= 5 % */
    double share_near;                      /* of cells with |bias| <= 15 % */
    double share_smooth;                    /* of cells with rms <= 15 % */
};

/* A cell's pixels into a verdict that began with {0}; and, after the last, its means. */
void neph_light_verdict_add(struct neph_light_verdict *verdict, const struct neph_light_sums *sums);
void neph_light_verdict_end(struct neph_light_verdict *verdict);

/* Over the cells that `counts` says yes to; NULL: all. */
struct neph_light_verdict
neph_light_verdict_of(const struct neph_light_study *study, int model, enum neph_light_part part,
                      bool (*counts)(const struct neph_light_cell *cell, const void *context),
                      const void *context);

/* ---- results --------------------------------------------------------------------------------- */

/* Into the forms that the publication has. */
enum neph_status neph_light_publish(const struct neph_light_study *study,
                                    struct neph_publication *publication, struct neph_diag *diag);

/* Radiance over the tracer's as SVG: for each model a square of optical depth towards the eye and
 * the sun, and one of the first and the angle to the sun, with numbers of pixels. */
void neph_light_plot(const struct neph_light_study *study, FILE *out);

/* ---- the fit --------------------------------------------------------------------------------- */

/* The fit of octaves to the tracer, over the cells of a study: damped least squares (D. W.
 * Marquardt 1963). What is made small is, for each cell, the square of its bias plus a quarter of
 * its mean square, of the whole frame and once more of the dense parts alone; cells count alike,
 * however bright they are. Nothing is rendered: along each view ray the light at scaled optical
 * depths is known (study/light_view.h). */

/* Radiance of a pixel under a sun of 1 W/m2 by a sum of reciprocal octaves (octaves_fitted.h), as
 * the march has it with endlessly small steps. */
double neph_light_octaves(const struct neph_light_view *view, const struct neph_octaves *octaves,
                          double g, double albedo);

/* How a fit does over the cells, as neph_light_verdict_of(). */
struct neph_light_verdict neph_light_fit_verdict(const struct neph_light_study *study,
                                                 const struct neph_octaves_fit *fit,
                                                 enum neph_light_part part);

/* From all factors 1/2 on. The request has a fit. NEPH_ERR_USAGE: it has no cell with media.
 * NEPH_ERR_MEMORY. */
enum neph_status neph_light_fit(const struct neph_light_study *study, struct neph_octaves_fit *fit,
                                struct neph_diag *diag);

/* The coefficients as the file that renderer/octaves_fitted.c includes, with what they were fitted
 * on. */
void neph_light_fit_print(const struct neph_light_study *study, const struct neph_octaves_fit *fit,
                          FILE *out);

#endif
