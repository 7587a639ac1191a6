#version 450
// SPDX-License-Identifier: MIT
//
// Second step of diffused light (diffusion.glsl), for one cell of the finest level per thread:
// - the links to the next cells, with the flux limit of diffusion_run.glsl,
// - the loss through open faces, added to the drain,
// - the flux that sunlight itself carries through the faces, added to the supply.
#extension GL_GOOGLE_include_directive : require

#include "diffusion_run.glsl"

uvec3 at;
DiffusionCell cell;

void open_to(int axis, float outward)
{
    Face face = open_face(cell, axis, outward);
    cell.drain += area_m2(axis) * face.conductance;
    cell.supply -= area_m2(axis) * face.beam;
}

void link_to(int axis, float outward)
{
    bool is_high = outward > 0.0;
    bool is_last = is_high ? at[axis] + 1u >= run.level.size[axis] : at[axis] == 0u;
    uvec3 there = is_high ? at + select_axis(axis) : at - select_axis(axis);
    if (is_last) {
        open_to(axis, outward);
        return;
    }
    DiffusionCell other = cells[cell_index(run.level, there)];
    if (is_solid(other)) {
        open_to(axis, outward); // solids are black
        return;
    }
    Face face = is_high ? face_between(cell, other, axis) : face_between(other, cell, axis);
    if (is_high)
        cell.link[axis] = area_m2(axis) * limited(face, cell.fluence, other.fluence);
    cell.supply -= outward * area_m2(axis) * face.beam;
}

void main()
{
    uint index = gl_GlobalInvocationID.x;
    if (index >= cell_count(run.level))
        return;
    at = cell_at(run.level, index);
    cell = cells[index];
    if (is_solid(cell))
        return;
    for (int axis = 0; axis < 3; axis++) {
        if (!has_faces(axis))
            continue;
        link_to(axis, -1.0);
        link_to(axis, 1.0);
    }
    cells[index].link = cell.link;
    cells[index].drain = cell.drain;
    cells[index].supply = cell.supply;
}
