/* SPDX-License-Identifier: MIT
 *
 * Conformance of a device: every picture of our Vulkan engines at a real size holds no NaN, no
 * infinity and nothing negative, and two devices give the same pictures within stated bounds.
 *
 *   FOLDER/SCENE.json                   what was rendered, what is wrong with it, means and hashes
 *   FOLDER/SCENE_ENGINE[_PRESET].exr    a lattice of pixels out of the last picture
 *
 * The devices are on different machines as a rule: their folders are what is compared.
 */
#ifndef NEPH_HARNESS_RUN_CONFORM_H
#define NEPH_HARNESS_RUN_CONFORM_H

#include "base/status.h"

#include "harness/json.h"
#include <stdbool.h>

#define NEPH_CONFORM_PICTURES_MAX 64

/* What a folder holds of each picture at most; few enough for hundreds of them to be carried. */
enum { NEPH_CONFORM_LATTICE_WIDTH_PX = 48, NEPH_CONFORM_LATTICE_HEIGHT_PX = 27 };

struct neph_conform_params {
    const char *folder;
    const char *const *scenes; /* names or files */
    int scene_count;
    const char *const *engines; /* names; none: all of ours that run on a Vulkan device */
    int engine_count;
    int width_px, height_px;
    int pictures;                      /* of a sequence of `realtime` */
    int samples;                       /* paths per pixel of `tracer` */
    struct neph_shared_device *device; /* as neph_shot.device */
    bool quiet;                        /* no progress */
    bool skip_absent; /* a scene whose file or data is not there is left out, not an error */
};

/* Render and count. `*report` is the list of what FOLDER/SCENE.json hold, for json_decref(); a
 * scene that is left out is {"scene", "absent": why, "pictures": []}. NEPH_ERR_UNAVAILABLE: no such
 * device. What is wrong with a picture is in the report. */
enum neph_status neph_conform_render(const struct neph_conform_params *params, json_t **report,
                                     struct neph_diag *diag);

/* How many pictures of a report were rendered, and how many of these are as they should be; an
 * engine that failed counts as a picture. */
void neph_conform_count(const json_t *report, int *expected, int *sound);

/* What of two folders is compared: pictures of these engines (none: all) and of these scenes (none:
 * all), by name. */
struct neph_conform_part {
    const char *const *engines;
    int engine_count;
    const char *const *scenes;
    int scene_count;
};

/* Hold the pictures of two folders against each other. `*report`: {"devices": [2], "expected",
 * "agreeing", "pictures": [{"picture", "agrees", "channels": [...], "because"}]}, for
 * json_decref(). A picture that only one folder holds, or that is of another scene, size or
 * setting, does not agree. NEPH_ERR_NOT_FOUND, NEPH_ERR_INPUT: no folder of neph_conform_render().
 */
enum neph_status neph_conform_compare(const char *folder_a, const char *folder_b,
                                      const struct neph_conform_part *part, json_t **report,
                                      struct neph_diag *diag);

#endif
