/* SPDX-License-Identifier: MIT */
#include "renderer/gpu_meshes.h"

#include "renderer/gpu_mesh_looks.h"
#include "renderer/relative.h"
#include "scenes/bounds.h"
#include "scenes/mesh.h"
#include "scenes/mesh_place.h"
#include "scenes/solids.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Does not compile with a new kind: this file then needs a change. */
_Static_assert(NEPH_SOLID_KIND_COUNT == 3, "a new kind");

typedef uint32_t words[4];

enum {
    NODE_WORDS = 2,
    INSTANCE_WORDS = 6,
    TRIANGLE_WORDS = 3,
    HIT_BITS = 30, /* of the number of a hit, for instance and triangle */
};

static bool is_instance(const struct neph_solid *solid)
{
    return solid->kind == NEPH_SOLID_MESH;
}

int neph_gpu_count_instances(const struct neph_scene *scene)
{
    int count = 0;
    for (int i = 0; i < scene->solid_count; i++)
        count += is_instance(&scene->solids[i]);
    return count;
}

double neph_gpu_count_triangles(const struct neph_scene *scene)
{
    double count = 0.0;
    for (int i = 0; i < scene->solid_count; i++)
        if (is_instance(&scene->solids[i]))
            count += scene->solids[i].mesh->data.triangle_count;
    return count;
}

bool neph_gpu_meshes_move(const struct neph_scene *scene)
{
    bool moves = false;
    for (int i = 0; i < scene->solid_count; i++)
        moves |= is_instance(&scene->solids[i]) && scene->solids[i].moves;
    return moves;
}

int neph_gpu_count_plain_solids(const struct neph_scene *scene)
{
    return scene->solid_count - neph_gpu_count_instances(scene);
}

/* --- places ---------------------------------------------------------------------------------- */

/* Vertices are relative to this point of their mesh. */
static struct neph_vec3 find_mesh_middle(const struct neph_mesh *mesh)
{
    return neph_bounds_middle(&mesh->tree.nodes[0].bounds);
}

static struct neph_bounds find_hull(const struct neph_solid *solids, int count)
{
    struct neph_bounds hull = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (int i = 0; i < count; i++)
        if (is_instance(&solids[i]))
            hull = neph_bounds_hull(hull, neph_solid_bounds(&solids[i]));
    return hull;
}

/* The origin of all places. It does not move with an instance, so that all others keep their bits.
 */
static struct neph_vec3 find_origin(const struct neph_scene *scene)
{
    const struct neph_solid *solids = scene->unmoved_solids ? scene->unmoved_solids : scene->solids;
    const struct neph_bounds hull = find_hull(solids, scene->solid_count);
    const struct neph_vec3 middle_m = neph_bounds_middle(&hull);
    return scene->unmoved_solids ? neph_vec3_add(middle_m, scene->shift_m) : middle_m;
}

/* The largest coordinate of a box relative to a point. */
static double find_reach(struct neph_vec3 point, const struct neph_bounds *box)
{
    const struct neph_vec3 away = neph_vec3_sub(neph_bounds_middle(box), point);
    const struct neph_vec3 side = neph_vec3_sub(box->max_m, box->min_m);
    return fmax(fabs(away.x) + 0.5 * side.x,
                fmax(fabs(away.y) + 0.5 * side.y, fabs(away.z) + 0.5 * side.z));
}

/* What a vector loses by rounding to float32. */
static struct neph_vec3 find_rest(struct neph_vec3 v)
{
    return (struct neph_vec3){v.x - (double)(float)v.x, v.y - (double)(float)v.y,
                              v.z - (double)(float)v.z};
}

static int count_bits(int largest)
{
    int bits = 0;
    while (largest >> bits > 0)
        bits++;
    return bits;
}

static int count_triangle_bits(const struct neph_scene *scene)
{
    int most = 1;
    for (int i = 0; i < scene->mesh_count; i++)
        most = scene->meshes[i]->data.triangle_count > most ? scene->meshes[i]->data.triangle_count
                                                            : most;
    return count_bits(most - 1);
}

