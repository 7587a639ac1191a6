/* SPDX-License-Identifier: MIT */
#include "harness/experiments/light.h"

#include "base/least_squares.h"
#include "scenes/media.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { UNKNOWNS = 3 * NEPH_OCTAVES_FEATURES, ITERATIONS_MAX = 200 };
_Static_assert(sizeof(struct neph_octaves_fit) == UNKNOWNS * sizeof(double), "nothing else");

/* Weight of the mean squared error relative to the squared bias. */
static const double rms_share = 0.25;

/* Weight of the squared coefficients (ridge regression): coefficients without influence stay
 * small. */
static const double ridge = 1e-2;

/* ---- the model ------------------------------------------------------------------------------- */

double neph_light_octaves(const struct neph_light_view *view, const struct neph_octaves *octaves,
                          double g, double albedo)
{
    const double cosine = cos(view->angle_rad);
    double sum = 0.0, a = 1.0, b = 1.0, c = 1.0;
    for (int i = 0; i < octaves->count; i++) {
        const struct neph_phase phase = {NEPH_PHASE_HENYEY_GREENSTEIN, c * g};
        sum += a * neph_phase_per_sr(&phase, cosine) * neph_light_interpolate_lit(view->lit, b);
        a *= octaves->contribution;
        b *= octaves->attenuation;
        c *= octaves->eccentricity;
    }
    return albedo * sum;
}

/* ---- pixels of a cell ------------------------------------------------------------------------ */

static bool is_among(const struct neph_light_pixel *pixel, enum neph_light_part part)
{
    if (part == NEPH_LIGHT_DENSE)
        return exp(-pixel->view.eye_depth) < NEPH_LIGHT_DENSE_TRANSMITTANCE;
    return neph_light_bin(NEPH_LIGHT_EYE, pixel->view.eye_depth) >= 0;
}

static struct neph_octaves evaluate_octaves(const struct neph_light_cell *cell,
                                            const struct neph_octaves_fit *fit)
{
    return neph_octaves_compute(fit, cell->light.g, cell->light.albedo);
}

static struct neph_light_sums sum_cell(const struct neph_light_cell *cell,
                                       const struct neph_octaves_fit *fit,
                                       enum neph_light_part part)
{
    const struct neph_octaves octaves = evaluate_octaves(cell, fit);
    struct neph_light_sums sums = {.count = 0};
    for (int p = 0; p < cell->pixel_count && !cell->left_out[0]; p++) {
        const struct neph_light_pixel *pixel = &cell->pixels[p];
        if (is_among(pixel, part))
            neph_light_sums_add(
                &sums,
                neph_light_octaves(&pixel->view, &octaves, cell->light.g, cell->light.albedo),
                pixel->first, pixel->second);
    }
    return sums;
}

/* ---- residuals ------------------------------------------------------------------------------- */

/* Residuals of a part of a cell, if it has enough pixels: first the bias, then one for each pixel.
 * Returns their number. */
static int compute_part_residuals(const struct neph_light_cell *cell,
                                  const struct neph_octaves_fit *fit, enum neph_light_part part,
                                  double *residuals)
{
    const struct neph_octaves octaves = evaluate_octaves(cell, fit);
    double truth = 0.0, off = 0.0;
    int count = 0;
    for (int p = 0; p < cell->pixel_count; p++) {
        const struct neph_light_pixel *pixel = &cell->pixels[p];
        if (!is_among(pixel, part))
            continue;
        const double radiance = 0.5 * (pixel->first + pixel->second);
        const double error = neph_light_octaves(&pixel->view, &octaves, cell->light.g,
                                                cell->light.albedo) -
                             radiance;
        residuals[++count] = error;
        truth += radiance;
        off += error;
    }
    if (!(truth > 0.0) || count < NEPH_LIGHT_PIXELS_MIN)
        return 0;
    for (int i = 1; i <= count; i++)
        residuals[i] *= sqrt(rms_share * count) / truth;
    residuals[0] = off / truth;
    return count + 1;
}

/* All residuals; returns their number. */
static int compute_residuals(const struct neph_light_study *study,
                             const struct neph_octaves_fit *fit, double *residuals)
{
    const double *coefficients = fit->contribution;
    int count = 0;
    for (int i = 0; i < study->cell_count; i++)
        for (int part = 0; part < NEPH_LIGHT_PARTS && !study->cells[i].left_out[0]; part++)
            count += compute_part_residuals(&study->cells[i], fit, (enum neph_light_part)part,
                                            residuals + count);
    for (int k = 0; k < UNKNOWNS && count > 0; k++)
        residuals[count++] = sqrt(ridge) * coefficients[k];
    return count;
}

/* ---- least squares --------------------------------------------------------------------------- */

static struct neph_octaves_fit make_fit(const double *coefficients)
{
    struct neph_octaves_fit fit;
    memcpy(&fit, coefficients, sizeof(fit));
    return fit;
}

