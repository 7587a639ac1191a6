#version 450
// SPDX-License-Identifier: MIT
//
// Fills the air before the camera (sky_aerial.glsl): a thread is a column of froxels, which it
// walks from the camera on, in two steps a slice. Columns that meet the ground go on below it, in
// air as it is at the ground, so that there is something to interpolate to.
#extension GL_GOOGLE_include_directive : require

#define SKY_IS_FILLED
#include "sky_aerial.glsl"
#include "sky_view.glsl"

layout(local_size_x = 64) in;

const uint STEPS_OF_SLICE = 2;

// The light of a stretch around its middle.
void add_stretch(SkyRay ray, float t0_m, float t1_m, inout SkyLight light)
{
    float r_m = air.radius_m + ray.altitude_m, rise_m = r_m * ray.cosine;
    float t_m = 0.5 * (t0_m + t1_m), growth_m2 = t_m * (2.0 * rise_m + t_m);
    float here_m = sqrt(max(r_m * r_m + growth_m2, 1.0));
    float altitude_m = max(0.0, ray.altitude_m + growth_m2 / (r_m + here_m));
    if (altitude_m >= air.top_m)
        return;
    float sun_cosine = (r_m * ray.sun_cosine + t_m * ray.toward_sun) / here_m;
    sky_step(ray, altitude_m, clamp((rise_m + t_m) / here_m, -1.0, 1.0),
             clamp(sun_cosine, -1.0, 1.0), t1_m - t0_m, eye.scatters != 0u, eye.has_field != 0u,
             light);
}

void main()
{
    uint index = gl_GlobalInvocationID.x;
    if (index >= eye.aerial_columns * eye.aerial_rows)
        return;
    uint column = index % eye.aerial_columns, row = index / eye.aerial_columns;
    SkyRay ray = sky_ray_along(eye.places[0], sky_aerial_direction(column, row));
    SkyLight light = SkyLight(vec3(0.0), vec3(0.0), vec3(1.0), FAR_M);
    for (uint slice = 1u; slice <= eye.aerial_slices; slice++) {
        float near_m = sky_slice_m(slice - 1u), far_m = sky_slice_m(slice);
        for (uint k = 0u; k < STEPS_OF_SLICE; k++) {
            float t0_m = mix(near_m, far_m, float(k) / float(STEPS_OF_SLICE));
            float t1_m = mix(near_m, far_m, float(k + 1u) / float(STEPS_OF_SLICE));
            add_stretch(ray, t0_m, t1_m, light);
        }
        uint node = sky_aerial_node(column, row, slice);
        sky_nodes[node] = vec4(light.volume, 0.0);
        sky_nodes[node + 1u] = vec4(light.transmittance, 0.0);
    }
}
