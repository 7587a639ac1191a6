/* SPDX-License-Identifier: MIT
 *
 * Frames, sun and wind from a scene file, and the checks of the finished scene over all of its
 * frames.
 */
#include "scenes/load.h"
#include "scenes/media.h"
#include "scenes/motion.h"
#include "scenes/solids.h"

#include <stddef.h>
#include <stdlib.h>

#define SCENE(member) offsetof(struct neph_scene, member)
#define WRITTEN(member) offsetof(struct neph_written_scene, member)
#define SUN_KEY(member) offsetof(struct neph_sun_key, member)
#define WIND_KEY(member) offsetof(struct neph_wind_key, member)

/* Two directions nearer to opposite than this have no unique great circle between them. */
#define OPPOSITE_SINE_MIN 1e-6
#define DRIFT_MAX_M NEPH_FAR_M /* the range in which a file may place a medium */

#define BRIGHT 1e9       /* a float32 pixel can represent the sum of 1e29 of them */
#define FAST_M_PER_S 1e5 /* a time lapse: 3 km per frame at 30 Hz */

/* --- Frames --- */

static const struct neph_field pause_fields[] = {
    {"frame", NEPH_WHOLE, offsetof(struct neph_pause, frame), "", 0, NEPH_KEY_FRAME_MAX,
     .note = "of the keys, not of the sequence", .hash_name = "pause"},
    {"count", NEPH_WHOLE, offsetof(struct neph_pause, count), "frames", 1, 10000,
     .note = "number of additional frames that show it"},
    {0},
};
static const struct neph_record pause_record = {.size = sizeof(struct neph_pause),
                                                .fields = pause_fields};

static const struct neph_field clear_fields[] = {
    {"frame", NEPH_WHOLE, offsetof(struct neph_clear, frame), "", 0, NEPH_KEY_FRAME_MAX,
     .note = "of the keys, the first without media", .hash_name = "clear"},
    {"count", NEPH_WHOLE, offsetof(struct neph_clear, count), "frames", 1, NEPH_KEY_FRAME_MAX,
     .note = "of the keys"},
    {0},
};
static const struct neph_record clear_record = {.size = sizeof(struct neph_clear),
                                                .fields = clear_fields};

static const struct neph_field size_fields[] = {
    {"frame", NEPH_WHOLE, offsetof(struct neph_frame_scale, frame), "", 0, NEPH_KEY_FRAME_MAX,
     .note = "the first frame of this size", .hash_name = "frame_scale"},
    {"scale", NEPH_NUMBER, offsetof(struct neph_frame_scale, scale), "", 0.05, 4,
     .note = "factor of the requested size"},
    {0},
};
static const struct neph_record size_record = {.size = sizeof(struct neph_frame_scale),
                                               .fields = size_fields};

static const struct neph_field frames_fields[] = {
    {"count", NEPH_WHOLE, SCENE(frame_count), "", 1, 10000, .standard = "1",
     .hash_name = "frame_count"},
    {"rate_hz", NEPH_NUMBER, SCENE(frame_rate_hz), "Hz", 0.001, 1000, .standard = "30",
     .hash_name = "frame_rate_hz"},
    {"pauses", NEPH_LIST, SCENE(pauses), .is_ascending = true, .least = 1,
     .most = NEPH_SCENE_KEYS_MAX, .count_at = SCENE(pause_count), .record = &pause_record,
     .standard = "none"},
    {"advance", NEPH_NUMBERS, SCENE(advances), "frames", 0, 1000,
     .note = "of the keys from frame to frame, in turn: frames at uneven times", .least = 1,
     .most = NEPH_SCENE_ADVANCES_MAX, .count_at = SCENE(advance_count), .standard = "[1]",
     .hash_name = "advance"},
    {"clear", NEPH_LIST, SCENE(clears), .note = "there are no media", .is_ascending = true,
     .least = 1, .most = NEPH_SCENE_KEYS_MAX, .count_at = SCENE(clear_count),
     .record = &clear_record, .standard = "none"},
    {"sizes", NEPH_LIST, SCENE(frame_scales), .is_ascending = true, .least = 1,
     .most = NEPH_SCENE_KEYS_MAX, .count_at = SCENE(frame_scale_count), .record = &size_record,
     .standard = "none"},
    {0},
};
const struct neph_record neph_frames_record = {.size = sizeof(struct neph_scene),
                                               .fields = frames_fields};

