// SPDX-License-Identifier: MIT
//
// Convex solids (spheres and boxes): ray intervals and normals. Positions are relative to the
// camera.
#ifndef NEPH_SOLIDS_GLSL
#define NEPH_SOLIDS_GLSL

#include "globe.glsl"

// Specialization constant with properties of the scene, the bits of constants.h.
layout(constant_id = 1) const uint TRAITS = NEPH_GPU_COLOURED;
const bool TURNED = (TRAITS & NEPH_GPU_TURNED) != 0u; // a box is rotated

// enum neph_solid_kind. SOLID_TURNED + 0, 1, 2 are boxes rotated about x, y, z.
const uint SOLID_BOX = 0;
const uint SOLID_SPHERE = 1;
const uint SOLID_TURNED = NEPH_GPU_SOLID_TURNED;

struct Solid {
    vec3 low_m; // sphere: centre; rotated box: before the rotation
    uint kind;
    vec3 high_m; // sphere: direction from its centre to the camera, unit
    float radius_m; // rotated box: cosine of its angle
    vec4 albedo; // w: sphere: altitude of the camera above it; rotated box: sine
};

// A node of the trees of boxes around solids (renderer/solid_tree.h).
struct SolidNode {
    vec3 low_m;
    uint leaf; // 0: the node behind this one is its first child; else see leaf_first()
    vec3 high_m;
    uint next; // the node behind this one's children; NO_SOLID behind the last tree
};

// A leaf has leaf_count() solids, whose numbers are in solid_order from leaf_first() on.
uint leaf_count(SolidNode node) { return node.leaf & 15u; }
uint leaf_first(SolidNode node) { return node.leaf >> 4; }

// Direction components below this count as parallel to the face. For larger ones a distance up to
// FAR_M over the component does not overflow.
const float PARALLEL = 1e-20;

const float ENDLESS_M = 3.0e38; // beyond every hit

// Narrows [t0, t1] to low <= origin + t direction <= high; false when it becomes empty.
bool clip_axis(float low, float high, float origin, float direction, inout float t0, inout float t1)
{
    if (abs(direction) < PARALLEL)
        return origin >= low && origin <= high;
    float a = (low - origin) / direction;
    float b = (high - origin) / direction;
    t0 = max(t0, min(a, b));
    t1 = min(t1, max(a, b));
    return t0 < t1;
}

bool clip_box(vec3 low_m, vec3 high_m, vec3 origin_m, vec3 direction, inout float t0_m,
              inout float t1_m)
{
    return t0_m < t1_m &&
           clip_axis(low_m.x, high_m.x, origin_m.x, direction.x, t0_m, t1_m) &&
           clip_axis(low_m.y, high_m.y, origin_m.y, direction.y, t0_m, t1_m) &&
           clip_axis(low_m.z, high_m.z, origin_m.z, direction.z, t0_m, t1_m);
}

// The part of a ray in a node, within [t0, t1]. It contains the rounded intervals of the node's
// solids. That of a box is computed in the same way from a larger low and a smaller high. Points of
// the others are within the node, because the node is larger by more than their rounding, which
// grows with their own distance from the camera (solid_tree.h) and with the ray's.
bool meets_node(SolidNode node, vec3 origin_m, vec3 direction, inout float t0_m, inout float t1_m)
{
    vec3 far_m = abs(origin_m);
    float margin_m = NEPH_GPU_NODE_MARGIN * max(far_m.x, max(far_m.y, far_m.z));
    return clip_box(node.low_m - margin_m, node.high_m + margin_m, origin_m, direction, t0_m,
                    t1_m);
}

// Computed from the ray's point nearest to the centre; the discriminant b^2 - 4 a c would cancel
// for far spheres.
bool sphere_interval(vec3 center_m, float radius_m, vec3 origin_m, vec3 direction, out float t0_m,
                     out float t1_m)
{
    vec3 offset_m = origin_m - center_m;
    float middle_m = -dot(offset_m, direction);
    vec3 nearest_m = offset_m + direction * middle_m;
    float distance_m = length(nearest_m);
    float half_chord_m = sqrt(max(0.0, (radius_m - distance_m) * (radius_m + distance_m)));
    t0_m = middle_m - half_chord_m;
    t1_m = middle_m + half_chord_m;
    return half_chord_m > 0.0;
}

