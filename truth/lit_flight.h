/* SPDX-License-Identifier: MIT
 *
 * The distribution of first collisions on a camera ray for singly scattered sunlight. Free flights
 * alone would end near the camera. Against the light, where as much comes from the far side, they
 * would find it once in e^(optical depth) paths: unbiased, but useless at usual sample counts.
 *
 * Distances are optical depths s from the camera (mean over the channels; the ray's table in
 * truth/flight.h converts them to metres). The density is a mixture of three:
 *   - the light itself, e^-(depth), of the whole path sun - collision - camera: known at the edges
 *     of cells, log-linear between them, which is exact if the depth is linear in s (P. Kutz et al.
 *     and others sample distances by such products; solids are ignored: they only reduce the
 *     light);
 *   - free flight, so that no collision has more than ten times its free-flight weight;
 *   - uniform in s, to find light that enters between two edges.
 * All have closed forms, so the estimate is unbiased for any table.
 */
#ifndef NEPH_TRUTH_LIT_FLIGHT_H
#define NEPH_TRUTH_LIT_FLIGHT_H

#include "truth/random.h"

#include <stdbool.h>

#define NEPH_LIT_CELLS 16

struct neph_lit_flight {
    bool is_known;
    double end;                           /* end of the ray in s; may be +inf */
    double lit_share, free_share;         /* shares of the mixture; the remainder is uniform */
    double s[NEPH_LIT_CELLS + 1];         /* edges; the last at `end`, or where it is dark */
    double log_light[NEPH_LIT_CELLS + 1]; /* at the edges, relative to the brightest */
    double below[NEPH_LIT_CELLS + 1];     /* part of the light before each edge; the last one is
                                           * 1 */
    double log_whole;                     /* logarithm of the total light; -inf: dark */
};

/* Set the edges of a ray with total depth `end` > 0: even, but finer at both ends if it is deep. */
void neph_lit_flight_edges(struct neph_lit_flight *lit, double end);

/* Complete the table after `log_light` is set to the logarithms of the light at the edges, in any
 * unit (-inf: dark). `also_ambient`: there is also light from all directions, which only free
 * flights sample well.
 */
void neph_lit_flight_complete(struct neph_lit_flight *lit, bool also_ambient);

/* Sample a depth s. */
double neph_lit_flight_sample(const struct neph_lit_flight *lit, struct neph_random *random);

/* The probability density per unit of s. */
double neph_lit_flight_density(const struct neph_lit_flight *lit, double s);

#endif
