/* SPDX-License-Identifier: MIT
 *
 * An entry of `solids`: a box, a sphere, or a fence, which is many thin boxes. Meshes are in
 * load_mesh.c.
 */
#include "scenes/load_solids.h"
#include "scenes/hash_text.h"
#include "scenes/mesh.h"
#include "scenes/solids.h"

#include <stdlib.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");
_Static_assert(NEPH_SOLID_KIND_COUNT == 3, "a new kind");

/* The rows of solids hash a struct neph_solid, too. */
_Static_assert(offsetof(struct neph_written_solid, solid) == 0, "a solid comes first");

#define FENCE(member) offsetof(struct neph_written_solid, fence.member)
#define MOVER(member) offsetof(struct neph_mover, member)
#define KEY(member) offsetof(struct neph_solid_key, member)

/* --- Surfaces --- */

/* Cycles renders alpha^2 < 1e-7 as a mirror, which is a roughness of 0.0178. */
static const double smoothest = 0.02;

#define TEXTURE(member) NEPH_SOLID_AT(surface.texture.member)

static const char *const pattern_words[] = {"checker", "noise", NULL};

static const struct neph_field texture_fields[] = {
    {"pattern", NEPH_WORD, TEXTURE(pattern), .words = pattern_words},
    {"cell_m", NEPH_NUMBER, TEXTURE(cell_m), "m", 1e-3, 1e4,
     .note = "side of a square of it, or between values of noise"},
    {"albedo", NEPH_THREE, TEXTURE(other), "", 0, 1, .note = "where its value is 1",
     .hash_name = "other"},
    {"seed", NEPH_WHOLE, TEXTURE(seed), "", 0, 1e9, .note = "of noise", .standard = "0"},
    {0},
};
static const struct neph_record texture_record = {.fields = texture_fields};

/* --- Motion --- */

static const char *const axis_words[] = {"x", "y", "z", NULL};

static const struct neph_field key_fields[] = {
    {"frame", NEPH_NUMBER, KEY(frame), "", 0, 1e5, .note = "of the keys, see Time",
     .hash_name = "solid_key"},
    {"move_m", NEPH_THREE, KEY(move_m), "m", -NEPH_FAR_M, NEPH_FAR_M,
     .note = "from where it is built", .standard = "[0, 0, 0]"},
    {"turn_deg", NEPH_NUMBER, KEY(turn_rad), "degrees", -1e5, 1e5,
     .note = "from how it is built, by the right hand", .standard = "0", .hash_name = "turn_rad"},
    {0},
};
static const struct neph_record key_record = {.size = sizeof(struct neph_solid_key),
                                              .fields = key_fields};

static const struct neph_field motion_fields[] = {
    {"axis", NEPH_WORD, MOVER(axis), .note = "of turns, by the pivot", .words = axis_words,
     .standard = "`x`"},
    {"pivot_m", NEPH_THREE, MOVER(pivot_m), "m", -NEPH_FAR_M, NEPH_FAR_M,
     .note = "as it is built; it moves along", .standard = "[0, 0, 0]"},
    {"keys", NEPH_LIST, MOVER(keys), .note = "by ascending frames; linear in between",
     .is_ascending = true, .least = 1, .most = NEPH_SCENE_KEYS_MAX, .count_at = MOVER(key_count),
     .record = &key_record},
    {0},
};

/* Converts turns from degrees. */
static enum neph_status read_motion(struct neph_reader *reader, const yaml_node_t *node,
                                    const struct neph_record *record, void *target)
{
    struct neph_mover *mover = target;
    const enum neph_status status = neph_read_fields(reader, node, record->fields, target);
    for (int i = 0; i < mover->key_count && !status; i++)
        mover->keys[i].turn_rad *= NEPH_RAD_PER_DEG;
    return status;
}

const struct neph_record neph_motion_record = {.fields = motion_fields, .read = read_motion};

static const struct neph_field box_fields[] = {
    {"min_m", NEPH_THREE, NEPH_SOLID_AT(box.min_m), "m", -NEPH_FAR_M, NEPH_FAR_M,
     .note = "the lower corner", .hash_name = "box_min_m"},
    {"max_m", NEPH_THREE, NEPH_SOLID_AT(box.max_m), "m", -NEPH_FAR_M, NEPH_FAR_M,
     .note = "the upper corner", .hash_name = "box_max_m"},
    NEPH_SURFACE_FIELDS,
    {"texture", NEPH_RECORD, .record = &texture_record, .standard = "",
     .note = "on its faces, see Surfaces", .hashing = NEPH_HASHED_IF_SET},
    NEPH_MOTION_FIELD,
    {0},
};

