/* SPDX-License-Identifier: MIT
 *
 * Entries `mesh` and `height_field` of `solids`: one mesh, and its solids, which share it.
 */
#include "scenes/errors.h"
#include "scenes/height_field.h"
#include "scenes/load_solids.h"
#include "scenes/mesh.h"
#include "scenes/mesh_file.h"
#include "scenes/resolve_path.h"
#include "scenes/solids.h"

#include <errno.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define MESH(member) offsetof(struct neph_written_solid, mesh.member)
#define INSTANCE(member) offsetof(struct neph_instance, member)
#define SCATTER(member) offsetof(struct neph_scatter, member)

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_ALPHA_COUNT == 3, "a new kind");

static const char *const ups[] = {"y", "z", NULL};
static const char *const shadings[] = {"flat", "smooth", NULL};
static const char *const alphas[] = {"ignored", "cutout", "coverage", NULL};

static const struct neph_field instance_fields[] = {
    {"position_m", NEPH_THREE, INSTANCE(position_m), "m", -NEPH_FAR_M, NEPH_FAR_M,
     .note = "of the file's origin"},
    {"turn_deg", NEPH_NUMBER, INSTANCE(turn_deg), "degrees", -1e5, 1e5,
     .note = "about y, added to that of the mesh", .standard = "0"},
    {"scale", NEPH_NUMBER, INSTANCE(scale), "", 1e-3, 1e3, .note = "times `scale_m`",
     .standard = "1"},
    {0},
};
static const struct neph_record instance_record = {.size = sizeof(struct neph_instance),
                                                   .fields = instance_fields};

static const struct neph_field scatter_fields[] = {
    {"count", NEPH_WHOLE, SCATTER(count), "", 1, NEPH_SCENE_INSTANCES_MAX,
     .note = "instances at random places, with random turns about y"},
    {"seed", NEPH_WHOLE, SCATTER(seed), "", 0, 1e9, .note = "another seed, other places",
     .standard = "0"},
    {"x_m", NEPH_NUMBERS, SCATTER(x_m), "m", -NEPH_FAR_M, NEPH_FAR_M, .least = 2, .most = 2,
     .count_at = SCATTER(x_count), .note = "between these two"},
    {"z_m", NEPH_NUMBERS, SCATTER(z_m), "m", -NEPH_FAR_M, NEPH_FAR_M, .least = 2, .most = 2,
     .count_at = SCATTER(z_count), .note = "between these two"},
    {"scale", NEPH_NUMBERS, SCATTER(scale), "", 1e-3, 1e3, .least = 2, .most = 2,
     .count_at = SCATTER(scale_count), .note = "between these two, times `scale_m`",
     .standard = "1"},
    {"height_m", NEPH_NUMBER, SCATTER(height_m), "m", -NEPH_FAR_M, NEPH_FAR_M,
     .note = "of the file's origin", .standard = "0"},
    {"on_ground", NEPH_FLAG, SCATTER(on_ground),
     .note =
         "the file's origin is on the highest solid of the entries before, in place of a height",
     .standard = "`false`"},
    {0},
};
static const struct neph_record scatter_record = {.fields = scatter_fields};

#define TEXTURE_FIELDS                                                                             \
    {"albedo_texture",     NEPH_TEXT,                                                              \
     MESH(albedo_texture), .least = 1,                                                             \
     .most = 1000,         .note = "a .png in the scene file's folder or below, times `albedo`",   \
     .standard = "none",   .hashing = NEPH_HASHED_AS_MADE},                                        \
    {                                                                                              \
        "alpha", NEPH_WORD, MESH(alpha),                                                           \
            .words = alphas,                                                                       \
            .note =                                                                                \
                "of the texture; cutout: nothing is there where it is below 1/2; coverage: the "   \
                "part of rays that meet it",                                                       \
            .standard = "ignored", .hashing = NEPH_HASHED_AS_MADE                                  \
    }

