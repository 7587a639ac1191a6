/* SPDX-License-Identifier: MIT
 *
 * An entry of `lights`.
 */
#include "scenes/load.h"
#include "scenes/solids.h"

#include <math.h>
#include <stddef.h>

#define LIGHT(member) offsetof(struct neph_light, member)

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
    if (!(neph_vec3_length(light->axis) > 1e-9))
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

static const struct neph_field light_fields[] = {
    {"position_m", NEPH_THREE, LIGHT(position_m), "m", -NEPH_FAR_M, NEPH_FAR_M,
     .note = "of a point: lights have no size", .hash_name = "light_position_m"},
    {"intensity_w_per_sr", NEPH_THREE, LIGHT(intensity_w_per_sr), "W/sr", 0, 1e9,
     .note = "in all directions, or within the inner angle"},
    {"cone", NEPH_RECORD, .record = &cone_record, .standard = "all around",
     .hashing = NEPH_HASHED_IF_SET},
    {0},
};

const struct neph_record neph_light_record = {.size = sizeof(struct neph_light),
                                              .fields = light_fields};

static enum neph_status check_light(const struct neph_reader *reader,
                                    const struct neph_scene *scene, int index)
{
    for (int s = 0; s < scene->solid_count; s++)
        if (neph_solid_contains(&scene->solids[s], scene->lights[index].position_m))
            return neph_refuse(reader, neph_at("lights[%d].position_m", index).text,
                               "the light is inside a solid, which would hide all of it; move it "
                               "out");
    return NEPH_OK;
}

enum neph_status neph_check_lights(const struct neph_reader *reader, const struct neph_scene *scene)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < scene->light_count; i++)
        status = neph_also(reader, status, check_light(reader, scene, i));
    return status;
}
