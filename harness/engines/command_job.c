/* SPDX-License-Identifier: MIT */
#include "harness/engines/command_job.h"

#include "base/exr.h"
#include "base/files.h"
#include "base/threads.h"
#include "harness/engines/scene_json.h"
#include "scenes/motion.h"
#include "scenes/solids.h"

#include <stdlib.h>
#include <string.h>

/* ---- job.json -------------------------------------------------------------------------------- */

/* Exactly one of the last two keys is not 0, as in struct neph_camera. */
static json_t *camera_json(const struct neph_camera *camera)
{
    return json_pack(
        "{s:o, s:o, s:o, s:o, s:f, s:f}", "position_m", neph_vector_json(camera->position_m),
        "right", neph_vector_json(camera->right), "up", neph_vector_json(camera->up), "forward",
        neph_vector_json(camera->forward), "vertical_fov_rad", camera->vertical_fov_rad,
        "orthographic_height_m", camera->orthographic_height_m);
}

static json_t *settings_json(const struct neph_engine *engine, const struct neph_settings *settings)
{
    json_t *json = json_object();
    for (int i = 0; engine->options[i].name; i++)
        neph_json_set(&json, engine->options[i].name, json_real(settings->values[i]));
    return json;
}

/* An absolute path, because the program runs in another folder. */
static json_t *path_json(const char *path)
{
    char *absolute = realpath(path, NULL);
    json_t *json = absolute ? json_string(absolute) : NULL;
    free(absolute);
    return json;
}

static json_t *job_json(const struct neph_engine *engine, const struct neph_shot *shot, int picture)
{
    const struct neph_scene *scene = shot->scene;
    const struct neph_camera camera = neph_scene_camera(scene, shot->frame);
    const struct neph_sun sun = neph_scene_sun(scene, shot->frame);
    const double time_s = neph_scene_time_frame(scene, shot->frame) / scene->frame_rate_hz;
    json_t *json = json_pack("{s:s, s:s, s:o, s:[i, i], s:i, s:i, s:f, s:I}", "format",
                             NEPH_COMMAND_FORMAT, "scene", scene->name, "scene_file",
                             path_json(scene->path), "size_px", shot->width_px, shot->height_px,
                             "frame", shot->frame, "picture", picture, "time_s", time_s, "seed",
                             (json_int_t)shot->seed);
    neph_json_set(&json, "camera", camera_json(&camera));
    neph_json_set(&json, "sun", neph_sun_json(&sun));
    neph_json_set(&json, "lights", neph_lights_json(scene, shot->frame));
    neph_json_set(&json, "wind_displacement_m",
                  neph_vector_json(neph_scene_wind_displacement_m(scene, shot->frame)));
    neph_json_set(&json, "background_w_per_m2_sr", neph_colour_json(scene->background_w_per_m2_sr));
    neph_json_set(&json, "scattering", json_string(neph_scattering_name(scene->scattering)));
    neph_json_set(&json, "settings", settings_json(engine, &shot->settings));
    return json;
}

static enum neph_status write_json(const json_t *json, const char *folder, struct neph_diag *diag)
{
    char *path = neph_path_join(folder, "job.json");
    char *text = json ? json_dumps(json, JSON_INDENT(2)) : NULL;
    enum neph_status status = neph_json_check(json, diag);
    if (!status)
        status = path && text ? neph_file_write(path, text, strlen(text), diag)
                              : neph_fail_memory(diag);
    free(text);
    free(path);
    return status;
}

/* ---- depth.exr ------------------------------------------------------------------------------- */

struct depths {
    const struct neph_scene *scene;
    struct neph_camera camera;
    int width_px, height_px;
    float *depth_m;
};

static void fill_row(int row, void *context)
{
    const struct depths *depths = context;
    for (int column = 0; column < depths->width_px; column++) {
        const struct neph_pixel_ray ray = neph_camera_ray(&depths->camera, depths->width_px,
                                                          depths->height_px, column, row);
        const struct neph_hit hit = neph_scene_hit(depths->scene, ray.origin_m, ray.direction);
        depths->depth_m[(size_t)row * (size_t)depths->width_px + (size_t)column] =
            (float)(hit.t_m * neph_vec3_dot(ray.direction, depths->camera.forward));
    }
}

static enum neph_status write_depth(const struct neph_shot *shot, const char *folder,
                                    struct neph_diag *diag)
{
    struct neph_scene *still = NULL; /* the scene at the time of this frame, with solids in place */
    struct neph_image *image = NULL;
    enum neph_status status = neph_scene_at(shot->scene, shot->frame, &still, diag);
    if (status)
        return status;
    struct depths depths = {.scene = still,
                            .camera = neph_scene_camera(shot->scene, shot->frame),
                            .width_px = shot->width_px,
                            .height_px = shot->height_px};
    char *path = neph_path_join(folder, "depth.exr");
    status = path ? NEPH_OK : neph_fail_memory(diag);
    if (!status)
        status = neph_image_create(shot->width_px, shot->height_px, &image, diag);
    if (!status)
        status = neph_image_add_channel(image, "Z", &depths.depth_m, diag);
    if (!status)
        status = neph_parallel_rows(shot->height_px, fill_row, &depths, diag);
    if (!status)
        status = neph_exr_write_plain(path, image, diag);
    neph_image_destroy(image);
    neph_scene_destroy(still);
    free(path);
    return status;
}

enum neph_status neph_command_job_write(const struct neph_engine *engine,
                                        const struct neph_shot *shot, int picture,
                                        const char *folder, struct neph_diag *diag)
{
    json_t *json = job_json(engine, shot, picture);
    const enum neph_status status = write_json(json, folder, diag);
    json_decref(json);
    return status ? status : write_depth(shot, folder, diag);
}
