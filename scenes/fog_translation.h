/* SPDX-License-Identifier: MIT
 *
 * Between a scene's height fog and the looks of it (scenes/fog_look.h): which fogs have one, and
 * what of physics has a place in it. Of the layers all has: neph_fog_layer_to_unreal() and back.
 */
#ifndef NEPH_SCENES_FOG_TRANSLATION_H
#define NEPH_SCENES_FOG_TRANSLATION_H

#include "scenes/scene.h"

/* False, with the reason in words, when a scene has no look, or what the model does not know: there
 * is one height fog, grey and without bounds, for Filament of one layer, and no light but the sun.
 */
bool neph_fog_look_is_of(const struct neph_scene *scene, enum neph_fog_model model, char *reason,
                         size_t reason_size);

/* As before, but that there may be other media beside the fog, which somebody else renders. */
bool neph_fog_look_is_among(const struct neph_scene *scene, enum neph_fog_model model, char *reason,
                            size_t reason_size);

/* What is left of a scene for somebody else: all but its height fog. It borrows all that the scene
 * owns; without another medium nothing is left to scatter light. */
struct neph_scene neph_fog_look_rest(const struct neph_scene *scene);

/* What of physics has a place in a look, of a height fog under a scene's sun: the radiance of its
 * thin parts, emission and sunlight scattered once and lost nowhere else. Where the mean cosine g
 * is above 1/2 that sunlight is a lobe cos^e with the same, e = (2 g - 1) / (1 - g), and with the
 * same energy; else it is even. All controls else are off. */
struct neph_fog_look neph_fog_look_of_physics(const struct neph_scene *scene,
                                              const struct neph_medium *fog);

/* The first height fog of a scene; NULL when it has none. */
const struct neph_medium *neph_fog_look_medium(const struct neph_scene *scene);

#endif
