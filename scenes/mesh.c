/* SPDX-License-Identifier: MIT */
#include "scenes/mesh.h"

#include "scenes/bounds.h"
#include "scenes/box_shadow.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- data ------------------------------------------------------------------------------------ */

void neph_mesh_data_finish(struct neph_mesh_data *data)
{
    free(data->positions);
    free(data->triangles);
    free(data->normals);
    free(data->uv);
    *data = (struct neph_mesh_data){0};
}

struct corners {
    struct neph_vec3 a, b, c;
};

static struct corners get_corners(const struct neph_mesh_data *data, int triangle)
{
    const int *v = data->triangles[triangle];
    return (struct corners){data->positions[v[0]], data->positions[v[1]], data->positions[v[2]]};
}

/* Twice the area along the normal. */
static struct neph_vec3 find_area(const struct corners *t)
{
    return neph_vec3_cross(neph_vec3_sub(t->b, t->a), neph_vec3_sub(t->c, t->a));
}

static double squared_length(struct neph_vec3 v)
{
    return neph_vec3_dot(v, v);
}

/* The area of lower triangles, and so their normal, is rounding error. */
static bool is_degenerate(const struct corners *t)
{
    const double longest = fmax(
        squared_length(neph_vec3_sub(t->b, t->a)),
        fmax(squared_length(neph_vec3_sub(t->c, t->b)), squared_length(neph_vec3_sub(t->a, t->c))));
    return !(neph_vec3_length(find_area(t)) > 1e-14 * longest);
}

static enum neph_status check_vertices(const struct neph_mesh_data *data, struct neph_diag *diag)
{
    for (int i = 0; i < data->vertex_count; i++) {
        const struct neph_vec3 p = data->positions[i];
        if (!(fabs(p.x) <= NEPH_MESH_FAR && fabs(p.y) <= NEPH_MESH_FAR &&
              fabs(p.z) <= NEPH_MESH_FAR))
            return neph_fail(diag, NEPH_ERR_INPUT,
                             "vertex %d is (%g, %g, %g); coordinates are finite, from %g to %g", i,
                             p.x, p.y, p.z, -NEPH_MESH_FAR, NEPH_MESH_FAR);
        const double length = data->normals ? neph_vec3_length(data->normals[i]) : 1.0;
        if (!(length > 0.0 && length < INFINITY))
            return neph_fail(diag, NEPH_ERR_INPUT,
                             "the normal of vertex %d has length %g; a normal has a finite length "
                             "above 0",
                             i, length);
    }
    return NEPH_OK;
}

static enum neph_status check_triangles(const struct neph_mesh_data *data, struct neph_diag *diag)
{
    if (data->triangle_count < 1)
        return neph_fail(diag, NEPH_ERR_INPUT, "the mesh has no triangle");
    if (data->triangle_count > NEPH_MESH_TRIANGLES_MAX)
        return neph_fail(diag, NEPH_ERR_INPUT, "%d triangles; a mesh has at most %d",
                         data->triangle_count, NEPH_MESH_TRIANGLES_MAX);
    for (int i = 0; i < data->triangle_count; i++)
        for (int corner = 0; corner < 3; corner++) {
            const int vertex = data->triangles[i][corner];
            if (vertex < 0 || vertex >= data->vertex_count)
                return neph_fail(diag, NEPH_ERR_INPUT,
                                 "triangle %d has vertex %d; the %d vertices are 0 to %d", i,
                                 vertex, data->vertex_count, data->vertex_count - 1);
        }
    return NEPH_OK;
}

static enum neph_status hash_data(const struct neph_mesh_data *data, char hash[NEPH_HASH_HEX_SIZE],
                                  struct neph_diag *diag)
{
    const size_t vertices = (size_t)data->vertex_count, triangles = (size_t)data->triangle_count;
    const struct {
        const void *values;
        size_t bytes;
    } parts[] = {
        {data->positions, vertices * sizeof(data->positions[0])},
        {data->triangles, triangles * sizeof(data->triangles[0])},
        {data->normals, data->normals ? vertices * sizeof(data->normals[0]) : 0},
        {data->uv, data->uv ? vertices * sizeof(data->uv[0]) : 0},
    };
    enum { COUNT = sizeof(parts) / sizeof(parts[0]) };
    char all[COUNT][NEPH_HASH_HEX_SIZE];
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < COUNT && !status; i++)
        status = neph_hash(parts[i].bytes > 0 ? parts[i].values : "", parts[i].bytes, all[i], diag);
    return status ? status : neph_hash(all, sizeof(all), hash, diag);
}

