#version 450
// SPDX-License-Identifier: MIT
//
// Fills the aerial table, the air in front of the camera (sky_aerial.glsl). One thread marches one
// froxel in two steps, as if the ray started there. A group of threads then composes AT_ONCE slices
// of a column in order, and continues with the next AT_ONCE slices.
//
// Where something shadows the air, sky_sunlit.comp has already stored the visible fraction of the
// sun in place of the shade. Columns that meet the ground continue below it, in air as at the
// ground, so that there are values to interpolate to.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require

#define SKY_IS_KNOWN
#define SKY_IS_FILLED
#include "sky_aerial.glsl"
#include "sky_view.glsl"

layout(local_size_x = 64) in;

const uint STEPS_OF_SLICE = 2, AT_ONCE = NEPH_GPU_SKY_SLICES_AT_ONCE;

// A part of a column: all light of clear air; its single scattering; the loss of single scattering
// to all shadows, and to shadows of clouds; light from clouds; transmittance.
struct Part {
    vec3 light, once, shade_of_once, clouds_of_once, of_clouds, through;
};

shared Part parts[gl_WorkGroupSize.x];

// A segment of the column, by the properties at its middle.
struct Stretch {
    float length_m, altitude_m, cosine, sun_cosine;
};

Stretch make_segment(SkyRay ray, float t0_m, float t1_m)
{
    float r_m = air.radius_m + ray.altitude_m, rise_m = r_m * ray.cosine;
    float t_m = 0.5 * (t0_m + t1_m), growth_m2 = t_m * (2.0 * rise_m + t_m);
    float here_m = sqrt(max(r_m * r_m + growth_m2, 1.0));
    float sun_cosine = (r_m * ray.sun_cosine + t_m * ray.toward_sun) / here_m;
    return Stretch(t1_m - t0_m, max(0.0, ray.altitude_m + growth_m2 / (r_m + here_m)),
                   clamp((rise_m + t_m) / here_m, -1.0, 1.0), clamp(sun_cosine, -1.0, 1.0));
}

// Single scattering of a segment in full sunlight.
vec3 light_once(SkyRay ray, Stretch stretch, vec3 through)
{
    SkyLight once = SkyLight(vec3(0.0), vec3(0.0), through, FAR_M);
    sky_step(ray, stretch.altitude_m, stretch.cosine, stretch.sun_cosine, stretch.length_m,
             eye.scatters != 0u, false, once);
    return once.volume;
}

// Light from the clouds above a segment that the air scatters: the sunlight that clouds scatter
// downwards, isotropic over the lower half of all directions.
vec3 light_of_clouds(SkyRay ray, Stretch stretch, vec3 through, float handed_on)
{
    for (uint n = 0u; n < sky_layers(); n++)
        ray.phases[n] = 1.0 / (4.0 * PI);
    float flux = max(stretch.sun_cosine, 0.0) * handed_on;
    return 2.0 * flux * light_once(ray, stretch, through);
}

// Light that shadows remove up to a slice. The tables have the multiple scattering of clear air
// only; in shade it loses the part of the directions that clouds cover. A slanted ray meets more of
// randomly placed clouds, in proportion to its length: with a mean transmittance T along the sun's
// cosine, the transmittance of the whole sky is T^(2 cosine), because the mean cosine of the sky is
// 1/2. Solids cover little of the sky and are neglected. In exchange the clouds' own light is added
// (light_of_clouds()).
vec3 shade_of_all(Part all, vec3 light, float sun_cosine)
{
    const float LEAST_THROUGH = 1e-6;
    vec3 part = clamp(all.clouds_of_once / max(all.once, vec3(1e-30)), 0.0, 1.0);
    vec3 through = max(1.0 - part, vec3(LEAST_THROUGH));
    vec3 covered = 1.0 - pow(through, vec3(2.0 * max(sun_cosine, 0.0)));
    return min(all.shade_of_once + covered * part * max(light - all.once, vec3(0.0)), light);
}

Part march_slice(SkyRay ray, uint slice, vec4 sunlit, float through_clouds)
{
    float near_m = sky_slice_m(slice - 1u), far_m = sky_slice_m(slice);
    SkyLight light = SkyLight(vec3(0.0), vec3(0.0), vec3(1.0), FAR_M);
    Part part = Part(vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(1.0));
    for (uint k = 0u; k < STEPS_OF_SLICE; k++) {
        Stretch stretch = make_segment(ray, mix(near_m, far_m, float(k) / float(STEPS_OF_SLICE)),
                                     mix(near_m, far_m, float(k + 1u) / float(STEPS_OF_SLICE)));
        if (stretch.altitude_m >= air.top_m)
            continue;
        if (eye.is_shaded != 0u) {
            part.once += light_once(ray, stretch, light.transmittance);
            if (eye.has_field != 0u)
                part.of_clouds += light_of_clouds(ray, stretch, light.transmittance, sunlit.a);
        }
        sky_step(ray, stretch.altitude_m, stretch.cosine, stretch.sun_cosine, stretch.length_m,
                 eye.scatters != 0u, eye.has_field != 0u, light);
    }
    return Part(light.volume, part.once, (1.0 - sunlit.rgb) * part.once,
                (1.0 - through_clouds) * part.once, part.of_clouds, light.transmittance);
}

// Composition: one part of a column in front of another.
Part before(Part near, Part far)
{
    return Part(near.light + near.through * far.light, near.once + near.through * far.once,
                near.shade_of_once + near.through * far.shade_of_once,
                near.clouds_of_once + near.through * far.clouds_of_once,
                near.of_clouds + near.through * far.of_clouds, near.through * far.through);
}

void keep(uint node, Part all, float sun_cosine)
{
    vec3 light = max(all.light, vec3(0.0));
    vec3 shade = shade_of_all(all, light, sun_cosine);
    sky_nodes[node + VEIL_LIGHT] = vec4(light - shade + all.of_clouds, 0.0);
    sky_nodes[node + VEIL_THROUGH] = vec4(all.through, 0.0);
    sky_nodes[node + VEIL_SHADE] = vec4(shade - all.of_clouds, 0.0);
}

void main()
{
    uint index = gl_GlobalInvocationID.x / AT_ONCE, own = gl_LocalInvocationIndex % AT_ONCE;
    uint first = gl_LocalInvocationIndex - own; // first thread of the column
    uint column = index % eye.aerial_columns, row = index / eye.aerial_columns;
    bool is_there = row < eye.aerial_rows;
    SkyRay ray = sky_ray_along(eye.places[0], sky_aerial_direction(column, row));
    Part all = Part(vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(1.0));
    for (uint done = 0u; done < eye.aerial_slices; done += AT_ONCE) {
        uint slice = done + own + 1u, node = sky_aerial_node(column, row, slice);
        bool is_kept = is_there && slice <= eye.aerial_slices;
        bool is_shaded = is_kept && eye.is_shaded != 0u;
        vec4 sunlit = is_shaded ? sky_nodes[node + VEIL_SHADE] : vec4(vec3(1.0), 0.0);
        float through = is_shaded ? sky_nodes[node + VEIL_THROUGH].a : 1.0;
        parts[gl_LocalInvocationIndex] = march_slice(ray, slice, sunlit, through);
        barrier();
        for (uint k = 0u; k < AT_ONCE; k++) {
            all = before(all, parts[first + k]);
            if (k == own && is_kept)
                keep(node, all, ray.sun_cosine);
        }
        barrier();
    }
}
