/* SPDX-License-Identifier: MIT
 *
 * Light that media emit. Emission is the source radiance of a medium's absorption: the radiance of
 * the medium as a black body, opaque and without scattering. By Kirchhoff's law it emits, per metre
 * and per channel,
 *
 *   (1 - albedo) * extinction * emission   [W m^-2 sr^-1 m^-1]
 *
 * (Chandrasekhar, "Radiative Transfer", 1960, chapter I). So a medium of any albedo is invisible in
 * an environment whose radiance equals its emission.
 *
 * Emitted light is visible for every `scattering` of a scene; only with `multiple` is it scattered
 * and does it light solids.
 */
#ifndef NEPH_SCENES_EMISSION_H
#define NEPH_SCENES_EMISSION_H

#include "scenes/scene.h"

#include <stdbool.h>

/* Emitted radiance per optical depth of the medium itself, per channel [W m^-2 sr^-1]:
 * (1 - albedo) * emission. 0 in channels without extinction. */
struct neph_rgb neph_medium_glow(const struct neph_medium *medium);

/* Whether a medium, or any medium of a scene, emits in any channel. */
bool neph_medium_emits(const struct neph_medium *medium);
bool neph_scene_emits(const struct neph_scene *scene);

/* The reason for which an engine without emission refuses a scene, and the way out, in words. */
extern const char neph_emission_reason[];

#endif