/* Whether numbers of hits, of so many bits, are sums of triangles (shaders/mesh_data.glsl). */
static bool has_searched_hits(const struct neph_scene *scene)
{
    return count_bits(neph_gpu_count_instances(scene) - 1) + count_triangle_bits(scene) > HIT_BITS;
}

/* A fit: on a terrain of 200,000 triangles with 2,000 trees, subgroups of eight paths of the tracer
 * take between a half and all of it on average; with few solids they take less. */
uint64_t neph_gpu_mesh_iterations(const struct neph_scene *scene)
{
    const int count = neph_gpu_count_instances(scene);
    const uint64_t levels = (uint64_t)(2 + count_bits(count - 1) + count_triangle_bits(scene));
    return count == 0 ? 0 : levels * levels / 2;
}

/* --- sizes ----------------------------------------------------------------------------------- */

/* Bounds of the nodes of the tree of instances: a leaf is one instance. */
static size_t count_instance_nodes(const struct neph_scene *scene)
{
    return 3 * (size_t)neph_gpu_count_instances(scene);
}

static size_t count_shape_words(const struct neph_mesh *mesh)
{
    return NODE_WORDS * (size_t)mesh->tree.node_count +
           TRIANGLE_WORDS * (size_t)mesh->data.triangle_count;
}

static size_t count_mesh_words(const struct neph_mesh *mesh)
{
    return count_shape_words(mesh) + neph_gpu_mesh_look_words(mesh);
}

size_t neph_gpu_mesh_place_words(const struct neph_scene *scene)
{
    return NODE_WORDS * count_instance_nodes(scene) +
           INSTANCE_WORDS * (size_t)neph_gpu_count_instances(scene);
}

size_t neph_gpu_mesh_words(const struct neph_scene *scene)
{
    size_t count = NEPH_GPU_MESH_PLACES_FIRST + neph_gpu_mesh_place_words(scene);
    if (neph_gpu_count_instances(scene) == 0)
        return 0;
    for (int i = 0; i < scene->mesh_count; i++)
        count += count_mesh_words(scene->meshes[i]);
    return count + neph_gpu_mesh_texture_words(scene);
}

struct neph_gpu_meshes neph_gpu_meshes_place(const struct neph_scene *scene,
                                             struct neph_vec3 camera_m)
{
    struct neph_gpu_meshes made = {0};
    if (neph_gpu_count_instances(scene) == 0)
        return made;
    const struct neph_bounds hull = find_hull(scene->solids, scene->solid_count);
    const struct neph_vec3 world_m = find_origin(scene);
    const struct neph_vec3 origin_m = neph_vec3_sub(world_m, camera_m);
    neph_gpu_direction(made.origin_m, origin_m);
    neph_gpu_direction(made.origin_low_m, find_rest(origin_m));
    made.reach_m = (float)find_reach(world_m, &hull);
    made.instances = NEPH_GPU_MESH_PLACES_FIRST +
                     (uint32_t)(NODE_WORDS * count_instance_nodes(scene));
    made.triangle_bits = (uint32_t)count_triangle_bits(scene);
    made.searched = has_searched_hits(scene) ? (uint32_t)neph_gpu_count_instances(scene) : 0;
    return made;
}

/* --- trees ----------------------------------------------------------------------------------- */

static void set_float(uint32_t *word, double value)
{
    const float rounded = (float)value;
    memcpy(word, &rounded, sizeof(rounded));
}

static void set_vector(uint32_t *word, struct neph_vec3 v)
{
    set_float(&word[0], v.x);
    set_float(&word[1], v.y);
    set_float(&word[2], v.z);
}

/* A tree in the order of a walk that enters all nodes. */
struct tree_writing {
    const struct neph_box_tree *tree;
    struct neph_vec3 origin, eye;
    const struct neph_bounds *items; /* NULL: a leaf of the tree is a node with its items; else each
                                        item is a node of its own, with these bounds */
    const int *numbers;              /* of those items */
    words *nodes;
    uint32_t count;
};

