/* SPDX-License-Identifier: MIT
 *
 * Splits a scene into the air of a planet and the remaining scene. Layers around the ground's
 * sphere become tables; clouds and fogs stay media.
 */
#ifndef NEPH_RENDERER_SKY_SPLIT_H
#define NEPH_RENDERER_SKY_SPLIT_H

#include "renderer/sky/air.h"

struct neph_sky_split {
    struct neph_sky_air air;
    bool is_air[NEPH_SCENE_MEDIA_MAX]; /* of the scene's media */
};

/* False, with the reason as text: no such air, or air that neph_sky_read_air() refuses (a
 * background, lights other than the sun, bounds that cut the air). */
bool neph_sky_split(const struct neph_scene *scene, struct neph_sky_split *split, char *reason,
                    size_t reason_size);

/* The scene at any frame without its air; it borrows everything that `scene` owns. Without other
 * media its scattering is none. */
struct neph_scene neph_sky_remove_air(const struct neph_scene *scene,
                                      const struct neph_sky_split *split);

#endif
