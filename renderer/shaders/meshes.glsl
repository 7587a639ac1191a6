// SPDX-License-Identifier: MIT
//
// Rays and triangle meshes (mesh_data.glsl): nearest hit and any hit.
//
// Rays meet triangles by S. Woop, C. Benthin, I. Wald, "Watertight Ray/Triangle Intersection", JCGT
// 2(1), 2013, in float32: no ray passes between triangles with a common edge or vertex. The signs
// of its edge functions are never wrong, because rounding keeps the order of two products; an edge
// function that rounds to 0 belongs to both sides. `precise` forbids fused operations, which would
// round the two sides of an edge differently.
#ifndef NEPH_MESHES_GLSL
#define NEPH_MESHES_GLSL

#include "mesh_looks.glsl"

// --- rays ---------------------------------------------------------------------------------------

// A ray in the axes of a mesh, in the mesh's unit of length; t is in metres. In sheared
// coordinates, with the axes `longest` + 1, + 2 and + 0, it is (0, 0, t).
struct MeshRay {
    vec3 origin;
    vec3 direction; // of the length 1 / scale_m
    vec3 inverse;
    vec3 margin;  // boxes are larger by it, more than all rounding
    uint longest; // axis
    vec3 shear;
};

// Rounding of float32, with a reserve: of positions relative to their own size.
const float MESH_ROUNDING = 1e-6;

MeshRay mesh_ray(vec3 origin, vec3 direction, float reach)
{
    MeshRay ray;
    ray.origin = origin;
    ray.direction = direction;
    vec3 size = abs(direction);
    vec3 toward = mix(vec3(-1.0), vec3(1.0), greaterThanEqual(direction, vec3(0.0)));
    ray.inverse = toward / max(size, vec3(PARALLEL));
    vec3 far = abs(origin);
    ray.margin = vec3(MESH_ROUNDING * (reach + max(far.x, max(far.y, far.z))));
    ray.longest = size.x > size.y ? 0u : 1u;
    ray.longest = size.z > max(size.x, size.y) ? 2u : ray.longest;
    vec3 d = ray.longest == 0u ? direction.yzx : ray.longest == 1u ? direction.zxy : direction;
    ray.shear = vec3(d.xy, 1.0) / d.z;
    return ray;
}

// The part of the ray in a box between two distances. A ray in a face of the enlarged box may miss
// it, because it is outside the box itself.
bool meets_box(MeshRay ray, vec3 low, vec3 high, float start_m, float end_m)
{
    vec3 a = (low - ray.margin - ray.origin) * ray.inverse;
    vec3 b = (high + ray.margin - ray.origin) * ray.inverse;
    vec3 near = min(a, b), far = max(a, b);
    float t0_m = max(max(near.x, near.y), max(near.z, start_m));
    float t1_m = min(min(far.x, far.y), min(far.z, end_m));
    return t0_m <= t1_m;
}

vec3 sheared(MeshRay ray, vec3 point)
{
    vec3 from = point - ray.origin;
    vec3 p = ray.longest == 0u ? from.yzx : ray.longest == 1u ? from.zxy : from;
    precise vec3 at = vec3(p.x - ray.shear.x * p.z, p.y - ray.shear.y * p.z, ray.shear.z * p.z);
    return at;
}

// The side of the edge from a to b on which the ray passes; exactly opposite for (b, a).
float edge_side(vec3 a, vec3 b)
{
    precise float left = b.x * a.y, right = b.y * a.x;
    precise float side = left - right;
    return side;
}

