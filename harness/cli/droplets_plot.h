/* SPDX-License-Identifier: MIT
 *
 * The plot of `neph droplets`: phase functions on a logarithmic axis over the scattering angle.
 */
#ifndef NEPH_HARNESS_CLI_DROPLETS_PLOT_H
#define NEPH_HARNESS_CLI_DROPLETS_PLOT_H

#include <stdio.h>

enum { NEPH_PHASE_CURVES_MAX = 16 };

struct neph_phase_curve {
    double wavelength_nm, asymmetry;
    const double *phase_per_sr; /* at each angle */
};

struct neph_phase_plot {
    const char *title;
    int angle_count, curve_count;
    const double *angles_deg;
    struct neph_phase_curve curves[NEPH_PHASE_CURVES_MAX];
};

/* Writes an SVG: each curve times 4 pi, so that isotropic scattering is 1, and dashed
 * Henyey-Greenstein with the asymmetry of the first. `plot` is a struct neph_phase_plot. */
void neph_phase_plot_print(const void *plot, FILE *out);

#endif
