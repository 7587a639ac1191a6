/* SPDX-License-Identifier: MIT
 *
 * The loader of scene files: every refusal has a position in the file; every scene that loads has a
 * valid camera ray, and a static copy at any frame.
 */
#include "tests/fuzz/fuzz.h"

#include "scenes/motion.h"
#include "scenes/scene.h"

#include <math.h>

/* Scenes that legitimately take seconds, or need other files: not tested here. */
static bool is_expensive(const uint8_t *data, size_t size)
{
    static const char *const keys[] = {"horizon", "voxels", "volume"};
    for (size_t i = 0; i < sizeof(keys) / sizeof(keys[0]); i++)
        if (memmem(data, size, keys[i], strlen(keys[i])))
            return true;
    return false;
}

static void require_camera(const struct neph_scene *scene)
{
    const struct neph_camera camera = neph_scene_camera(scene, scene->frame_count - 1);
    const struct neph_vec3 ray = neph_camera_ray(&camera, 7, 5, 6, 0).direction;
    fuzz_require(fabs(neph_vec3_length(ray) - 1.0) < 1e-9, "rays of the camera are unit vectors");
}

static void require_still(const struct neph_scene *scene, double frame)
{
    struct neph_scene *still = NULL;
    fuzz_require(neph_scene_at(scene, frame, &still, NULL) == NEPH_OK, "time can be stopped");
    fuzz_require(fabs(neph_vec3_length(still->sun.direction) - 1.0) < 1e-9,
                 "the direction of the sun is a unit vector");
    for (int i = 0; i < still->light_count; i++)
        fuzz_require(!still->lights[i].is_spot ||
                         fabs(neph_vec3_length(still->lights[i].axis) - 1.0) < 1e-9,
                     "the axis of a spot is a unit vector");
    fuzz_require(neph_scene_time_frame(scene, frame) <= frame, "pauses do not go forward");
    int width_px = 7, height_px = 5;
    neph_scene_frame_size(scene, frame, &width_px, &height_px);
    fuzz_require(width_px >= 1 && width_px <= 28 && height_px >= 1 && height_px <= 20,
                 "pictures have a size");
    neph_scene_destroy(still);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (is_expensive(data, size))
        return 0;
    const struct fuzz_file file = fuzz_file_make("fuzz.yaml", data, size); /* name: fuzz */
    struct neph_scene *scene = NULL;
    struct neph_diag diag = {0};
    const enum neph_status status = neph_scene_load(file.path, &scene, &diag);
    fuzz_require_outcome(status, &diag, scene);
    fuzz_require(status == NEPH_OK || status == NEPH_ERR_INPUT, "the file is at fault");
    fuzz_require(status == NEPH_OK || (diag.line >= 1 && diag.column >= 1), "a position is named");
    if (scene) {
        require_camera(scene);
        require_still(scene, 0.5);
        require_still(scene, scene->frame_count - 1);
    }
    neph_scene_destroy(scene);
    fuzz_file_remove(&file);
    return 0;
}
