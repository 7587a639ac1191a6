// SPDX-License-Identifier: MIT
//
// What sums over steps ask of the media: the extinction at a point, of voxel grids by the texture
// unit where that is chosen (struct neph_shortcuts). One look-up, no branch and no border: the
// lattice of grid.glsl with its layer of zeros, which goes on beyond its faces.
//
// The error is that of the unit's weights, which have 8 bits on GPUs, and of what a texel holds
// (docs/realtime.md).
#ifndef NEPH_GRID_TEXTURE_GLSL
#define NEPH_GRID_TEXTURE_GLSL

#include "shortcuts.glsl"

const uint TEXTURES = SHORTCUTS & NEPH_SHORTCUT_GRID_SAMPLING;
const bool SAMPLES_TEXTURES = has_kind(MEDIUM_GRID) && TEXTURES != 0u;

// By place in the frame; of what is no grid one texel that nobody asks for.
layout(binding = NEPH_GPU_IMAGES_BINDING) uniform sampler3D grid_textures[MEDIA_MAX];

// By constant numbers: lavapipe has no other. Loops over media that are unrolled keep one of them.
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

// A ray as the texture of an only medium sees it: three products and sums a sample. Its places are
// in the medium's bounds, as those of a stretch are.
struct TextureRay {
    vec3 start, per_m; // in parts of the texture
    float full_per_m;  // the extinction of a texel of 1
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

// As medium_extinction_per_m().
float sampled_extinction_per_m(uint m, vec3 point_m)
{
    if (SAMPLES_TEXTURES && !is_fog(m) && is_a(MEDIUM_GRID, kind_of(m))) {
        // Whether or not it counts, without a branch: samples are on their way before it is known.
        float per_m = medium_full_per_m(m) * grid_texture_density(m, point_m);
        return mix(0.0, per_m, medium_contains(m, point_m));
    }
    return medium_extinction_per_m(m, point_m);
}

// As scene_extinction_per_m().
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