const struct neph_field neph_mesh_fields[] = {
    {"file", NEPH_TEXT, MESH(file), .least = 1, .most = 1000,
     .note = ".obj, .ply, .gltf or .glb; absolute, from the scene file on, or $NAME or $NAME/... "
             "from the environment",
     .hashing = NEPH_HASHED_AS_MADE},
    {"object", NEPH_TEXT, MESH(object), .least = 1, .most = 200,
     .note = "only the object, group or node of this name", .standard = "all",
     .hashing = NEPH_HASHED_AS_MADE},
    {"up", NEPH_WORD, MESH(up), .words = ups,
     .note = "the file's axis that points up; z: (x, y, z) of the file becomes (x, z, -y)",
     .standard = "y", .hashing = NEPH_HASHED_AS_MADE},
    {"position_m", NEPH_THREE, NEPH_SOLID_AT(center_m), "m", -NEPH_FAR_M, NEPH_FAR_M,
     .note = "of the file's origin", .standard = "[0, 0, 0]", .hash_name = "mesh_m"},
    {"turn_deg", NEPH_NUMBER, MESH(turn_deg), "degrees", -1e5, 1e5,
     .note = "about y, by the right hand", .standard = "0", .hashing = NEPH_HASHED_AS_MADE},
    {"scale_m", NEPH_NUMBER, NEPH_SOLID_AT(scale_m), "m", 1e-6, 1e6,
     .note = "the file's unit of length; 0.01 where it is a centimetre", .standard = "1"},
    {"instances", NEPH_LIST, MESH(instances), .most = NEPH_SCENE_INSTANCES_MAX,
     .count_at = MESH(instance_count), .record = &instance_record,
     .note = "places of the same mesh, instead of `position_m`", .standard = "one",
     .hashing = NEPH_HASHED_AS_MADE},
    {"scatter", NEPH_RECORD, MESH(scatter), .record = &scatter_record,
     .note = "random places, instead of a list", .standard = "", .hashing = NEPH_HASHED_AS_MADE},
    {"shading", NEPH_WORD, MESH(shading), .words = shadings,
     .note = "smooth: light is reflected by the normals of the file's vertices", .standard = "flat",
     .hashing = NEPH_HASHED_AS_MADE},
    TEXTURE_FIELDS,
    {"memory_limit_mib", NEPH_WHOLE, MESH(memory_limit_mib), "MiB", 1, 8192,
     .note = "of each file, of the mesh and of the texture", .standard = "512",
     .hashing = NEPH_HASHED_AS_MADE},
    NEPH_SURFACE_FIELDS,
    NEPH_MOTION_FIELD,
    {0},
};

static const struct neph_field height_field_fields[] = {
    {"file", NEPH_TEXT, MESH(file), .least = 1, .most = 1000,
     .note = "a 16-bit grey .png, or an .exr; rows go along +z, columns along +x; a path as that "
             "of a mesh",
     .hashing = NEPH_HASHED_AS_MADE},
    {"channel", NEPH_TEXT, MESH(channel), .least = 1, .most = 200, .note = "of an .exr",
     .standard = "the only one, or R", .hashing = NEPH_HASHED_AS_MADE},
    {"min_m", NEPH_THREE, NEPH_SOLID_AT(box.min_m), "m", -NEPH_FAR_M, NEPH_FAR_M,
     .note = "the lower corner: the height of value 0", .hashing = NEPH_HASHED_AS_MADE},
    {"max_m", NEPH_THREE, NEPH_SOLID_AT(box.max_m), "m", -NEPH_FAR_M, NEPH_FAR_M,
     .note = "the upper corner: the height of value 1, which is code 65535 of a .png",
     .hashing = NEPH_HASHED_AS_MADE},
    {"shading", NEPH_WORD, MESH(shading), .words = shadings,
     .note = "smooth: light is reflected by normals of the vertices, the means of their triangles'",
     .standard = "flat", .hashing = NEPH_HASHED_AS_MADE},
    TEXTURE_FIELDS,
    {"memory_limit_mib", NEPH_WHOLE, MESH(memory_limit_mib), "MiB", 1, 8192,
     .note = "of the texture", .standard = "512", .hashing = NEPH_HASHED_AS_MADE},
    NEPH_SURFACE_FIELDS,
    NEPH_MOTION_FIELD,
    {0},
};

/* --- Reading --- */

static enum neph_status check_surface_keys(struct neph_reader *reader, const yaml_node_t *node,
                                           const struct neph_solid *solid, enum neph_status status)
{
    return neph_were_keys_read(reader, "metalness roughness")
               ? neph_keep_error(reader, status, neph_check_surface(reader, node, &solid->surface))
               : status;
}

static enum neph_status check_material(struct neph_reader *reader,
                                       const struct neph_written_solid *written,
                                       enum neph_status status)
{
    if (written->mesh.alpha && !written->mesh.albedo_texture)
        status = neph_keep_error(
            reader, status,
            neph_refuse(reader, "alpha", "it is that of `albedo_texture`, which is not given"));
    return status;
}