/* Writes bounds and content, and reserves the node. */
static uint32_t open_node(struct tree_writing *writing, const struct neph_bounds *bounds,
                          uint32_t leaf)
{
    words *node = &writing->nodes[NODE_WORDS * writing->count];
    set_vector(node[0], neph_vec3_sub(bounds->min_m, writing->origin));
    set_vector(node[1], neph_vec3_sub(bounds->max_m, writing->origin));
    node[0][3] = leaf;
    return writing->count++;
}

static void close_node(struct tree_writing *writing, uint32_t node)
{
    writing->nodes[NODE_WORDS * node + 1][3] = writing->count;
}

static void write_items(struct tree_writing *writing, const struct neph_tree_node *node)
{
    for (int i = 0; i < node->count; i++) {
        const int item = writing->tree->order[node->first + i];
        close_node(writing,
                   open_node(writing, &writing->items[item], (uint32_t)writing->numbers[item] + 1));
    }
}

static double distance_to(struct neph_vec3 point, const struct neph_bounds *box)
{
    return neph_vec3_length(neph_vec3_sub(neph_bounds_nearest(box, point), point));
}

/* The child that is nearer to the eye is first: view rays meet near triangles first then, and pass
 * the boxes of far ones. */
static void write_node(struct tree_writing *writing, int at)
{
    const struct neph_tree_node *node = &writing->tree->nodes[at];
    const uint32_t leaf = (uint32_t)node->first << 4 | (uint32_t)node->count;
    const bool has_items = node->count > 0;
    const uint32_t own = open_node(writing, &node->bounds, has_items && !writing->items ? leaf : 0);
    if (has_items && writing->items)
        write_items(writing, node);
    else if (!has_items) {
        const struct neph_tree_node *children = &writing->tree->nodes[node->first];
        const bool swaps = distance_to(writing->eye, &children[1].bounds) <
                           distance_to(writing->eye, &children[0].bounds);
        write_node(writing, node->first + swaps);
        write_node(writing, node->first + !swaps);
    }
    close_node(writing, own);
}

/* Nodes whose next one is behind the last have none. */
static void end_trees(struct tree_writing *writing)
{
    for (uint32_t n = 0; n < writing->count; n++)
        if (writing->nodes[NODE_WORDS * n + 1][3] == writing->count)
            writing->nodes[NODE_WORDS * n + 1][3] = UINT32_MAX;
}

/* Room to build a tree of instances. */
struct instance_trees {
    struct neph_bounds *boxes;
    struct neph_tree_node *nodes;
    int *order, *numbers;
};

/* The tree of all instances that move, or of all that rest, behind the nodes that are written. */
static void write_part(const struct neph_scene *scene, bool moves, struct instance_trees *room,
                       struct tree_writing *writing)
{
    int count = 0, number = 0;
    for (int i = 0; i < scene->solid_count; i++) {
        const struct neph_solid *solid = &scene->solids[i];
        if (is_instance(solid) && solid->moves == moves) {
            room->boxes[count] = neph_solid_bounds(solid);
            room->numbers[count++] = number;
        }
        number += is_instance(solid);
    }
    if (count > 0) {
        const struct neph_box_tree tree = neph_box_tree_build(room->boxes, count, room->nodes,
                                                              room->order);
        writing->tree = &tree;
        write_node(writing, 0);
    }
}

static enum neph_status write_instance_trees(const struct neph_scene *scene,
                                             struct neph_vec3 origin_m, struct neph_vec3 eye_m,
                                             words *to, struct neph_diag *diag)
{
    const size_t count = (size_t)neph_gpu_count_instances(scene);
    struct instance_trees room = {
        malloc(count * sizeof(*room.boxes)),
        malloc((size_t)neph_box_tree_room((int)count) * sizeof(*room.nodes)),
        malloc(count * sizeof(*room.order)), malloc(count * sizeof(*room.numbers))};
    struct tree_writing writing = {NULL, origin_m, eye_m, room.boxes, room.numbers, to, 0};
    const bool has_room = room.boxes && room.nodes && room.order && room.numbers;
    if (has_room) {
        write_part(scene, true, &room, &writing);
        write_part(scene, false, &room, &writing);
        end_trees(&writing);
    }
    free(room.numbers);
    free(room.order);
    free(room.nodes);
    free(room.boxes);
    return has_room ? NEPH_OK : neph_fail_memory(diag);
}

