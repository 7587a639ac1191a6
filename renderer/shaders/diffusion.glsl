// SPDX-License-Identifier: MIT
//
// Diffused light: light of higher orders as a fluid that seeps through a coarse lattice of cells.
//
// The medium is the similar one of delta-Eddington (J. H. Joseph, W. J. Wiscombe, J. A. Weinman,
// J. Atmos. Sci. 33, 1976): a part f = g^2 of what is scattered goes on as if nothing had happened,
// the rest scatters with g' = g / (1 + g). Sunlight comes as far as exp(-(1 - f albedo) tau), what
// it loses to the rest feeds the fluence phi [W/m^2] and the flux F [W/m^2] of order P1:
//
//   div F + sigma_a phi = (1 - f) sigma_s E'            E': sunlight in the similar medium
//   grad phi / 3 + sigma_tr F = g' (1 - f) sigma_s E' s    sigma_tr = (1 - g albedo) sigma_t
//
// and nothing comes in from outside: phi = F / outward at the faces (constants.h). Each face
// between two cells passes what the one loses to the other, so that all that the sun gives is
// absorbed or leaves: that is the equation of finite volumes, and holds to what the solver leaves.
//
// Where next to nothing is in the way P1 knows no end to a flux: there light goes no further than
// the mean chord of the box, as if that were its mean free path.
#ifndef NEPH_DIFFUSION_GLSL
#define NEPH_DIFFUSION_GLSL

#include "numbers.glsl"

// Per 1 W/m^2 of sun. Of levels above the finest `supply` is what the finer one has left.
struct DiffusionCell {
    vec3 link;      // to the next cell along each axis: flux by difference of fluence [m^2]
    float fluence;  // phi
    float drain;    // absorbed and lost through faces, by fluence [m^2]
    float supply;   // [m^2]
    float opacity_per_m; // 3 sigma_tr; negative: within a solid, where no light is
    float beam;     // the flux that sunlight has by itself, along its way
};

// The levels lie one after the other, the finest first, x fastest.
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

uint index_of(DiffusionLevel level, uvec3 at)
{
    return level.first + at.x + level.size.x * (at.y + level.size.y * at.z);
}

uvec3 axis_of(int axis) { return uvec3(axis == 0, axis == 1, axis == 2); }

// How many cells of a level are one of the next, along each axis.
uvec3 joined(DiffusionLevel level) { return uvec3(1u) + uvec3(greaterThan(level.size, uvec3(1u))); }

#endif