/* --- Sun --- */

static const struct neph_field sun_key_fields[] = {
    {"frame", NEPH_NUMBER, SUN_KEY(frame), "", 0, NEPH_KEY_FRAME_MAX,
     .note = "of the keys, see Time", .hash_name = "sun_key"},
    {"direction", NEPH_THREE, SUN_KEY(direction), "", -NEPH_FAR_M, NEPH_FAR_M,
     .note = "towards the sun"},
    {"irradiance_w_per_m2", NEPH_THREE, SUN_KEY(irradiance_w_per_m2), "W/m2", 0, BRIGHT,
     .note = "on a plane perpendicular to the direction"},
    {0},
};
static const struct neph_record sun_key_record = {.size = sizeof(struct neph_sun_key),
                                                  .fields = sun_key_fields};

static const struct neph_field sun_fields[] = {
    {"direction", NEPH_THREE, WRITTEN(sun.direction), "", -NEPH_FAR_M, NEPH_FAR_M,
     .note = "towards the sun; any length but 0", .standard = "needed, or `keys`",
     .hashing = NEPH_HASHED_AS_MADE},
    {"irradiance_w_per_m2", NEPH_THREE, WRITTEN(sun.irradiance_w_per_m2), "W/m2", 0, BRIGHT,
     .note = "on a plane perpendicular to the direction, per channel",
     .standard = "needed, or `keys`", .hashing = NEPH_HASHED_AS_MADE},
    {"keys", NEPH_LIST, SCENE(sun_keys),
     .note = "in place of both, by ascending frames; directions go along the great circle, so "
             "neighbours may not be opposite",
     .is_ascending = true, .least = 1, .most = NEPH_SCENE_KEYS_MAX,
     .count_at = SCENE(sun_key_count), .record = &sun_key_record, .standard = "none"},
    {0},
};

bool neph_has_great_circle(struct neph_vec3 a, struct neph_vec3 b)
{
    return neph_vec3_length(neph_vec3_add(neph_vec3_normalize(a), neph_vec3_normalize(b))) >=
           OPPOSITE_SINE_MIN;
}

static enum neph_status check_sun_key(const struct neph_reader *reader,
                                      const struct neph_sun_key *keys, int index)
{
    const struct neph_sun_key *key = &keys[index];
    const struct neph_path path = neph_format_path("keys[%d].direction", index);
    const enum neph_status status = neph_check_direction(reader, path.text, key->direction);
    if (status || index == 0)
        return status;
    if (neph_has_great_circle(key->direction, key[-1].direction))
        return NEPH_OK;
    return neph_refuse(reader, path.text,
                       "at frame %g the sun is opposite to its place at frame %g (sun.keys[%d]); "
                       "give a key between them, which defines its path",
                       key->frame, key[-1].frame, index - 1);
}

static enum neph_status read_sun(struct neph_reader *reader, const yaml_node_t *node,
                                 const struct neph_record *record, void *target)
{
    struct neph_written_scene *written = target;
    struct neph_scene *scene = &written->scene;
    enum neph_status status = neph_read_fields(reader, node, record->fields, target);
    if (!neph_were_keys_read(reader, "keys"))
        return status;
    const bool has_direction = neph_reader_has(reader, node, "direction");
    const bool has_irradiance = neph_reader_has(reader, node, "irradiance_w_per_m2");
    if (scene->sun_keys && (has_direction || has_irradiance))
        return neph_refuse(reader, "keys",
                           "give either keys or direction and irradiance_w_per_m2, not both");
    if (!scene->sun_keys && !(has_direction && has_irradiance) && neph_were_keys_read(reader, ""))
        return neph_refuse(reader, "", "give direction and irradiance_w_per_m2, or keys");
    scene->sun.present = true;
    if (!scene->sun_keys && has_direction && neph_were_keys_read(reader, "direction"))
        return neph_keep_error(reader, status,
                               neph_check_direction(reader, "direction", written->sun.direction));
    for (int i = 0; i < scene->sun_key_count; i++)
        status = neph_keep_error(reader, status, check_sun_key(reader, scene->sun_keys, i));
    return status;
}

