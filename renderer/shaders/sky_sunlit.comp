#version 450
// SPDX-License-Identifier: MIT
//
// Shadows on the air: the fraction of the sun that is visible from each froxel of sky_aerial.glsl,
// past media and solids, as a mean over samples between its slice and the one before. The planet's
// own shadow is in the table of transmittance to the sun. The results are stored in the aerial
// table, where sky_aerial.comp replaces them.
#extension GL_GOOGLE_include_directive : require

#define DRAWS_COVERAGE
#define SKY_IS_FILLED
#include "march_light.glsl"
#include "march_run.glsl"
#include "counting.glsl"

layout(std430, binding = 6) buffer SunCounters {
    uint density_evaluations[2]; // lower and upper half of 64 bits
    uint closed_forms[2];
} counters;

const uint GROUND = 0; // number of the solid that is the planet's ground

// Fraction of sunlight that arrives; fraction that clouds on the way scatter downwards;
// transmittance of the clouds without solids.
struct Sunlit {
    vec3 seen;
    float handed_on; // over the flux through a horizontal plane
    float through;
};

// Mean properties of all media.
struct Clouds {
    float g, albedo;
};

Clouds mean_clouds()
{
    vec2 sum = vec2(0.0);
    for (uint m = 0u; m < media_count(); m++)
        sum += vec2(medium_mean_cosine(m), frame.media[m].albedo.g);
    sum /= max(float(media_count()), 1.0);
    return Clouds(sum.x, sum.y);
}

// Sunlight that clouds scatter downwards, without the direct beam: Eddington's transmittance of a
// layer (K. N. Liou, "An Introduction to Atmospheric Radiation", 2002, chapter 6), times the
// absorption along a diffusion length. The clouds are taken to be as deep as they are long on the
// sun ray, and the optical depth is the similar isotropic medium's.
float scattered_downwards(Clouds clouds, float depth, float mu)
{
    float similar = (1.0 - clouds.g) * depth;
    float whole = (2.0 / 3.0 + mu + (2.0 / 3.0 - mu) * transmittance(similar)) /
                  (4.0 / 3.0 + similar);
    float loss = sqrt(3.0 * (1.0 - clouds.albedo) * (1.0 - clouds.albedo * clouds.g));
    return max(whole * transmittance(loss * depth) - transmittance(depth), 0.0);
}

Sunlit sunlit_at(Clouds clouds, vec3 point_m)
{
    is_in_shape = false; // use the shadow map, which is accurate enough
    vec3 depth = sun_depth_outside_shapes(point_m);
    float mu = max(sky_spot(point_m).sun_cosine, 0.0), through = fraction_through(depth).g;
    if (!sees_sun(point_m, GROUND))
        return Sunlit(vec3(0.0), 0.0, through);
    return Sunlit(fraction_through(depth), scattered_downwards(clouds, depth.g, mu), through);
}

void main()
{
    if (gl_GlobalInvocationID.x >= run.ray_count)
        return;
    uint index = run.first_ray + gl_GlobalInvocationID.x;
    set_coverage(uvec2(index, NO_SOLID), frame.meshes.frame_number);
    uint columns = eye.aerial_columns, rows = eye.aerial_rows;
    uint column = index % columns, row = index / columns % rows;
    uint slice = 1u + index / (columns * rows);
    float near_m = sky_slice_m(slice - 1u), far_m = sky_slice_m(slice);
    vec3 direction = sky_aerial_direction(column, row);
    vec4 sum = vec4(0.0);
    float through = 0.0;
    Clouds clouds = mean_clouds();
    for (uint k = 0u; k < NEPH_GPU_SKY_SUN_SAMPLES; k++) {
        float part = (float(k) + 0.5) / float(NEPH_GPU_SKY_SUN_SAMPLES);
        Sunlit sunlit = sunlit_at(clouds, mix(near_m, far_m, part) * direction);
        sum += vec4(sunlit.seen, sunlit.handed_on);
        through += sunlit.through;
    }
    uint node = sky_aerial_node(column, row, slice);
    sky_nodes[node + VEIL_SHADE] = sum / float(NEPH_GPU_SKY_SUN_SAMPLES);
    sky_nodes[node + VEIL_THROUGH].a = through / float(NEPH_GPU_SKY_SUN_SAMPLES);
    ADD_64(counters.density_evaluations, density_evaluations);
    ADD_64(counters.closed_forms, closed_forms);
}
