// SPDX-License-Identifier: MIT
//
// Looking up what light diffuses (diffusion.glsl) at a place. Who includes this declares
// higher_orders, the cells' flux and fluence, first.
#ifndef NEPH_DIFFUSED_FIELD_GLSL
#define NEPH_DIFFUSED_FIELD_GLSL

#include "scene.glsl"

// Flux and fluence at a place of the lattice, in cells; `low` and `high` are its neighbours.
vec4 field_along_x(uint row, uint low, uint high, float part)
{
    return mix(higher_orders[row + low], higher_orders[row + high], part);
}

// Per 1 W/m^2 of sun; beyond the centres of the last cells as in these.
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
