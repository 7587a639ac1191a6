/* SPDX-License-Identifier: MIT
 *
 * Matrices between primaries, with published ones.
 */
#include "base/chromaticities.h"
#include "tests/neph_test.h"

static void assert_matrix(double found[3][3], const double expected[3][3], double tolerance)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            neph_assert_close(found[i][j], expected[i][j], 0.0, tolerance);
}

/* Bruce Lindbloom, "RGB/XYZ Matrices": sRGB relative to its own white, whose chromaticity is
 * written with four digits there, too. Seven digits are given. */
static void test_srgb_to_xyz(void **state)
{
    (void)state;
    static const double expected[3][3] = {{0.4124564, 0.3575761, 0.1804375},
                                          {0.2126729, 0.7151522, 0.0721750},
                                          {0.0193339, 0.1191920, 0.9503041}};
    double found[3][3];
    assert_true(neph_matrix_to_xyz(neph_rec709_chromaticities, found));
    /* His white is that of ASTM E308, (0.95047, 1, 1.08883): it differs in the fifth digit. */
    assert_matrix(found, expected, 3e-4);
}

/* Rows of RGB to XYZ under D50 in CSS Color 4, 10.2 (profiles of the ICC have them, rounded). */
static void test_srgb_adapted_to_d50(void **state)
{
    (void)state;
    static const double expected[3][3] = {{0.4360747, 0.3850649, 0.1430804},
                                          {0.2225045, 0.7168786, 0.0606169},
                                          {0.0139322, 0.0971045, 0.7141733}};
    double matrix[3][3], adapted[3][3], white[3];
    neph_xyz_from_xy(neph_rec709_chromaticities + 6, white);
    neph_matrix_adapt(white, neph_icc_white_xyz, adapted);
    assert_true(neph_matrix_to_xyz(neph_rec709_chromaticities, matrix));
    neph_matrix_multiply(adapted, matrix, matrix);
    assert_matrix(matrix, expected, 3e-4); /* as above */
}

/* ACES2065-1 and ACEScg to linear Rec. 709 with Bradford's adaptation: "Utility - Linear - sRGB" of
 * the configuration of ACES 1.x for OpenColorIO. */
static void test_aces_to_rec709(void **state)
{
    (void)state;
    static const double ap0[8] = {0.7347, 0.2653, 0.0, 1.0, 0.0001, -0.077, 0.32168, 0.33767},
                        ap1[8] = {0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767},
                        of_ap0[3][3] = {{2.52169, -1.13413, -0.38756},
                                        {-0.27648, 1.37272, -0.09624},
                                        {-0.01538, -0.15298, 1.16835}},
                        of_ap1[3][3] = {{1.70505, -0.62179, -0.08326},
                                        {-0.13026, 1.14080, -0.01055},
                                        {-0.02400, -0.12897, 1.15297}};
    double found[3][3];
    assert_true(neph_matrix_to_rec709(ap0, found)); /* its blue has a negative y */
    assert_matrix(found, of_ap0, 1e-5);             /* digits of the configuration */
    assert_true(neph_matrix_to_rec709(ap1, found));
    assert_matrix(found, of_ap1, 1e-5);
}

static void test_rec709_stays_and_white_becomes_white(void **state)
{
    (void)state;
    static const double wide[8] = {0.708, 0.292, 0.17, 0.797, 0.131, 0.046, 0.3457, 0.3585},
                        unit[3][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    double found[3][3];
    assert_true(neph_matrix_to_rec709(neph_rec709_chromaticities, found));
    assert_matrix(found, unit, 1e-14);
    assert_true(neph_matrix_to_rec709(wide, found));
    for (int i = 0; i < 3; i++)
        neph_assert_close(found[i][0] + found[i][1] + found[i][2], 1.0, 0.0, 1e-14);
}

static void test_no_matrix_of_a_line(void **state)
{
    (void)state;
    static const double line[8] = {0.2, 0.2, 0.3, 0.3, 0.4, 0.4, 0.3127, 0.329},
                        dark[8] = {0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.0};
    double found[3][3];
    assert_false(neph_matrix_to_xyz(line, found));
    assert_false(neph_matrix_to_rec709(dark, found));
}

#include "tests/main.h"
