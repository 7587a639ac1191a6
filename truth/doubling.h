/* SPDX-License-Identifier: MIT
 *
 * The doubling method for one azimuthal Fourier mode of a homogeneous plane-parallel layer. Private
 * to truth/.
 */
#ifndef NEPH_TRUTH_DOUBLING_H
#define NEPH_TRUTH_DOUBLING_H

#include "base/status.h"

/* Rows are directions of leaving light: the nodes, which have the quadrature weights, then the
 * views (weight 0: exact, without interpolation). Columns are directions of incoming light: the
 * nodes, then the sun. */
struct neph_doubling {
    double optical_depth; /* > 0 */
    double albedo;        /* 0..1 */
    int moment_count;     /* Legendre: p = sum (2 l + 1) moment_l P_l / (4 pi) */
    const double *moments;
    int node_count;
    const double *node_weights; /* of Gauss-Legendre on (0, 1) */
    int view_count;
    const double *row_cosines;    /* nodes, views: node_count + view_count, > 0 */
    const double *column_cosines; /* nodes, sun: node_count + 1, > 0 */
};

/* The light of one mode from the sun, one k_m per row; arrays of the caller. Diffuse radiance / E =
 * sum over m of (2 - delta_0m) k_m cos(m azimuth) / (2 pi). */
struct neph_doubling_light {
    double *up, *down;           /* all orders of scattering */
    double *once_up, *once_down; /* the singly scattered part */
};

/* Solve one mode. NEPH_ERR_MEMORY. */
enum neph_status neph_doubling_mode(const struct neph_doubling *layer, int mode,
                                    const struct neph_doubling_light *light,
                                    struct neph_diag *diag);

/* Singly scattered light divided by albedo and phase function [1]: the integral over the layer of
 * e^-(depth down) e^-(depth to the side of exit) d tau / view_cosine. */
double neph_once_up(double optical_depth, double view_cosine, double sun_cosine);
double neph_once_down(double optical_depth, double view_cosine, double sun_cosine);

/* Gauss-Legendre nodes (ascending) and weights on (0, 1), to double precision. */
void neph_gauss_legendre(int count, double *nodes, double *weights);

#endif
