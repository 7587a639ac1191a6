// SPDX-License-Identifier: MIT
//
// The looks of meshes (scenes/mesh_material.h): interpolated normals. renderer/gpu_mesh_looks.c
// writes the data.
#ifndef NEPH_MESH_LOOKS_GLSL
#define NEPH_MESH_LOOKS_GLSL

#include "mesh_data.glsl"

const bool MESH_SMOOTH = (SCENE_KINDS & NEPH_GPU_MESH_SMOOTH) != 0u;

struct MeshLook {
    uint normals; // index of the first; three for each triangle; 0: flat
};

MeshLook mesh_look(uint at)
{
    return MeshLook(mesh_words[at].x);
}

// Where a point of a triangle is: weights of the corners, whose sum is 1. They are areas in the
// plane of two axes, across which the triangle is largest: products of more lengths would underflow.
vec3 triangle_weights(Triangle t, vec3 point)
{
    vec3 area = triangle_area(t), size = abs(area);
    uint across = size.x > size.y ? 0u : 1u;
    across = size.z > max(size.x, size.y) ? 2u : across;
    vec3 a = t.a - point, b = t.b - point, c = t.c - point;
    vec3 sides = vec3(cross(b, c)[across], cross(c, a)[across], cross(a, b)[across]);
    vec3 weights = clamp(sides / area[across], 0.0, 1.0);
    float sum = weights.x + weights.y + weights.z;
    return sum > 0.0 ? weights / sum : vec3(1.0 / 3.0);
}

// A point relative to the camera in the axes of a mesh.
vec3 to_mesh(MeshInstance mesh, vec3 point_m)
{
    return (point_m - frame.meshes.origin_m - mesh.position_m) * mesh.turn / mesh.scale_m;
}

// In the axes of the mesh; `normal` is the triangle's, on the side of the ray. As
// neph_mesh_shading_normal().
vec3 smooth_normal(MeshLook look, uint triangle, vec3 weights, vec3 normal)
{
    uint at = look.normals + 3u * triangle;
    vec3 sum = weights.x * uintBitsToFloat(mesh_words[at].xyz) +
               weights.y * uintBitsToFloat(mesh_words[at + 1].xyz) +
               weights.z * uintBitsToFloat(mesh_words[at + 2].xyz);
    float side = dot(sum, normal);
    if (!(length(sum) > 1e-6) || side == 0.0)
        return normal;
    return side > 0.0 ? normalize(sum) : -normalize(sum);
}

// Changes the normal of a hit, which is the triangle's, to the one for the cosine law.
void add_mesh_look(uint solid, vec3 point_m, inout vec3 normal)
{
    MeshInstance mesh = mesh_instance(hit_instance(solid));
    if (mesh.look == 0u)
        return;
    MeshLook look = mesh_look(mesh.look);
    uint triangle = hit_triangle(solid);
    vec3 weights = triangle_weights(mesh_triangle(mesh.triangles + 3u * triangle),
                                    to_mesh(mesh, point_m));
    if (MESH_SMOOTH && look.normals != 0u)
        normal = mesh.turn * smooth_normal(look, triangle, weights, normal * mesh.turn);
}

// The cosine of the law of Lambert for light from a direction, below or at 0: none. Light from
// behind the triangle counts as 0, even where the normal of a smooth mesh sees it.
float hit_cosine(uint solid, vec3 normal, vec3 direction)
{
    bool is_behind = MESH_SMOOTH && is_mesh(solid) && dot(mesh_normal(solid), direction) <= 0.0;
    return is_behind ? 0.0 : dot(normal, direction);
}

// Whether a direction that was drawn around the normal of a smooth mesh goes through the triangle:
// such a path has no light.
bool is_through_own(uint solid, vec3 normal, vec3 direction)
{
    return MESH_SMOOTH && hit_cosine(solid, normal, direction) <= 0.0;
}

#endif
