// SPDX-License-Identifier: MIT
//
// Trilinear lookup of diffused light (diffusion.glsl). The including shader first declares
// `higher_orders[]`, the buffer that diffuse_field.comp fills: xyz flux, w fluence.
#ifndef NEPH_DIFFUSED_FIELD_GLSL
#define NEPH_DIFFUSED_FIELD_GLSL

#include "scene.glsl"

// Interpolation along x within a row of cells.
vec4 field_along_x(uint row, uint low, uint high, float part)
{
    return mix(higher_orders[row + low], higher_orders[row + high], part);
}

// Flux (xyz) and fluence (w) at a point, per 1 W/m^2 of sun. Cells have their values at their
// centres. The field is constant beyond the outermost centres.
vec4 diffused_field(vec3 point_m)
{
    uvec3 size = frame.light_lattice.size;
    vec3 place = (point_m - frame.light_lattice.origin_m) * frame.light_lattice.per_m - 0.5;
    place = clamp(place, vec3(0.0), vec3(size - 1u));
    uvec3 low = uvec3(place), high = min(low + 1u, size - 1u);
    vec3 part = place - vec3(low);
    uint wide = size.x, deep = size.x * size.y;
    vec4 near = mix(field_along_x(wide * low.y + deep * low.z, low.x, high.x, part.x),
                    field_along_x(wide * high.y + deep * low.z, low.x, high.x, part.x), part.y);
    vec4 far = mix(field_along_x(wide * low.y + deep * high.z, low.x, high.x, part.x),
                   field_along_x(wide * high.y + deep * high.z, low.x, high.x, part.x), part.y);
    return mix(near, far, part.z);
}

#endif
