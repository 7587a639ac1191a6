/* SPDX-License-Identifier: MIT
 *
 * Boxes and spheres are convex, so a ray meets each in one interval. The shadow of a solid is
 * convex, too: the points from which the sun is hidden are the solid swept away from the sun. The
 * same is true for a point light at L: with k1 and k2 in the solid and factors a, b >= 1 the middle
 * of L + a (k1 - L) and L + b (k2 - L) is L + (a + b)/2 (k - L), with k between k1 and k2.
 */
#include "scenes/solids.h"

#include "scenes/bounds.h"
#include "scenes/box_shadow.h"
#include "scenes/mesh.h"

#include <math.h>
#include <stddef.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_SOLID_KIND_COUNT == 3, "a new kind");

/* --- rotated boxes --------------------------------------------------------------------------- */

struct neph_vec3 neph_rotate(const struct neph_turn *turn, struct neph_vec3 v)
{
    const double c = turn->cosine, s = turn->sine;
    switch (turn->axis) {
    case 0:
        return (struct neph_vec3){v.x, c * v.y - s * v.z, s * v.y + c * v.z};
    case 1:
        return (struct neph_vec3){c * v.x + s * v.z, v.y, c * v.z - s * v.x};
    default:
        return (struct neph_vec3){c * v.x - s * v.y, s * v.x + c * v.y, v.z};
    }
}

struct neph_vec3 neph_rotate_back(const struct neph_turn *turn, struct neph_vec3 vector)
{
    const struct neph_turn back = {turn->axis, turn->cosine, -turn->sine};
    return neph_rotate(&back, vector);
}

struct neph_vec3 neph_box_direction(const struct neph_solid *box, struct neph_vec3 direction)
{
    return neph_is_turned(&box->turn) ? neph_rotate_back(&box->turn, direction) : direction;
}

struct neph_vec3 neph_box_place_m(const struct neph_solid *box, struct neph_vec3 point_m)
{
    return neph_box_direction(box, neph_vec3_sub(point_m, neph_bounds_middle(&box->box)));
}

/* A point in the coordinates of the unrotated box. */
static struct neph_vec3 to_box_axes(const struct neph_solid *solid, struct neph_vec3 point_m)
{
    if (!neph_is_turned(&solid->turn))
        return point_m;
    return neph_vec3_add(neph_bounds_middle(&solid->box), neph_box_place_m(solid, point_m));
}

struct neph_bounds neph_turned_box_bounds(const struct neph_bounds *box,
                                          const struct neph_turn *turn)
{
    const struct neph_vec3 half_m = neph_vec3_scale(neph_vec3_sub(box->max_m, box->min_m), 0.5);
    const struct neph_turn by = {turn->axis, fabs(turn->cosine), fabs(turn->sine)};
    const struct neph_turn back = {by.axis, by.cosine, -by.sine};
    const struct neph_vec3 a = neph_rotate(&by, half_m), b = neph_rotate(&back, half_m);
    const struct neph_vec3 reach_m = {fmax(a.x, b.x), fmax(a.y, b.y), fmax(a.z, b.z)};
    const struct neph_vec3 middle_m = neph_bounds_middle(box);
    return (struct neph_bounds){neph_vec3_sub(middle_m, reach_m), neph_vec3_add(middle_m, reach_m)};
}

/* --- the space of a mesh --------------------------------------------------------------------- */

/* Both without the scale. */
static struct neph_vec3 to_mesh_axes(const struct neph_solid *solid, struct neph_vec3 vector)
{
    const struct neph_vec3 turned = neph_box_direction(solid, vector);
    return neph_is_turned(&solid->yaw) ? neph_rotate_back(&solid->yaw, turned) : turned;
}

static struct neph_vec3 from_mesh_axes(const struct neph_solid *solid, struct neph_vec3 vector)
{
    if (neph_is_turned(&solid->yaw))
        vector = neph_rotate(&solid->yaw, vector);
    return neph_is_turned(&solid->turn) ? neph_rotate(&solid->turn, vector) : vector;
}