/* --- meshes ---------------------------------------------------------------------------------- */

/* A point of the world in the axes of a mesh. */
static struct neph_vec3 to_mesh(const struct neph_solid *solid, struct neph_vec3 point_m)
{
    const struct neph_vec3 from_m = neph_vec3_sub(point_m, solid->center_m);
    struct neph_vec3 axes[3];
    neph_mesh_axes(solid, axes);
    return neph_vec3_scale((struct neph_vec3){neph_vec3_dot(from_m, axes[0]),
                                              neph_vec3_dot(from_m, axes[1]),
                                              neph_vec3_dot(from_m, axes[2])},
                           1.0 / solid->scale_m);
}

/* The eye as seen from the first instance of a mesh. */
static struct neph_vec3 find_eye(const struct neph_scene *scene, const struct neph_mesh *mesh,
                                 struct neph_vec3 eye_m)
{
    int i = 0;
    while (i + 1 < scene->solid_count && scene->solids[i].mesh != mesh)
        i++;
    return to_mesh(&scene->solids[i], eye_m);
}

static void write_mesh(const struct neph_mesh *mesh, struct neph_vec3 eye, words *to)
{
    const struct neph_vec3 middle = find_mesh_middle(mesh);
    struct tree_writing writing = {&mesh->tree, middle, eye, NULL, NULL, to, 0};
    words *triangles = to + NODE_WORDS * (size_t)mesh->tree.node_count;
    write_node(&writing, 0);
    end_trees(&writing);
    for (int i = 0; i < mesh->data.triangle_count; i++)
        for (int corner = 0; corner < 3; corner++)
            set_vector(
                triangles[TRIANGLE_WORDS * i + corner],
                neph_vec3_sub(mesh->data.positions[mesh->data.triangles[i][corner]], middle));
}

static void write_instance(const struct neph_solid *solid, struct neph_vec3 origin_m,
                           uint32_t first, uint32_t first_hit, words *to)
{
    const struct neph_mesh *mesh = solid->mesh;
    const struct neph_vec3 middle = find_mesh_middle(mesh);
    struct neph_vec3 axes[3], place_m = neph_vec3_sub(solid->center_m, origin_m);
    neph_mesh_axes(solid, axes);
    place_m = neph_vec3_along(place_m, axes[0], middle.x * solid->scale_m);
    place_m = neph_vec3_along(place_m, axes[1], middle.y * solid->scale_m);
    place_m = neph_vec3_along(place_m, axes[2], middle.z * solid->scale_m);
    for (int axis = 0; axis < 3; axis++)
        set_vector(to[axis], axes[axis]);
    to[0][3] = first;
    to[1][3] = first + NODE_WORDS * (uint32_t)mesh->tree.node_count;
    to[2][3] = neph_gpu_mesh_look_words(mesh) > 0 ? first + (uint32_t)count_shape_words(mesh) : 0;
    set_vector(to[3], place_m);
    set_vector(to[5], find_rest(place_m));
    to[5][3] = first_hit;
    set_float(&to[3][3], solid->scale_m);
    set_vector(to[4], (struct neph_vec3){solid->albedo.r, solid->albedo.g, solid->albedo.b});
    set_float(&to[4][3], find_reach(middle, &mesh->tree.nodes[0].bounds));
}

/* The index of the first word behind the places. */
static uint32_t find_first_mesh(const struct neph_scene *scene)
{
    return NEPH_GPU_MESH_PLACES_FIRST + (uint32_t)neph_gpu_mesh_place_words(scene);
}

