/* SPDX-License-Identifier: MIT
 *
 * Variants of a scene with an event, so that lag can be measured in any scene: the sun becomes
 * brighter in one step, its brightness oscillates, or the camera jumps.
 */
#ifndef NEPH_SCENES_VARIANT_H
#define NEPH_SCENES_VARIANT_H

#include "scenes/scene.h"

enum neph_variant_kind {
    NEPH_VARIANT_SUN_STEP,   /* from `frame` on the sun is four times as bright */
    NEPH_VARIANT_SUN_SINE,   /* in frame t the sun is 1 + 0.3 sum_P sin(2 pi t / P) times as bright,
                                P of neph_variant_periods */
    NEPH_VARIANT_CAMERA_CUT, /* at `frame` the camera turns right by half its vertical field of
                                view in one frame, marked as a cut */
    NEPH_VARIANT_KIND_COUNT,
};

/* 16, 32 and 64 frames, the periods of NEPH_VARIANT_SUN_SINE. They include the corner of every
 * exponential average in use (2 pi / a frames: 16 for a = 0.4, 31 for 0.2, 63 for 0.1), are whole
 * in 64 frames and in multiples of it, and are multiples of cycles of 2, 4, 8 and 16 frames, so
 * that each frame of such a cycle has the same phases of the light. */
enum { NEPH_VARIANT_PERIOD_COUNT = 3 };
extern const int neph_variant_periods[NEPH_VARIANT_PERIOD_COUNT];

enum { NEPH_VARIANT_FRAMES_MAX = 1024 };

struct neph_variant {
    enum neph_variant_kind kind;
    int frame;       /* of the step or cut, 1 .. frame_count - 1; unused for a sine */
    int frame_count; /* of the sequence, 2 .. NEPH_VARIANT_FRAMES_MAX */
};

/* "sun_step", "sun_sine", "camera_cut": on the command line and at the end of names of scenes. */
const char *neph_variant_name(enum neph_variant_kind kind);

/* The reason for which a scene has no such variant ("its sun moves already"), a static text; NULL:
 * it has. */
const char *neph_variant_obstacle(const struct neph_scene *scene, enum neph_variant_kind kind);

/* The variant in memory, with a name ("fog_sun_step"), title and hash of its own. It borrows all
 * large data from `scene`, which must outlive it. Free with neph_scene_destroy().
 * NEPH_ERR_UNSUPPORTED: the obstacle. NEPH_ERR_USAGE: frames out of range. */
enum neph_status neph_scene_variant(const struct neph_scene *scene,
                                    const struct neph_variant *variant, struct neph_scene **made,
                                    struct neph_diag *diag);

/* The variant as a scene file: the file of `scene`, comments included, with the changed keys
 * replaced and with absolute paths of volumes. Read from a file of the variant's name it has the
 * hash of neph_scene_variant(). The caller frees `*text`. Errors: those of neph_scene_variant() and
 * of reading the file; NEPH_ERR_UNSUPPORTED: it is not in UTF-8. */
enum neph_status neph_scene_variant_text(const struct neph_scene *scene,
                                         const struct neph_variant *variant, char **text,
                                         struct neph_diag *diag);

/* A scene in memory that was made from a file, as a file: as above, but the replaced keys are name,
 * title, number of frames and camera. `made->path` is the original file; `made` has no pauses.
 * NEPH_ERR_UNSUPPORTED: the camera is orthographic. */
enum neph_status neph_scene_camera_text(const struct neph_scene *made, char **text,
                                        struct neph_diag *diag);

#endif