static struct neph_vec3 to_mesh(const struct neph_solid *solid, struct neph_vec3 point_m)
{
    return neph_vec3_scale(to_mesh_axes(solid, neph_vec3_sub(point_m, solid->center_m)),
                           1.0 / solid->scale_m);
}

static struct neph_vec3 from_mesh(const struct neph_solid *solid, struct neph_vec3 point)
{
    return neph_vec3_along(solid->center_m, from_mesh_axes(solid, point), solid->scale_m);
}

/* The direction of a ray whose t is in metres. */
static struct neph_vec3 to_mesh_ray(const struct neph_solid *solid, struct neph_vec3 direction)
{
    return neph_vec3_scale(to_mesh_axes(solid, direction), 1.0 / solid->scale_m);
}

/* Around the corners of the mesh's box. */
static struct neph_bounds mesh_bounds(const struct neph_solid *solid)
{
    const struct neph_bounds *box = &solid->mesh->tree.nodes[0].bounds;
    struct neph_bounds around = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (int corner = 0; corner < 8; corner++) {
        const struct neph_vec3 at = from_mesh(
            solid, (struct neph_vec3){corner & 1 ? box->max_m.x : box->min_m.x,
                                      corner & 2 ? box->max_m.y : box->min_m.y,
                                      corner & 4 ? box->max_m.z : box->min_m.z});
        around = neph_bounds_hull(around, (struct neph_bounds){at, at});
    }
    return around;
}

struct neph_bounds neph_solid_bounds(const struct neph_solid *solid)
{
    if (solid->kind == NEPH_SOLID_MESH)
        return mesh_bounds(solid);
    if (solid->kind == NEPH_SOLID_SPHERE)
        return neph_bounds_around(solid->center_m, solid->radius_m);
    if (!neph_is_turned(&solid->turn))
        return solid->box;
    return neph_turned_box_bounds(&solid->box, &solid->turn);
}

/* --- rays ------------------------------------------------------------------------------------ */

bool neph_solid_contains(const struct neph_solid *solid, struct neph_vec3 point_m)
{
    if (solid->kind == NEPH_SOLID_MESH)
        return neph_mesh_contains(solid->mesh, to_mesh(solid, point_m));
    if (solid->kind == NEPH_SOLID_SPHERE)
        return neph_vec3_length(neph_vec3_sub(point_m, solid->center_m)) <= solid->radius_m;
    return neph_bounds_contain(&solid->box, to_box_axes(solid, point_m));
}

/* A shadow ray starts on a surface: nearer hits are that surface. Points of a sphere are rounded to
 * 1e-16 of its size; a low sun increases the resulting distance. */
static double shadow_start_m(const struct neph_solid *solid)
{
    return fmax(1e-9, solid->kind == NEPH_SOLID_SPHERE ? 1e-12 * solid->radius_m : 0.0);
}

/* radius^2 - distance^2 as a product, because the difference cancels on the surface of a planet. */
static double half_chord_squared(double radius_m, double distance_m)
{
    return (radius_m - distance_m) * (radius_m + distance_m);
}

/* The entry and exit of a ray; false when it misses. */
static bool sphere_interval(const struct neph_solid *sphere, struct neph_vec3 origin_m,
                            struct neph_vec3 direction, double *t0_m, double *t1_m)
{
    const struct neph_vec3 offset_m = neph_vec3_sub(origin_m, sphere->center_m);
    const double middle_m = -neph_vec3_dot(offset_m, direction);
    const struct neph_vec3 nearest_m = neph_vec3_along(offset_m, direction, middle_m);
    const double half_squared = half_chord_squared(sphere->radius_m, neph_vec3_length(nearest_m));
    if (half_squared <= 0.0)
        return false;
    *t0_m = middle_m - sqrt(half_squared);
    *t1_m = middle_m + sqrt(half_squared);
    return true;
}

