// SPDX-License-Identifier: MIT
//
// Surfaces: patterns and rough metal; float32 version of scenes/surface.h.
#ifndef NEPH_SURFACE_GLSL
#define NEPH_SURFACE_GLSL

#include "random.glsl"

// --- patterns ---------------------------------------------------------------------------------

const uint NOISE_CELLS = 32;

float noise_value(uint seed, ivec2 cell)
{
    uvec3 bits = pcg3d(uvec3(uvec2(cell) % NOISE_CELLS, seed));
    return float(bits.x >> 8) * exp2(-24.0);
}

// Value noise: bilinear between random values of cells.
float noise_at(uint seed, vec2 place)
{
    ivec2 cell = ivec2(floor(place));
    vec2 way = place - vec2(cell);
    return mix(mix(noise_value(seed, cell), noise_value(seed, cell + ivec2(1, 0)), way.x),
               mix(noise_value(seed, cell + ivec2(0, 1)), noise_value(seed, cell + 1), way.x),
               way.y);
}

float checker_at(vec2 place)
{
    ivec2 cell = ivec2(floor(place));
    return float((cell.x + cell.y) & 1);
}

// --- metal ------------------------------------------------------------------------------------

// Smith's masking function of GGX: the visible fraction of microfacets (B. Walter et al.,
// "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007, equation 34).
float masking(float alpha, float cosine)
{
    float tangent_squared = (1.0 - cosine * cosine) / (cosine * cosine);
    return 2.0 / (1.0 + sqrt(1.0 + alpha * alpha * max(0.0, tangent_squared)));
}

// The microfacet reflectance D G / (4 cos_in cos_out) [1/sr]. A mirror (alpha 0) gives 0: no light
// at a point hits its delta lobe.
float metal_reflectance(float alpha, vec3 normal, vec3 to_light, vec3 to_eye)
{
    float cos_in = dot(normal, to_light), cos_out = dot(normal, to_eye);
    if (!(alpha > 0.0 && cos_in > 0.0 && cos_out > 0.0))
        return 0.0;
    float cos_half = dot(normal, normalize(to_light + to_eye));
    float alpha2 = alpha * alpha;
    float fall = cos_half * cos_half * (alpha2 - 1.0) + 1.0;
    float facets = alpha2 / (PI * fall * fall);
    return facets * masking(alpha, cos_in) * masking(alpha, cos_out) / (4.0 * cos_in * cos_out);
}

// Samples a visible microfacet normal; z is the surface normal (E. Heitz, "Sampling the GGX
// Distribution of Visible Normals", JCGT 7(4), 2018). A reflection by it has the weight
// masking(in).
vec3 visible_facet(float alpha, vec3 to_eye, vec2 u)
{
    vec3 stretched = normalize(vec3(alpha * to_eye.xy, to_eye.z));
    float across2 = dot(stretched.xy, stretched.xy);
    vec3 first = across2 > 1e-14 ? vec3(-stretched.y, stretched.x, 0.0) * inversesqrt(across2)
                                 : vec3(1.0, 0.0, 0.0);
    vec3 second = cross(stretched, first);
    float radius = sqrt(u.x), angle = 2.0 * PI * u.y;
    float x = radius * cos(angle), y = radius * sin(angle), half_way = 0.5 * (1.0 + stretched.z);
    y = mix(sqrt(max(0.0, 1.0 - x * x)), y, half_way);
    float z = sqrt(max(0.0, 1.0 - x * x - y * y));
    vec3 facet = x * first + y * second + z * stretched;
    return normalize(vec3(alpha * facet.xy, max(1e-6, facet.z)));
}

#endif
