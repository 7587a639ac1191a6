/* SPDX-License-Identifier: MIT
 *
 * The scene in memory: its end, its names and its camera.
 */
#include "scenes/scene.h"
#include "scenes/build.h"
#include "scenes/media.h"
#include "scenes/motion.h"

#include <stdlib.h>

void neph_scene_destroy(struct neph_scene *scene)
{
    if (!scene)
        return;
    if (scene->borrows) {
        free(scene);
        return;
    }
    for (int i = 0; i < scene->gate_count; i++) {
        free(scene->gates[i].engine);
        free(scene->gates[i].metric);
        free(scene->gates[i].mask);
        free(scene->gates[i].reason);
    }
    free(scene->gates);
    for (int i = 0; i < scene->medium_count; i++) {
        neph_medium_finish(&scene->media[i]);
    }
    free(scene->solids);
    free(scene->wind_keys);
    free(scene->sun_keys);
    free(scene->frame_scales);
    free(scene->pauses);
    free(scene->camera_keys);
    free(scene->physics);
    free(scene->title);
    free(scene->name);
    free(scene->path);
    free(scene);
}

static const char *const scattering_names[] = {
    [NEPH_SCATTERING_NONE] = "none",
    [NEPH_SCATTERING_SINGLE] = "single",
    [NEPH_SCATTERING_MULTIPLE] = "multiple",
};

static const char *const quantity_names[] = {
    [NEPH_QUANTITY_RADIANCE] = "radiance",
    [NEPH_QUANTITY_TRANSMITTANCE] = "transmittance",
    [NEPH_QUANTITY_DEPTH] = "depth",
};

const char *neph_scattering_name(enum neph_scattering scattering)
{
    return scattering_names[scattering];
}

const char *neph_gate_quantity_name(enum neph_gate_quantity quantity)
{
    return quantity_names[quantity];
}

struct neph_camera neph_scene_camera(const struct neph_scene *scene, double frame)
{
    struct neph_camera_key key = neph_camera_key_at(scene, neph_scene_time_frame(scene, frame));
    struct neph_camera camera = {.position_m = key.position_m,
                                 .vertical_fov_rad = scene->vertical_fov_rad};
    camera.forward = neph_vec3_normalize(neph_vec3_sub(key.look_at_m, key.position_m));
    camera.right = neph_vec3_normalize(neph_vec3_cross(camera.forward, scene->camera_up));
    camera.up = neph_vec3_cross(camera.right, camera.forward);
    return camera;
}

/* Image plane at distance 1: half its height is tan(fov/2); square pixels. Blender and POV-Ray
 * were measured to use the same rays. */
struct neph_vec3 neph_camera_ray(const struct neph_camera *camera, int width_px, int height_px,
                                 double i, double j)
{
    double half_height = tan(0.5 * camera->vertical_fov_rad);
    double half_width = half_height * width_px / height_px;
    double x = (2.0 * (i + 0.5) / width_px - 1.0) * half_width;
    double y = (1.0 - 2.0 * (j + 0.5) / height_px) * half_height;
    struct neph_vec3 ray = neph_vec3_along(camera->forward, camera->right, x);
    return neph_vec3_normalize(neph_vec3_along(ray, camera->up, y));
}
