/* SPDX-License-Identifier: MIT
 *
 * A scene over time. Engines, jobs and files count frames; camera, sun, lights, wind and solids
 * have keys at frames of their own, the key frames, which stand still in a pause. Functions here
 * take a frame unless they name a key frame: 0-based, may be fractional, before 0 or after the
 * last.
 */
#ifndef NEPH_SCENES_MOTION_H
#define NEPH_SCENES_MOTION_H

#include "scenes/keys.h"
#include "scenes/scene.h"

/* Whether the camera jumps between two frames, in either order: a key with `cut` lies after the
 * earlier one and not after the later one. */
bool neph_scene_is_cut(const struct neph_scene *scene, double frame_from, double frame_to);

/* Converts the requested size to the size of a frame: times the scale at that frame, rounded to the
 * nearest pixel, at least 1. */
void neph_scene_frame_size(const struct neph_scene *scene, double frame, int *width_px,
                           int *height_px);

/* The sun of a frame: its direction follows the great circle between keys, its irradiance is
 * linear. */
struct neph_sun neph_scene_sun(const struct neph_scene *scene, double frame);

/* A light at a key frame, and light `index` of a scene in a frame: place and intensity are linear
 * between keys, the axis follows the great circle. The results have no keys. */
struct neph_light neph_place_light(const struct neph_light *light, double key_frame);
struct neph_light neph_scene_light(const struct neph_scene *scene, int index, double frame);

/* Displacement of the media by the wind since frame 0, see neph_medium_drift(): the exact integral
 * of the velocity, which is linear between keys; 0 without wind. */
struct neph_vec3 neph_scene_wind_displacement_m(const struct neph_scene *scene, double frame);

/* Whether the media are absent in a frame (frames.clear). */
bool neph_scene_is_clear(const struct neph_scene *scene, double frame);

/* A solid at a key frame, and at a frame. */
struct neph_solid neph_scene_solid_at(const struct neph_scene *scene, int index, double key_frame);
struct neph_solid neph_scene_solid(const struct neph_scene *scene, int index, double frame);

/* Transform of a moving solid: point -> pivot_m + turned (point - pivot_m) + move_m. */
struct neph_placing {
    struct neph_turn turn;
    struct neph_vec3 pivot_m, move_m;
};

/* The transform of a mover's solids in a frame. */
struct neph_placing neph_mover_placing(const struct neph_scene *scene,
                                       const struct neph_mover *mover, double frame);

/* The earlier place of a point of a solid, given its present place. */
struct neph_vec3 neph_find_earlier_place_m(const struct neph_placing *now,
                                           const struct neph_placing *before,
                                           struct neph_vec3 point_m);

/* Whether anything but the camera changes from frame to frame. */
bool neph_scene_moves(const struct neph_scene *scene);

/* Whether two frames have the same content: camera, sun, lights, wind displacement, presence of the
 * media, solids and size are equal bit by bit. Differences that are too small to see count. */
bool neph_scene_are_frames_equal(const struct neph_scene *scene, double frame_a, double frame_b);

/* Whether all frames of the scene have the same content. */
bool neph_scene_is_static(const struct neph_scene *scene);

/* The static scene of one frame, for engines without time: sun, lights, media and solids at that
 * frame, one camera key, no wind, pause or size. The hash is the hash of `scene`, because the frame
 * is part of a job. Costs one allocation, independent of the size of the scene: all large data are
 * borrowed, so `scene` must outlive the result. Free with neph_scene_destroy(). */
enum neph_status neph_scene_at(const struct neph_scene *scene, double frame,
                               struct neph_scene **static_scene, struct neph_diag *diag);

/* Translates a scene from neph_scene_at(); for injections that move the origin. */
void neph_scene_shift(struct neph_scene *static_scene, struct neph_vec3 by_m);

#endif
