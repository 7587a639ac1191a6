#version 450
// SPDX-License-Identifier: MIT
//
// First step of diffused light (diffusion.glsl): fills one cell of the finest level per thread. The
// coefficients of the medium and the sunlight in it are means over a few points of the cell. The
// fluence of the frame before stays as the initial guess of the solver.
#extension GL_GOOGLE_include_directive : require

#include "march_light.glsl"
#include "march_run.glsl"
#include "diffusion.glsl"

layout(std430, binding = 5) buffer Cells {
    DiffusionCell cells[];
};

// Sample points of a cell along an axis. An axis with only one cell needs one point, because
// nothing varies along it.
const uint ACROSS = 2; // in a grid with several cells along two or three axes
const uint ALONG = 8;  // in a column: several cells along one axis only

struct Contents {
    float absorption_per_m, transport_per_m; // sigma_a, sigma_tr
    float supply_per_m, beam_per_m;          // right-hand sides of both equations
};

Contents contents_at(vec3 point_m)
{
    Contents all = Contents(0.0, 0.0, 0.0, 0.0);
    Similar similar = make_similar_medium(mixture_at(point_m));
    all.absorption_per_m = similar.extinction_per_m - similar.scattering_per_m;
    all.transport_per_m = similar.extinction_per_m - similar.onward_per_m;
    if (similar.scattering_per_m <= 0.0 || !sees_sun(point_m, NO_SOLID))
        return all;
    float sunlight = transmittance(similar_scale(similar) * sample_sun_depth(point_m).x);
    all.supply_per_m = (similar.scattering_per_m - similar.peak_per_m) * sunlight;
    all.beam_per_m = (similar.onward_per_m - similar.peak_per_m) * sunlight;
    return all;
}

bool is_in_solid(vec3 point_m)
{
    for (uint s = 0; s < make_nonuniform(frame.solid_count); s++) {
        float t0_m, t1_m;
        if (solid_interval(solids[s], point_m, vec3(0.0, 1.0, 0.0), t0_m, t1_m) && t0_m <= 0.0 &&
            t1_m > 0.0)
            return true;
    }
    return false;
}

vec3 cell_sides_m() { return 1.0 / frame.light_lattice.per_m; }

// Mean chord of the grid's box, 4 volume / surface (Cauchy), over axes with more than one cell. In
// an almost empty medium it replaces the mean free path, which has no upper bound there.
float chord_m()
{
    vec3 sides_m = vec3(frame.light_lattice.size) * cell_sides_m();
    vec3 faces = mix(1.0 / sides_m, vec3(0.0), lessThanEqual(frame.light_lattice.size, uvec3(1)));
    return 2.0 / max(faces.x + faces.y + faces.z, 1e-30);
}

void main()
{
    if (gl_GlobalInvocationID.x >= run.ray_count)
        return;
    uint index = run.first_ray + gl_GlobalInvocationID.x;
    DiffusionLevel level = DiffusionLevel(frame.light_lattice.size, 0u);
    vec3 sides_m = cell_sides_m();
    vec3 low_m = frame.light_lattice.origin_m + vec3(cell_at(level, index)) * sides_m;
    bvec3 has_many = greaterThan(level.size, uvec3(1));
    uint many = uint(has_many.x) + uint(has_many.y) + uint(has_many.z);
    uvec3 points = mix(uvec3(1), uvec3(many > 1 ? ACROSS : ALONG), has_many);
    Contents sum = Contents(0.0, 0.0, 0.0, 0.0);
    for (uint i = 0; i < points.x * points.y * points.z; i++) {
        uvec3 point = uvec3(i % points.x, i / points.x % points.y, i / (points.x * points.y));
        Contents found = contents_at(low_m + (vec3(point) + 0.5) / vec3(points) * sides_m);
        sum.absorption_per_m += found.absorption_per_m;
        sum.transport_per_m += found.transport_per_m;
        sum.supply_per_m += found.supply_per_m;
        sum.beam_per_m += found.beam_per_m;
    }
    float part = 1.0 / float(points.x * points.y * points.z);
    float volume_m3 = sides_m.x * sides_m.y * sides_m.z;
    float transport_per_m = max(part * sum.transport_per_m, 1.0 / chord_m());
    DiffusionCell cell;
    cell.link = vec3(0.0);
    cell.fluence = cells[index].fluence; // of the frame before: the initial guess
    cell.drain = part * sum.absorption_per_m * volume_m3;
    cell.supply = part * sum.supply_per_m * volume_m3;
    cell.opacity_per_m = 3.0 * transport_per_m;
    cell.beam = part * sum.beam_per_m / transport_per_m;
    if (is_in_solid(low_m + 0.5 * sides_m))
        cell = DiffusionCell(vec3(0.0), 0.0, 1.0, 0.0, -1.0, 0.0);
    cells[index] = cell;
}
