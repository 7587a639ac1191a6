/* SPDX-License-Identifier: MIT
 *
 * From the file as it stands to the scene as it is used. Private to scenes/.
 */
#ifndef NEPH_SCENES_BUILD_H
#define NEPH_SCENES_BUILD_H

#include "scenes/document.h"
#include "scenes/schema.h"

/* Apply defaults, convert units, expand fences into their bars, read volumes. The raw scene has
 * been checked; the document and the path tell where in it an error lies and where files start. */
enum neph_status neph_scene_build(const struct neph_raw_scene *raw, struct neph_document *document,
                                  const char *path, struct neph_scene **scene,
                                  struct neph_diag *diag);

/* The media alone; what is half made after an error is freed with the scene. */
enum neph_status neph_build_media(const struct neph_raw_scene *raw, struct neph_document *document,
                                  const char *path, struct neph_scene *scene,
                                  struct neph_diag *diag);

/* How many solids a fence makes: per row its bars and its rails. */
int neph_fence_solid_count(const struct neph_raw_fence *fence);

/* Camera, sun, wind and frames: all that may change over time. What is half made after an
 * error is freed with the scene. */
enum neph_status neph_build_motion(const struct neph_raw_scene *raw, struct neph_scene *scene,
                                   struct neph_diag *diag);

/* Position and target at a frame of the keys. */
struct neph_camera_key neph_camera_key_at(const struct neph_scene *scene, double key_frame);

#endif