static const struct neph_field sphere_fields[] = {
    {"center_m", NEPH_THREE, NEPH_SOLID_AT(center_m), "m", -NEPH_PLANET_M, NEPH_PLANET_M,
     .note = "of the ball", .hash_name = "sphere_center_m"},
    {"radius_m", NEPH_NUMBER, NEPH_SOLID_AT(radius_m), "m", 1e-4, NEPH_PLANET_M,
     .note = "a planet, too", .hash_name = "sphere_radius_m"},
    NEPH_SURFACE_FIELDS,
    NEPH_MOTION_FIELD,
    {0},
};

static const struct neph_field rails_fields[] = {
    {"heights_m", NEPH_NUMBERS, FENCE(rail_heights_m), "m", 0, 1e4, .least = 1,
     .most = NEPH_RAILS_MAX, .count_at = FENCE(rail_count)},
    {"width_m", NEPH_NUMBER, FENCE(rail_width_m), "m", 1e-4, 1e3, .note = "along Y"},
    {"depth_m", NEPH_NUMBER, FENCE(rail_depth_m), "m", 1e-4, 1e3,
     .note = "along Z, less than bar_depth_m"},
    {0},
};
static const struct neph_record rails_record = {.fields = rails_fields};

static const struct neph_field fence_fields[] = {
    {"origin_m", NEPH_THREE, FENCE(origin_m), "m", -NEPH_FAR_M, NEPH_FAR_M,
     .note = "the foot of the first bar; bars follow along +X"},
    {"bars", NEPH_WHOLE, FENCE(bars), "", 1, NEPH_SCENE_SOLIDS_MAX, .note = "in a row"},
    {"pitch_m", NEPH_NUMBER, FENCE(pitch_m), "m", 1e-3, 1e3, .note = "from bar to bar"},
    {"bar_width_m", NEPH_NUMBER, FENCE(bar_width_m), "m", 1e-4, 1e3, .note = "along X"},
    {"bar_depth_m", NEPH_NUMBER, FENCE(bar_depth_m), "m", 1e-4, 1e3, .note = "along Z"},
    {"height_m", NEPH_NUMBER, FENCE(height_m), "m", 1e-3, 1e4, .note = "of the bars"},
    {"rows", NEPH_WHOLE, FENCE(rows), "", 1, NEPH_SCENE_SOLIDS_MAX, .note = "along -Z",
     .standard = "1"},
    {"row_spacing_m", NEPH_NUMBER, FENCE(row_spacing_m), "m", 1e-3, 1e4,
     .standard = "needed by `rows`"},
    {"rails", NEPH_RECORD, .record = &rails_record, .standard = ""},
    {"albedo", NEPH_THREE, FENCE(albedo), "", 0, 1, .note = NEPH_ALBEDO_NOTE},
    NEPH_MOTION_FIELD,
    {0},
};

/* --- Reading --- */

static enum neph_status check_rails(const struct neph_reader *reader,
                                    const struct neph_fence *fence)
{
    if (fence->bars < 2)
        return neph_refuse(reader, "rails", "rails need at least two bars to join");
    if (fence->rail_depth_m >= fence->bar_depth_m)
        return neph_refuse(reader, "rails.depth_m",
                           "%g m must be below bar_depth_m, %g m, so that no two faces coincide",
                           fence->rail_depth_m, fence->bar_depth_m);
    double floor_m = 0.0;
    for (int i = 0; i < fence->rail_count; i++) {
        const double low_m = fence->rail_heights_m[i] - 0.5 * fence->rail_width_m;
        const double high_m = fence->rail_heights_m[i] + 0.5 * fence->rail_width_m;
        if (!(low_m > floor_m && high_m < fence->height_m))
            return neph_refuse(reader, neph_format_path("rails.heights_m[%d]", i).text,
                               "the rail spans %g to %g m; it must lie above %g m (the ground or "
                               "the rail before) and below the top of the bars, %g m",
                               low_m, high_m, floor_m, fence->height_m);
        floor_m = high_m;
    }
    return NEPH_OK;
}

