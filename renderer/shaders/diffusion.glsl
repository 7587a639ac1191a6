// SPDX-License-Identifier: MIT
//
// Diffused light: multiple scattering by P1 diffusion on a coarse grid, solved on the device. This
// file has the equations and the grid's layout; the steps of a frame are
//
//   diffuse_fill.comp    media and sunlight in the cells
//   diffuse_links.comp   conductances of the faces, boundary conditions
//   diffuse_cycle.comp   multigrid cycles (renderer/diffused_light.c has their schedule)
//   diffuse_field.comp   the table for the ray marcher, which reads it in diffused_light.glsl
//
// The medium is replaced by the similar one of delta-Eddington (J. H. Joseph, W. J. Wiscombe, J. A.
// Weinman, J. Atmos. Sci. 33, 1976): the fraction f = g^2 of the scattered light goes straight on,
// as if unscattered, and the fraction 1 - f scatters with the asymmetry g' = g / (1 + g). Sunlight
// is attenuated by exp(-(1 - f albedo) tau). The light that it loses feeds the fluence phi [W/m^2]
// and the flux F [W/m^2] of the P1 approximation:
//
//   div F + sigma_a phi = (1 - f) sigma_s E'               E': sunlight in the similar medium
//   grad phi / 3 + sigma_tr F = g' (1 - f) sigma_s E' s    sigma_tr = (1 - g albedo) sigma_t
//
// with s the direction of sunlight. No diffuse light enters from outside: phi = F / outward at the
// faces of the grid (`outward`: NEPH_GPU_OUTWARD in constants.h, or Marshak's 0.5).
//
// The discretization is a finite-volume method. A face takes from one cell exactly the flux that it
// gives to the other, so all sunlight is either absorbed or leaves, up to the residual of the
// solver.
//
//         +-----------+-----------+      flux through the face between two cells:
//         |           |           |
//         |  phi_low --->  phi_high      link (phi_low - phi_high) + flux of sunlight
//         |           |           |
//         +-----------+-----------+
//
// In an almost empty medium the P1 flux is not bounded. There the mean free path is limited to the
// mean chord of the grid's box.
#ifndef NEPH_DIFFUSION_GLSL
#define NEPH_DIFFUSION_GLSL

#include "numbers.glsl"

// A cell, per 1 W/m^2 of sun. On the coarse levels `supply` is the residual of the finer level.
struct DiffusionCell {
    vec3 link;      // conductances to the next cells: flux over difference of fluence [m^2]
    float fluence;  // phi
    float drain;    // absorption, and loss through open faces, over the fluence [m^2]
    float supply;   // right-hand side of the balance [m^2]
    float opacity_per_m; // 3 sigma_tr; negative: in a solid, which has no light
    float beam;     // flux that the sunlight term of the second equation drives, along the sunlight
};

// A level of the multigrid pyramid. Levels are stored one after the other, the finest first, in
// each the x axis fastest.
struct DiffusionLevel {
    uvec3 size;
    uint first;
};

uint cell_count(DiffusionLevel level) { return level.size.x * level.size.y * level.size.z; }

uvec3 cell_at(DiffusionLevel level, uint index)
{
    return uvec3(index % level.size.x, index / level.size.x % level.size.y,
                 index / (level.size.x * level.size.y));
}

uint cell_index(DiffusionLevel level, uvec3 at)
{
    return level.first + at.x + level.size.x * (at.y + level.size.y * at.z);
}

uvec3 select_axis(int axis) { return uvec3(axis == 0, axis == 1, axis == 2); }

// Cells of a level that form one cell of the next coarser level, along each axis: 2, or 1 along an
// axis of one cell.
uvec3 coarsening(DiffusionLevel level)
{
    return uvec3(1u) + uvec3(greaterThan(level.size, uvec3(1u)));
}

#endif
