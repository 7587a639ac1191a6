#version 450
// SPDX-License-Identifier: MIT
//
// The steps of a multigrid cycle that solves for diffused light (equations and cells:
// diffusion.glsl). One dispatch does one job (below) on one level; one thread is one cell of
// run.level. The C side, renderer/diffused_light.c, orders the dispatches into V-cycles.
//
// A coarse cell is the sum of the fine cells in it. The link between two coarse cells is half the
// sum of the fine links through their common face, because the distance between the centres is
// twice as long. (Multigrid: A. Brandt, Math. Comp. 31, 1977; the factor: D. Braess, Computing 55,
// 1995.)
//
// Flows are computed from differences of fluence:
//
//   residual = supply + sum over faces of link (fluence_there - fluence_here) - drain fluence_here
//
// Neighbouring fluences are nearly equal. The algebraically equal form with separate sums of inflow
// and outflow cancels, with an error that depends on the device: 4e-4 of a layer's light over 256
// cells, against 1e-6 for this form.
#extension GL_GOOGLE_include_directive : require

#include "diffusion_run.glsl"

// enum job of renderer/diffused_light.c
const uint CLEAR = 0;   // set the fluence to 0
const uint COARSEN = 1; // build this level's cells from the finer level `other`
const uint RED = 2, BLACK = 3; // Gauss-Seidel in checkerboard order: half of the cells
const uint LEAVE = 4;   // restrict: the supply of this level is the residual of the finer `other`
const uint CORRECT = 5; // prolong: add the correction that the coarser level `other` has found
const uint LIMIT = 6;   // recompute the flux limit of the links from the present fluence

// Net inflow from the neighbours, and the sum of the conductances including the drain.
struct Around {
    float inflow, conductance;
};

Around around(DiffusionLevel level, uvec3 at, DiffusionCell cell)
{
    Around sum = Around(0.0, cell.drain);
    for (int axis = 0; axis < 3; axis++) {
        if (at[axis] > 0u) {
            DiffusionCell low = cells[cell_index(level, at - select_axis(axis))];
            sum.inflow += low.link[axis] * (low.fluence - cell.fluence);
            sum.conductance += low.link[axis];
        }
        if (at[axis] + 1u < level.size[axis]) {
            DiffusionCell high = cells[cell_index(level, at + select_axis(axis))];
            sum.inflow += cell.link[axis] * (high.fluence - cell.fluence);
            sum.conductance += cell.link[axis];
        }
    }
    return sum;
}

// The residual of a cell's balance, per 1 W/m^2 of sun [m^2].
float cell_residual(DiffusionCell cell, Around sum)
{
    return cell.supply + sum.inflow - cell.drain * cell.fluence;
}

// One half-sweep: sets the fluence of every cell of one colour so that its residual is 0.
void relax(uint index, uvec3 at)
{
    if (((at.x + at.y + at.z) & 1u) != run.job - RED)
        return;
    DiffusionCell cell = cells[index];
    Around sum = around(run.level, at, cell);
    cells[index].fluence = sum.conductance > 0.0
                               ? cell.fluence + cell_residual(cell, sum) / sum.conductance
                               : 0.0;
}

float cell_residual(uvec3 at)
{
    DiffusionCell cell = cells[cell_index(run.other, at)];
    return cell_residual(cell, around(run.other, at, cell));
}

// The fine cells that a cell of this level covers, from `from` up to but without `to`.
void fine_cells(uvec3 at, out uvec3 from, out uvec3 to)
{
    uvec3 parts = coarsening(run.other);
    from = parts * at;
    to = min(from + parts, run.other.size);
}

void restrict_residual(uint index, uvec3 at)
{
    uvec3 from, to;
    float sum = 0.0;
    fine_cells(at, from, to);
    for (uint z = from.z; z < to.z; z++)
        for (uint y = from.y; y < to.y; y++)
            for (uint x = from.x; x < to.x; x++)
                sum += cell_residual(uvec3(x, y, z));
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
                DiffusionCell fine = cells[cell_index(run.other, uvec3(x, y, z))];
                sum.drain += fine.drain;
                sum.link += mix(vec3(0.0), 0.5 * fine.link,
                                equal(uvec3(x, y, z) + 1u, to));
            }
    cells[index] = sum;
}

void correct(uint index, uvec3 at)
{
    cells[index].fluence += cells[cell_index(run.other, at / coarsening(run.level))].fluence;
}

void limit(uint index, uvec3 at)
{
    DiffusionCell cell = cells[index];
    for (int axis = 0; axis < 3; axis++) {
        if (!has_faces(axis) || at[axis] + 1u >= run.level.size[axis])
            continue;
        DiffusionCell high = cells[cell_index(run.level, at + select_axis(axis))];
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
        restrict_residual(index, at);
    else if (run.job == LIMIT)
        limit(index, at);
    else if (run.job == CORRECT)
        correct(index, at);
    else
        relax(index, at);
}