static bool solid_interval(const struct neph_solid *solid, struct neph_vec3 origin_m,
                           struct neph_vec3 direction, double *t0_m, double *t1_m)
{
    if (solid->kind == NEPH_SOLID_SPHERE)
        return sphere_interval(solid, origin_m, direction, t0_m, t1_m);
    *t0_m = -INFINITY;
    *t1_m = INFINITY;
    return neph_bounds_clip(&solid->box, to_box_axes(solid, origin_m),
                            neph_box_direction(solid, direction), t0_m, t1_m);
}

/* The normal of the face on which a point lies: the face nearest to it. */
static struct neph_vec3 box_normal(const struct neph_bounds *box, struct neph_vec3 p)
{
    const double distance_m[6] = {fabs(p.x - box->min_m.x), fabs(p.x - box->max_m.x),
                                  fabs(p.y - box->min_m.y), fabs(p.y - box->max_m.y),
                                  fabs(p.z - box->min_m.z), fabs(p.z - box->max_m.z)};
    static const struct neph_vec3 normals[6] = {{-1, 0, 0}, {1, 0, 0},  {0, -1, 0},
                                                {0, 1, 0},  {0, 0, -1}, {0, 0, 1}};
    int nearest = 0;
    for (int face = 1; face < 6; face++)
        if (distance_m[face] < distance_m[nearest])
            nearest = face;
    return normals[nearest];
}

static struct neph_vec3 solid_normal(const struct neph_solid *solid, struct neph_vec3 point_m)
{
    if (solid->kind == NEPH_SOLID_SPHERE)
        return neph_vec3_normalize(neph_vec3_sub(point_m, solid->center_m));
    const struct neph_vec3 normal = box_normal(&solid->box, to_box_axes(solid, point_m));
    return neph_is_turned(&solid->turn) ? neph_rotate(&solid->turn, normal) : normal;
}

/* --- trees ----------------------------------------------------------------------------------- */

/* With fewer solids, tests of all take less time than the tree. */
enum { TREE_FROM = 12 };

struct tree_block {
    struct neph_box_tree tree;
    max_align_t rest[]; /* nodes, bounds of the solids, their order */
};

size_t neph_scene_tree_bytes(int solid_count)
{
    const size_t count = (size_t)solid_count;
    return solid_count < TREE_FROM
               ? 0
               : sizeof(struct tree_block) +
                     (size_t)neph_box_tree_room(solid_count) * sizeof(struct neph_tree_node) +
                     count * (sizeof(struct neph_bounds) + sizeof(int));
}

/* Slightly larger: solids round, too. */
static struct neph_bounds find_tree_bounds(const struct neph_solid *solid)
{
    const struct neph_bounds box = neph_solid_bounds(solid);
    const struct neph_vec3 away = neph_bounds_farthest(&box, (struct neph_vec3){0, 0, 0});
    const double by_m = 1e-9 * neph_vec3_length(away);
    const struct neph_vec3 margin_m = {by_m, by_m, by_m};
    return (struct neph_bounds){neph_vec3_sub(box.min_m, margin_m),
                                neph_vec3_add(box.max_m, margin_m)};
}

struct neph_box_tree *neph_scene_tree_build(const struct neph_solid *solids, int solid_count,
                                            void *memory)
{
    struct tree_block *block = memory;
    struct neph_tree_node *nodes = (void *)block->rest;
    struct neph_bounds *boxes = (void *)(nodes + neph_box_tree_room(solid_count));
    for (int i = 0; i < solid_count; i++)
        boxes[i] = find_tree_bounds(&solids[i]);
    block->tree = neph_box_tree_build(boxes, solid_count, nodes, (int *)(boxes + solid_count));
    return &block->tree;
}

/* NULL: none, or that of other solids. */
static const struct neph_box_tree *find_tree(const struct neph_scene *scene)
{
    const struct neph_box_tree *tree = scene->solid_tree;
    return tree && tree->item_count == scene->solid_count ? tree : NULL;
}

/* --- hits ------------------------------------------------------------------------------------ */

