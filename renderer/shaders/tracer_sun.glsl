// SPDX-License-Identifier: MIT
//
// The path tracer's sunlight by a table, if SUN_BY_TABLE: no event in a medium sends a ray to the
// sun. How much arrives is looked up, the transmittance of all shapes towards the sun between the
// nodes of a lattice (tracer_sun.comp). Then one of all events of a batch of samples is chosen, in
// proportion to the light that it has by the table, and its true transmittance over that of the
// table is what the batch's light is multiplied with (tracer_check.comp): resampled importance
// sampling (J. Talbot, D. Cline, P. Egbert, EGSR 2005), without bias whatever the table says, and
// never negative.
#ifndef NEPH_TRACER_SUN_GLSL
#define NEPH_TRACER_SUN_GLSL

#include "tracer.glsl"

layout(std430, binding = 15) buffer SunTable {
    float sun_transmittances[];
};

// No transmittance of the table is less: what it takes for dark may have a gap.
const float SUN_LEAST = 1e-5;

// An item's sunlight by the table: of all events behind the first, and one of them, chosen in
// proportion to that; and of the first, if FIRST_BY_PATH.
struct SunCheck {
    vec3 light;          // of all
    float most;          // the same in one number: the sum over events of their brightest channel
    vec3 point_m;        // of the chosen one
    float guessed;       // transmittance there
    vec3 color;          // of its light; the brightest channel is 1
    float first_guessed; // transmittance at the first event
    vec3 first_light;    // of that
};

layout(std430, binding = 16) buffer SunChecks {
    SunCheck sun_checks[]; // as results[]
};

SunCheck no_sun_check()
{
    return SunCheck(vec3(0.0), 0.0, vec3(0.0), 1.0, vec3(0.0), 1.0, vec3(0.0));
}

// That of all shapes, by the table, at any point: one outside of the lattice sees what it sees
// where its sun ray enters that.
float shapes_sun_transmittance(Lattice lattice, vec3 point_m, vec3 sun)
{
    vec3 last = vec3(lattice.size - 1);
    float t0_m = 0.0, t1_m = FAR_M;
    if (!clip_box(lattice.origin_m, lattice.origin_m + last / lattice.per_m, point_m, sun, t0_m,
                  t1_m))
        return 1.0;
    vec3 place = clamp((point_m + t0_m * sun - lattice.origin_m) * lattice.per_m, vec3(0.0), last);
    vec3 cell = min(floor(place), last - 1.0);
    uvec3 node = uvec3(cell);
    uint x = 1, y = lattice.size.x, z = y * lattice.size.y;
    uint at = node.x + y * node.y + z * node.z;
    return cell_density(Cell(vec4(sun_transmittances[at], sun_transmittances[at + x],
                                  sun_transmittances[at + y], sun_transmittances[at + x + y]),
                             vec4(sun_transmittances[at + z], sun_transmittances[at + x + z],
                                  sun_transmittances[at + y + z],
                                  sun_transmittances[at + x + y + z])),
                        place - cell);
}

// That of all media; fogs are exact.
float guess_sun_transmittance(Lattice lattice, vec3 point_m, vec3 sun)
{
    float depth = 0.0;
    for (uint m = 0; HAS_FOG && m < media_count(); m++)
        if (is_fog(m))
            depth += frame.media[m].extinction_color.r *
                     medium_optical_depth(m, point_m, sun, FAR_M);
    float shapes = shapes_sun_transmittance(lattice, point_m, sun);
    return HAS_FOG ? shapes * transmittance(depth) : shapes;
}

#endif
