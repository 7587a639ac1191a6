// SPDX-License-Identifier: MIT
//
// The air before the camera: what lies between it and a place in its picture, by froxels (S.
// Hillaire, "A scalable and production ready sky and atmosphere rendering technique", EGSR 2020,
// the aerial perspective volume). A node is a direction, from one edge of the picture to the other,
// and a distance; these grow as squares. Light and transmittance are linear between nodes.
#ifndef NEPH_SKY_AERIAL_GLSL
#define NEPH_SKY_AERIAL_GLSL

#include "sky.glsl"

// What is between: light for a sun of irradiance 1.
struct SkyVeil {
    vec3 light, through;
};

float sky_slice_m(uint slice)
{
    float part = float(slice) / float(eye.aerial_slices);
    return eye.aerial_far_m * part * part;
}

// Slice 0, at the camera, is not kept.
uint sky_aerial_node(uint column, uint row, uint slice)
{
    uint index = ((slice - 1u) * eye.aerial_rows + row) * eye.aerial_columns + column;
    return eye.aerial_first + 2u * index;
}

vec3 sky_aerial_direction(uint column, uint row)
{
    float x = 2.0 * float(column) / float(eye.aerial_columns - 1u) - 1.0;
    float y = 1.0 - 2.0 * float(row) / float(eye.aerial_rows - 1u);
    return normalize(eye.forward + x * eye.half_width * eye.right + y * eye.half_height * eye.up);
}

SkyVeil sky_slice_veil(uint i, uint j, float x, float y, uint slice)
{
    if (slice == 0u)
        return SkyVeil(vec3(0.0), vec3(1.0));
    uint a = sky_aerial_node(i, j, slice), c = a + 2u * eye.aerial_columns;
    return SkyVeil(mix(mix(sky_nodes[a].rgb, sky_nodes[a + 2u].rgb, x),
                       mix(sky_nodes[c].rgb, sky_nodes[c + 2u].rgb, x), y),
                   mix(mix(sky_nodes[a + 1u].rgb, sky_nodes[a + 3u].rgb, x),
                       mix(sky_nodes[c + 1u].rgb, sky_nodes[c + 3u].rgb, x), y));
}

// Up to a distance in a direction of the picture; beyond the last slice it stays as it is there.
SkyVeil sky_veil(vec3 direction, float distance_m)
{
    float ahead = max(dot(direction, eye.forward), 1e-6);
    float right = dot(direction, eye.right) / (ahead * eye.half_width);
    float up = dot(direction, eye.up) / (ahead * eye.half_height);
    uint i, j;
    float x = sky_among(0.5 + 0.5 * right, eye.aerial_columns, i);
    float y = sky_among(0.5 - 0.5 * up, eye.aerial_rows, j);
    float root = sqrt(min(distance_m / eye.aerial_far_m, 1.0)) * float(eye.aerial_slices);
    uint slice = min(uint(root), eye.aerial_slices - 1u);
    float near_m = sky_slice_m(slice), far_m = sky_slice_m(slice + 1u);
    float z = clamp((distance_m - near_m) / (far_m - near_m), 0.0, 1.0);
    SkyVeil near = sky_slice_veil(i, j, x, y, slice), far = sky_slice_veil(i, j, x, y, slice + 1u);
    return SkyVeil(mix(near.light, far.light, z), mix(near.through, far.through, z));
}

#endif
