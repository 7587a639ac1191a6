/* SPDX-License-Identifier: MIT
 *
 * Shares of the parts of a real-time renderer in the squared flicker seen, from its values with
 * each set of parts real and the others ideal. Pure functions on an array of values.
 */
#ifndef NEPH_HARNESS_STUDY_ATTRIBUTION_VALUE_H
#define NEPH_HARNESS_STUDY_ATTRIBUTION_VALUE_H

#include <stdbool.h>

enum neph_attribution_part_id {
    NEPH_PART_RAYS,
    NEPH_PART_REPROJECTION,
    NEPH_PART_DISOCCLUSION,
    NEPH_PART_BOX,
    NEPH_PART_NOISE,
    NEPH_PART_UPSCALE,
    NEPH_PART_BLUR,
    NEPH_PART_ALIASING,
    NEPH_PARTS,
};

/* Bit i: part i is real. Reprojection, disocclusion, box and noise, the children of rays, have no
 * effect without real rays: a set with a child and without rays is no state. */
typedef unsigned neph_part_set;
enum { NEPH_PART_SETS = 1 << NEPH_PARTS, NEPH_PARTS_ALL = NEPH_PART_SETS - 1 };

bool neph_part_needs_rays(enum neph_attribution_part_id part);

/* Whether no child is real without rays: 136 sets. */
bool neph_part_set_is_state(neph_part_set set);

/* The set with a part made ideal, and with rays its children. */
neph_part_set neph_part_set_without(neph_part_set set, enum neph_attribution_part_id part);

/* In the unit of the values. */
struct neph_part_values {
    double share;   /* mean contribution over all orders in which parts become real, rays before
                       their children; the shares add up to the value of all parts */
    double alone;   /* the value with only this part real; of a child: beyond the value of rays */
    double without; /* the value with only this part ideal, rays with their children */
};

struct neph_attribution_values {
    double all; /* the value with all parts real */
    struct neph_part_values parts[NEPH_PARTS];
    double interaction; /* all - sum of `alone` */
    int order_count;    /* 8!/5 = 8064 */
};

/* The Shapley value under precedence constraints (U. Faigle, W. Kern, The Shapley value for
 * cooperative games under precedence constraints, Int. J. Game Theory 21, 1992). `values` of sets
 * that are no states are not read; the value of the empty set is 0. */
struct neph_attribution_values neph_attribution_divide(const double values[NEPH_PART_SETS]);

/* Whether the parts explain the value: an interaction of at most 15 % of it. */
bool neph_attribution_explains(const struct neph_attribution_values *values);

#endif
