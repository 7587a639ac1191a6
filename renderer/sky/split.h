/* SPDX-License-Identifier: MIT
 *
 * A scene cut into the air of a planet and what is in it: its layers around the ball that is the
 * ground become tables, clouds and fogs stay media.
 */
#ifndef NEPH_RENDERER_SKY_SPLIT_H
#define NEPH_RENDERER_SKY_SPLIT_H

#include "renderer/sky/air.h"

struct neph_sky_split {
    struct neph_sky_air air;
    bool is_air[NEPH_SCENE_MEDIA_MAX]; /* of the scene's media */
};

/* False, with the reason in words: there is no such air, or what neph_sky_air_of() refuses of it
 * (a background, lights beside the sun, bounds that cut the air). */
bool neph_sky_split(const struct neph_scene *scene, struct neph_sky_split *split, char *reason,
                    size_t reason_size);

/* The scene at any moment without its air; it borrows all that the scene owns. Without another
 * medium nothing is left to scatter light. */
struct neph_scene neph_sky_rest(const struct neph_scene *scene, const struct neph_sky_split *split);

#endif
