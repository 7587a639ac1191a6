/* SPDX-License-Identifier: MIT
 *
 * Conformance of a Vulkan device: every frame of the project's Vulkan engines, at full size, has
 * only finite values and none below zero, and two devices give the same frames within stated
 * bounds.
 *
 *   FOLDER/SCENE.json                   the rendered cases, their invalid values, means and hashes
 *   FOLDER/SCENE_ENGINE[_PRESET].exr    a sparse grid of pixels of the last frame
 *
 * Devices are usually on different machines, so `neph conform` compares their folders.
 */
#ifndef NEPH_HARNESS_RUN_CONFORM_H
#define NEPH_HARNESS_RUN_CONFORM_H

#include "base/status.h"

#include "harness/json.h"
#include <stdbool.h>

#define NEPH_CONFORM_PICTURES_MAX 64

/* Size limit of the sparse pixel grid, small enough for hundreds of files to be copied to another
 * machine. */
enum { NEPH_CONFORM_LATTICE_WIDTH_PX = 48, NEPH_CONFORM_LATTICE_HEIGHT_PX = 27 };

struct neph_conform_params {
    const char *folder;
    const char *const *scenes; /* names or files */
    int scene_count;
    const char *const *engines; /* names; none: all of ours that run on a Vulkan device */
    int engine_count;
    int width_px, height_px;
    int pictures;                      /* frames of a sequence of `realtime` */
    int samples;                       /* paths per pixel of `tracer` */
    struct neph_shared_device *device; /* like neph_shot.device */
    bool quiet;                        /* no progress */
    bool skip_absent; /* skip scenes with a missing file or data; otherwise an error */
};

/* Renders the frames and counts their invalid values. `*report` is the list of the contents of all
 * FOLDER/SCENE.json, for json_decref(); a scene that is left out is {"scene", "absent": why,
 * "pictures": []}. NEPH_ERR_UNAVAILABLE: there is no such device. Invalid values are no error: the
 * report lists them. */
enum neph_status neph_conform_render(const struct neph_conform_params *params, json_t **report,
                                     struct neph_diag *diag);

/* `*expected`: cases that their engine supports, failed ones included. `*sound`: supported cases
 * that were rendered without invalid values. */
void neph_conform_count(const json_t *report, int *expected, int *sound);

/* The part of two folders that is compared: frames of these engines (none given: all) and of these
 * scenes (none given: all), by name. */
struct neph_conform_part {
    const char *const *engines;
    int engine_count;
    const char *const *scenes;
    int scene_count;
};

/* Compares the frames of two folders. `*report`, for json_decref():
 *
 *   {"devices": [2], "expected", "agreeing",
 *    "pictures": [{"picture", "agrees", "channels": [...], "because"}]}
 *
 * A frame that only one folder has, or whose scene, size or settings differ, does not agree.
 * NEPH_ERR_NOT_FOUND: no such folder. NEPH_ERR_INPUT: a folder without files of
 * neph_conform_render(). */
enum neph_status neph_conform_compare(const char *folder_a, const char *folder_b,
                                      const struct neph_conform_part *part, json_t **report,
                                      struct neph_diag *diag);

#endif
