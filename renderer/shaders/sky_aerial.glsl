// SPDX-License-Identifier: MIT
//
// The aerial table: light and transmittance of the air between the camera and a point in view, by
// froxels (S. Hillaire, "A scalable and production ready sky and atmosphere rendering technique",
// EGSR 2020, aerial perspective volume). Nodes in the image plane reach from edge to edge;
// distances grow with the square of the slice number. Values between nodes are interpolated
// linearly.
#ifndef NEPH_SKY_AERIAL_GLSL
#define NEPH_SKY_AERIAL_GLSL

#include "sky.glsl"

// Light for a sun of irradiance 1, with shadows removed, and transmittance.
struct SkyVeil {
    vec3 light, through;
};

// Values of a node, in this order.
const uint VEIL_LIGHT = 0, VEIL_THROUGH = 1, VEIL_SHADE = 2, VEIL_PARTS = 3;

float sky_slice_m(uint slice)
{
    float part = float(slice) / float(eye.aerial_slices);
    return eye.aerial_far_m * part * part;
}

// Slice 0 is at the camera and is not stored.
uint sky_aerial_node(uint column, uint row, uint slice)
{
    uint index = ((slice - 1u) * eye.aerial_rows + row) * eye.aerial_columns + column;
    return eye.aerial_first + VEIL_PARTS * index;
}

vec3 sky_aerial_direction(uint column, uint row)
{
    float x = 2.0 * float(column) / float(eye.aerial_columns - 1u) - 1.0;
    float y = 1.0 - 2.0 * float(row) / float(eye.aerial_rows - 1u);
    return normalize(eye.forward + x * eye.half_width * eye.right + y * eye.half_height * eye.up);
}

// A position between nodes: the lower ones of four directions and two distances.
struct SkyFroxel {
    uint column, row, slice;
    float x, y, z; // fractions to the next node
};

// Position of a direction in view and a distance; constant beyond the last slice.
SkyFroxel sky_froxel(vec3 direction, float distance_m)
{
    SkyFroxel at;
    float ahead = max(dot(direction, eye.forward), 1e-6);
    float right = dot(direction, eye.right) / (ahead * eye.half_width);
    float up = dot(direction, eye.up) / (ahead * eye.half_height);
    at.x = sky_among(0.5 + 0.5 * right, eye.aerial_columns, at.column);
    at.y = sky_among(0.5 - 0.5 * up, eye.aerial_rows, at.row);
    float root = sqrt(min(distance_m / eye.aerial_far_m, 1.0)) * float(eye.aerial_slices);
    at.slice = min(uint(root), eye.aerial_slices - 1u);
    float near_m = sky_slice_m(at.slice), far_m = sky_slice_m(at.slice + 1u);
    at.z = clamp((distance_m - near_m) / (far_m - near_m), 0.0, 1.0);
    return at;
}

// One value of a slice, interpolated bilinearly.
vec3 sky_slice_part(SkyFroxel at, uint slice, uint part)
{
    if (slice == 0u)
        return vec3(part == VEIL_THROUGH ? 1.0 : 0.0);
    uint low = sky_aerial_node(at.column, at.row, slice) + part;
    uint high = low + VEIL_PARTS * eye.aerial_columns;
    return mix(mix(sky_nodes[low].rgb, sky_nodes[low + VEIL_PARTS].rgb, at.x),
               mix(sky_nodes[high].rgb, sky_nodes[high + VEIL_PARTS].rgb, at.x), at.y);
}

vec3 sky_veil_part(SkyFroxel at, uint part)
{
    return mix(sky_slice_part(at, at.slice, part), sky_slice_part(at, at.slice + 1u, part), at.z);
}

SkyVeil sky_veil(vec3 direction, float distance_m)
{
    SkyFroxel at = sky_froxel(direction, distance_m);
    return SkyVeil(sky_veil_part(at, VEIL_LIGHT), sky_veil_part(at, VEIL_THROUGH));
}

#endif
