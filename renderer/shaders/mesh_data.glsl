// SPDX-License-Identifier: MIT
//
// Triangle meshes as renderer/gpu_meshes.c writes them, and the number and the normal of a hit.
// Meshes are
//
//   a tree of boxes around instances -> an instance: a mesh and its place
//                                       -> the mesh's tree of boxes around triangles
#ifndef NEPH_MESH_DATA_GLSL
#define NEPH_MESH_DATA_GLSL

#include "media.glsl"

const bool MESHES = (SCENE_KINDS & NEPH_GPU_MESHES) != 0u;
const bool MESHES_MOVE = (SCENE_KINDS & NEPH_GPU_MESHES_MOVE) != 0u;

// The meshes are in the buffer of Horizon's textures, in front of them.
layout(std430, binding = 4) readonly buffer MeshWords {
    uvec4 mesh_words[];
};

// Its first word is set where a device has left a loop before its end: such a frame is wrong
// (renderer/compute.h).
layout(std430, binding = 4) writeonly buffer MeshFault {
    uint mesh_fault;
};

void report_left_loop(bool is_left)
{
    if (ON_CPU && is_left)
        mesh_fault = 1u;
}

// Reports if the thread has no loop iterations left. For the end of a kernel with long loops.
void check_loops()
{
    uint turns = 0u, wanted = make_nonuniform(2u);
    while (MESHES && ON_CPU && turns < wanted)
        turns++;
    report_left_loop(MESHES && turns < wanted);
}

// Marks of the hit of a mesh.
const uint IS_MESH = 0x80000000u;
const uint IS_BACK = 0x40000000u; // the ray comes from the side opposite to the normal

// --- data -----------------------------------------------------------------------------------

// A node of a tree, as SolidNode. Nodes are in the order of a walk that enters all of them.
const uint MESH_NODE_WORDS = 2;

struct MeshNode {
    vec3 low_m;
    uint leaf; // 0: its first child is the next node; else its content
    vec3 high_m;
    uint next; // behind all children; NO_SOLID: the end
};

MeshNode mesh_node(uint first, uint n)
{
    uvec4 low = mesh_words[first + MESH_NODE_WORDS * n];
    uvec4 high = mesh_words[first + MESH_NODE_WORDS * n + 1];
    return MeshNode(uintBitsToFloat(low.xyz), low.w, uintBitsToFloat(high.xyz), high.w);
}

const uint MESH_INSTANCE_WORDS = 6;

struct MeshInstance {
    mat3 turn;       // columns: the mesh's axes in the world, unit
    vec3 position_m; // of the mesh's middle, relative to the camera
    float scale_m;   // the mesh's unit of length
    vec3 albedo;
    float reach;    // largest coordinate of the mesh
    uint nodes;     // index of the tree's first node
    uint triangles; // index of the first triangle
    uint look;      // index of its look (mesh_looks.glsl); 0: flat, of one colour and whole
    uint first_hit; // a hit of its first triangle
};

// The place of an instance and the origin of all places are sums of two floats each. The larger
// ones cancel near the camera: the position is precise there, wherever other instances are.
vec3 instance_position_m(uvec4 place_m, uvec4 low_m)
{
    precise vec3 far_m = frame.meshes.origin_m + uintBitsToFloat(place_m.xyz);
    precise vec3 position_m = far_m + (frame.meshes.origin_low_m + uintBitsToFloat(low_m.xyz));
    return position_m;
}

MeshInstance mesh_instance(uint i)
{
    uint at = frame.meshes.instances + MESH_INSTANCE_WORDS * i;
    uvec4 x = mesh_words[at], y = mesh_words[at + 1], z = mesh_words[at + 2];
    uvec4 place = mesh_words[at + 3], surface = mesh_words[at + 4], place_low = mesh_words[at + 5];
    return MeshInstance(
        mat3(uintBitsToFloat(x.xyz), uintBitsToFloat(y.xyz), uintBitsToFloat(z.xyz)),
        instance_position_m(place, place_low), uintBitsToFloat(place.w),
        uintBitsToFloat(surface.xyz), uintBitsToFloat(surface.w), x.w, y.w, z.w,
        IS_MESH | place_low.w);
}

// A point relative to the camera in the axes of a mesh, relative to its middle.
vec3 to_mesh(MeshInstance mesh, vec3 point_m)
{
    return (point_m - mesh.position_m) * mesh.turn / mesh.scale_m;
}

struct Triangle {
    vec3 a, b, c; // counterclockwise, seen from outside
};

Triangle mesh_triangle(uint at)
{
    return Triangle(uintBitsToFloat(mesh_words[at].xyz), uintBitsToFloat(mesh_words[at + 1].xyz),
                    uintBitsToFloat(mesh_words[at + 2].xyz));
}

// Twice the area along the normal.
vec3 triangle_area(Triangle t)
{
    return cross(t.b - t.a, t.c - t.a);
}

// --- the number of a hit ------------------------------------------------------------------------

// A hit of a mesh has, in place of the number of a solid, IS_MESH and a number: its triangle's,
// plus the first one of its instance. First numbers are multiples of 2^triangle_bits; where there
// are too few bits for that, they are the triangles of all instances before, and the instance is
// searched.

bool is_mesh(uint solid)
{
    return MESHES && solid >= IS_MESH && solid != NO_SOLID;
}

uint first_hit_number(uint instance)
{
    return mesh_words[frame.meshes.instances + MESH_INSTANCE_WORDS * instance + 5u].w;
}

uint hit_instance(uint solid)
{
    uint number = solid & ~(IS_MESH | IS_BACK);
    uint behind = make_nonuniform(frame.meshes.searched), found = 0u;
    if (behind == 0u)
        return number >> frame.meshes.triangle_bits;
    while (behind - found > 1u) {
        uint middle = (found + behind) / 2u;
        if (first_hit_number(middle) <= number)
            found = middle;
        else
            behind = middle;
    }
    return found;
}

uint hit_triangle(uint solid, MeshInstance mesh)
{
    return (solid & ~IS_BACK) - mesh.first_hit;
}

// Unit normal of a hit, on the side that the ray came from.
vec3 mesh_normal(uint solid)
{
    MeshInstance mesh = mesh_instance(hit_instance(solid));
    vec3 area = triangle_area(mesh_triangle(mesh.triangles + 3u * hit_triangle(solid, mesh)));
    // Scaled to about 1: the square of the area of a small triangle underflows.
    area /= max(abs(area.x), max(abs(area.y), abs(area.z)));
    vec3 normal = normalize(mesh.turn * area);
    return (solid & IS_BACK) != 0u ? -normal : normal;
}

#endif