// The distance of the ray to a triangle's plane, within the distances of the triangle itself, and
// the sides of the edges bc, ca and ab. False: the ray does not pass it between its edges.
bool meet_triangle(MeshRay ray, Triangle t, out float t_m, out bool is_back, out vec3 sides)
{
    vec3 a = sheared(ray, t.a), b = sheared(ray, t.b), c = sheared(ray, t.c);
    sides = vec3(edge_side(b, c), edge_side(c, a), edge_side(a, b));
    vec3 low = min(a, min(b, c)), high = max(a, max(b, c));
    t_m = 0.0;
    is_back = false;
    if (any(lessThan(sides, vec3(0.0))) && any(greaterThan(sides, vec3(0.0))))
        return false;
    // All sides of a triangle that is edge on, in a plane with the ray, may round to 0, also beside
    // the triangle.
    if (any(greaterThan(low.xy, vec2(0.0))) || any(lessThan(high.xy, vec2(0.0))))
        return false;
    vec3 area = triangle_area(t);
    float facing = -dot(area, ray.direction);
    if (facing == 0.0 || sides == vec3(0.0))
        return false; // edge on: its neighbours are met
    is_back = facing < 0.0;
    t_m = clamp(dot(area, ray.origin - t.a) / facing, low.z, high.z);
    return t_m > 0.0;
}

// --- walks --------------------------------------------------------------------------------------

// The trees are walked by all threads of a subgroup together: a node is entered if one of them
// meets its box. So its index is the same in all of them, and the device reads it once. Paths of
// the tracer go different ways, each thread for itself.
#ifdef WALKS_ALONE
#define is_entered(meets) (meets)

// Loop iterations of this thread in walks. A bound of them is far above their mean, so a kernel on
// a CPU counts them and ends its dispatch before its loops are left (renderer/compute.h). lavapipe
// executes a loop that no thread enters once. Eight threads of a subgroup whose walks never
// coincide take NEPH_GPU_WALKS together.
uint walked = 0u;

void count_walk(uint iterations) { walked += ON_CPU ? iterations : 0u; }

bool has_walked_enough() { return MESHES && ON_CPU && walked >= NEPH_GPU_WALKS / 8; }
#else
#extension GL_KHR_shader_subgroup_vote : require
#define is_entered(meets) subgroupAny(meets)

void count_walk(uint iterations) {}
#endif

// Iterations that the loops over the leaves take for each leaf, with the loops in them.
const uint TRIANGLE_LEAF_TURNS = 3;
const uint INSTANCE_LEAF_TURNS = 2 + TRIANGLE_LEAF_TURNS;

// The content of the next leaf that the ray meets, from node `n` on and before node `behind`; `n`
// then is the node after the leaf. 0: none. Walks that go together stop at a leaf that another
// thread meets. Leaves are handled outside of this loop: without branches their work would be done
// for each node.
uint find_leaf(uint first, MeshRay ray, bool is_open, float start_m, float end_m, uint behind,
               inout uint n)
{
    uint leaf = 0u, found = 0u;
    while (n < behind && found == 0u) {
        MeshNode node = mesh_node(first, n);
        bool meets = is_open && meets_box(ray, node.low_m, node.high_m, start_m, end_m);
        bool enters = is_entered(meets);
        leaf |= meets ? node.leaf : 0u;
        found = enters ? node.leaf : 0u;
        n = enters && node.leaf == 0u ? n + 1u : node.next;
        count_walk(1u);
    }
    return leaf;
}

MeshRay instance_ray(MeshInstance to, vec3 origin_m, vec3 direction)
{
    return mesh_ray(to_mesh(to, origin_m), direction * to.turn / to.scale_m, to.reach);
}

// The nearest triangle of an instance with t > 0 if it is nearer than `hit`, except for one.
void keep_nearest_triangle(uint instance, vec3 origin_m, vec3 direction, uint except, inout Hit hit)
{
    MeshInstance mesh = mesh_instance(instance);
    MeshRay ray = instance_ray(mesh, origin_m, direction);
    uint n = 0u;
    while (n != NO_SOLID) {
        uint leaf = find_leaf(mesh.nodes, ray, true, 0.0, hit.t_m, NO_SOLID, n);
        count_walk(TRIANGLE_LEAF_TURNS + (leaf & 15u));
        for (uint i = 0u; i < (leaf & 15u); i++) {
            uint triangle = (leaf >> 4u) + i, own = mesh.first_hit + triangle;
            float t_m;
            bool is_back;
            vec3 sides;
            if (own != (except & ~IS_BACK) &&
                meet_triangle(ray, mesh_triangle(mesh.triangles + 3u * triangle), t_m, is_back,
                              sides) &&
                t_m < hit.t_m && !is_cut_out(mesh, own, sides))
                hit = Hit(t_m, own | (is_back ? IS_BACK : 0u));
        }
    }
    report_left_loop(n != NO_SOLID);
}