struct hit_search {
    const struct neph_scene *scene;
    struct neph_tree_ray ray;
    int nearest; /* -1: none */
    struct neph_mesh_hit mesh_hit;
};

/* The distance of a solid, where it is nearer than the nearest, or as near and before it in the
 * scene. */
static void try_hit(struct hit_search *search, int index)
{
    const struct neph_solid *solid = &search->scene->solids[index];
    const struct neph_vec3 origin_m = search->ray.origin_m, direction = search->ray.direction;
    const double limit_m = index < search->nearest ? nextafter(search->ray.limit_m, INFINITY)
                                                   : search->ray.limit_m;
    double t0_m, t1_m, t_m;
    if (solid->kind == NEPH_SOLID_MESH) {
        const struct neph_mesh_hit hit = neph_mesh_meet(solid->mesh, to_mesh(solid, origin_m),
                                                        to_mesh_ray(solid, direction), limit_m,
                                                        search->scene->coverage_draw);
        if (!(hit.t < INFINITY))
            return;
        search->mesh_hit = hit;
        t_m = hit.t;
    } else {
        if (!solid_interval(solid, origin_m, direction, &t0_m, &t1_m))
            return;
        t_m = t0_m > 0.0 ? t0_m : t1_m;
    }
    if (t_m > 0.0 && t_m < limit_m) {
        search->ray.limit_m = t_m;
        search->nearest = index;
    }
}

static bool visit_hit(int place, void *context)
{
    struct hit_search *search = context;
    try_hit(search, search->scene->solid_tree->order[place]);
    return false;
}

struct neph_hit neph_scene_hit(const struct neph_scene *scene, struct neph_vec3 origin_m,
                               struct neph_vec3 direction)
{
    struct hit_search search = {scene, {origin_m, direction, 0.0, INFINITY}, -1, {0}};
    const struct neph_box_tree *tree = find_tree(scene);
    if (tree)
        neph_tree_walk_ray(tree, &search.ray, visit_hit, &search);
    for (int i = 0; i < scene->solid_count && !tree; i++)
        try_hit(&search, i);
    struct neph_hit hit = {.t_m = search.ray.limit_m};
    if (search.nearest < 0)
        return hit;
    hit.solid = &scene->solids[search.nearest];
    if (hit.solid->kind != NEPH_SOLID_MESH) {
        hit.normal = solid_normal(hit.solid, neph_vec3_along(origin_m, direction, hit.t_m));
        hit.shading = hit.normal;
        return hit;
    }
    const struct neph_mesh *mesh = hit.solid->mesh;
    const struct neph_mesh_data *data = &mesh->data;
    hit.place = search.mesh_hit.place;
    const int corner = data->triangles[hit.place.triangle][0];
    hit.normal = from_mesh_axes(hit.solid, search.mesh_hit.normal);
    hit.shading = from_mesh_axes(
        hit.solid,
        neph_mesh_shading_normal(&mesh->material, data, &hit.place, search.mesh_hit.normal));
    hit.plane_m = neph_vec3_dot(hit.normal, from_mesh(hit.solid, data->positions[corner]));
    return hit;
}

/* On the plane of a triangle first: the point of a long thin one is far from it. */
static struct neph_vec3 move_off_triangle(const struct neph_hit *hit, struct neph_vec3 point_m,
                                          double scale_m)
{
    const struct neph_solid *solid = hit->solid;
    scale_m = fmax(scale_m, neph_vec3_length(solid->center_m) +
                                2.0 * solid->scale_m * solid->mesh->tree.reach_m);
    const double below_m = hit->plane_m - neph_vec3_dot(hit->normal, point_m);
    return neph_vec3_along(point_m, hit->normal, below_m + 1e-12 * scale_m);
}