const struct neph_record neph_sun_record = {
    .size = sizeof(struct neph_written_scene), .fields = sun_fields, .read = read_sun};

/* A single key is a static sun. */
void neph_finish_sun(struct neph_written_scene *written)
{
    struct neph_scene *scene = &written->scene;
    if (!scene->sun.present) {
        scene->sun.direction = (struct neph_vec3){0, 1, 0};
        return;
    }
    for (int i = 0; i < scene->sun_key_count; i++)
        scene->sun_keys[i].direction = neph_vec3_normalize(scene->sun_keys[i].direction);
    written->sun.direction = neph_vec3_normalize(written->sun.direction);
    const struct neph_sun_key first = scene->sun_keys ? scene->sun_keys[0] : written->sun;
    scene->sun = (struct neph_sun){true, first.direction, first.irradiance_w_per_m2};
    if (scene->sun_key_count > 1) {
        scene->sun = neph_scene_sun(scene, 0.0);
        return;
    }
    scene->sun_keys = NULL;
    scene->sun_key_count = 0;
}

/* --- Wind --- */

static const struct neph_field wind_key_fields[] = {
    {"frame", NEPH_NUMBER, WIND_KEY(frame), "", 0, NEPH_KEY_FRAME_MAX,
     .note = "of the keys, see Time", .hash_name = "wind_key"},
    {"velocity_m_per_s", NEPH_THREE, WIND_KEY(velocity_m_per_s), "m/s", -FAST_M_PER_S, FAST_M_PER_S,
     .note = "of media that drift, see Time"},
    {0},
};
static const struct neph_record wind_key_record = {.size = sizeof(struct neph_wind_key),
                                                   .fields = wind_key_fields};

static const struct neph_field wind_fields[] = {
    {"velocity_m_per_s", NEPH_THREE, WRITTEN(wind.velocity_m_per_s), "m/s", -FAST_M_PER_S,
     FAST_M_PER_S, .standard = "needed, or `keys`", .hashing = NEPH_HASHED_AS_MADE},
    {"keys", NEPH_LIST, SCENE(wind_keys),
     .note = "in its place, by ascending frames; linear in between", .is_ascending = true,
     .least = 1, .most = NEPH_SCENE_KEYS_MAX, .count_at = SCENE(wind_key_count),
     .record = &wind_key_record, .standard = "none"},
    {0},
};

static enum neph_status read_wind(struct neph_reader *reader, const yaml_node_t *node,
                                  const struct neph_record *record, void *target)
{
    struct neph_written_scene *written = target;
    struct neph_scene *scene = &written->scene;
    const enum neph_status status = neph_read_fields(reader, node, record->fields, target);
    if (status)
        return status;
    if (!scene->wind_keys == !neph_reader_has(reader, node, "velocity_m_per_s"))
        return neph_refuse(reader, "", "give exactly one of velocity_m_per_s, keys");
    if (scene->wind_keys)
        return NEPH_OK;
    scene->wind_keys = neph_arena_copy(reader->arena, &written->wind, sizeof(written->wind));
    scene->wind_key_count = 1;
    return neph_arena_check(reader->arena, reader->diag);
}

const struct neph_record neph_wind_record = {
    .size = sizeof(struct neph_written_scene), .fields = wind_fields, .read = read_wind};

/* --- In the finished scene --- */

/* A camera nearer to its target than this has no well-defined direction of view. */
#define VIEW_DISTANCE_MIN_M 1e-3
/* Sine of the smallest angle between the view and `up`: below it rounding of the input could turn
 * the image by any angle. */
