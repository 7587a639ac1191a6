/* SPDX-License-Identifier: MIT
 *
 * The fit of octaves to the tracer, over the cells of a light study: damped least squares (D. W.
 * Marquardt 1963). What is made small is, for each cell, the square of its bias plus a quarter of
 * its mean square, of the whole picture and once more of the dense parts alone; cells count alike,
 * however bright they are. Nothing is rendered: along each view ray the light at scaled optical
 * depths is known (study/light_view.h).
 */
#ifndef NEPH_HARNESS_EXPERIMENTS_LIGHT_FIT_H
#define NEPH_HARNESS_EXPERIMENTS_LIGHT_FIT_H

#include "harness/experiments/light.h"
#include "renderer/octaves_fitted.h"

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
