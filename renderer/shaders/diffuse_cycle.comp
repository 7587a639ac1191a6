#version 450
// SPDX-License-Identifier: MIT
//
// The pieces of a multigrid cycle over the cells of diffused light (diffusion.glsl): one thread is
// one cell of run.level. Coarse cells are the sums of the fine ones in them; a link between two of
// them is half the sum of those through their face, for its way is twice as long. (A. Brandt, Math.
// Comp. 31, 1977; D. Braess, Computing 55, 1995, for that factor.)
//
// What flows is told by differences of fluence. Neighbours have nearly the same, and sums of what
// comes in and of what goes out would leave of it what last bits of many conductances are off by,
// on each device others: 4e-4 of a layer's light in 256 cells, where this is off by 1e-6.
#extension GL_GOOGLE_include_directive : require

#include "diffusion_run.glsl"

// enum job of renderer/diffused_light.c
const uint CLEAR = 0;   // no fluence
const uint COARSEN = 1; // make this level of the finer one `other`
const uint RED = 2, BLACK = 3; // every other cell is balanced with those around it
const uint LEAVE = 4;   // what the finer level `other` has left is the supply of this one
const uint CORRECT = 5; // add what the coarser level `other` has found
const uint LIMIT = 6;   // no more passes a face than the fluence before it can give

// What flows in from the cells around, less what flows out to them, and all conductances.
struct Around {
    float inflow, conductance;
};

Around around(DiffusionLevel level, uvec3 at, DiffusionCell cell)
{
    Around sum = Around(0.0, cell.drain);
    for (int axis = 0; axis < 3; axis++) {
        if (at[axis] > 0u) {
            DiffusionCell low = cells[index_of(level, at - axis_of(axis))];
            sum.inflow += low.link[axis] * (low.fluence - cell.fluence);
            sum.conductance += low.link[axis];
        }
        if (at[axis] + 1u < level.size[axis]) {
            DiffusionCell high = cells[index_of(level, at + axis_of(axis))];
            sum.inflow += cell.link[axis] * (high.fluence - cell.fluence);
            sum.conductance += cell.link[axis];
        }
    }
    return sum;
}

float left_in(DiffusionCell cell, Around sum)
{
    return cell.supply + sum.inflow - cell.drain * cell.fluence;
}

void relax(uint index, uvec3 at)
{
    if (((at.x + at.y + at.z) & 1u) != run.job - RED)
        return;
    DiffusionCell cell = cells[index];
    Around sum = around(run.level, at, cell);
    cells[index].fluence = sum.conductance > 0.0
                               ? cell.fluence + left_in(cell, sum) / sum.conductance
                               : 0.0;
}

float left_in(uvec3 at)
{
    DiffusionCell cell = cells[index_of(run.other, at)];
    return left_in(cell, around(run.other, at, cell));
}

// The finer cells of one of this level: from .. to.
void fine_cells(uvec3 at, out uvec3 from, out uvec3 to)
{
    uvec3 parts = joined(run.other);
    from = parts * at;
    to = min(from + parts, run.other.size);
}

void leave(uint index, uvec3 at)
{
    uvec3 from, to;
    float sum = 0.0;
    fine_cells(at, from, to);
    for (uint z = from.z; z < to.z; z++)
        for (uint y = from.y; y < to.y; y++)
            for (uint x = from.x; x < to.x; x++)
                sum += left_in(uvec3(x, y, z));
    cells[index].supply = sum;
    cells[index].fluence = 0.0;
}

void coarsen(uint index, uvec3 at)
{
    uvec3 from, to;
    DiffusionCell sum = DiffusionCell(vec3(0.0), 0.0, 0.0, 0.0, 0.0, 0.0);
    fine_cells(at, from, to);
    for (uint z = from.z; z < to.z; z++)
        for (uint y = from.y; y < to.y; y++)
            for (uint x = from.x; x < to.x; x++) {
                DiffusionCell fine = cells[index_of(run.other, uvec3(x, y, z))];
                sum.drain += fine.drain;
                sum.link += mix(vec3(0.0), 0.5 * fine.link,
                                equal(uvec3(x, y, z) + 1u, to));
            }
    cells[index] = sum;
}

void correct(uint index, uvec3 at)
{
    cells[index].fluence += cells[index_of(run.other, at / joined(run.level))].fluence;
}

void limit(uint index, uvec3 at)
{
    DiffusionCell cell = cells[index];
    for (int axis = 0; axis < 3; axis++) {
        if (!has_faces(axis) || at[axis] + 1u >= run.level.size[axis])
            continue;
        DiffusionCell high = cells[index_of(run.level, at + axis_of(axis))];
        if (is_solid(cell) || is_solid(high))
            continue;
        cells[index].link[axis] =
            area_m2(axis) * limited(face_between(cell, high, axis), cell.fluence, high.fluence);
    }
}

void main()
{
    uint thread = gl_GlobalInvocationID.x;
    if (thread >= cell_count(run.level))
        return;
    uvec3 at = cell_at(run.level, thread);
    uint index = run.level.first + thread;
    if (run.job == CLEAR)
        cells[index].fluence = 0.0;
    else if (run.job == COARSEN)
        coarsen(index, at);
    else if (run.job == LEAVE)
        leave(index, at);
    else if (run.job == LIMIT)
        limit(index, at);
    else if (run.job == CORRECT)
        correct(index, at);
    else
        relax(index, at);
}
