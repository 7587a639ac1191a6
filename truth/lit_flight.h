/* SPDX-License-Identifier: MIT
 *
 * Where on a camera's ray sunlight is scattered that still has a way to go: the distribution from
 * which first collisions are drawn when light is scattered once. Free flights alone end near the
 * camera, and against the light, where as much comes from the far side, they would meet it once in
 * e^(optical depth) paths: the mean would be right, but no sample of usual size would know it.
 *
 * Distances are optical depths s from the camera (mean over the channels; the ray's table in
 * truth/flight.h turns them into metres). The density is a mixture of three:
 *   - the light itself, e^-(way), of the whole way sun - collision - camera: known at the edges of
 *     cells, log-linear between them, which is exact where the way is linear in s (P. Kutz et al.
 *     and others draw distances by such products; solids are left out: they only make light less);
 *   - free flight, so that no collision weighs more than ten times what it would there;
 *   - even in s, so that light which comes in between two edges is found.
 * All are known in closed form, so that the estimate stays unbiased whatever the table misses.
 */
#ifndef NEPH_TRUTH_LIT_FLIGHT_H
#define NEPH_TRUTH_LIT_FLIGHT_H

#include "truth/random.h"

#include <stdbool.h>

#define NEPH_LIT_CELLS 16

struct neph_lit_flight {
    bool is_known;
    double end;                           /* of the ray, in s; may be +inf */
    double lit_share, free_share;         /* of the mixture; the rest is even */
    double s[NEPH_LIT_CELLS + 1];         /* edges; the last at `end`, or where it is dark */
    double log_light[NEPH_LIT_CELLS + 1]; /* at the edges, over the brightest's */
    double below[NEPH_LIT_CELLS + 1];     /* part of the light before each edge; the last is 1 */
    double log_whole;                     /* the logarithm of all the light; -inf: it is dark */
};

/* The edges of a ray of whole depth `end` > 0: even, but finer at both ends when it is deep. */
void neph_lit_flight_edges(struct neph_lit_flight *lit, double end);

/* Complete it when `log_light` holds the logarithms of the light at the edges, in any unit; -inf is
 * darkness. `also_ambient`: light comes from all around, too, which only free flights are good for.
 */
void neph_lit_flight_complete(struct neph_lit_flight *lit, bool also_ambient);

/* Draw a depth s. */
double neph_lit_flight_draw(const struct neph_lit_flight *lit, struct neph_random *random);

/* Its probability density, per unit of s. */
double neph_lit_flight_density(const struct neph_lit_flight *lit, double s);

#endif
