/* SPDX-License-Identifier: MIT
 *
 * Light that media emit. Emission is the source radiance of a medium's absorption, the radiance of
 * the black body that it would be if it were opaque and scattered nothing: by Kirchhoff's law it
 * emits, per metre and per channel,
 *
 *   (1 - albedo) * extinction * emission   [W m^-2 sr^-1 m^-1]
 *
 * (Chandrasekhar, "Radiative Transfer", 1960, chapter I). So a medium
 * of any albedo whose emission is the radiance of its surroundings cannot be told from them.
 *
 * Emitted light is seen whatever `scattering` a scene has; with `multiple` alone it is scattered
 * and lights solids.
 */
#ifndef NEPH_SCENES_EMISSION_H
#define NEPH_SCENES_EMISSION_H

#include "scenes/scene.h"

#include <stdbool.h>

/* Emitted radiance per optical depth of the medium itself, per channel [W m^-2 sr^-1]:
 * (1 - albedo) * emission. 0 in channels that it does not attenuate. */
struct neph_rgb neph_medium_glow(const struct neph_medium *medium);

/* Whether any channel of a medium, of any medium of a scene, glows. */
bool neph_medium_emits(const struct neph_medium *medium);
bool neph_scene_emits(const struct neph_scene *scene);

/* Why an engine without it refuses a scene that emits, and the way out, in words. */
extern const char neph_emission_reason[];

#endif
