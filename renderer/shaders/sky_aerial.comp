#version 450
// SPDX-License-Identifier: MIT
//
// Fills the air before the camera (sky_aerial.glsl): a thread is a column of froxels, which it
// walks from the camera on, in two steps a slice. Where something throws shadows on the air,
// sky_sunlit.comp has left in place of the shade how much of the sun each slice sees. Columns that
// meet the ground go on below it, in air as it is at the ground, so that there is something to
// interpolate to.
#extension GL_GOOGLE_include_directive : require

#define SKY_IS_FILLED
#include "sky_aerial.glsl"
#include "sky_view.glsl"

layout(local_size_x = 64) in;

const uint STEPS_OF_SLICE = 2;

// A stretch of the column, seen from its middle.
struct Stretch {
    float length_m, altitude_m, cosine, sun_cosine;
};

Stretch stretch_of(SkyRay ray, float t0_m, float t1_m)
{
    float r_m = air.radius_m + ray.altitude_m, rise_m = r_m * ray.cosine;
    float t_m = 0.5 * (t0_m + t1_m), growth_m2 = t_m * (2.0 * rise_m + t_m);
    float here_m = sqrt(max(r_m * r_m + growth_m2, 1.0));
    float sun_cosine = (r_m * ray.sun_cosine + t_m * ray.toward_sun) / here_m;
    return Stretch(t1_m - t0_m, max(0.0, ray.altitude_m + growth_m2 / (r_m + here_m)),
                   clamp((rise_m + t_m) / here_m, -1.0, 1.0), clamp(sun_cosine, -1.0, 1.0));
}

// Light of a stretch that is scattered once, its sun being seen.
vec3 light_once(SkyRay ray, Stretch stretch, vec3 through)
{
    SkyLight once = SkyLight(vec3(0.0), vec3(0.0), through, FAR_M);
    sky_step(ray, stretch.altitude_m, stretch.cosine, stretch.sun_cosine, stretch.length_m,
             eye.scatters != 0u, false, once);
    return once.volume;
}

// What shadows take of all light up to a slice. Tables know the higher orders of clear air alone.
// Under clouds one half of the directions that these come from is of air in the same shade, and
// loses the same part as light scattered once; the other is of clouds and what is above them, which
// is taken to stay as it is, for clouds are white.
vec3 shade_of_all(vec3 light, vec3 once, vec3 shade_of_once)
{
    const float IN_SHADE = 0.5; // of the directions
    vec3 part = clamp(shade_of_once / max(once, vec3(1e-30)), 0.0, 1.0);
    return min(shade_of_once + IN_SHADE * part * max(light - once, vec3(0.0)), light);
}

void main()
{
    uint index = gl_GlobalInvocationID.x;
    if (index >= eye.aerial_columns * eye.aerial_rows)
        return;
    uint column = index % eye.aerial_columns, row = index / eye.aerial_columns;
    SkyRay ray = sky_ray_along(eye.places[0], sky_aerial_direction(column, row));
    SkyLight light = SkyLight(vec3(0.0), vec3(0.0), vec3(1.0), FAR_M);
    vec3 once = vec3(0.0), shade_of_once = vec3(0.0);
    for (uint slice = 1u; slice <= eye.aerial_slices; slice++) {
        float near_m = sky_slice_m(slice - 1u), far_m = sky_slice_m(slice);
        uint node = sky_aerial_node(column, row, slice);
        vec3 sunlit = eye.is_shaded != 0u ? sky_nodes[node + VEIL_SHADE].rgb : vec3(1.0);
        for (uint k = 0u; k < STEPS_OF_SLICE; k++) {
            Stretch stretch = stretch_of(ray, mix(near_m, far_m, float(k) / float(STEPS_OF_SLICE)),
                                         mix(near_m, far_m,
                                             float(k + 1u) / float(STEPS_OF_SLICE)));
            if (stretch.altitude_m >= air.top_m)
                continue;
            vec3 of_stretch = vec3(0.0);
            if (eye.is_shaded != 0u)
                of_stretch = light_once(ray, stretch, light.transmittance);
            once += of_stretch;
            shade_of_once += (1.0 - sunlit) * of_stretch;
            sky_step(ray, stretch.altitude_m, stretch.cosine, stretch.sun_cosine, stretch.length_m,
                     eye.scatters != 0u, eye.has_field != 0u, light);
        }
        vec3 all = max(light.volume, vec3(0.0));
        vec3 shade = shade_of_all(all, once, shade_of_once);
        sky_nodes[node + VEIL_LIGHT] = vec4(all - shade, 0.0);
        sky_nodes[node + VEIL_THROUGH] = vec4(light.transmittance, 0.0);
        sky_nodes[node + VEIL_SHADE] = vec4(shade, 0.0);
    }
}
