/* SPDX-License-Identifier: MIT
 *
 * Linear colour spaces: conversion matrices from chromaticities, in double precision, for column
 * vectors.
 */
#ifndef NEPH_RENDERER_POST_COLOUR_H
#define NEPH_RENDERER_POST_COLOUR_H

struct neph_matrix3 {
    double m[3][3];
};

struct neph_chromaticity {
    double x, y; /* CIE 1931 */
};

struct neph_primaries {
    struct neph_chromaticity red, green, blue, white;
};

/* ITU-R BT.709 and BT.2020, white D65; Academy S-2014-004: AP0 (ACES) and AP1 (ACEScg), white at
 * 6000 K. */
extern const struct neph_primaries neph_rec709, neph_rec2020, neph_ap0, neph_ap1;

struct neph_matrix3 neph_matrix_product(const struct neph_matrix3 *a, const struct neph_matrix3 *b);

/* The conversion between two spaces, white to white by Bradford's cone responses (K. Lam 1985; as
 * in ACES). */
struct neph_matrix3 neph_colour_matrix(const struct neph_primaries *from,
                                       const struct neph_primaries *to);

/* The white of a correlated colour temperature: daylight from 4000 to 25000 K (CIE 015:2018, eq.
 * 4.5 ff.), a black body below 4000 K (Kim et al. 2002, 1667 K and above). At 4000 K the two differ
 * by 0.006. */
struct neph_chromaticity neph_white_chromaticity(double temperature_k);

/* The matrix in Rec.709 that maps light of a colour temperature to white; the identity at
 * NEPH_WHITE_K. There the daylight formula agrees with D65 to within 1.2e-4. */
#define NEPH_WHITE_K 6504.0
struct neph_matrix3 neph_white_balance(double temperature_k);

#endif
