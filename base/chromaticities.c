/* SPDX-License-Identifier: MIT */
#include "base/chromaticities.h"

#include <math.h>
#include <string.h>

const double neph_rec709_chromaticities[8] = {0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329};
const double neph_icc_white_xyz[3] = {0.9642, 1.0, 0.8249};

void neph_xyz_from_xy(const double xy[2], double xyz[3])
{
    xyz[0] = xy[0] / xy[1];
    xyz[1] = 1.0;
    xyz[2] = (1.0 - xy[0] - xy[1]) / xy[1];
}

void neph_matrix_multiply(double a[3][3], double b[3][3], double product[3][3])
{
    double sums[3][3] = {{0.0}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++)
                sums[i][j] += a[i][k] * b[k][j];
    memcpy(product, sums, sizeof(sums));
}

/* By cofactors; false: no inverse. */
static bool invert(double m[3][3], double inverse[3][3])
{
    double determinant = 0.0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const int a = (j + 1) % 3, b = (j + 2) % 3, c = (i + 1) % 3, d = (i + 2) % 3;
            inverse[i][j] = m[a][c] * m[b][d] - m[a][d] * m[b][c];
        }
    for (int k = 0; k < 3; k++)
        determinant += m[0][k] * inverse[k][0];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            inverse[i][j] /= determinant;
    return fabs(determinant) > 1e-9; /* of rows with numbers near 1 */
}

bool neph_matrix_to_xyz(const double chromaticities[8], double matrix[3][3])
{
    double primaries[3][3], inverse[3][3], white[3];
    bool is_valid = chromaticities[7] > 0.0;
    for (int c = 0; c < 3; c++) { /* y may be negative: blue of ACES */
        primaries[0][c] = chromaticities[2 * c];
        primaries[1][c] = chromaticities[2 * c + 1];
        primaries[2][c] = 1.0 - primaries[0][c] - primaries[1][c];
    }
    for (int i = 0; i < 8; i++)
        is_valid &= fabs(chromaticities[i]) < 1e3; /* false for NaN */
    if (!is_valid)
        return false;
    neph_xyz_from_xy(chromaticities + 6, white);
    if (!invert(primaries, inverse))
        return false;
    for (int c = 0; c < 3; c++) {
        const double luminance = inverse[c][0] * white[0] + inverse[c][1] * white[1] +
                                 inverse[c][2] * white[2];
        for (int i = 0; i < 3; i++)
            matrix[i][c] = primaries[i][c] * luminance;
    }
    return true;
}

void neph_matrix_adapt(const double from_xyz[3], const double to_xyz[3], double matrix[3][3])
{
    static const double bradford[3][3] = {
        {0.8951, 0.2664, -0.1614}, {-0.7502, 1.7135, 0.0367}, {0.0389, -0.0685, 1.0296}};
    double cones[3][3], inverse[3][3];
    memcpy(cones, bradford, sizeof(cones));
    invert(cones, inverse);
    for (int i = 0; i < 3; i++) {
        double from = 0.0, to = 0.0;
        for (int j = 0; j < 3; j++) {
            from += bradford[i][j] * from_xyz[j];
            to += bradford[i][j] * to_xyz[j];
        }
        for (int j = 0; j < 3; j++)
            cones[i][j] *= to / from;
    }
    neph_matrix_multiply(inverse, cones, matrix);
}

bool neph_matrix_to_rec709(const double chromaticities[8], double matrix[3][3])
{
    double to_xyz[3][3], rec709[3][3], from_xyz[3][3], adapted[3][3], whites[2][3];
    if (!neph_matrix_to_xyz(chromaticities, to_xyz) ||
        !neph_matrix_to_xyz(neph_rec709_chromaticities, rec709) || !invert(rec709, from_xyz))
        return false;
    neph_xyz_from_xy(chromaticities + 6, whites[0]);
    neph_xyz_from_xy(neph_rec709_chromaticities + 6, whites[1]);
    neph_matrix_adapt(whites[0], whites[1], adapted);
    neph_matrix_multiply(adapted, to_xyz, adapted);
    neph_matrix_multiply(from_xyz, adapted, matrix);
    return true;
}
