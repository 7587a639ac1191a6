/* SPDX-License-Identifier: MIT
 *
 * The trial of an external renderer: before any other frame it renders a fog and a few voxels side
 * by side above a floor, 24 x 8 pixels. A version number is not enough: Debian's Blender 5.2, for
 * example, was built without voxels and omits them without an error.
 */
#ifndef NEPH_HARNESS_ENGINES_TRIAL_H
#define NEPH_HARNESS_ENGINES_TRIAL_H

#include "base/image.h"
#include "harness/json.h"
#include "scenes/scene.h"

enum { NEPH_TRIAL_WIDTH_PX = 24, NEPH_TRIAL_HEIGHT_PX = 8 };

struct neph_trial {
    struct neph_scene scene; /* single scattering */
    struct neph_camera_key key;
    struct neph_solid floor;
    struct neph_grid *grid;
};

/* Open the trial scene; always end with neph_trial_close(). Without `with_voxels` it has only
 * fog. */
enum neph_status neph_trial_open(bool with_voxels, struct neph_trial *trial,
                                 struct neph_diag *diag);
void neph_trial_close(struct neph_trial *trial);

/* Compare a frame of all layers with exact transport. `*has_voxels`: they are visible; voxels that
 * are completely missing are not an error. NEPH_ERR_ENGINE: the frame is black, or a value is
 * wrong. */
enum neph_status neph_trial_judge(const struct neph_trial *trial, const struct neph_image *image,
                                  bool *has_voxels, struct neph_diag *diag);

/* The path of the cache file for the trial's result, for the caller to free. Its name is a digest
 * of the program's path, size and date, and of `data_file` in the data folder (or NULL), which the
 * program is run with. NULL: one of them cannot be read, or memory is short. */
char *neph_trial_file(const char *program, const char *data_file);

/* The cached result, for json_decref() by the caller; NULL: none. */
json_t *neph_trial_load_result(const char *file);

/* Cache a result; takes the reference over. If that fails, the next process repeats the trial. */
void neph_trial_save_result(const char *file, json_t *found);

#endif
