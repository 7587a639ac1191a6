/* SPDX-License-Identifier: MIT
 *
 * A trial of an external renderer: a fog and a few voxels side by side above a floor, of 24 x 8
 * pixels, that it renders before anything else. A version number would be a promise; Debian's
 * Blender 5.2, for one, was built without voxels and leaves them out without an error.
 */
#ifndef NEPH_HARNESS_ENGINES_TRIAL_H
#define NEPH_HARNESS_ENGINES_TRIAL_H

#include "base/image.h"
#include "harness/json.h"
#include "scenes/scene.h"

enum { NEPH_TRIAL_WIDTH_PX = 24, NEPH_TRIAL_HEIGHT_PX = 8 };

struct neph_trial {
    struct neph_scene scene; /* one order of scattering */
    struct neph_camera_key key;
    struct neph_solid floor;
    struct neph_grid *grid;
};

/* Free with neph_trial_close(), whatever the status. Without `with_voxels` there is only fog. */
enum neph_status neph_trial_open(bool with_voxels, struct neph_trial *trial,
                                 struct neph_diag *diag);
void neph_trial_close(struct neph_trial *trial);

/* Compare a frame of all layers with exact transport. `*has_voxels`: they are in it. Voxels that
 * are not there at all are no error. NEPH_ERR_ENGINE: it is black, or a value is not that of the
 * scene. */
enum neph_status neph_trial_judge(const struct neph_trial *trial, const struct neph_image *image,
                                  bool *has_voxels, struct neph_diag *diag);

/* The file in the cache folder for the result of a trial of `program`, for the caller to free: its
 * name is a digest of the program's path, size and date and of what it was run with, the file
 * `data_file` of the data folder, or NULL. NULL: one of them cannot be read, or memory is short. */
char *neph_trial_file(const char *program, const char *data_file);

/* What the file keeps, for the caller to json_decref(); NULL: nothing. */
json_t *neph_trial_recall(const char *file);

/* Keep it; consumes the reference. Where that cannot be done, the next process tries again. */
void neph_trial_keep(const char *file, json_t *found);

#endif
