/* SPDX-License-Identifier: MIT
 *
 * How far the shaders' float32 reaches. Positions are relative to the camera, so that it loses
 * nothing nearby; but a place at a distance d is known to 6e-8 d, and beyond some distance that is
 * no longer small beside a mean free path of what is there.
 */
#ifndef NEPH_RENDERER_REACH_H
#define NEPH_RENDERER_REACH_H

#include "scenes/scene.h"

#include <stdbool.h>
#include <stddef.h>

/* Whether the shaders know all media of a scene, and these are near enough to the camera, at every
 * key; if not, `reason` says which is not and by what numbers. Rays of an orthographic camera begin
 * beside it: its picture's height counts as a distance across that to the media. */
bool neph_float32_reaches(const struct neph_scene *scene, char *reason, size_t reason_size);

#endif
