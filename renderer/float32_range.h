/* SPDX-License-Identifier: MIT
 *
 * The range of the shaders' float32. Positions are relative to the camera, so precision is best
 * nearby. A position at a distance d is rounded to 6e-8 d, which beyond some distance is no longer
 * small compared with the mean free path of the media there.
 */
#ifndef NEPH_RENDERER_FLOAT32_RANGE_H
#define NEPH_RENDERER_FLOAT32_RANGE_H

#include "scenes/scene.h"

#include <stdbool.h>
#include <stddef.h>

/* Whether the shaders support all media of a scene and these are within range of the camera at
 * every key frame. If not, `reason` names the medium and the numbers. Rays of an orthographic
 * camera start beside it: the height of its image adds to the distance of the media. */
bool neph_is_in_float32_range(const struct neph_scene *scene, char *reason, size_t reason_size);

#endif
