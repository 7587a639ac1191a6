/* SPDX-License-Identifier: MIT
 *
 * The first flight of all paths of a pixel. They share one ray, so its optical depth is tabulated
 * once, and the place of the first collision is drawn from the exact distribution of those that do
 * collide: no path is lost, and thin media have little noise. Where all light is sunlight scattered
 * once, the place is drawn by that light (truth/lit_flight.h) instead.
 */
#ifndef NEPH_TRUTH_FLIGHT_H
#define NEPH_TRUTH_FLIGHT_H

#include "truth/guess.h"
#include "truth/lit_flight.h"
#include "truth/own_flight.h"
#include "truth/tracking.h"

/* Per medium: two ends, inner edges, and a ladder of optical depths per fog layer. */
#define NEPH_FLIGHT_INNER_EDGES 32
#define NEPH_FLIGHT_LADDER 9
#define NEPH_FLIGHT_EDGES_MAX                                                                      \
    (2 + NEPH_SCENE_MEDIA_MAX *                                                                    \
             (2 + NEPH_FLIGHT_INNER_EDGES + NEPH_FLIGHT_LADDER * NEPH_FOG_LAYERS_MAX))

/* In the place of a channel: the mean of the three. */
#define NEPH_FLIGHT_MEAN 3

struct neph_flight {
    const struct neph_scene *scene;
    struct neph_ray ray;
    double chance[3];                  /* that light of a channel collides before the end */
    int count;                         /* of the edges */
    double t_m[NEPH_FLIGHT_EDGES_MAX]; /* ascending; the last is the end of the ray */
    /* Optical depth from the start, per channel, and the mean of these. */
    double depth[4][NEPH_FLIGHT_EDGES_MAX];
    struct neph_lit_flight lit; /* used when `lit.is_known` */
    /* Where a medium has no closed form there is no table, and the guess in its place is used when
     * `guess.lit.is_known`. */
    bool is_table;
    struct neph_guess guess;
    /* Where media differ in brightness it is used in place of all others, when `own.is_known`. */
    struct neph_own_flight own;
};

/* Tabulate a ray, where that is possible, and the sunlight along it where that is all the light
 * there is to scatter. */
void neph_flight_init(struct neph_flight *flight, const struct neph_scene *scene,
                      const struct neph_ray *ray);

/* Sample a collision as light of one channel, given that it has one; `ratio` as in
 * neph_tracker_collide(), of the probabilities given that there is one, too: a channel's light is
 * chance[channel] of them. Medium -1 when chance[channel] is 0. */
struct neph_collision neph_flight_collide(const struct neph_flight *flight, int channel,
                                          struct neph_random *random);

/* Draw a collision by the light that comes from there, when `flight->lit.is_known`. `value`
 * receives the weight of the collision per channel: extinction by the medium times the
 * transmittance from the camera, divided by the probability density of this collision. Medium -1:
 * nothing would come. */
struct neph_collision neph_flight_collide_lit(const struct neph_flight *flight,
                                              struct neph_random *random, double value[3]);

#endif
