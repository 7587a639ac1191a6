/* SPDX-License-Identifier: MIT
 *
 * One path: the estimator of truth/oracle.h for one sample of one view.
 */
#ifndef NEPH_TRUTH_PATH_H
#define NEPH_TRUTH_PATH_H

#include "scenes/solids.h"
#include "truth/flight.h"
#include "truth/tracking.h"

/* The deterministic part of a view. */
struct neph_view {
    struct neph_vec3 origin_m, direction;
    struct neph_hit hit;
    struct neph_rgb transmittance; /* to the hit, or to infinity */
    struct neph_rgb unscattered;   /* background, or the surface in the direct light of sun and
                                    lights [W m^-2 sr^-1] */
};

/* The light of one path beyond the unscattered light [W m^-2 sr^-1]; an unbiased estimate. */
struct neph_path_light {
    struct neph_rgb volume;  /* last scattered by a medium before the camera, or visible emission */
    struct neph_rgb order1;  /* of `volume`: light of sun or environment, scattered only once */
    struct neph_rgb surface; /* from the visible surface, without the direct light in
                              * `unscattered` */
};

/* Whether the scene's media can send light. */
bool neph_path_has_volume(const struct neph_scene *scene);

/* Compute the exact part of the view along a ray. */
struct neph_view neph_view_create(const struct neph_scene *scene, struct neph_vec3 origin_m,
                                  struct neph_vec3 direction);

/* Trace one path. `flight` is the table of the view's ray up to the hit, or NULL: then the first
 * collision is sampled like all others, and most paths through thin media contribute nothing. */
struct neph_path_light neph_path_trace(const struct neph_scene *scene,
                                       const struct neph_tracker *tracker,
                                       const struct neph_view *view,
                                       const struct neph_flight *flight, struct neph_random *random,
                                       struct neph_tracking_cost *cost);

#endif