static enum neph_status find_residuals(void *study, const double *coefficients, double *residuals,
                                       struct neph_diag *diag)
{
    const struct neph_octaves_fit fit = make_fit(coefficients);
    (void)diag;
    compute_residuals(study, &fit, residuals);
    return NEPH_OK;
}

/* By forward differences: a step of 1e-5 keeps half the digits of a double. */
static enum neph_status find_slopes(void *study, const double *coefficients,
                                    const double *residuals, double *const *slopes,
                                    struct neph_diag *diag)
{
    const double step = 1e-5;
    (void)diag;
    for (int k = 0; k < UNKNOWNS; k++) {
        double moved[UNKNOWNS];
        memcpy(moved, coefficients, sizeof(moved));
        moved[k] += step;
        const struct neph_octaves_fit fit = make_fit(moved);
        const int count = compute_residuals(study, &fit, slopes[k]);
        for (int i = 0; i < count; i++)
            slopes[k][i] = (slopes[k][i] - residuals[i]) / step;
    }
    return NEPH_OK;
}

static size_t count_residuals_max(const struct neph_light_study *study)
{
    size_t room = UNKNOWNS;
    for (int i = 0; i < study->cell_count; i++)
        room += NEPH_LIGHT_PARTS * ((size_t)study->cells[i].pixel_count + 1);
    return room;
}

static enum neph_status count_residuals(const struct neph_light_study *study, int *count,
                                        struct neph_diag *diag)
{
    const struct neph_octaves_fit zero = {.contribution = {0.0}};
    double *residuals = calloc(count_residuals_max(study), sizeof(*residuals));
    if (!residuals)
        return neph_fail_memory(diag);
    *count = compute_residuals(study, &zero, residuals);
    free(residuals);
    return *count > 0 ? NEPH_OK
                      : neph_fail(diag, NEPH_ERR_USAGE, "there is no cell with media to fit on");
}

enum neph_status neph_light_fit(const struct neph_light_study *study, struct neph_octaves_fit *fit,
                                struct neph_diag *diag)
{
    struct neph_light_study copy = *study;
    struct neph_least_squares problem = {.unknown_count = UNKNOWNS,
                                         .find_residuals = find_residuals,
                                         .find_slopes = find_slopes,
                                         .context = &copy,
                                         .tolerance = 1e-7,
                                         .iterations_max = ITERATIONS_MAX};
    double coefficients[UNKNOWNS] = {0.0}, squares;
    enum neph_status status = count_residuals(study, &problem.residual_count, diag);
    if (!status)
        status = neph_least_squares_solve(&problem, coefficients, &squares, diag);
    if (!status)
        *fit = make_fit(coefficients);
    return status;
}

/* ---- results --------------------------------------------------------------------------------- */

struct neph_light_verdict neph_light_fit_verdict(const struct neph_light_study *study,
                                                 const struct neph_octaves_fit *fit,
                                                 enum neph_light_part part)
{
    struct neph_light_verdict verdict = {.cell_count = 0};
    for (int i = 0; i < study->cell_count; i++) {
        const struct neph_light_sums sums = sum_cell(&study->cells[i], fit, part);
        if (neph_light_counts(&sums))
            neph_light_verdict_add(&verdict, &sums);
    }
    neph_light_verdict_end(&verdict);
    return verdict;
}

static void print_factors(const char *name, const double k[NEPH_OCTAVES_FEATURES], FILE *out)
{
    fprintf(out, ".%s = {%.6g, %.6g, %.6g, %.6g, %.6g},\n", name, k[0], k[1], k[2], k[3], k[4]);
}

void neph_light_fit_print(const struct neph_light_study *study, const struct neph_octaves_fit *fit,
                          FILE *out)
{
    const struct neph_light_request *request = study->request;
    const struct neph_light_verdict dense = neph_light_fit_verdict(study, fit, NEPH_LIGHT_DENSE),
                                    whole = neph_light_fit_verdict(study, fit, NEPH_LIGHT_WHOLE);
    fprintf(
        out,
        "/* Written by `neph study light --suite tuning --fit`: %d cells at %dx%d, the tracer's "
        "noise %g.\n * Mean of abs(bias) %.1f %% (worst %.1f %%), mean rms %.1f %%; in the "
        "dense parts of %d cells %.1f %%\n * (worst %.1f %%), %.1f %%. */\n",
        whole.cell_count, request->shared.size.width_px, request->shared.size.height_px,
        request->noise, 100.0 * whole.mean_bias, 100.0 * whole.worst_bias, 100.0 * whole.mean_rms,
        dense.cell_count, 100.0 * dense.mean_bias, 100.0 * dense.worst_bias,
        100.0 * dense.mean_rms);
    print_factors("contribution", fit->contribution, out);
    print_factors("attenuation", fit->attenuation, out);
    print_factors("eccentricity", fit->eccentricity, out);
}
