/* SPDX-License-Identifier: MIT
 *
 * A scene over time. Pictures are counted by engines, jobs and files; camera, sun, wind and solids
 * have keys at frames of their own, which stand still while pictures go on in a pause. Functions
 * here take the frame of a picture, unless they say of the keys: 0-based, may be fractional, may
 * lie before 0 or after the last.
 */
#ifndef NEPH_SCENES_MOTION_H
#define NEPH_SCENES_MOTION_H

#include "scenes/keys.h"
#include "scenes/scene.h"

/* Whether the camera jumps between two pictures, in either order: a key with `cut` lies after the
 * earlier and not after the later. */
bool neph_scene_is_cut(const struct neph_scene *scene, double frame_from, double frame_to);

/* From the size that was asked for to that of a picture: times the scale in force, to the nearest
 * pixel, at least 1. */
void neph_scene_frame_size(const struct neph_scene *scene, double frame, int *width_px,
                           int *height_px);

/* The sun: its direction goes along the great circle between keys, its irradiance is linear. */
struct neph_sun neph_scene_sun(const struct neph_scene *scene, double frame);

/* How far the wind has carried media since frame 0, see neph_medium_drift(): the exact integral of
 * the velocity, which is linear between keys; 0 without wind. */
struct neph_vec3 neph_scene_wind_displacement_m(const struct neph_scene *scene, double frame);

/* Whether the media are away in a picture (frames.clear). */
bool neph_scene_is_clear(const struct neph_scene *scene, double frame);

/* A solid as it stands at a frame of the keys, and one at a picture. */
struct neph_solid neph_scene_solid_at(const struct neph_scene *scene, int index, double key_frame);
struct neph_solid neph_scene_solid(const struct neph_scene *scene, int index, double frame);

/* Where a point of a moving solid stands: point -> pivot_m + turned (point - pivot_m) + move_m. */
struct neph_placing {
    struct neph_turn turn;
    struct neph_vec3 pivot_m, move_m;
};

/* Where a mover has its solids in a picture. */
struct neph_placing neph_mover_placing(const struct neph_scene *scene,
                                       const struct neph_mover *mover, double frame);

/* Where a point of a solid stood, from where it stands now. */
struct neph_vec3 neph_placed_before_m(const struct neph_placing *now,
                                      const struct neph_placing *before, struct neph_vec3 point_m);

/* Whether anything but the camera changes from frame to frame. */
bool neph_scene_moves(const struct neph_scene *scene);

/* Whether two pictures show the same: camera, sun, the wind's displacement, what is there of the
 * media, solids and the size have the same bits. What differs by less than can be seen is another
 * moment. */
bool neph_scene_is_same_moment(const struct neph_scene *scene, double frame_a, double frame_b);

/* Whether all frames of the scene show the same. */
bool neph_scene_is_static(const struct neph_scene *scene);

/* The scene as it stands in one picture, for engines that know nothing of time: its sun, media and
 * solids where they are then, one camera key, no wind, pause or size. The hash is that of `scene`:
 * a picture's frame is part of its job. Costs one allocation and no work that grows with the scene:
 * all large data are borrowed, so `scene` must outlive it. Free with neph_scene_destroy(). */
enum neph_status neph_scene_at(const struct neph_scene *scene, double frame,
                               struct neph_scene **still, struct neph_diag *diag);

/* A scene that neph_scene_at() made, of one whose injections move its origin, elsewhere. */
void neph_scene_shift(struct neph_scene *still, struct neph_vec3 by_m);

#endif