static void write_meshes(const struct neph_scene *scene, struct neph_vec3 eye_m, words *to)
{
    const uint32_t textures = (uint32_t)(neph_gpu_mesh_words(scene) -
                                         neph_gpu_mesh_texture_words(scene));
    uint32_t at = find_first_mesh(scene);
    for (int i = 0; i < scene->mesh_count; i++) {
        const struct neph_mesh *mesh = scene->meshes[i];
        write_mesh(mesh, find_eye(scene, mesh, eye_m), to + at);
        if (neph_gpu_mesh_look_words(mesh) > 0)
            neph_gpu_mesh_look_write(scene, i, at + (uint32_t)count_shape_words(mesh), textures,
                                     to);
        at += (uint32_t)count_mesh_words(mesh);
    }
}

enum neph_status neph_gpu_mesh_places_write(const struct neph_scene *scene, struct neph_vec3 eye_m,
                                            uint32_t (*to)[4], struct neph_diag *diag)
{
    const struct neph_vec3 origin_m = find_origin(scene);
    const bool is_searched = has_searched_hits(scene);
    const uint32_t regular = 1u << count_triangle_bits(scene);
    words *instance = to + NODE_WORDS * count_instance_nodes(scene);
    uint32_t *firsts = malloc((size_t)scene->mesh_count * sizeof(*firsts)), hit = 0;
    if (!firsts)
        return neph_fail_memory(diag);
    for (int i = 0; i < scene->mesh_count; i++)
        firsts[i] = i == 0 ? find_first_mesh(scene)
                           : firsts[i - 1] + (uint32_t)count_mesh_words(scene->meshes[i - 1]);
    for (int i = 0; i < scene->solid_count; i++)
        if (is_instance(&scene->solids[i])) {
            const int mesh = neph_mesh_index(scene, &scene->solids[i]);
            write_instance(&scene->solids[i], origin_m, firsts[mesh], hit, instance);
            instance += INSTANCE_WORDS;
            hit += is_searched ? (uint32_t)scene->solids[i].mesh->data.triangle_count : regular;
        }
    free(firsts);
    return write_instance_trees(scene, origin_m, eye_m, to, diag);
}

enum neph_status neph_gpu_meshes_upload(const struct neph_vulkan *vulkan,
                                        const struct neph_scene *scene, struct neph_vec3 eye_m,
                                        const struct neph_buffer *buffer, struct neph_diag *diag)
{
    const size_t count = neph_gpu_mesh_words(scene);
    if (count == 0)
        return NEPH_OK;
    if (neph_gpu_count_triangles(scene) > (double)(1 << HIT_BITS))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "%d instances of meshes with %.4g triangles in all; a device has numbers "
                         "for 2^%d",
                         neph_gpu_count_instances(scene), neph_gpu_count_triangles(scene),
                         HIT_BITS);
    words *data = calloc(count, sizeof(*data));
    if (!data)
        return neph_fail_memory(diag);
    write_meshes(scene, eye_m, data);
    enum neph_status status = neph_gpu_mesh_places_write(scene, eye_m,
                                                         data + NEPH_GPU_MESH_PLACES_FIRST, diag);
    if (!status)
        status = neph_buffer_upload(vulkan, buffer, 0, data, count * sizeof(*data), diag);
    free(data);
    return status;
}

enum neph_status neph_gpu_meshes_check(const struct neph_vulkan *vulkan,
                                       const struct neph_buffer *buffer,
                                       const struct neph_buffer *readback, struct neph_diag *diag)
{
    const enum neph_status status = neph_buffer_download(vulkan, buffer, readback, sizeof(uint32_t),
                                                         diag);
    uint32_t fault = 0;
    if (!status)
        memcpy(&fault, readback->mapped, sizeof(fault));
    return fault == 0 ? status
                      : neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                                  "rays meet too many boxes of the meshes: the device leaves loops "
                                  "after %d iterations; a GPU does not, or take fewer steps or "
                                  "samples",
                                  NEPH_KERNEL_LOOP_ITERATIONS_MAX);
}