static enum neph_status read_fence(struct neph_reader *reader, const yaml_node_t *node,
                                   const struct neph_record *record, void *target)
{
    const struct neph_fence *fence = &((struct neph_written_solid *)target)->fence;
    const enum neph_status status = neph_read_fields(reader, node, record->fields, target);
    if (status)
        return status;
    const bool has_rows = neph_reader_has(reader, node, "rows");
    const bool has_spacing = neph_reader_has(reader, node, "row_spacing_m");
    if (fence->bars > 1 && fence->bar_width_m >= fence->pitch_m)
        return neph_refuse(reader, "bar_width_m", "%g m leaves no gap at a pitch_m of %g m",
                           fence->bar_width_m, fence->pitch_m);
    if (has_spacing && !has_rows)
        return neph_refuse(reader, "row_spacing_m", "a spacing needs the key rows");
    if (has_rows && !has_spacing)
        return neph_refuse(reader, "rows", "rows need the key row_spacing_m");
    if (has_rows && fence->row_spacing_m <= fence->bar_depth_m)
        return neph_refuse(reader, "row_spacing_m",
                           "%g m leaves no gap between rows that are %g m deep",
                           fence->row_spacing_m, fence->bar_depth_m);
    return fence->rail_count > 0 ? check_rails(reader, fence) : NEPH_OK;
}

static const char surface_keys[] = "metalness roughness";

enum neph_status neph_check_surface(const struct neph_reader *reader, const yaml_node_t *node,
                                    const struct neph_surface *surface)
{
    if (surface->metalness == 0.0 && neph_reader_has(reader, node, "roughness"))
        return neph_refuse(reader, "roughness",
                           "roughness is of the metal's reflection, and there is no metal: give "
                           "metalness above 0, or leave roughness out");
    if (surface->roughness > 0.0 && surface->roughness < smoothest)
        return neph_refuse(reader, "roughness",
                           "%g is smoother than %g, at which other renderers take a metal for a "
                           "mirror: 0 is a mirror",
                           surface->roughness, smoothest);
    return NEPH_OK;
}

static enum neph_status read_box(struct neph_reader *reader, const yaml_node_t *node,
                                 const struct neph_record *record, void *target)
{
    struct neph_solid *solid = &((struct neph_written_solid *)target)->solid;
    enum neph_status status = neph_read_fields(reader, node, record->fields, target);
    solid->kind = NEPH_SOLID_BOX;
    if (neph_were_keys_read(reader, surface_keys))
        status = neph_keep_error(reader, status, neph_check_surface(reader, node, &solid->surface));
    if (neph_were_keys_read(reader, "min_m max_m"))
        status = neph_keep_error(reader, status, neph_check_extent(reader, "", &solid->box));
    return status;
}

static enum neph_status read_sphere(struct neph_reader *reader, const yaml_node_t *node,
                                    const struct neph_record *record, void *target)
{
    struct neph_solid *solid = &((struct neph_written_solid *)target)->solid;
    const enum neph_status status = neph_read_fields(reader, node, record->fields, target);
    solid->kind = NEPH_SOLID_SPHERE;
    return neph_were_keys_read(reader, surface_keys)
               ? neph_keep_error(reader, status, neph_check_surface(reader, node, &solid->surface))
               : status;
}

static const struct neph_record box_record = {.fields = box_fields, .read = read_box};
static const struct neph_record sphere_record = {.fields = sphere_fields, .read = read_sphere};
static const struct neph_record fence_record = {.fields = fence_fields, .read = read_fence};

static const struct neph_field solid_fields[] = {
    {"box", NEPH_RECORD, .record = &box_record, .standard = ""},
    {"sphere", NEPH_RECORD, .record = &sphere_record, .standard = ""},
    {"fence", NEPH_RECORD, .record = &fence_record, .standard = ""},
    {"mesh", NEPH_RECORD, .record = &neph_mesh_record, .standard = ""},
    {"height_field", NEPH_RECORD, .record = &neph_height_field_record, .standard = ""},
    {0},
};

static enum neph_status read_solid(struct neph_reader *reader, const yaml_node_t *node,
                                   const struct neph_record *record, void *target)
{
    return neph_read_choice(reader, node, record->fields, target, "a solid");
}

const struct neph_record neph_solid_record = {
    .size = sizeof(struct neph_written_solid), .fields = solid_fields, .read = read_solid};

/* --- Fences into bars --- */

/* A thin box around a centre line. */
static struct neph_solid thin_box(struct neph_vec3 center_m, struct neph_vec3 size_m,
                                  struct neph_rgb albedo)
{
    return (struct neph_solid){
        .kind = NEPH_SOLID_BOX,
        .box = {neph_vec3_along(center_m, size_m, -0.5), neph_vec3_along(center_m, size_m, 0.5)},
        .albedo = albedo,
        .thin = true,
    };
}