static enum neph_status check_places(const struct neph_reader *reader, const yaml_node_t *node,
                                     const struct neph_scatter *scatter)
{
    const bool has_list = neph_reader_has(reader, node, "instances");
    const bool has_scatter = neph_reader_has(reader, node, "scatter");
    if (has_list && has_scatter)
        return neph_refuse(reader, "scatter", "instances are given, too: leave one of them out");
    if ((has_list || has_scatter) && neph_reader_has(reader, node, "position_m"))
        return neph_refuse(reader, "position_m", "%s have the places: leave this key out",
                           has_list ? "instances" : "scatter and its keys");
    if (!has_scatter)
        return NEPH_OK;
    if (scatter->x_m[0] > scatter->x_m[1] || scatter->z_m[0] > scatter->z_m[1] ||
        scatter->scale[0] > scatter->scale[1])
        return neph_refuse(reader, "scatter", "the first number of a range is above the second");
    if (scatter->on_ground && scatter->height_m != 0.0)
        return neph_refuse(reader, "scatter.height_m",
                           "on_ground gives the heights: leave one of them out");
    return NEPH_OK;
}

static enum neph_status read_mesh(struct neph_reader *reader, const yaml_node_t *node,
                                  const struct neph_record *record, void *target)
{
    struct neph_written_solid *written = target;
    enum neph_status status = neph_read_fields(reader, node, record->fields, target);
    written->solid.kind = NEPH_SOLID_MESH;
    status = check_material(reader, written, status);
    if (neph_were_keys_read(reader, "instances scatter position_m"))
        status = neph_keep_error(reader, status,
                                 check_places(reader, node, &written->mesh.scatter));
    return check_surface_keys(reader, node, &written->solid, status);
}

static enum neph_status read_height_field(struct neph_reader *reader, const yaml_node_t *node,
                                          const struct neph_record *record, void *target)
{
    struct neph_written_solid *written = target;
    enum neph_status status = neph_read_fields(reader, node, record->fields, target);
    written->solid.kind = NEPH_SOLID_MESH;
    written->solid.scale_m = 1.0;
    written->mesh.is_height_field = true;
    status = check_material(reader, written, status);
    if (neph_were_keys_read(reader, "min_m max_m"))
        status = neph_keep_error(reader, status,
                                 neph_check_extent(reader, "", &written->solid.box));
    return check_surface_keys(reader, node, &written->solid, status);
}

const struct neph_record neph_mesh_record = {.fields = neph_mesh_fields, .read = read_mesh};
const struct neph_record neph_height_field_record = {.fields = height_field_fields,
                                                     .read = read_height_field};

/* --- The mesh --- */

static void turn_upright(struct neph_mesh_data *data)
{
    for (int i = 0; i < data->vertex_count; i++) {
        const struct neph_vec3 p = data->positions[i];
        data->positions[i] = (struct neph_vec3){p.x, p.z, -p.y};
        if (data->normals) {
            const struct neph_vec3 n = data->normals[i];
            data->normals[i] = (struct neph_vec3){n.x, n.z, -n.y};
        }
    }
}

static enum neph_status read_data(struct neph_reader *reader,
                                  const struct neph_written_solid *written,
                                  struct neph_mesh_data *data)
{
    const struct neph_written_mesh *mesh = &written->mesh;
    const char *path = NULL;
    enum neph_status status = neph_resolve_path(
        reader, mesh->file, mesh->is_height_field ? "/path/to/the/image" : "/path/to/the/mesh",
        &path);
    if (status)
        return status;
    if (mesh->is_height_field) {
        const struct neph_height_field field = {path, mesh->channel, written->solid.box,
                                                mesh->shading, mesh->albedo_texture};
        return neph_height_field_read(&field, data, reader->diag);
    }
    const struct neph_mesh_request request = {.path = path,
                                              .shown = mesh->file,
                                              .object = mesh->object,
                                              .limit_bytes = (size_t)mesh->memory_limit_mib << 20};
    status = neph_mesh_read(&request, data, reader->diag);
    if (!status && mesh->up == 1)
        turn_upright(data);
    return status;
}

/* --- Its material --- */

