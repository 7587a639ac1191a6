/* SPDX-License-Identifier: MIT
 *
 * Translation between a scene's height fog and the non-physical fog models (scenes/fog_look.h): the
 * fogs that a model supports, and the physical quantities that it can express. Layers translate
 * completely: neph_fog_layer_to_unreal() and back.
 */
#ifndef NEPH_SCENES_FOG_TRANSLATION_H
#define NEPH_SCENES_FOG_TRANSLATION_H

#include "scenes/scene.h"

/* Whether a model supports a scene. False, with the reason in words, unless the scene has the
 * controls and one height fog, grey and without bounds (for Filament of one layer), no other
 * medium, and no light but the sun. */
bool neph_fog_look_can_model(const struct neph_scene *scene, enum neph_fog_model model,
                             char *reason, size_t reason_size);

/* The same, but other media are allowed beside the fog; another renderer renders them. */
bool neph_fog_look_can_model_fog_only(const struct neph_scene *scene, enum neph_fog_model model,
                                      char *reason, size_t reason_size);

/* The scene without its height fog, for another renderer. It borrows all memory of the scene;
 * without another medium nothing scatters light in it. */
struct neph_scene neph_fog_look_remove_fog(const struct neph_scene *scene);

/* The controls that express the physics of a height fog under a scene's sun: the radiance of its
 * thin parts, that is emission and sunlight scattered once, without other losses. With a mean
 * cosine g above 1/2 this sunlight is a lobe cos^e with the same mean cosine, e = (2 g - 1) / (1 -
 * g), and the same energy; else it is uniform. All other controls are off. */
struct neph_fog_look neph_fog_look_from_physics(const struct neph_scene *scene,
                                                const struct neph_medium *fog);

/* The first height fog of a scene; NULL when it has none. */
const struct neph_medium *neph_fog_look_find_medium(const struct neph_scene *scene);

#endif
