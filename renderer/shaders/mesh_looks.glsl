// SPDX-License-Identifier: MIT
//
// The looks of meshes (scenes/mesh_material.h): interpolated normals, and textures for the colour
// and for holes. renderer/gpu_mesh_looks.c writes the data.
#ifndef NEPH_MESH_LOOKS_GLSL
#define NEPH_MESH_LOOKS_GLSL

#include "mesh_data.glsl"

const bool MESH_SMOOTH = (SCENE_KINDS & NEPH_GPU_MESH_SMOOTH) != 0u;
const bool MESH_TEXTURES = (SCENE_KINDS & NEPH_GPU_MESH_TEXTURES) != 0u;
const bool MESH_COVERAGE = (SCENE_KINDS & NEPH_GPU_MESH_COVERAGE) != 0u;
const bool MESH_HOLES = (SCENE_KINDS & (NEPH_GPU_MESH_CUTOUTS | NEPH_GPU_MESH_COVERAGE)) != 0u;

struct MeshLook {
    uint normals;    // index of the first; three for each triangle; 0: flat
    uint uv;         // index of the first; two words for each triangle; 0: no texture
    uint texels;     // index of the first; rows from the top
    uint alpha;      // NEPH_GPU_ALPHA_CUTOUT, NEPH_GPU_ALPHA_COVERAGE, or 0: no holes
    uvec2 size_px;
};

MeshLook mesh_look(uint at)
{
    uvec4 data = mesh_words[at], size = mesh_words[at + 1];
    return MeshLook(data.x, data.y, data.z, data.w, size.xy);
}

// Where a point of a triangle is: weights of the corners, whose sum is 1. They are areas in the
// plane of the two axes in which the triangle is largest: products of more lengths would underflow.
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

vec4 mesh_texel(MeshLook look, uvec2 pixel)
{
    return uintBitsToFloat(mesh_words[look.texels + pixel.y * look.size_px.x + pixel.x]);
}

// Equal values stay as they are, to the last bit.
vec4 mix_texels(vec4 a, vec4 b, float part)
{
    return a + part * (b - a);
}

// Colour and alpha of the texture, as neph_albedo_texture_find(); the second coordinate is down.
vec4 find_texel(MeshLook look, uint triangle, vec3 weights)
{
    vec4 ab = uintBitsToFloat(mesh_words[look.uv + 2u * triangle]);
    vec2 c = uintBitsToFloat(mesh_words[look.uv + 2u * triangle + 1].xy);
    vec2 at = weights.x * ab.xy + weights.y * ab.zw + weights.z * c;
    vec2 place = fract(at) * vec2(look.size_px) - 0.5, low = floor(place), part = place - low;
    uvec2 first = uvec2(ivec2(low) + ivec2(look.size_px)) % look.size_px;
    uvec2 last = (first + 1u) % look.size_px;
    vec4 above = mix_texels(mesh_texel(look, first), mesh_texel(look, uvec2(last.x, first.y)),
                            part.x);
    vec4 below = mix_texels(mesh_texel(look, uvec2(first.x, last.y)), mesh_texel(look, last),
                            part.x);
    return mix_texels(above, below, part.y);
}

// --- alpha as coverage --------------------------------------------------------------------------
//
// A ray meets each triangle with the probability alpha: it is met if alpha exceeds a hash of the
// ray and the triangle (stochastic transparency: E. Enderton et al., I3D 2010; C. Wyman, M.
// McGuire, "Hashed Alpha Testing", I3D 2017). So any hit and nearest hit stay decisions, whose mean
// over many rays is right.
//
// A kernel that defines DRAWS_COVERAGE sets what its rays have in common. Passes that find the same
// view ray set the same numbers and find the same hit: its hash is without the ray's own bits, in
// which kernels differ. In consecutive frames the hash moves by the golden ratio, modulo 1: so the
// mean of a pixel over frames converges faster than with independent numbers. In other kernels a
// triangle is met where alpha is at least 1/2.
#ifdef DRAWS_COVERAGE
uint coverage_seed;
uint coverage_shift;
uint coverage_ray; // bits of a shadow ray; 0: a ray to the nearest hit

// A hash: M. Jarzynski and M. Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020, `pcg`.
uint mix_bits(uint bits)
{
    bits = bits * 747796405u + 2891336453u;
    bits = (bits >> ((bits >> 28) + 4u) ^ bits) * 277803737u;
    return bits >> 22 ^ bits;
}

// `key`: a pixel, or a path and its segment.
void set_coverage(uvec2 key, uint frame_number)
{
    coverage_seed = mix_bits(key.x + mix_bits(key.y));
    coverage_shift = frame_number * 2654435769u; // 2^32 over the golden ratio
}

void set_coverage_ray(vec3 origin_m, vec3 direction)
{
    uvec3 bits = floatBitsToUint(origin_m) + 747796405u * floatBitsToUint(direction);
    bits *= uvec3(2376512323u, 3625334849u, 3407524639u);
    coverage_ray = bits.x ^ bits.y ^ bits.z;
}

// The part of rays that pass a triangle is below this number, 0..1. On an edge or vertex it is that
// of all triangles of the instance: one of them would else be drawn after another.
float draw_covered_part(MeshInstance mesh, uint hit, vec3 sides)
{
    uint number = any(equal(sides, vec3(0.0))) ? mesh.first_hit : hit;
    uint bits = mix_bits(number + mix_bits(coverage_seed ^ coverage_ray)) + coverage_shift;
    return float(bits >> 8) * exp2(-24.0);
}
#define SET_COVERAGE_VIEW() coverage_ray = 0u
#else
#define set_coverage_ray(origin_m, direction)
#define SET_COVERAGE_VIEW()
#endif

// Whether a ray passes a triangle that it meets, through a hole. `hit`: the number of this hit.
// `sides`: of its edges, the largest where the corner opposite to the edge is met.
bool is_cut_out(MeshInstance mesh, uint hit, vec3 sides)
{
    if (!MESH_HOLES || mesh.look == 0u)
        return false;
    MeshLook look = mesh_look(mesh.look);
    if (look.alpha == 0u)
        return false;
    vec3 weights = sides / (sides.x + sides.y + sides.z);
    float alpha = find_texel(look, hit_triangle(hit, mesh), weights).a;
#ifdef DRAWS_COVERAGE
    if (MESH_COVERAGE && look.alpha == NEPH_GPU_ALPHA_COVERAGE)
        return alpha <= draw_covered_part(mesh, hit, sides);
#endif
    return alpha < 0.5;
}

// --- surfaces -----------------------------------------------------------------------------------

// Changes the normal of a hit, which is the triangle's, to the one for the cosine law, and the
// albedo, which is the instance's, to the one at the point.
void add_mesh_look(uint solid, vec3 point_m, inout vec3 normal, inout vec3 albedo)
{
    MeshInstance mesh = mesh_instance(hit_instance(solid));
    if (mesh.look == 0u)
        return;
    MeshLook look = mesh_look(mesh.look);
    uint triangle = hit_triangle(solid, mesh);
    vec3 weights = triangle_weights(mesh_triangle(mesh.triangles + 3u * triangle),
                                    to_mesh(mesh, point_m));
    if (MESH_SMOOTH && look.normals != 0u)
        normal = mesh.turn * smooth_normal(look, triangle, weights, normal * mesh.turn);
    if (MESH_TEXTURES && look.uv != 0u)
        albedo *= find_texel(look, triangle, weights).rgb;
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
