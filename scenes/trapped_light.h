/* SPDX-License-Identifier: MIT
 *
 * Scenes whose light no path tracer can follow to its end.
 */
#ifndef NEPH_SCENES_TRAPPED_LIGHT_H
#define NEPH_SCENES_TRAPPED_LIGHT_H

#include "scenes/scene.h"

#include <stdbool.h>

/* All orders of scattering without absorption in a fog that is open to the sides, and below or
 * above has neither an end nor a ground: light always comes out, but after infinitely many events
 * on the average (a recurrent random walk). */
bool neph_scene_traps_light(const struct neph_scene *scene);

/* Why a tracer refuses such a scene, and the way out, in words. */
extern const char neph_trapped_light_reason[];

#endif
