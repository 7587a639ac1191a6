/* SPDX-License-Identifier: MIT
 *
 * An entry of `lights`.
 */
#include "scenes/load.h"
#include "scenes/motion.h"
#include "scenes/solids.h"

#include <math.h>
#include <stddef.h>

#define LIGHT(member) offsetof(struct neph_light, member)
#define KEY(member) offsetof(struct neph_light_key, member)

#define BRIGHT 1e9    /* a float32 pixel can represent the sum of 1e29 of them */
#define AXIS_MIN 1e-9 /* a shorter axis is taken for 0 */

static const struct neph_field cone_fields[] = {
    {"axis", NEPH_THREE, LIGHT(axis), "", -1e6, 1e6,
     .note = "from the light; its length does not matter"},
    {"inner_deg", NEPH_NUMBER, LIGHT(inner_cosine), "degrees", 0, 179,
     .note = "from the axis; full intensity up to here", .hash_name = "inner_cosine"},
    {"outer_deg", NEPH_NUMBER, LIGHT(outer_cosine), "degrees", 0.1, 179.9,
     .note = "0 from here on; smoothstep of the cosine between", .hash_name = "outer_cosine"},
    {0},
};

/* Reads the cone in degrees, then converts it to the form of struct neph_light. */
static enum neph_status read_cone(struct neph_reader *reader, const yaml_node_t *node,
                                  const struct neph_record *record, void *target)
{
    struct neph_light *light = target;
    const enum neph_status status = neph_read_fields(reader, node, record->fields, target);
    const double inner_deg = light->inner_cosine, outer_deg = light->outer_cosine;
    if (status)
        return status;
    if (!(neph_vec3_length(light->axis) > AXIS_MIN))
        return neph_refuse(reader, "axis", "an axis has a length; this one is 0");
    /* In single precision a narrower edge could not be distinguished from a step. */
    if (!(outer_deg >= inner_deg + 0.1))
        return neph_refuse(reader, "outer_deg",
                           "%g degrees must be inner_deg, %g, plus 0.1 or more", outer_deg,
                           inner_deg);
    light->is_spot = true;
    light->axis = neph_vec3_normalize(light->axis);
    light->inner_cosine = cos(inner_deg * NEPH_RAD_PER_DEG);
    light->outer_cosine = cos(outer_deg * NEPH_RAD_PER_DEG);
    return NEPH_OK;
}

static const struct neph_record cone_record = {
    .size = sizeof(struct neph_light), .fields = cone_fields, .read = read_cone};

/* --- Keys --- */

static const struct neph_field key_fields[] = {
    {"frame", NEPH_NUMBER, KEY(frame), "", 0, NEPH_KEY_FRAME_MAX, .note = "of the keys, see Time",
     .hash_name = "light_key"},
    {"position_m", NEPH_THREE, KEY(position_m), "m", -NEPH_FAR_M, NEPH_FAR_M},
    {"intensity_w_per_sr", NEPH_THREE, KEY(intensity_w_per_sr), "W/sr", 0, BRIGHT,
     .note = "0 0 0: the light is off"},
    {"axis", NEPH_THREE, KEY(axis), "", -1e6, 1e6, .note = "of a cone, in place of its axis",
     .standard = "the cone's"},
    {"cut", NEPH_FLAG, KEY(cut),
     .note = "the light stays at the key before and jumps; so it goes on or off in one frame",
     .standard = "`false`", .hashing = NEPH_HASHED_IF_SET},
    {0},
};

static enum neph_status read_key(struct neph_reader *reader, const yaml_node_t *node,
                                 const struct neph_record *record, void *target)
{
    const struct neph_light_key *key = target;
    const enum neph_status status = neph_read_fields(reader, node, record->fields, target);
    if (status || !neph_reader_has(reader, node, "axis") || neph_vec3_length(key->axis) > AXIS_MIN)
        return status;
    return neph_refuse(reader, "axis", "an axis has a length; this one is 0");
}

static const struct neph_record key_record = {
    .size = sizeof(struct neph_light_key), .fields = key_fields, .read = read_key};

static enum neph_status check_key_axis(const struct neph_reader *reader,
                                       const struct neph_light *light, int index)
{
    const struct neph_light_key *key = &light->keys[index];
    const struct neph_path path = neph_format_path("keys[%d].axis", index);
    if (!light->is_spot && neph_vec3_length(key->axis) > 0.0)
        return neph_refuse(reader, path.text, "a light without a cone has no axis: give it a cone");
    if (index == 0 || key->cut || !light->is_spot || neph_has_great_circle(key->axis, key[-1].axis))
        return NEPH_OK;
    return neph_refuse(
        reader, path.text,
        "at frame %g the axis is opposite to the axis at frame %g (keys[%d]); give a "
        "key between them, which defines its path, or a cut",
        key->frame, key[-1].frame, index - 1);
}