/* The foot of the row's first bar: rows are arranged along -Z, away from a default camera. */
static struct neph_vec3 row_foot(const struct neph_fence *fence, int row)
{
    struct neph_vec3 foot_m = fence->origin_m;
    if (row)
        foot_m.z -= row * fence->row_spacing_m;
    return foot_m;
}

static struct neph_solid fence_bar(const struct neph_fence *fence, int row, int bar)
{
    struct neph_vec3 center_m = row_foot(fence, row);
    center_m.x += bar * fence->pitch_m;
    center_m.y += 0.5 * fence->height_m;
    const struct neph_vec3 size_m = {fence->bar_width_m, fence->height_m, fence->bar_depth_m};
    struct neph_solid solid = thin_box(center_m, size_m, fence->albedo);
    solid.box.min_m.y = fence->origin_m.y; /* exactly on the ground */
    return solid;
}

/* From the centre of the first bar to the centre of the last: its ends are inside them. */
static struct neph_solid fence_rail(const struct neph_fence *fence, int row, int rail)
{
    const double length_m = (fence->bars - 1) * fence->pitch_m;
    struct neph_vec3 center_m = row_foot(fence, row);
    center_m.x += 0.5 * length_m;
    center_m.y += fence->rail_heights_m[rail];
    const struct neph_vec3 size_m = {length_m, fence->rail_width_m, fence->rail_depth_m};
    return thin_box(center_m, size_m, fence->albedo);
}

static struct neph_solid *append_fence(const struct neph_fence *fence, struct neph_solid *next)
{
    for (int row = 0; row < fence->rows; row++) {
        for (int bar = 0; bar < fence->bars; bar++)
            *next++ = fence_bar(fence, row, bar);
        for (int rail = 0; rail < fence->rail_count; rail++)
            *next++ = fence_rail(fence, row, rail);
    }
    return next;
}

static int count_parts(const struct neph_written_solid *written)
{
    const struct neph_fence *fence = &written->fence;
    if (written->solid.kind == NEPH_SOLID_MESH)
        return neph_count_instances(&written->mesh);
    return fence->bars > 0 ? fence->rows * (fence->bars + fence->rail_count) : 1;
}

static enum neph_status finish_movers(struct neph_reader *reader,
                                      struct neph_written_scene *written)
{
    struct neph_scene *scene = &written->scene;
    scene->movers = neph_arena_allocate(reader->arena, NEPH_SCENE_MOVERS_MAX,
                                        sizeof(*scene->movers));
    if (!scene->movers)
        return neph_fail_memory(reader->diag);
    for (int i = 0; i < written->solid_count; i++) {
        if (written->solids[i].mover.key_count == 0)
            continue;
        if (scene->mover_count == NEPH_SCENE_MOVERS_MAX)
            return neph_refuse(reader, neph_format_path("solids[%d]", i).text,
                               "no more than %d entries may move", NEPH_SCENE_MOVERS_MAX);
        scene->movers[scene->mover_count++] = written->solids[i].mover;
    }
    return NEPH_OK;
}

static const char *find_key(const struct neph_written_solid *written)
{
    if (written->solid.kind == NEPH_SOLID_MESH)
        return written->mesh.is_height_field ? "height_field" : "mesh";
    return written->solid.kind == NEPH_SOLID_BOX ? "box" : "sphere";
}

/* Runs after all keys were read, because it needs the scattering. */
static enum neph_status check_metals(const struct neph_reader *reader,
                                     const struct neph_written_scene *written)
{
    enum neph_status status = NEPH_OK;
    if (written->scene.scattering == NEPH_SCATTERING_MULTIPLE)
        return NEPH_OK;
    for (int i = 0; i < written->solid_count; i++) {
        const struct neph_solid *solid = &written->solids[i].solid;
        if (solid->surface.metalness > 0.0)
            status = neph_keep_error(
                reader, status,
                neph_refuse(
                    reader,
                    neph_format_path("solids[%d].%s.metalness", i, find_key(&written->solids[i]))
                        .text,
                    "a metal reflects other surfaces, and scattering is %s: "
                    "set scattering: multiple",
                    neph_scattering_name(written->scene.scattering)));
    }
    return status;
}

