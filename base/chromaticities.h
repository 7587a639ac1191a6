/* SPDX-License-Identifier: MIT
 *
 * Matrices between linear RGB of different primaries. Chromaticities are x and y of red, green,
 * blue and white.
 */
#ifndef NEPH_BASE_CHROMATICITIES_H
#define NEPH_BASE_CHROMATICITIES_H

#include <stdbool.h>

/* ITU-R BT.709-6, and D50 of the connection space of colour profiles (ICC.1:2022, 7.2.16) as XYZ */
extern const double neph_rec709_chromaticities[8], neph_icc_white_xyz[3];

/* XYZ of a chromaticity with Y = 1. */
void neph_xyz_from_xy(const double xy[2], double xyz[3]);

/* The matrix from linear RGB to CIE XYZ in which white has Y = 1: SMPTE RP 177-1993, 3.3. False:
 * the primaries lie on a line, or y of the white is not positive. */
bool neph_matrix_to_xyz(const double chromaticities[8], double matrix[3][3]);

/* Bradford's chromatic adaptation of XYZ from one white to another (ICC.1:2022, annex E.3). */
void neph_matrix_adapt(const double from_xyz[3], const double to_xyz[3], double matrix[3][3]);

/* The matrix from linear RGB of these chromaticities to linear Rec. 709, in which white becomes
 * white. False as for neph_matrix_to_xyz(). */
bool neph_matrix_to_rec709(const double chromaticities[8], double matrix[3][3]);

/* product = a b; `product` may be one of them. */
void neph_matrix_multiply(double a[3][3], double b[3][3], double product[3][3]);

#endif
