/* SPDX-License-Identifier: MIT
 *
 * The plot of `neph fluxes`: each flux over the columns along x, a mean over those along z.
 */
#ifndef NEPH_HARNESS_CLI_FLUXES_PLOT_H
#define NEPH_HARNESS_CLI_FLUXES_PLOT_H

#include "truth/fluxes.h"

#include <stdio.h>

struct neph_fluxes_plot {
    const char *title;
    const struct neph_fluxes *fluxes; /* borrowed */
};

/* Writes an SVG: a step for each column, in a band of one standard error to both sides; the mean
 * over the channels. `plot` is a struct neph_fluxes_plot. */
void neph_fluxes_plot_print(const void *plot, FILE *out);

#endif
