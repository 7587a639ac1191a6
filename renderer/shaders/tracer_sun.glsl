// SPDX-License-Identifier: MIT
//
// Sunlight from a table in the path tracer, if SUN_BY_TABLE. Events in media send no shadow rays:
// the transmittance of all shapes is interpolated between the nodes of a grid (tracer_sun.comp).
//
// The bias of the table is removed per batch of samples: one event of the batch is chosen in
// proportion to its light L_i by the table, and the batch is multiplied with the ratio of true and
// tabulated transmittance there (tracer_check.comp):
//
//   estimate = (sum L_i) T_true(k) / T_table(k),    P(k) = L_k / sum L_i
//
// with L_i the brightest channel of an event, and the colour of event k for the whole batch.
//
// This is resampled importance sampling (J. Talbot, D. Cline, P. Egbert, EGSR 2005): unbiased for
// every table with positive values, and never negative.
#ifndef NEPH_TRACER_SUN_GLSL
#define NEPH_TRACER_SUN_GLSL

#include "tracer.glsl"

layout(std430, binding = 15) buffer SunTable {
    float sun_transmittances[];
};

// Smallest value of the table: a place that seems dark may have a gap.
const float SUN_LEAST = 1e-5;

// An item's sunlight by the table: of all events after the first, with one event chosen in
// proportion to its light; and of the first event, if FIRST_BY_PATH.
struct SunCheck {
    vec3 light;          // sum over events
    float most;          // sum over events of the brightest channel
    vec3 point_m;        // of the chosen event
    float guessed;       // transmittance there, by the table
    vec3 color;          // of its light; the brightest channel is 1
    float first_guessed; // transmittance at the first event, by the table
    vec3 first_light;    // light of the first event
};

layout(std430, binding = 16) buffer SunChecks {
    SunCheck sun_checks[]; // indexed as results[]
};

SunCheck no_sun_check()
{
    return SunCheck(vec3(0.0), 0.0, vec3(0.0), 1.0, vec3(0.0), 1.0, vec3(0.0));
}

// Transmittance of all shapes by the table. From outside the grid it is the value where the sun ray
// enters the grid.
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

// Transmittance of all media; fogs are exact.
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