struct neph_vec3 neph_hit_outside_m(const struct neph_hit *hit, struct neph_vec3 point_m)
{
    double scale_m = fmax(1.0, neph_vec3_length(point_m) + hit->t_m);
    if (hit->solid->kind == NEPH_SOLID_MESH)
        return move_off_triangle(hit, point_m, scale_m);
    if (hit->solid->kind == NEPH_SOLID_SPHERE)
        scale_m = fmax(scale_m, hit->solid->radius_m);
    return neph_vec3_along(point_m, hit->normal, 1e-12 * scale_m);
}

struct block_search {
    const struct neph_scene *scene;
    struct neph_tree_ray ray;
};

static bool blocks(const struct block_search *search, int index)
{
    const struct neph_solid *solid = &search->scene->solids[index];
    const struct neph_tree_ray *ray = &search->ray;
    double t0_m, t1_m;
    if (solid->kind == NEPH_SOLID_MESH)
        return neph_mesh_blocks(solid->mesh, to_mesh(solid, ray->origin_m),
                                to_mesh_ray(solid, ray->direction), shadow_start_m(solid),
                                ray->limit_m, search->scene->coverage_draw);
    return solid_interval(solid, ray->origin_m, ray->direction, &t0_m, &t1_m) &&
           t1_m > shadow_start_m(solid) && t0_m < ray->limit_m;
}

static bool visit_block(int place, void *context)
{
    const struct block_search *search = context;
    return blocks(search, search->scene->solid_tree->order[place]);
}

/* Whether a solid is on the ray before a distance. */
static bool is_blocked(const struct neph_scene *scene, struct neph_vec3 point_m,
                       struct neph_vec3 direction, double distance_m)
{
    struct block_search search = {scene, {point_m, direction, 0.0, distance_m}};
    const struct neph_box_tree *tree = find_tree(scene);
    if (tree)
        return neph_tree_walk_ray(tree, &search.ray, visit_block, &search);
    for (int i = 0; i < scene->solid_count; i++)
        if (blocks(&search, i))
            return true;
    return false;
}

bool neph_scene_is_sun_visible(const struct neph_scene *scene, struct neph_vec3 point_m)
{
    return !is_blocked(scene, point_m, scene->sun.direction, INFINITY);
}

bool neph_scene_is_visible(const struct neph_scene *scene, struct neph_vec3 point_m,
                           struct neph_vec3 other_m)
{
    const struct neph_vec3 toward_m = neph_vec3_sub(other_m, point_m);
    const double distance_m = neph_vec3_length(toward_m);
    return distance_m == 0.0 ||
           !is_blocked(scene, point_m, neph_vec3_scale(toward_m, 1.0 / distance_m), distance_m);
}

/* --- shadows from the sun -------------------------------------------------------------------- */

/* Shadow of a sphere: where the nearest point of the sun ray lies ahead, the ray is tested with the
 * cylinder along the sun; where it lies behind, with the sphere itself. */
static bool sphere_shadow(const struct neph_solid *sphere, struct neph_vec3 sun, struct neph_vec3 o,
                          struct neph_vec3 d, double *u0, double *u1)
{
    const struct neph_vec3 w = neph_vec3_sub(o, sphere->center_m);
    /* The nearest approach is at t*(u) = -(w + u d).s; it is ahead while t* >= 0. */
    const struct neph_affine behind = {neph_vec3_dot(w, sun), neph_vec3_dot(d, sun)};
    const struct neph_affine zero = {0.0, 0.0};

