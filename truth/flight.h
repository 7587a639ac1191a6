/* SPDX-License-Identifier: MIT
 *
 * The first flight of all paths of a pixel. They share one ray, so its optical depth is tabulated
 * once, and the first collision is sampled from the exact distribution of colliding paths: no path
 * is lost, and thin media have little noise. If all light is singly scattered sunlight, the place
 * is sampled by that light instead (truth/lit_flight.h).
 */
#ifndef NEPH_TRUTH_FLIGHT_H
#define NEPH_TRUTH_FLIGHT_H

#include "truth/guess.h"
#include "truth/lit_flight.h"
#include "truth/majorant_flight.h"
#include "truth/tracking.h"

/* Edges per medium: two ends, inner edges, and a series of optical depths per fog layer. */
#define NEPH_FLIGHT_INNER_EDGES 32
#define NEPH_FLIGHT_LADDER 9
#define NEPH_FLIGHT_EDGES_MAX                                                                      \
    (2 + NEPH_SCENE_MEDIA_MAX *                                                                    \
             (2 + NEPH_FLIGHT_INNER_EDGES + NEPH_FLIGHT_LADDER * NEPH_FOG_LAYERS_MAX))

/* A channel index for the mean of the three channels. */
#define NEPH_FLIGHT_MEAN 3

struct neph_flight {
    const struct neph_scene *scene;
    struct neph_ray ray;
    double chance[3];                  /* probability of a collision before the end, for each
                                        * channel */
    int count;                         /* of the edges */
    double t_m[NEPH_FLIGHT_EDGES_MAX]; /* ascending; the last is the end of the ray */
    /* Optical depth from the start, per channel, and the mean of these. */
    double depth[4][NEPH_FLIGHT_EDGES_MAX];
    struct neph_lit_flight lit; /* valid if `lit.is_known` */
    /* Without a table (a medium has no closed form), the guess is used if `guess.lit.is_known`. */
    bool is_table;
    struct neph_guess guess;
    /* Used instead of all others if media differ in brightness and `own.is_known`. */
    struct neph_medium_flight own;
};

/* Tabulate a ray, if possible, and the sunlight along it, if that is the only light to scatter. */
void neph_flight_init(struct neph_flight *flight, const struct neph_scene *scene,
                      const struct neph_ray *ray);

/* Sample a collision for light of one channel, given that there is one. `ratio` as in
 * neph_tracker_collide(), of the conditional probabilities: chance[channel] of a channel's light
 * collides. Medium -1 if chance[channel] is 0. */
struct neph_collision neph_flight_collide(const struct neph_flight *flight, int channel,
                                          struct neph_random *random);

/* Sample a collision by its light, if `flight->lit.is_known`. `value` receives the weight of the
 * collision per channel: extinction of the medium times the transmittance from the camera, divided
 * by the probability density of this collision. Medium -1: no light. */
struct neph_collision neph_flight_collide_lit(const struct neph_flight *flight,
                                              struct neph_random *random, double value[3]);

#endif
