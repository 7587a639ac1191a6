/* SPDX-License-Identifier: MIT
 *
 * The first flight of all paths of a pixel. They share one ray, so its optical depth is tabulated
 * once, and the place of the first collision is drawn from the exact distribution of those that do
 * collide: no path is lost, and thin media have little noise.
 */
#ifndef NEPH_TRUTH_FLIGHT_H
#define NEPH_TRUTH_FLIGHT_H

#include "truth/tracking.h"

/* Per medium: two ends, inner edges, and a ladder of optical depths per fog layer. */
#define NEPH_FLIGHT_INNER_EDGES 32
#define NEPH_FLIGHT_LADDER 9
#define NEPH_FLIGHT_EDGES_MAX                                                                      \
    (2 + NEPH_SCENE_MEDIA_MAX *                                                                    \
             (2 + NEPH_FLIGHT_INNER_EDGES + NEPH_FLIGHT_LADDER * NEPH_FOG_LAYERS_MAX))

struct neph_flight {
    const struct neph_scene *scene;
    struct neph_ray ray;
    double chance[3];                       /* that light of a channel collides before the end */
    int count;                              /* of the edges */
    double t_m[NEPH_FLIGHT_EDGES_MAX];      /* ascending; the last is the end of the ray */
    double depth[3][NEPH_FLIGHT_EDGES_MAX]; /* optical depth from the start, per channel */
};

/* Whether all media have the closed forms that this takes. */
bool neph_flight_is_possible(const struct neph_scene *scene);

/* Tabulate a ray. */
void neph_flight_init(struct neph_flight *flight, const struct neph_scene *scene,
                      const struct neph_ray *ray);

/* Sample a collision as light of one channel, given that it has one; `ratio` as in
 * neph_tracker_collide(), of the probabilities given that there is one, too: a channel's light is
 * chance[channel] of them. Medium -1 when chance[channel] is 0. */
struct neph_collision neph_flight_collide(const struct neph_flight *flight, int channel,
                                          struct neph_random *random);

#endif