#define VIEW_SINE_MIN 1e-6

/* Path in the file of the camera at a key frame: the last key not after it. */
static struct neph_path camera_path(const struct neph_reader *reader,
                                    const struct neph_scene *scene, double frame, const char *key)
{
    if (neph_document_find(reader->document, "camera.keys")->type != YAML_SEQUENCE_NODE)
        return neph_format_path("camera.%s", key);
    int index = 0;
    while (index + 1 < scene->camera_key_count && scene->camera_keys[index + 1].frame <= frame)
        index++;
    return neph_format_path("camera.keys[%d].%s", index, key);
}

/* Checks that the camera at a key frame is outside solids and has a direction of view. */
static enum neph_status check_view(const struct neph_reader *reader, const struct neph_scene *scene,
                                   double frame)
{
    const struct neph_camera_key key = neph_camera_key_at(scene, frame);
    const struct neph_vec3 view = neph_vec3_sub(key.look_at_m, key.position_m);
    const double distance_m = neph_vec3_length(view);
    if (distance_m < VIEW_DISTANCE_MIN_M)
        return neph_refuse(reader, camera_path(reader, scene, frame, "look_at_m").text,
                           "at frame %g the camera is %g m from the point it looks at; at least %g "
                           "m are needed",
                           frame, distance_m, VIEW_DISTANCE_MIN_M);
    const double sine = neph_vec3_length(neph_vec3_cross(view, scene->camera_up)) / distance_m;
    if (sine < VIEW_SINE_MIN)
        return neph_refuse(reader, camera_path(reader, scene, frame, "look_at_m").text,
                           "at frame %g the camera looks along its up direction; turn the view or "
                           "give another camera.up",
                           frame);
    for (int i = 0; i < scene->solid_count; i++) {
        const struct neph_solid solid = neph_scene_solid_at(scene, i, frame);
        if (neph_solid_contains(&solid, key.position_m))
            return neph_refuse(reader, camera_path(reader, scene, frame, "position_m").text,
                               "at frame %g the camera is inside a solid (number %d of the %d in "
                               "the scene, bars counted)",
                               frame, i + 1, scene->solid_count);
    }
    return NEPH_OK;
}

/* Checks that the wind moves a medium, and keeps it within the range of renderers. */
enum neph_status neph_check_wind(const struct neph_reader *reader, const struct neph_scene *scene)
{
    bool any = false;
    if (scene->wind_key_count == 0)
        return NEPH_OK;
    char forms[256] = "";
    for (int i = 0; i < scene->medium_count; i++)
        any |= neph_medium_drifts(&scene->media[i]);
    neph_list_drifting_forms(forms, sizeof(forms));
    if (!any)
        return neph_refuse(reader, "wind",
                           "no medium of the scene drifts: wind moves %smedia with voxels", forms);
    for (int frame = 0; frame < scene->frame_count; frame++) {
        const double displacement_m = neph_vec3_length(
            neph_scene_wind_displacement_m(scene, frame));
        if (displacement_m > DRIFT_MAX_M)
            return neph_refuse(
                reader, "wind",
                "at frame %d it has moved the media by %g m; at most %g m are allowed", frame,
                displacement_m, DRIFT_MAX_M);
    }
    return NEPH_OK;
}

enum neph_status neph_check_views(const struct neph_reader *reader, const struct neph_scene *scene)
{
    enum neph_status status = NEPH_OK;
    if (scene->advance_count > 0 && scene->pause_count > 0)
        return neph_refuse(reader, "frames.advance",
                           "give either advance, which may be 0, or pauses");
    for (int i = 0; i < scene->camera_key_count && !status; i++)
        status = check_view(reader, scene, scene->camera_keys[i].frame);
    for (int frame = 0; frame < scene->frame_count && !status; frame++)
        status = check_view(reader, scene, neph_scene_time_frame(scene, frame));
    return status;
}
