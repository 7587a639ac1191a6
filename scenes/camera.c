/* SPDX-License-Identifier: MIT
 *
 * The camera: its keys in a scene file, the camera of a frame and the rays of its pixels. To add a
 * field, add a member in scenes/scene.h and a row here, which reads it, hashes it and writes it
 * into variants of the file.
 */
#include "scenes/keys.h"
#include "scenes/load.h"

#include <math.h>
#include <stddef.h>

#define SCENE(member) offsetof(struct neph_scene, member)
#define WRITTEN(member) offsetof(struct neph_written_scene, member)
#define CAMERA_KEY(member) offsetof(struct neph_camera_key, member)

/* --- in a scene file ------------------------------------------------------------------------- */

const struct neph_field neph_camera_key_fields[] = {
    {"frame", NEPH_NUMBER, CAMERA_KEY(frame), "", 0, NEPH_KEY_FRAME_MAX,
     .note = "of the keys, see Time", .hash_name = "camera_key"},
    {"position_m", NEPH_THREE, CAMERA_KEY(position_m), "m", -NEPH_FAR_M, NEPH_FAR_M,
     .note = "of the camera"},
    {"look_at_m", NEPH_THREE, CAMERA_KEY(look_at_m), "m", -NEPH_FAR_M, NEPH_FAR_M,
     .note = "at the centre of the frame"},
    {"cut", NEPH_FLAG, CAMERA_KEY(cut), .note = "the camera stays at the key before and jumps",
     .standard = "`false`", .hashing = NEPH_HASHED_IF_SET},
    {0},
};
static const struct neph_record camera_key_record = {.size = sizeof(struct neph_camera_key),
                                                     .fields = neph_camera_key_fields};

static const struct neph_field camera_fields[] = {
    {"position_m", NEPH_THREE, WRITTEN(camera.position_m), "m", -NEPH_FAR_M, NEPH_FAR_M,
     .standard = "needed, or `keys`", .hashing = NEPH_HASHED_AS_MADE},
    {"look_at_m", NEPH_THREE, WRITTEN(camera.look_at_m), "m", -NEPH_FAR_M, NEPH_FAR_M,
     .standard = "needed, or `keys`", .hashing = NEPH_HASHED_AS_MADE},
    {"keys", NEPH_LIST, SCENE(camera_keys),
     .note = "in place of both, by ascending frames; linear in between", .is_ascending = true,
     .least = 1, .most = NEPH_SCENE_KEYS_MAX, .count_at = SCENE(camera_key_count),
     .record = &camera_key_record, .standard = "none"},
    {"up", NEPH_THREE, SCENE(camera_up), "", -NEPH_FAR_M, NEPH_FAR_M, .standard = "[0, 1, 0]"},
    {"vertical_fov_deg", NEPH_NUMBER, SCENE(vertical_fov_rad), "degrees", 0.1, 170,
     .note = "from the lower edge to the upper", .standard = "needed, or `orthographic_height_m`",
     .hash_name = "vertical_fov_rad"},
    {"orthographic_height_m", NEPH_NUMBER, SCENE(orthographic_height_m), "m", 1e-3, NEPH_FAR_M,
     .note = "in place of it: parallel rays, the frame's height at any distance",
     .standard = "none", .hashing = NEPH_HASHED_IF_SET},
    {0},
};

static enum neph_status make_camera_key(struct neph_written_scene *written, struct neph_diag *diag)
{
    written->scene.camera_keys = neph_arena_copy(&written->scene.arena, &written->camera,
                                                 sizeof(written->camera));
    written->scene.camera_key_count = 1;
    return neph_arena_check(&written->scene.arena, diag);
}

static enum neph_status check_place(const struct neph_reader *reader, const yaml_node_t *node,
                                    const struct neph_scene *scene)
{
    const bool has_position = neph_reader_has(reader, node, "position_m");
    const bool has_target = neph_reader_has(reader, node, "look_at_m");
    if (scene->camera_keys && (has_position || has_target))
        return neph_refuse(reader, "keys",
                           "give either keys or position_m and look_at_m, not both");
    if (!scene->camera_keys && !(has_position && has_target))
        return neph_refuse(reader, "", "give position_m and look_at_m, or keys");
    if (scene->camera_keys && scene->camera_keys[0].cut)
        return neph_refuse(reader, "keys[0].cut", "the first key has none before it to cut from");
    return NEPH_OK;
}

static enum neph_status check_lens(const struct neph_reader *reader, const yaml_node_t *node,
                                   const struct neph_scene *scene)
{
    if (neph_reader_has(reader, node, "vertical_fov_deg") ==
        neph_reader_has(reader, node, "orthographic_height_m"))
        return neph_refuse(reader, "", "give either vertical_fov_deg or orthographic_height_m");
    if (scene->orthographic_height_m > 0.0 && scene->camera_key_count > 1)
        return neph_refuse(
            reader, "keys",
            "an orthographic camera is static: motion vectors support only perspective cameras");
    return NEPH_OK;
}

