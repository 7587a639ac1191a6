/* SPDX-License-Identifier: MIT
 *
 * Exact transport to 50 digits (mpmath), from reference_values.json. reference_values.py writes the
 * JSON; the build converts it to C.
 */
#ifndef NEPH_TESTS_SCENES_REFERENCE_VALUES_H
#define NEPH_TESTS_SCENES_REFERENCE_VALUES_H

#include "scenes/scene.h"

#include <math.h>

struct reference_phi {
    double x, phi;
};

/* Optical depth of one layer; 2^-53 * condition is its unavoidable relative error. */
struct reference_depth {
    double length_m, optical_depth, condition;
};
struct reference_fog {
    struct neph_fog_layer layer;
    double y_m, k_y;
    int count;
    struct reference_depth depths[8];
};

struct reference_phase {
    struct neph_phase phase;
    int count;
    struct {
        double cosine, per_sr;
    } values[8];
};

/* In-scattered radiance of a ray under a sun of irradiance 1; `media` are indices of
 * reference_medium. */
struct reference_view {
    const char *name;
    struct neph_vec3 sun, origin_m, direction;
    double radiance, condition;
    int medium_count, media[2];
};

#include "tests/scenes/reference_values_tables.h"

#endif