/* Sets the axes of keys without one, the light of frame 0, and one key as a static light. */
static enum neph_status finish_keys(const struct neph_reader *reader, struct neph_light *light)
{
    enum neph_status status = NEPH_OK;
    if (light->keys[0].cut)
        return neph_refuse(reader, "keys[0].cut", "the first key has none before it to cut from");
    for (int i = 0; i < light->key_count; i++) {
        struct neph_light_key *key = &light->keys[i];
        if (light->is_spot)
            key->axis = neph_vec3_length(key->axis) > 0.0 ? neph_vec3_normalize(key->axis)
                                                          : light->axis;
        status = neph_keep_error(reader, status, check_key_axis(reader, light, i));
    }
    const struct neph_light first = neph_place_light(light, 0.0);
    if (light->key_count > 1) {
        light->position_m = first.position_m;
        light->intensity_w_per_sr = first.intensity_w_per_sr;
        light->axis = first.axis;
    } else {
        *light = first;
    }
    return status;
}

/* --- Lights --- */

static const struct neph_field light_fields[] = {
    {"position_m", NEPH_THREE, LIGHT(position_m), "m", -NEPH_FAR_M, NEPH_FAR_M,
     .note = "of a point: lights have no size", .standard = "needed, or `keys`",
     .hash_name = "light_position_m"},
    {"intensity_w_per_sr", NEPH_THREE, LIGHT(intensity_w_per_sr), "W/sr", 0, BRIGHT,
     .note = "in all directions, or within the inner angle", .standard = "needed, or `keys`"},
    {"cone", NEPH_RECORD, .record = &cone_record, .standard = "all around",
     .hashing = NEPH_HASHED_IF_SET},
    {"keys", NEPH_LIST, LIGHT(keys),
     .note = "in place of both, by ascending frames; linear in between, the axis along the great "
             "circle",
     .is_ascending = true, .least = 1, .most = NEPH_SCENE_KEYS_MAX, .count_at = LIGHT(key_count),
     .record = &key_record, .standard = "none"},
    {0},
};

static enum neph_status read_light(struct neph_reader *reader, const yaml_node_t *node,
                                   const struct neph_record *record, void *target)
{
    struct neph_light *light = target;
    const enum neph_status status = neph_read_fields(reader, node, record->fields, target);
    const bool has_position = neph_reader_has(reader, node, "position_m");
    const bool has_intensity = neph_reader_has(reader, node, "intensity_w_per_sr");
    if (status)
        return status;
    if (light->keys && (has_position || has_intensity))
        return neph_refuse(reader, "keys",
                           "give either keys or position_m and intensity_w_per_sr, not both");
    if (!light->keys && !(has_position && has_intensity))
        return neph_refuse(reader, "", "give position_m and intensity_w_per_sr, or keys");
    return light->keys ? finish_keys(reader, light) : NEPH_OK;
}

const struct neph_record neph_light_record = {
    .size = sizeof(struct neph_light), .fields = light_fields, .read = read_light};

/* --- In the finished scene --- */

static bool is_hidden(const struct neph_scene *scene, struct neph_vec3 point_m, double key_frame)
{
    for (int s = 0; s < scene->solid_count; s++) {
        const struct neph_solid solid = neph_scene_solid_at(scene, s, key_frame);
        if (neph_solid_contains(&solid, point_m))
            return true;
    }
    return false;
}

static enum neph_status check_light(const struct neph_reader *reader,
                                    const struct neph_scene *scene, int index)
{
    for (int s = 0; s < scene->solid_count; s++)
        if (neph_solid_contains(&scene->solids[s], scene->lights[index].position_m))
            return neph_refuse(reader, neph_format_path("lights[%d].position_m", index).text,
                               "the light is inside a solid, which would hide all of it; move it "
                               "out");
    return NEPH_OK;
}

static enum neph_status check_moving_light(const struct neph_reader *reader,
                                           const struct neph_scene *scene, int index)
{
    const struct neph_light *light = &scene->lights[index];
    for (int frame = 0; frame < scene->frame_count; frame++) {
        const double key_frame = neph_scene_time_frame(scene, frame);
        if (!is_hidden(scene, neph_place_light(light, key_frame).position_m, key_frame))
            continue;
        const int key =
            neph_span_at(light->keys, sizeof(*light->keys), light->key_count, key_frame).from;
        return neph_refuse(reader,
                           neph_format_path("lights[%d].keys[%d].position_m", index, key).text,
                           "at frame %g the light is inside a solid, which would hide all of it; "
                           "move it out",
                           key_frame);
    }
    return NEPH_OK;
}

enum neph_status neph_check_lights(const struct neph_reader *reader, const struct neph_scene *scene)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < scene->light_count; i++)
        status = neph_keep_error(
            reader, status,
            (scene->lights[i].key_count > 0 ? check_moving_light : check_light)(reader, scene, i));
    return status;
}