static enum neph_status read_camera(struct neph_reader *reader, const yaml_node_t *node,
                                    const struct neph_record *record, void *target)
{
    struct neph_written_scene *written = target;
    struct neph_scene *scene = &written->scene;
    enum neph_status status = neph_read_fields(reader, node, record->fields, target);
    const bool has_place = neph_is_sound(reader, "position_m look_at_m keys");
    const bool has_lens = neph_is_sound(reader, "vertical_fov_deg orthographic_height_m keys");
    const bool has_up = neph_is_sound(reader, "up");
    if (has_place)
        status = neph_also(reader, status, check_place(reader, node, scene));
    if (has_lens)
        status = neph_also(reader, status, check_lens(reader, node, scene));
    if (has_up)
        status = neph_also(reader, status, neph_check_direction(reader, "up", scene->camera_up));
    if (!status && !scene->camera_keys)
        status = make_camera_key(written, reader->diag);
    scene->camera_up = neph_vec3_normalize(scene->camera_up);
    scene->vertical_fov_rad *= NEPH_RAD_PER_DEG;
    return status;
}

const struct neph_record neph_camera_record = {
    .size = sizeof(struct neph_written_scene), .fields = camera_fields, .read = read_camera};

/* --- in a frame ------------------------------------------------------------------------------ */

struct neph_camera_key neph_camera_key_at(const struct neph_scene *scene, double key_frame)
{
    const struct neph_camera_key *keys = scene->camera_keys;
    const struct neph_span span = neph_span_at(keys, sizeof(*keys), scene->camera_key_count,
                                               key_frame);
    const struct neph_camera_key *a = &keys[span.from], *b = &keys[span.to];
    const double part = b->cut ? 0.0 : span.part;
    return (struct neph_camera_key){
        .frame = key_frame,
        .position_m = neph_mix(a->position_m, b->position_m, part),
        .look_at_m = neph_mix(a->look_at_m, b->look_at_m, part),
    };
}

struct neph_camera neph_scene_camera(const struct neph_scene *scene, double frame)
{
    struct neph_camera_key key = neph_camera_key_at(scene, neph_scene_time_frame(scene, frame));
    struct neph_camera camera = {.position_m = key.position_m,
                                 .vertical_fov_rad = scene->vertical_fov_rad,
                                 .orthographic_height_m = scene->orthographic_height_m};
    camera.forward = neph_vec3_normalize(neph_vec3_sub(key.look_at_m, key.position_m));
    camera.right = neph_vec3_normalize(neph_vec3_cross(camera.forward, scene->camera_up));
    camera.up = neph_vec3_cross(camera.right, camera.forward);
    return camera;
}

double neph_camera_half_height(const struct neph_camera *camera)
{
    return camera->orthographic_height_m > 0.0 ? 0.5 * camera->orthographic_height_m
                                               : tan(0.5 * camera->vertical_fov_rad);
}

/* Pixels are square. Measurements showed the same rays in Blender and POV-Ray. */
struct neph_pixel_ray neph_camera_ray(const struct neph_camera *camera, int width_px, int height_px,
                                      double i, double j)
{
    const bool is_parallel = camera->orthographic_height_m > 0.0;
    const double half_height = neph_camera_half_height(camera);
    const double half_width = half_height * width_px / height_px;
    const double x = (2.0 * (i + 0.5) / width_px - 1.0) * half_width;
    const double y = (1.0 - 2.0 * (j + 0.5) / height_px) * half_height;
    const struct neph_vec3 middle = is_parallel ? camera->position_m : camera->forward;
    const struct neph_vec3 place = neph_vec3_along(neph_vec3_along(middle, camera->right, x),
                                                   camera->up, y);
    if (is_parallel)
        return (struct neph_pixel_ray){place, camera->forward};
    return (struct neph_pixel_ray){camera->position_m, neph_vec3_normalize(place)};
}

bool neph_camera_find_pixel(const struct neph_camera *camera, int width_px, int height_px,
                            struct neph_vec3 point_m, struct neph_point_in_frame *found)
{
    const bool is_parallel = camera->orthographic_height_m > 0.0;
    const struct neph_vec3 way_m = neph_vec3_sub(point_m, camera->position_m);
    const double depth_m = neph_vec3_dot(way_m, camera->forward);
    if (!is_parallel && !(depth_m > 0.0))
        return false;
    const double half_height = neph_camera_half_height(camera);
    const double half_width = half_height * width_px / height_px;
    const double scale = is_parallel ? 1.0 : 1.0 / depth_m;
    const double x = neph_vec3_dot(way_m, camera->right) * scale / half_width;
    const double y = neph_vec3_dot(way_m, camera->up) * scale / half_height;
    *found = (struct neph_point_in_frame){0.5 * (1.0 + x) * width_px - 0.5,
                                          0.5 * (1.0 - y) * height_px - 0.5, depth_m};
    return true;
}