    double low = INFINITY, high = -INFINITY;
    double a0 = *u0, a1 = *u1;
    if (neph_clip_less_equal(behind, zero, &a0, &a1)) {
        const struct neph_vec3 w_across = neph_vec3_along(w, sun, -behind.constant);
        const struct neph_vec3 d_across = neph_vec3_along(d, sun, -behind.slope);
        const double speed_squared = neph_vec3_dot(d_across, d_across);
        if (speed_squared < 1e-24) { /* parallel to the sun: always inside the cylinder or never */
            if (neph_vec3_dot(w_across, w_across) < sphere->radius_m * sphere->radius_m) {
                low = a0;
                high = a1;
            }
        } else {
            const double middle = -neph_vec3_dot(w_across, d_across) / speed_squared;
            const struct neph_vec3 nearest = neph_vec3_along(w_across, d_across, middle);
            const double half_squared = half_chord_squared(sphere->radius_m,
                                                           neph_vec3_length(nearest));
            if (half_squared > 0.0) {
                const double half = sqrt(half_squared / speed_squared);
                const double c0 = fmax(a0, middle - half), c1 = fmin(a1, middle + half);
                if (c0 < c1) {
                    low = c0;
                    high = c1;
                }
            }
        }
    }
    double b0 = *u0, b1 = *u1, s0, s1;
    if (neph_clip_less_equal(zero, behind, &b0, &b1) && sphere_interval(sphere, o, d, &s0, &s1)) {
        b0 = fmax(b0, s0);
        b1 = fmin(b1, s1);
        if (b0 < b1) {
            low = fmin(low, b0);
            high = fmax(high, b1);
        }
    }
    *u0 = low;
    *u1 = high;
    return low < high;
}

bool neph_solid_shadow(const struct neph_solid *solid, struct neph_vec3 sun_direction,
                       struct neph_vec3 origin_m, struct neph_vec3 direction, double t0_m,
                       double t1_m, double *shadow_t0_m, double *shadow_t1_m)
{
    double u0 = t0_m, u1 = t1_m;
    const bool hidden = solid->kind == NEPH_SOLID_SPHERE
                            ? sphere_shadow(solid, sun_direction, origin_m, direction, &u0, &u1)
                            : neph_box_shadow(&solid->box, neph_box_direction(solid, sun_direction),
                                              to_box_axes(solid, origin_m),
                                              neph_box_direction(solid, direction), &u0, &u1);
    if (!hidden)
        return false;
    *shadow_t0_m = u0;
    *shadow_t1_m = u1;
    return true;
}

/* --- shadows from a point -------------------------------------------------------------------- */

/* Whether a sphere hides one point from another. */
static bool sphere_hides(const struct neph_solid *sphere, struct neph_vec3 light_m,
                         struct neph_vec3 point_m)
{
    const struct neph_vec3 toward_m = neph_vec3_sub(light_m, point_m);
    const double distance_m = neph_vec3_length(toward_m);
    double t0_m, t1_m;
    return distance_m > 0.0 &&
           sphere_interval(sphere, point_m, neph_vec3_scale(toward_m, 1.0 / distance_m), &t0_m,
                           &t1_m) &&
           t1_m > 0.0 && t0_m < distance_m;
}

/* Real roots of a u^2 + 2 b u + c; returns their number. */
static int quadratic_roots(double a, double b, double c, double roots[2])
{
    const double discriminant = b * b - a * c;
    if (discriminant <= 0.0 || (a == 0.0 && b == 0.0))
        return 0;
    const double q = -(b + copysign(sqrt(discriminant), b));
    int count = 0;
    if (a != 0.0)
        roots[count++] = q / a;
    if (q != 0.0)
        roots[count++] = c / q;
    return count;
}

/* The edge of the shadow is on the tangent cone around the sphere or on the sphere; between two
 * intersections of the ray with these the ray is entirely hidden or entirely visible. */
static bool sphere_point_shadow(const struct neph_solid *sphere, struct neph_vec3 light_m,
                                struct neph_vec3 o, struct neph_vec3 d, double *u0, double *u1)
{
    const struct neph_vec3 axis_m = neph_vec3_sub(sphere->center_m, light_m);
    const struct neph_vec3 w = neph_vec3_sub(o, light_m);
    const double tangent_squared = -half_chord_squared(sphere->radius_m, neph_vec3_length(axis_m));
    const double wa = neph_vec3_dot(w, axis_m), da = neph_vec3_dot(d, axis_m);
    double at[6] = {*u0, *u1};
    int count = 2 + quadratic_roots(da * da - tangent_squared,
                                    wa * da - tangent_squared * neph_vec3_dot(w, d),
                                    wa * wa - tangent_squared * neph_vec3_dot(w, w), &at[2]);
    if (sphere_interval(sphere, o, d, &at[count], &at[count + 1]))
        count += 2;
    double low = INFINITY, high = -INFINITY;
    for (int i = 0; i < count; i++) { /* from each place to the next above it */
        double next = INFINITY;
        for (int j = 0; j < count; j++)
            next = at[j] > at[i] ? fmin(next, at[j]) : next;
        const double a = fmax(at[i], *u0), b = fmin(next, *u1);
        if (a < b && sphere_hides(sphere, light_m, neph_vec3_along(o, d, 0.5 * (a + b)))) {
            low = fmin(low, a);
            high = fmax(high, b);
        }
    }
    *u0 = low;
    *u1 = high;
    return low < high;
}

