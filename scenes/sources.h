/* SPDX-License-Identifier: MIT
 *
 * The brightness of each medium: an estimate of the light of one collision in it. Samplers use it
 * to distribute samples over the media, so that a bright medium inside a dark one is sampled
 * (truth/majorant_flight.h). It does not change the expected radiance.
 */
#ifndef NEPH_SCENES_SOURCES_H
#define NEPH_SCENES_SOURCES_H

#include "scenes/scene.h"

#include <stdbool.h>

/* Light of a collision per channel [W m^-2 sr^-1], as for isotropic scattering. A channel is 0 only
 * where no collision gives light in it. */
struct neph_source {
    struct neph_rgb sun;     /* scattered sunlight, before it is attenuated on its way */
    struct neph_rgb ambient; /* emitted, or scattered and not the sun's */
};

struct neph_source neph_medium_source(const struct neph_scene *scene,
                                      const struct neph_medium *medium);

/* Whether the media of a scene differ by more than a factor of 8 in a channel, so that collisions
 * in proportion to extinction may miss most of the light. Below that, a few hundred collisions
 * sample the light of all media, or their variance shows that they do not. */
bool neph_scene_sources_differ(const struct neph_scene *scene);

#endif
