/* SPDX-License-Identifier: MIT
 *
 * Scattering of a plane wave by one homogeneous sphere (G. Mie 1908), as in C. F. Bohren, D. R.
 * Huffman, "Absorption and Scattering of Light by Small Particles" (1983), chapter 4 and appendix
 * A. The refractive index is n + i k with k >= 0 for absorption, relative to the medium.
 */
#ifndef NEPH_TRUTH_MIE_H
#define NEPH_TRUTH_MIE_H

#include "base/status.h"

#include <complex.h>

/* Bounds of the size parameter 2 pi radius / wavelength, and of |index|. */
#define NEPH_MIE_SIZE_MIN 1e-3
#define NEPH_MIE_SIZE_MAX 2e4
#define NEPH_MIE_INDEX_MAX 20.0

/* Cross sections over the geometric cross section, and the mean cosine of scattering. */
struct neph_mie_efficiency {
    double extinction, scattering, asymmetry;
};

/* Computes the efficiencies and, for `angle_count` cosines of the scattering angle in -1..1, the
 * intensities S11 of unpolarised light, (|S1|^2 + |S2|^2) / 2: the differential cross section is
 * S11 / k^2 with k = 2 pi / wavelength (equation 3.19 and 4.77). NEPH_ERR_INPUT: a parameter is out
 * of its bounds. */
enum neph_status neph_mie_sphere(double size_parameter, double complex index, int angle_count,
                                 const double *cosines, struct neph_mie_efficiency *efficiency,
                                 double *intensities, struct neph_diag *diag);

#endif