/* A file in the folder of the scene file or below it, after links were followed. */
static enum neph_status find_beside(const struct neph_reader *reader, const char *file,
                                    const char **path)
{
    const char *scene_path = reader->document->file, *slash = strrchr(scene_path, '/');
    const char *folder = slash ? neph_arena_format(reader->arena, "%.*s/",
                                                   (int)(slash - scene_path), scene_path)
                               : "./";
    const char *named = neph_arena_format(reader->arena, "%s%s", folder, file);
    enum neph_status status = neph_arena_check(reader->arena, reader->diag);
    if (status)
        return status;
    char *real_folder = realpath(folder, NULL), *real = realpath(named, NULL); /* sets errno */
    const size_t length = real_folder ? strlen(real_folder) : 0;
    if (file[0] != '/' && !real) {
        status = neph_fail(reader->diag, NEPH_ERR_NOT_FOUND, "cannot open the texture '%s': %s",
                           named, strerror(errno));
    } else if (file[0] == '/' || !real_folder || strncmp(real, real_folder, length) != 0 ||
               (length > 1 && real[length] != '/')) {
        status = neph_fail(reader->diag, NEPH_ERR_INPUT,
                           "the texture '%s' is outside the folder of the scene file", file);
        neph_hint(reader->diag, "copy it beside the scene file and name it there");
    }
    free(real);
    free(real_folder);
    *path = named;
    return status;
}

static enum neph_status read_texture(struct neph_reader *reader,
                                     const struct neph_written_mesh *mesh,
                                     struct neph_albedo_texture **texture)
{
    const char *path = NULL;
    enum neph_status status = find_beside(reader, mesh->albedo_texture, &path);
    if (!status)
        status = neph_albedo_texture_read(path, (size_t)mesh->memory_limit_mib << 20, texture,
                                          reader->diag);
    return status;
}

/* A check that failed. */
static enum neph_status refuse_data(const struct neph_reader *reader, const char *message,
                                    const char *hint)
{
    neph_fail(reader->diag, NEPH_ERR_INPUT, "%s", message);
    neph_hint(reader->diag, "%s", hint);
    return NEPH_ERR_INPUT;
}

/* On errors `*key` is the key that has it. */
static enum neph_status make_material(struct neph_reader *reader,
                                      const struct neph_written_mesh *written,
                                      struct neph_mesh *mesh, const char **key)
{
    struct neph_mesh_material *material = &mesh->material;
    *key = "shading";
    if (written->shading && !mesh->data.normals)
        return refuse_data(reader, "the mesh has no normals for smooth shading",
                           "write the file with normals at all vertices, or use shading: flat");
    material->is_smooth = written->shading;
    *key = "albedo_texture";
    if (!written->albedo_texture)
        return NEPH_OK;
    if (!mesh->data.uv)
        return refuse_data(reader, "the mesh has no uv for a texture",
                           "write the file with texture coordinates at all vertices");
    const enum neph_status status = read_texture(reader, written, &material->texture);
    if (status)
        return status;
    *key = "alpha";
    if (written->alpha && !material->texture->has_alpha)
        return refuse_data(reader, "the texture is opaque everywhere", "leave `alpha` out");
    material->alpha = (enum neph_alpha)written->alpha;
    if (material->alpha != NEPH_ALPHA_IGNORED)
        mesh->inside = NEPH_MESH_OPEN;
    return NEPH_OK;
}

/* Gives an error the position of the entry's key. */
static enum neph_status place_error(const struct neph_reader *reader, const char *path,
                                    enum neph_status status)
{
    if (status) {
        neph_document_locate(reader->document, neph_document_find(reader->document, path),
                             reader->diag);
        neph_errors_attribute(reader->errors, path);
    }
    return status;
}

static enum neph_status make_mesh(struct neph_reader *reader, struct neph_scene *scene,
                                  const struct neph_written_solid *written)
{
    struct neph_mesh_data data = {0};
    enum neph_status status = read_data(reader, written, &data);
    if (status)
        return status;
    status = neph_mesh_create(&data, &scene->meshes[scene->mesh_count], reader->diag);
    if (status)
        neph_prefix(reader->diag, "'%s': ", written->mesh.file);
    else
        scene->mesh_count++;
    return status;
}

/* --- Its solids --- */

int neph_count_instances(const struct neph_written_mesh *mesh)
{
    return mesh->instance_count > 0  ? mesh->instance_count
           : mesh->scatter.count > 0 ? mesh->scatter.count
                                     : 1;
}

/* Uniform in 0..1: the upper 53 bits of splitmix64 (G. Steele, D. Lea, C. Flood, "Fast Splittable
 * Pseudorandom Number Generators", OOPSLA 2014). */