/* --- the boundary ---------------------------------------------------------------------------- */

static uint64_t mix_bits(uint64_t x) /* the finaliser of MurmurHash3 */
{
    x = (x ^ x >> 33) * 0xff51afd7ed558ccdu;
    x = (x ^ x >> 33) * 0xc4ceb9fe1a85ec53u;
    return x ^ x >> 33;
}

static uint64_t hash_point(struct neph_vec3 p)
{
    const double values[3] = {p.x + 0.0, p.y + 0.0, p.z + 0.0}; /* no -0 */
    uint64_t bits[3], sum = 0;
    memcpy(bits, values, sizeof(bits));
    for (int i = 0; i < 3; i++)
        sum = mix_bits(sum + bits[i] + 0x9e3779b97f4a7c15u);
    return sum;
}

/* An order of points. */
static bool is_before(struct neph_vec3 a, struct neph_vec3 b)
{
    return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

/* A mesh has no boundary where each edge is used equally often in both directions, or an even
 * number of times in any. The sum of a hash of all edges, signed by direction, is 0 then, and else
 * with a probability of 2^-64. Edges are equal where their points are, because files repeat
 * vertices. */
static enum neph_mesh_inside find_inside(const struct neph_mesh_data *data)
{
    uint64_t sum = 0, parity = 0;
    for (int i = 0; i < data->triangle_count; i++)
        for (int corner = 0; corner < 3; corner++) {
            const struct neph_vec3 a = data->positions[data->triangles[i][corner]];
            const struct neph_vec3 b = data->positions[data->triangles[i][(corner + 1) % 3]];
            const uint64_t hash_a = hash_point(a), hash_b = hash_point(b);
            if (hash_a == hash_b)
                continue;
            const uint64_t edge = hash_a < hash_b ? mix_bits(hash_a) + hash_b
                                                  : mix_bits(hash_b) + hash_a;
            sum += hash_a < hash_b ? mix_bits(edge) : -mix_bits(edge);
            parity ^= mix_bits(edge);
        }
    return sum == 0 ? NEPH_MESH_ORIENTED : parity == 0 ? NEPH_MESH_EVEN : NEPH_MESH_OPEN;
}

/* --- construction ---------------------------------------------------------------------------- */

/* Moves the triangles with an area to the front. */
static void drop_degenerate(struct neph_mesh *mesh)
{
    struct neph_mesh_data *data = &mesh->data;
    int count = 0;
    for (int i = 0; i < data->triangle_count; i++) {
        const struct corners corners = get_corners(data, i);
        if (is_degenerate(&corners))
            continue;
        memmove(data->triangles[count], data->triangles[i], sizeof(data->triangles[0]));
        mesh->number[count++] = i;
    }
    mesh->dropped_count = data->triangle_count - count;
    data->triangle_count = count;
}

static struct neph_bounds find_bounds(const struct corners *t)
{
    return (struct neph_bounds){
        {fmin(t->a.x, fmin(t->b.x, t->c.x)), fmin(t->a.y, fmin(t->b.y, t->c.y)),
         fmin(t->a.z, fmin(t->b.z, t->c.z))},
        {fmax(t->a.x, fmax(t->b.x, t->c.x)), fmax(t->a.y, fmax(t->b.y, t->c.y)),
         fmax(t->a.z, fmax(t->b.z, t->c.z))}};
}

/* Puts triangles and their numbers into the tree's order; the tree needs its order no more. */
static bool sort_triangles(struct neph_mesh *mesh)
{
    struct neph_mesh_data *data = &mesh->data;
    const size_t count = (size_t)data->triangle_count;
    int(*sorted)[3] = malloc(count * sizeof(*sorted));
    if (!sorted)
        return false;
    for (size_t i = 0; i < count; i++) {
        memcpy(sorted[i], data->triangles[mesh->tree.order[i]], sizeof(*sorted));
        mesh->tree.order[i] = mesh->number[mesh->tree.order[i]];
    }
    free(data->triangles);
    data->triangles = sorted;
    free(mesh->number);
    mesh->number = mesh->tree.order;
    mesh->tree.order = NULL;
    return true;
}

static enum neph_status build_tree(struct neph_mesh *mesh, struct neph_diag *diag)
{
    const struct neph_mesh_data *data = &mesh->data;
    const int count = data->triangle_count, room = neph_box_tree_room(count);
    struct neph_bounds *boxes = malloc((size_t)count * sizeof(*boxes));
    struct neph_tree_node *nodes = malloc((size_t)room * sizeof(*nodes));
    int *order = malloc((size_t)count * sizeof(*order));
    enum neph_status status = boxes && nodes && order ? NEPH_OK : neph_fail_memory(diag);
    if (status) {
        free(nodes);
        free(order);
        free(boxes);
        return status;
    }
    for (int i = 0; i < count; i++) {
        const struct corners corners = get_corners(data, i);
        boxes[i] = find_bounds(&corners);
    }
    mesh->tree = neph_box_tree_build(boxes, count, nodes, order);
    free(boxes);
    return sort_triangles(mesh) ? NEPH_OK : neph_fail_memory(diag);
}

enum neph_status neph_mesh_create(struct neph_mesh_data *data, struct neph_mesh **mesh,
                                  struct neph_diag *diag)
{
    struct neph_mesh *made = calloc(1, sizeof(*made));
    enum neph_status status = NEPH_OK;
    if (!made) {
        neph_mesh_data_finish(data);
        return neph_fail_memory(diag);
    }
    made->data = *data;
    *data = (struct neph_mesh_data){0};
    status = check_triangles(&made->data, diag);
    if (!status)
        status = check_vertices(&made->data, diag);
    if (!status)
        status = hash_data(&made->data, made->hash, diag);
    if (status)
        goto done;
    made->inside = find_inside(&made->data);
    made->number = malloc((size_t)made->data.triangle_count * sizeof(*made->number));
    if (!made->number) {
        status = neph_fail_memory(diag);
        goto done;
    }
    drop_degenerate(made);
    if (made->data.triangle_count == 0) {
        status = neph_fail(diag, NEPH_ERR_INPUT,
                           "none of the %d triangles has an area: their corners are on a line",
                           made->dropped_count);
        goto done;
    }
    status = build_tree(made, diag);
    if (!status) {
        *mesh = made;
        made = NULL;
    }
done:
    neph_mesh_destroy(made);
    return status;
}

void neph_mesh_destroy(struct neph_mesh *mesh)
{
    if (!mesh)
        return;
    neph_albedo_texture_destroy(mesh->material.texture);
    neph_mesh_data_finish(&mesh->data);
    free(mesh->number);
    free(mesh->tree.nodes);
    free(mesh->tree.order);
    free(mesh);
}

struct neph_vec3 neph_mesh_normal(const struct neph_mesh *mesh, int triangle)
{
    const struct corners corners = get_corners(&mesh->data, triangle);
    return neph_vec3_normalize(find_area(&corners));
}

/* --- rays and triangles ---------------------------------------------------------------------- */

/* A ray in coordinates in which it is (0, 0, t). */
struct sheared_ray {
    const struct neph_mesh *mesh;
    struct neph_tree_ray ray;
    uint64_t draw; /* 0: coverage of 1/2 and more stops it, and less does not */
    int x, y, z;   /* axes; z: the longest of the direction */
    double shear_x, shear_y, scale_z;
};

/* The random number of a ray on a mesh with coverage. */
static uint64_t draw_ray(const struct neph_mesh *mesh, const struct neph_tree_ray *ray,
                         uint64_t draw)
{
    return draw == 0 || mesh->material.alpha != NEPH_ALPHA_COVERAGE
               ? 0
               : mix_bits(hash_point(ray->origin_m) ^
                          mix_bits(hash_point(ray->direction) ^ mix_bits(draw))) |
                     1;
}

static struct sheared_ray shear_ray(const struct neph_mesh *mesh, const struct neph_tree_ray *ray,
                                    uint64_t draw)
{
    const double d[3] = {ray->direction.x, ray->direction.y, ray->direction.z};
    int z = fabs(d[0]) > fabs(d[1]) ? 0 : 1;
    z = fabs(d[2]) > fabs(d[z]) ? 2 : z;
    const int x = (z + 1) % 3, y = (z + 2) % 3;
    return (struct sheared_ray){
        mesh, *ray, draw_ray(mesh, ray, draw), x, y, z, d[x] / d[z], d[y] / d[z], 1.0 / d[z]};
}

struct sheared_point {
    double x, y, z;
};

static struct sheared_point shear_point(const struct sheared_ray *ray, struct neph_vec3 point)
{
    const struct neph_vec3 from = neph_vec3_sub(point, ray->ray.origin_m);
    const double p[3] = {from.x, from.y, from.z};
    return (struct sheared_point){p[ray->x] - ray->shear_x * p[ray->z],
                                  p[ray->y] - ray->shear_y * p[ray->z], ray->scale_z * p[ray->z]};
}

/* The side of the edge from a to b on which the ray passes. Exactly opposite for (b, a). */
static double edge_side(struct sheared_point a, struct sheared_point b)
{
    return b.x * a.y - b.y * a.x;
}

struct met {
    double t, facing; /* facing > 0: the ray comes from the side of the normal */
    double u, v, w;   /* sides of the edges bc, ca, ab */
};

/* The distance of the ray to a triangle's plane, within the triangle's own distances. False: it
 * does not pass the triangle between its edges. */
static bool meet_triangle(const struct sheared_ray *ray, const struct corners *t, struct met *met)
{
    const struct sheared_point a = shear_point(ray, t->a), b = shear_point(ray, t->b),
                               c = shear_point(ray, t->c);
    met->u = edge_side(b, c);
    met->v = edge_side(c, a);
    met->w = edge_side(a, b);
    if ((met->u < 0.0 || met->v < 0.0 || met->w < 0.0) &&
        (met->u > 0.0 || met->v > 0.0 || met->w > 0.0))
        return false;
    const struct neph_vec3 area = find_area(t);
    met->facing = -neph_vec3_dot(area, ray->ray.direction);
    if (met->facing == 0.0 || met->u + met->v + met->w == 0.0)
        return false; /* edge on: its neighbours are met */
    met->t = neph_vec3_dot(area, neph_vec3_sub(ray->ray.origin_m, t->a)) / met->facing;
    const double near = fmin(a.z, fmin(b.z, c.z)), far = fmax(a.z, fmax(b.z, c.z));
    if (met->t > 0.0)
        met->t = fmax(near, fmin(far, met->t));
    return met->t > 0.0;
}

/* The place that a ray has met. */
static struct neph_mesh_place find_place(const struct met *met, int triangle)
{
    const double sum = met->u + met->v + met->w;
    return (struct neph_mesh_place){triangle, {met->u / sum, met->v / sum, met->w / sum}};
}

/* Edges exactly on the ray belong to one side, the same for all of their triangles. */
static bool is_left(double side, struct neph_vec3 a, struct neph_vec3 b)
{
    return side != 0.0 ? side > 0.0 : is_before(a, b);
}

/* Whether a ray between the edges, with these sides of bc, ca and ab, crosses this triangle, and
 * not another one with which it has the edge on the ray. */
static bool is_own_crossing(const struct corners *t, double u, double v, double w)
{
    const bool left = is_left(u, t->b, t->c);
    return is_left(v, t->c, t->a) == left && is_left(w, t->a, t->b) == left;
}

/* Whether a ray passes the triangle that it has met. An edge is drawn for one triangle. */
static bool is_cut_out(const struct sheared_ray *ray, const struct met *met, int triangle)
{
    const struct neph_mesh *mesh = ray->mesh;
    if (mesh->material.alpha == NEPH_ALPHA_IGNORED)
        return false;
    const struct neph_mesh_place place = find_place(met, triangle);
    const double alpha = neph_mesh_alpha(&mesh->material, &mesh->data, &place);
    if (ray->draw == 0)
        return alpha < 0.5;
    const struct corners corners = get_corners(&mesh->data, triangle);
    if (!is_own_crossing(&corners, met->u, met->v, met->w))
        return true;
    const uint64_t own = mix_bits(ray->draw +
                                  (uint64_t)mesh->number[triangle] * 0x9e3779b97f4a7c15u);
    return alpha <= (double)(own >> 11) * 0x1p-53;
}

/* --- hits ------------------------------------------------------------------------------------ */

struct nearest {
    struct sheared_ray ray;
    struct neph_mesh_hit hit;
    struct met met;
};

static bool visit_nearest(int place, void *context)
{
    struct nearest *nearest = context;
    const struct neph_mesh *mesh = nearest->ray.mesh;
    const struct corners corners = get_corners(&mesh->data, place);
    struct met met;
    if (!meet_triangle(&nearest->ray, &corners, &met) || met.t > nearest->ray.ray.limit_m)
        return false;
    const bool has_hit = nearest->hit.t < INFINITY;
    if (met.t == nearest->ray.ray.limit_m &&
        !(has_hit && mesh->number[place] < mesh->number[nearest->hit.place.triangle]))
        return false;
    if (is_cut_out(&nearest->ray, &met, place))
        return false;
    nearest->hit.t = nearest->ray.ray.limit_m = met.t;
    nearest->hit.place.triangle = place;
    nearest->met = met;
    return false;
}

struct neph_mesh_hit neph_mesh_meet(const struct neph_mesh *mesh, struct neph_vec3 origin,
                                    struct neph_vec3 direction, double limit, uint64_t draw)
{
    const struct neph_tree_ray ray = {origin, direction, 0.0, limit};
    struct nearest nearest = {.ray = shear_ray(mesh, &ray, draw), .hit = {.t = INFINITY}};
    neph_tree_walk_ray(&mesh->tree, &nearest.ray.ray, visit_nearest, &nearest);
    if (!(nearest.hit.t < INFINITY))
        return nearest.hit;
    nearest.hit.place = find_place(&nearest.met, nearest.hit.place.triangle);
    nearest.hit.normal = neph_vec3_scale(neph_mesh_normal(mesh, nearest.hit.place.triangle),
                                         nearest.met.facing > 0.0 ? 1.0 : -1.0);
    return nearest.hit;
}

static bool visit_any(int place, void *context)
{
    const struct sheared_ray *ray = context;
    const struct corners corners = get_corners(&ray->mesh->data, place);
    struct met met;
    return meet_triangle(ray, &corners, &met) && met.t > ray->ray.t_min_m &&
           met.t < ray->ray.limit_m && !is_cut_out(ray, &met, place);
}

bool neph_mesh_blocks(const struct neph_mesh *mesh, struct neph_vec3 origin,
                      struct neph_vec3 direction, double t_min, double limit, uint64_t draw)
{
    const struct neph_tree_ray ray = {origin, direction, t_min, limit};
    struct sheared_ray sheared = shear_ray(mesh, &ray, draw);
    return neph_tree_walk_ray(&mesh->tree, &sheared.ray, visit_any, &sheared);
}

/* --- inside ---------------------------------------------------------------------------------- */

struct crossings {
    struct sheared_ray ray;
    int count, sum; /* signed: 1 where the ray leaves */
};

static bool visit_crossing(int place, void *context)
{
    struct crossings *crossings = context;
    const struct corners t = get_corners(&crossings->ray.mesh->data, place);
    const struct sheared_ray *ray = &crossings->ray;
    const struct sheared_point a = shear_point(ray, t.a), b = shear_point(ray, t.b),
                               c = shear_point(ray, t.c);
    if (!is_own_crossing(&t, edge_side(b, c), edge_side(c, a), edge_side(a, b)))
        return false;
    const struct neph_vec3 area = find_area(&t);
    const double facing = -neph_vec3_dot(area, ray->ray.direction);
    const double from = neph_vec3_dot(area, neph_vec3_sub(ray->ray.origin_m, t.a));
    if (facing == 0.0 || !(from / facing > 0.0))
        return false;
    crossings->count++;
    crossings->sum += facing < 0.0 ? 1 : -1;
    return false;
}

bool neph_mesh_contains(const struct neph_mesh *mesh, struct neph_vec3 point)
{
    /* Any direction; meshes rarely have edges along this one. */
    const struct neph_vec3 direction = {0.5377, 0.7324, -0.4177};
    const struct neph_tree_ray ray = {point, direction, 0.0, INFINITY};
    struct crossings crossings = {.ray = shear_ray(mesh, &ray, 0)};
    if (mesh->inside == NEPH_MESH_OPEN)
        return false;
    neph_tree_walk_ray(&mesh->tree, &crossings.ray.ray, visit_crossing, &crossings);
    return mesh->inside == NEPH_MESH_ORIENTED ? crossings.sum != 0 : crossings.count % 2 == 1;
}

/* --- shadows --------------------------------------------------------------------------------- */

struct shadow_visit {
    const struct neph_mesh *mesh;
    const struct neph_shadow_ray *ray;
    struct neph_shadows *shadows;
};

/* Where the ray is beside the plane through an edge and the light. The order of the points decides
 * the sign only, so the two triangles of an edge have the same root. */
static struct neph_affine edge_plane(const struct neph_shadow_ray *ray, struct neph_vec3 a,
                                     struct neph_vec3 b)
{
    const bool swaps = is_before(b, a);
    const struct neph_vec3 from = swaps ? b : a, to = swaps ? a : b;
    const struct neph_vec3 light = ray->light_m ? neph_vec3_sub(*ray->light_m, from) : ray->sun;
    const struct neph_vec3 n = neph_vec3_cross(neph_vec3_sub(to, from), light);
    const struct neph_affine side = {neph_vec3_dot(n, neph_vec3_sub(ray->origin_m, from)),
                                     neph_vec3_dot(n, ray->direction)};
    return swaps ? (struct neph_affine){-side.constant, -side.slope} : side;
}

/* The ray is hidden where it is within the three planes and on the far side of the triangle. */
static bool visit_shadow(int place, void *context)
{
    const struct shadow_visit *visit = context;
    const struct neph_shadow_ray *ray = visit->ray;
    const struct corners t = get_corners(&visit->mesh->data, place);
    const struct neph_vec3 area = find_area(&t);
    const struct neph_vec3 light = ray->light_m ? neph_vec3_sub(*ray->light_m, t.a) : ray->sun;
    const double facing = neph_vec3_dot(area, light); /* > 0: the light is on the normal's side */
    const struct neph_affine behind = {neph_vec3_dot(area, neph_vec3_sub(ray->origin_m, t.a)),
                                       neph_vec3_dot(area, ray->direction)};
    const struct neph_affine sides[4] = {behind, edge_plane(ray, t.a, t.b),
                                         edge_plane(ray, t.b, t.c), edge_plane(ray, t.c, t.a)};
    const struct neph_affine zero = {0.0, 0.0};
    double t0_m = ray->t0_m, t1_m = ray->t1_m;
    if (facing == 0.0)
        return false;
    for (int i = 0; i < 4; i++)
        if (!(facing > 0.0 ? neph_clip_less_equal(sides[i], zero, &t0_m, &t1_m)
                           : neph_clip_less_equal(zero, sides[i], &t0_m, &t1_m)))
            return false;
    if (t0_m < t1_m)
        neph_shadows_add(visit->shadows, t0_m, t1_m);
    return false;
}

void neph_mesh_add_shadows(const struct neph_mesh *mesh, const struct neph_shadow_ray *ray,
                           struct neph_shadows *shadows)
{
    struct shadow_visit visit = {mesh, ray, shadows};
    neph_tree_walk_shadow(&mesh->tree, ray, shadows, visit_shadow, &visit);
}
