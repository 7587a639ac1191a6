/* SPDX-License-Identifier: MIT
 *
 * How bright each medium may be: about how much light one collision with it brings. Samplers use it
 * to share out their samples between the media, so that a bright medium in a dark one is not missed
 * (truth/own_flight.h). It never enters a radiance.
 */
#ifndef NEPH_SCENES_SOURCES_H
#define NEPH_SCENES_SOURCES_H

#include "scenes/scene.h"

#include <stdbool.h>

/* Light that a collision brings, per channel [W m^-2 sr^-1], as isotropic scattering would have it.
 * A channel is 0 only where no collision brings any light of it. */
struct neph_source {
    struct neph_rgb sun;     /* scattered sunlight, before it is attenuated on its way */
    struct neph_rgb ambient; /* emitted, or scattered and not the sun's */
};

struct neph_source neph_medium_source(const struct neph_scene *scene,
                                      const struct neph_medium *medium);

/* Whether the media of a scene differ so much in some channel that collisions in proportion to
 * extinction may miss most of the light: by more than a factor of 8. Below, a sample of a few
 * hundred collisions has light of all media or knows that it has not. */
bool neph_scene_sources_differ(const struct neph_scene *scene);

#endif
