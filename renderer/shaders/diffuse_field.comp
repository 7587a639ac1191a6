#version 450
// SPDX-License-Identifier: MIT
//
// Last step of diffused light (diffusion.glsl): the table that the ray marcher looks up
// (diffused_field.glsl). Each thread writes one cell of the finest level: the flux, as the mean of
// the fluxes through the two faces of each axis, and the fluence.
#extension GL_GOOGLE_include_directive : require

#include "diffusion_run.glsl"

layout(std430, binding = 1) writeonly buffer Field {
    vec4 field[];
};

uvec3 at;
DiffusionCell cell;

// Flux density along the axis through the upper or the lower face of the cell.
float flux_through(int axis, bool is_high)
{
    float outward = is_high ? 1.0 : -1.0;
    bool is_last = is_high ? at[axis] + 1u >= run.level.size[axis] : at[axis] == 0u;
    if (!is_last) {
        DiffusionCell other =
            cells[cell_index(run.level, is_high ? at + select_axis(axis) : at - select_axis(axis))];
        if (!is_solid(other)) {
            Face face = is_high ? face_between(cell, other, axis)
                                : face_between(other, cell, axis);
            float link = (is_high ? cell.link[axis] : other.link[axis]) / area_m2(axis);
            return link * outward * (cell.fluence - other.fluence) + face.beam;
        }
    }
    Face face = open_face(cell, axis, outward);
    return outward * (face.conductance * cell.fluence + face.beam);
}

void main()
{
    uint index = gl_GlobalInvocationID.x;
    if (index >= cell_count(run.level))
        return;
    at = cell_at(run.level, index);
    cell = cells[index];
    vec3 flux = vec3(0.0);
    for (int axis = 0; axis < 3 && !is_solid(cell); axis++)
        flux[axis] = has_faces(axis)
                         ? 0.5 * (flux_through(axis, false) + flux_through(axis, true))
                         : run.beam[axis] * cell.beam;
    field[index] = vec4(flux, cell.fluence);
}
