// SPDX-License-Identifier: MIT
//
// Extinction at a point for sums over steps. Voxel grids are read through the texture unit where
// the setting `grid_sampling` selects it (struct neph_shortcuts): one fetch without branches or
// border tests. The texture has the nodes of grid.glsl with their layer of zeros, which clamping to
// the edge extends beyond its faces.
//
// The error comes from the unit's interpolation weights, 8 bits on GPUs, and from the texel format
// (docs/realtime.md).
#ifndef NEPH_GRID_TEXTURE_GLSL
#define NEPH_GRID_TEXTURE_GLSL

#include "shortcuts.glsl"

const uint TEXTURES = SHORTCUTS & NEPH_SHORTCUT_GRID_SAMPLING;
const bool SAMPLES_TEXTURES = has_kind(MEDIUM_GRID) && TEXTURES != 0u;

// One texture per medium of the frame. Media that are no grids have an unused texture of one texel.
layout(binding = NEPH_GPU_IMAGES_BINDING) uniform sampler3D grid_textures[MEDIA_MAX];

// Switch over constant indices, because lavapipe supports no others. In an unrolled loop over media
// one case remains.
float grid_texture_at(uint m, vec3 place)
{
    switch (m) {
    case 0u:
        return textureLod(grid_textures[0], place, 0.0).r;
    case 1u:
        return textureLod(grid_textures[1], place, 0.0).r;
    case 2u:
        return textureLod(grid_textures[2], place, 0.0).r;
    case 3u:
        return textureLod(grid_textures[3], place, 0.0).r;
    case 4u:
        return textureLod(grid_textures[4], place, 0.0).r;
    case 5u:
        return textureLod(grid_textures[5], place, 0.0).r;
    case 6u:
        return textureLod(grid_textures[6], place, 0.0).r;
    default:
        return textureLod(grid_textures[7], place, 0.0).r;
    }
}

// Texture coordinates of a point.
vec3 grid_texture_place(uint m, vec3 point_m)
{
    Grid grid = medium_grid(m);
    vec3 at = (point_m - grid.origin_m) * grid.nodes_per_m;
    return (at + 0.5) * grid.texel;
}

float grid_texture_density(uint m, vec3 point_m)
{
    return medium_grid(m).full * grid_texture_at(m, grid_texture_place(m, point_m));
}

// A ray in the texture coordinates of the only medium: a sample costs three multiply-adds. The
// caller keeps the samples within the medium's bounds.
struct TextureRay {
    vec3 start, per_m; // in texture coordinates
    float full_per_m;  // extinction of a texel of value 1
};

TextureRay texture_ray(vec3 origin_m, vec3 direction)
{
    Grid grid = medium_grid(0);
    return TextureRay(grid_texture_place(0, origin_m), direction * grid.nodes_per_m * grid.texel,
                      medium_full_per_m(0) * grid.full);
}

float texture_ray_density(TextureRay ray, float t_m)
{
    return grid_texture_at(0, ray.start + t_m * ray.per_m);
}

const bool HAS_ONLY_TEXTURE = SAMPLES_TEXTURES && KNOWN_MEDIA == 1u;

// Extinction of a medium at a point; with textures off it equals medium_extinction_per_m().
float sampled_extinction_per_m(uint m, vec3 point_m)
{
    if (SAMPLES_TEXTURES && !is_fog(m) && is_a(MEDIUM_GRID, get_medium_kind(m))) {
        // Selects without a branch, so that the fetch is issued before the test is known.
        float per_m = medium_full_per_m(m) * grid_texture_density(m, point_m);
        return mix(0.0, per_m, medium_contains(m, point_m));
    }
    return medium_extinction_per_m(m, point_m);
}

// Extinction of all media of some kinds at a point, as scene_extinction_per_m().
vec3 sampled_extinctions_per_m(uint kinds, vec3 point_m)
{
    vec3 extinction_per_m = vec3(0.0);
    [[unroll]] for (uint m = 0; m < media_count(); m++)
        if (is_among(kinds, m))
            extinction_per_m +=
                medium_color(m) * sampled_extinction_per_m(m, point_m);
    return grey(extinction_per_m);
}

#endif