bool neph_solid_point_shadow(const struct neph_solid *solid, struct neph_vec3 light_m,
                             struct neph_vec3 origin_m, struct neph_vec3 direction, double t0_m,
                             double t1_m, double *shadow_t0_m, double *shadow_t1_m)
{
    double u0 = t0_m, u1 = t1_m;
    const bool hidden = solid->kind == NEPH_SOLID_SPHERE
                            ? sphere_point_shadow(solid, light_m, origin_m, direction, &u0, &u1)
                            : neph_box_point_shadow(&solid->box, to_box_axes(solid, light_m),
                                                    to_box_axes(solid, origin_m),
                                                    neph_box_direction(solid, direction), &u0, &u1);
    if (!hidden)
        return false;
    *shadow_t0_m = u0;
    *shadow_t1_m = u1;
    return true;
}

/* --- shadows of all -------------------------------------------------------------------------- */

static void add_mesh_shadows(const struct neph_solid *solid, const struct neph_shadow_ray *ray,
                             struct neph_shadows *shadows)
{
    const struct neph_vec3 light = ray->light_m ? to_mesh(solid, *ray->light_m) : ray->sun;
    const struct neph_shadow_ray own = {to_mesh(solid, ray->origin_m),
                                        to_mesh_ray(solid, ray->direction),
                                        to_mesh_axes(solid, ray->sun),
                                        ray->light_m ? &light : NULL,
                                        ray->t0_m,
                                        ray->t1_m};
    neph_mesh_add_shadows(solid->mesh, &own, shadows);
}

void neph_solid_add_shadows(const struct neph_solid *solid, const struct neph_shadow_ray *ray,
                            struct neph_shadows *shadows)
{
    double t0_m, t1_m;
    if (solid->kind == NEPH_SOLID_MESH)
        add_mesh_shadows(solid, ray, shadows);
    else if (ray->light_m
                 ? neph_solid_point_shadow(solid, *ray->light_m, ray->origin_m, ray->direction,
                                           ray->t0_m, ray->t1_m, &t0_m, &t1_m)
                 : neph_solid_shadow(solid, ray->sun, ray->origin_m, ray->direction, ray->t0_m,
                                     ray->t1_m, &t0_m, &t1_m))
        neph_shadows_add(shadows, t0_m, t1_m);
}

struct shadow_search {
    const struct neph_scene *scene;
    const struct neph_shadow_ray *ray;
    struct neph_shadows *shadows;
};

static bool visit_shadow(int place, void *context)
{
    const struct shadow_search *search = context;
    const int index = search->scene->solid_tree->order[place];
    neph_solid_add_shadows(&search->scene->solids[index], search->ray, search->shadows);
    return false;
}

void neph_scene_add_shadows(const struct neph_scene *scene, const struct neph_shadow_ray *ray,
                            struct neph_shadows *shadows)
{
    struct shadow_search search = {scene, ray, shadows};
    const struct neph_box_tree *tree = find_tree(scene);
    if (tree)
        neph_tree_walk_shadow(tree, ray, shadows, visit_shadow, &search);
    for (int i = 0; i < scene->solid_count && !tree; i++)
        neph_solid_add_shadows(&scene->solids[i], ray, shadows);
}