// A sphere is treated as a planet when the camera and the ray's origin are within one radius of its
// surface and of each other. Then the nearest point's distance from the centre would cancel against
// the radius (an error of half a metre at Earth's size), and altitudes do not (globe.glsl). In
// other cases the altitudes would cancel.
bool ball_interval(Solid ball, vec3 origin_m, vec3 direction, out float t0_m, out float t1_m)
{
    if (ball.albedo.w >= ball.radius_m || dot(origin_m, origin_m) >= ball.radius_m * ball.radius_m)
        return sphere_interval(ball.low_m, ball.radius_m, origin_m, direction, t0_m, t1_m);
    Globe globe = Globe(ball.high_m, length(ball.low_m), ball.albedo.w, ball.radius_m);
    return globe_interval(globe, globe_ray(globe, origin_m, direction), 0.0, t0_m, t1_m);
}

// Rotates about an axis, 0 x, 1 y, 2 z; the opposite sine rotates back.
vec3 turned_about(uint axis, vec3 v, float c, float sine)
{
    if (axis == 0u)
        return vec3(v.x, c * v.y - sine * v.z, sine * v.y + c * v.z);
    if (axis == 1u)
        return vec3(c * v.x + sine * v.z, v.y, c * v.z - sine * v.x);
    return vec3(c * v.x - sine * v.y, sine * v.x + c * v.y, v.z);
}

// By the angle of a rotated box with the given sine.
vec3 turned(Solid box, vec3 v, float sine)
{
    return turned_about(box.kind - SOLID_TURNED, v, box.radius_m, sine);
}

bool is_turned(Solid solid) { return TURNED && solid.kind >= SOLID_TURNED; }

// A point in the axes of a rotated box.
vec3 to_box_axes(Solid box, vec3 point_m)
{
    vec3 middle_m = 0.5 * (box.low_m + box.high_m);
    return middle_m + turned(box, point_m - middle_m, -box.albedo.w);
}

bool solid_interval(Solid solid, vec3 origin_m, vec3 direction, out float t0_m, out float t1_m)
{
    if (solid.kind == SOLID_SPHERE)
        return ball_interval(solid, origin_m, direction, t0_m, t1_m);
    t0_m = -FAR_M;
    t1_m = FAR_M;
    if (is_turned(solid)) {
        origin_m = to_box_axes(solid, origin_m);
        direction = turned(solid, direction, -solid.albedo.w);
    }
    return clip_box(solid.low_m, solid.high_m, origin_m, direction, t0_m, t1_m);
}

// Outward normal of the nearest face of an axis-aligned box.
vec3 box_normal(Solid box, vec3 point_m)
{
    vec3 to_low_m = abs(point_m - box.low_m);
    vec3 to_high_m = abs(point_m - box.high_m);
    vec3 to_face_m = min(to_low_m, to_high_m);
    vec3 outward = mix(vec3(-1.0), vec3(1.0), lessThan(to_high_m, to_low_m));
    if (to_face_m.x <= to_face_m.y && to_face_m.x <= to_face_m.z)
        return vec3(outward.x, 0.0, 0.0);
    if (to_face_m.y <= to_face_m.z)
        return vec3(0.0, outward.y, 0.0);
    return vec3(0.0, 0.0, outward.z);
}

// Outward unit normal at a point of the surface; for a box, of the nearest face.
vec3 solid_normal(Solid solid, vec3 surface_m)
{
    if (solid.kind == SOLID_SPHERE)
        return normalize(surface_m - solid.low_m);
    vec3 point_m = is_turned(solid) ? to_box_axes(solid, surface_m) : surface_m;
    vec3 normal = box_normal(solid, point_m);
    return is_turned(solid) ? turned(solid, normal, solid.albedo.w) : normal;
}

#endif
