/* SPDX-License-Identifier: MIT
 *
 * Optical depths of blobs and shells to 40 digits (mpmath), from reference_radial.json.
 * reference_radial.py writes the JSON; the build converts it to C.
 */
#ifndef NEPH_TESTS_SCENES_REFERENCE_RADIAL_H
#define NEPH_TESTS_SCENES_REFERENCE_RADIAL_H

#include "base/vec3.h"

#include <math.h>

struct reference_piece {
    struct neph_vec3 origin_m;
    double t0_m, t1_m, optical_depth;
};

/* Extinction 1 at the ground, centre (0, -radius, 0). */
struct reference_shell {
    double radius_m, scale_height_m;
    struct neph_vec3 direction;
    int count;
    struct reference_piece pieces[10];
};

/* Extinction 1 at the centre. */
struct reference_gaussian {
    double width_m;
    struct neph_vec3 center_m, direction;
    int count;
    struct reference_piece pieces[8];
};

#include "tests/scenes/reference_radial_tables.h"

#endif