// Whether a triangle of an instance is met between two distances, except for one.
bool is_instance_met(uint instance, vec3 origin_m, vec3 direction, float start_m, float end_m,
                     uint except)
{
    MeshInstance mesh = mesh_instance(instance);
    MeshRay ray = instance_ray(mesh, origin_m, direction);
    bool is_met = false;
    uint n = 0u;
    while (n != NO_SOLID) {
        uint leaf = find_leaf(mesh.nodes, ray, !is_met, start_m, end_m, NO_SOLID, n);
        count_walk(TRIANGLE_LEAF_TURNS + (leaf & 15u));
        for (uint i = 0u; i < (leaf & 15u); i++) {
            uint triangle = (leaf >> 4u) + i, own = mesh.first_hit + triangle;
            float t_m;
            bool is_back;
            vec3 sides;
            if (own != (except & ~IS_BACK) &&
                meet_triangle(ray, mesh_triangle(mesh.triangles + 3u * triangle), t_m, is_back,
                              sides) &&
                t_m > start_m && t_m < end_m && !is_cut_out(mesh, own, sides))
                is_met = true;
        }
        n = is_entered(!is_met) ? n : NO_SOLID;
    }
    report_left_loop(n != NO_SOLID);
    return is_met;
}

// The start of a ray, relative to the camera. On a triangle it is moved off the triangle's plane by
// more than rounding, to the side of the hit: its neighbours are nearly in this plane, and rounding
// would put the point behind them.
vec3 mesh_origin_m(vec3 origin_m, uint solid)
{
    if (!is_mesh(solid))
        return origin_m;
    MeshInstance mesh = mesh_instance(hit_instance(solid));
    float size_m = length(origin_m) + length(mesh.position_m) + mesh.reach * mesh.scale_m;
    return origin_m + MESH_ROUNDING * size_m * mesh_normal(solid);
}

// The nearest triangle with t > 0 in place of `hit` if it is nearer, except for one.
void keep_nearest_mesh(vec3 origin_m, vec3 direction, uint except, inout Hit hit)
{
    vec3 from_m = mesh_origin_m(origin_m, except);
    MeshRay ray = mesh_ray(from_m - frame.meshes.origin_m, direction, frame.meshes.reach_m);
    SET_COVERAGE_VIEW();
    uint n = 0u;
    count_walk(INSTANCE_LEAF_TURNS);
    while (n != NO_SOLID) {
        uint leaf = find_leaf(1u, ray, true, 0.0, hit.t_m, NO_SOLID, n);
        count_walk(INSTANCE_LEAF_TURNS);
        if (leaf != 0u)
            keep_nearest_triangle(leaf - 1u, from_m, direction, except, hit);
    }
    report_left_loop(n != NO_SOLID);
}

// The node behind the tree of instances that move.
uint find_first_at_rest() { return MESHES_MOVE ? mesh_node(1u, 0u).next : 0u; }

// Whether a triangle is met between two distances, except for one. Only of instances before the
// node `behind`, which is NO_SOLID where none moves.
bool is_mesh_met(vec3 origin_m, vec3 direction, float start_m, float end_m, uint except,
                 uint behind)
{
    vec3 from_m = mesh_origin_m(origin_m, except);
    MeshRay ray = mesh_ray(from_m - frame.meshes.origin_m, direction, frame.meshes.reach_m);
    set_coverage_ray(from_m, direction);
    bool is_met = false;
    uint n = 0u;
    behind = MESHES_MOVE ? behind : NO_SOLID;
    count_walk(INSTANCE_LEAF_TURNS);
    while (n < behind) {
        uint leaf = find_leaf(1u, ray, !is_met, start_m, end_m, behind, n);
        count_walk(INSTANCE_LEAF_TURNS);
        if (leaf != 0u)
            is_met = is_instance_met(leaf - 1u, from_m, direction, start_m, end_m, except);
    }
    report_left_loop(n < behind);
    return is_met;
}

#endif