static double draw(uint64_t *state)
{
    uint64_t z = (*state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static double draw_between(const double range[2], uint64_t *state)
{
    return range[0] + (range[1] - range[0]) * draw(state);
}

/* Four numbers for each instance, in this order. */
static struct neph_instance scatter_one(const struct neph_scatter *scatter, uint64_t *state)
{
    struct neph_instance made = {.position_m.y = scatter->height_m, .scale = 1.0};
    made.position_m.x = draw_between(scatter->x_m, state);
    made.position_m.z = draw_between(scatter->z_m, state);
    made.turn_deg = 360.0 * draw(state);
    const double part = draw(state);
    if (scatter->scale_count > 0)
        made.scale = scatter->scale[0] + (scatter->scale[1] - scatter->scale[0]) * part;
    return made;
}

/* Puts an instance on the highest solid below 1e6 m. */
static bool put_on_ground(const struct neph_scene *before, struct neph_vec3 *position_m)
{
    const struct neph_vec3 above_m = {position_m->x, NEPH_FAR_M, position_m->z};
    const struct neph_hit hit = neph_scene_hit(before, above_m, (struct neph_vec3){0, -1, 0});
    if (hit.solid)
        position_m->y = NEPH_FAR_M - hit.t_m;
    return hit.solid;
}

static struct neph_solid place_solid(const struct neph_written_solid *written,
                                     const struct neph_mesh *mesh,
                                     const struct neph_instance *instance)
{
    struct neph_solid solid = written->solid;
    const double turn_rad = (written->mesh.turn_deg + instance->turn_deg) * NEPH_RAD_PER_DEG;
    solid.box = (struct neph_bounds){{0, 0, 0}, {0, 0, 0}};
    solid.mesh = mesh;
    solid.center_m = instance->position_m;
    solid.scale_m *= instance->scale;
    if (turn_rad != 0.0)
        solid.yaw = (struct neph_turn){1, cos(turn_rad), sin(turn_rad)};
    return solid;
}

static enum neph_status check_place(const struct neph_reader *reader, const char *key,
                                    const struct neph_solid *solid)
{
    const struct neph_bounds box = neph_solid_bounds(solid);
    const double *low_m = &box.min_m.x, *high_m = &box.max_m.x;
    for (int axis = 0; axis < 3; axis++)
        if (low_m[axis] < -NEPH_FAR_M || high_m[axis] > NEPH_FAR_M)
            return neph_refuse(reader, key,
                               "the mesh would be at %g to %g m along %c; a world is %g to %g m",
                               low_m[axis], high_m[axis], "xyz"[axis], -NEPH_FAR_M, NEPH_FAR_M);
    return NEPH_OK;
}

static enum neph_status make_solids(const struct neph_reader *reader, struct neph_scene *scene,
                                    const struct neph_written_solid *written, const char *key,
                                    int count)
{
    const struct neph_scatter *scatter = &written->mesh.scatter;
    const struct neph_mesh *mesh = scene->meshes[scene->mesh_count - 1];
    const struct neph_scene before = {.solid_count = count, .solids = scene->solids};
    uint64_t state = (uint64_t)scatter->seed;
    for (int i = 0; i < neph_count_instances(&written->mesh); i++) {
        struct neph_instance instance = {.position_m = written->solid.center_m, .scale = 1.0};
        if (written->mesh.instance_count > 0)
            instance = written->mesh.instances[i];
        else if (scatter->count > 0)
            instance = scatter_one(scatter, &state);
        if (scatter->on_ground && !put_on_ground(&before, &instance.position_m))
            return neph_refuse(reader, key,
                               "no solid of an entry before is below the place of instance %d at "
                               "x %g m, z %g m: make the range smaller, or give height_m",
                               i, instance.position_m.x, instance.position_m.z);
        scene->solids[count + i] = place_solid(written, mesh, &instance);
        const enum neph_status status = check_place(reader, key, &scene->solids[count + i]);
        if (status)
            return status;
    }
    return NEPH_OK;
}

enum neph_status neph_make_mesh_solids(struct neph_reader *reader,
                                       struct neph_written_scene *written, int index, int count)
{
    const struct neph_written_solid *entry = &written->solids[index];
    const struct neph_path key = neph_format_path(
        "solids[%d].%s", index, entry->mesh.is_height_field ? "height_field" : "mesh");
    const struct neph_path file = neph_format_path("%s.file", key.text);
    const char *part = "";
    enum neph_status status = make_mesh(reader, &written->scene, entry);
    if (status)
        return place_error(reader, file.text, status);
    status = make_material(reader, &entry->mesh,
                           written->scene.meshes[written->scene.mesh_count - 1], &part);
    return status ? place_error(reader, neph_format_path("%s.%s", key.text, part).text, status)
                  : make_solids(reader, &written->scene, entry, key.text, count);
}
