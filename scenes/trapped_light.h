/* SPDX-License-Identifier: MIT
 *
 * Scenes in which paths of light have infinite mean length.
 */
#ifndef NEPH_SCENES_TRAPPED_LIGHT_H
#define NEPH_SCENES_TRAPPED_LIGHT_H

#include "scenes/scene.h"

#include <stdbool.h>

/* Scattering of all orders without absorption, in a fog that is open to the sides and endless or
 * without ground below or above: light always escapes, but after infinitely many events on average
 * (a recurrent random walk). */
bool neph_scene_traps_light(const struct neph_scene *scene);

/* The reason for which a tracer refuses such a scene, and the way out, in words. */
extern const char neph_trapped_light_reason[];

#endif