/* Adds up the solids of all entries; those of meshes have a limit of their own. */
static enum neph_status count_solids(const struct neph_reader *reader,
                                     const struct neph_written_scene *written, int *count)
{
    int counts[2] = {0, 0};
    for (int i = 0; i < written->solid_count; i++) {
        const bool is_mesh = written->solids[i].solid.kind == NEPH_SOLID_MESH;
        const int most = is_mesh ? NEPH_SCENE_INSTANCES_MAX : NEPH_SCENE_SOLIDS_MAX;
        counts[is_mesh] += count_parts(&written->solids[i]);
        if (counts[is_mesh] > most)
            return neph_refuse(
                reader, neph_format_path("solids[%d]", i).text,
                "the scene would have %d %s; at most %d are allowed", counts[is_mesh],
                is_mesh ? "instances of meshes" : "solids with its bars and rails", most);
    }
    *count = counts[0] + counts[1];
    return NEPH_OK;
}

static enum neph_status build_tree(struct neph_reader *reader, struct neph_scene *scene)
{
    const size_t bytes = neph_scene_tree_bytes(scene->solid_count);
    if (bytes == 0)
        return NEPH_OK;
    void *memory = neph_arena_allocate(reader->arena, 1, bytes);
    if (!memory)
        return neph_fail_memory(reader->diag);
    scene->solid_tree = neph_scene_tree_build(scene->solids, scene->solid_count, memory);
    return NEPH_OK;
}

static enum neph_status make_solids(struct neph_reader *reader, struct neph_written_scene *written)
{
    struct neph_scene *scene = &written->scene;
    struct neph_solid *next = scene->solids;
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < written->solid_count; i++) {
        struct neph_written_solid *entry = &written->solids[i];
        const int count = (int)(next - scene->solids);
        entry->mover.first = count;
        entry->mover.count = count_parts(entry);
        if (entry->fence.bars > 0)
            append_fence(&entry->fence, next);
        else if (entry->solid.kind != NEPH_SOLID_MESH)
            *next = entry->solid;
        else if (!status)
            status = neph_make_mesh_solids(reader, written, i, count);
        for (int part = 0; part < entry->mover.count; part++)
            next[part].moves = entry->mover.key_count > 1;
        next += entry->mover.count;
    }
    return status;
}

enum neph_status neph_finish_solids(struct neph_reader *reader, struct neph_written_scene *written)
{
    struct neph_scene *scene = &written->scene;
    int count = 0;
    enum neph_status status = check_metals(reader, written);
    if (!status)
        status = count_solids(reader, written, &count);
    if (status || count == 0)
        return status;
    scene->solids = neph_arena_allocate(reader->arena, (size_t)count, sizeof(*scene->solids));
    scene->meshes = neph_arena_allocate(reader->arena, (size_t)written->solid_count,
                                        sizeof(scene->meshes[0]));
    if (!scene->solids || !scene->meshes)
        return neph_fail_memory(reader->diag);
    status = make_solids(reader, written);
    if (status)
        return status;
    scene->solid_count = count;
    status = build_tree(reader, scene);
    return status ? status : finish_movers(reader, written);
}

/* --- Hash --- */

/* Nothing for a mesh of one colour: older hashes stay. */
static void hash_material(const struct neph_mesh_material *material, FILE *text)
{
    if (material->is_smooth)
        neph_put_number(text, "shading", 1);
    if (material->texture)
        neph_put_text(text, "albedo_texture", material->texture->hash);
    if (material->alpha != NEPH_ALPHA_IGNORED)
        neph_put_number(text, "alpha", material->alpha);
}

void neph_solids_hash(const struct neph_scene *scene, FILE *text)
{
    static const struct neph_field *const fields[NEPH_SOLID_KIND_COUNT] = {
        [NEPH_SOLID_BOX] = box_fields,
        [NEPH_SOLID_SPHERE] = sphere_fields,
        [NEPH_SOLID_MESH] = neph_mesh_fields};
    for (int i = 0; i < scene->solid_count; i++) {
        const struct neph_solid *solid = &scene->solids[i];
        neph_fields_hash(fields[solid->kind], solid, text);
        if (solid->kind == NEPH_SOLID_MESH) {
            neph_put_text(text, "mesh", solid->mesh->hash);
            neph_put_three(text, "yaw", solid->yaw.axis, solid->yaw.cosine, solid->yaw.sine);
            hash_material(&solid->mesh->material, text);
        }
        neph_put_number(text, "thin", scene->solids[i].thin); /* part of the masks of a frame */
    }
}

void neph_movers_hash(const struct neph_scene *scene, FILE *text)
{
    for (int i = 0; i < scene->mover_count; i++) {
        neph_put_number(text, "mover", scene->movers[i].first);
        neph_put_number(text, "count", scene->movers[i].count);
        neph_fields_hash(motion_fields, &scene->movers[i], text);
    }
}
