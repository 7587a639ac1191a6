// SPDX-License-Identifier: MIT
//
// A march under the sky of a planet (renderer/sky/tables.h): the air is no medium of the march, and
// comes from tables. What the march finds at a distance is seen through the air before it: it loses
// what that takes, and the air adds its own light, as far as the place hides what is behind it. As
//
//   L = sum_i T_i (1 - e^-dtau_i) (A(t_i) + T_air(t_i) J_i) + T (A(D) + T_air(D) L_behind)
//
// this is the transport equation of air and media together, with A(t) = integral of T_air j_air up
// to t: by parts, the integral of T dA is T(D) A(D) less that of A dT. So no order of layers needs
// to be known, and where a medium is cut in two, nothing changes. What it leaves out: media cast no
// shadow on the air, and scatter no light to it.
#ifndef NEPH_MARCH_SKY_GLSL
#define NEPH_MARCH_SKY_GLSL

#include "shortcuts.glsl"

#define SKY_BINDING 9
#include "sky_aerial.glsl"
#include "sky_view.glsl"

const bool HAS_SKY = (SHORTCUTS & 64u) != 0u;
const bool SKY_LIGHTS = (SHORTCUTS & 128u) != 0u; // media, by a table of their own place

// For a place relative to the camera.
struct SkySpot {
    vec3 vertical;
    float altitude_m, sun_cosine;
};

SkySpot sky_spot(vec3 point_m)
{
    SkyPlace camera = eye.places[0];
    float r_m = air.radius_m + camera.altitude_m;
    Globe globe = Globe(camera.vertical, r_m, camera.altitude_m, air.radius_m);
    vec3 vertical = normalize(camera.vertical * r_m + point_m);
    return SkySpot(vertical, max(0.0, globe_altitude_m(globe, point_m)),
                   dot(vertical, to_sun()));
}

// Sunlight that comes to a place through the air alone [W/m^2].
vec3 sun_at(vec3 point_m)
{
    vec3 irradiance = frame.sun_irradiance;
    if (HAS_SKY) {
        SkySpot spot = sky_spot(point_m);
        irradiance *= sky_sun_transmittance(spot.altitude_m, spot.sun_cosine);
    }
    return irradiance;
}

// Radiance seen through the air before it.
vec3 behind_air(vec3 direction, float distance_m, vec3 radiance, vec3 opacity)
{
    SkyVeil veil = sky_veil(direction, distance_m);
    return veil.through * radiance + frame.sun_irradiance * veil.light * opacity;
}

// Irradiance of a surface by the sky and the ground around it: moments of the field by the cosine's
// own, pi, 2 pi / 3, pi / 4, 0, -pi / 24 (neph_sky_irradiance()).
vec3 sky_irradiance(SkySpot spot, vec3 normal)
{
    if (eye.has_field == 0u)
        return vec3(0.0);
    const float COSINE_PARTS[5] = {PI, 2.0 * PI / 3.0, PI / 4.0, 0.0, -PI / 24.0};
    vec3 by_degree[NEPH_GPU_SKY_DEGREE_MAX + 1];
    for (uint l = 0u; l <= NEPH_GPU_SKY_DEGREE_MAX; l++)
        by_degree[l] = vec3(l < 5u ? COSINE_PARTS[min(l, 4u)] : 0.0);
    vec3 ahead = to_sun() - spot.sun_cosine * spot.vertical;
    float x = dot(normal, ahead) / max(length(ahead), 1e-6);
    vec3 sky = sky_scatter_field(spot.altitude_m, spot.sun_cosine, x, dot(normal, spot.vertical),
                                 by_degree);
    return frame.sun_irradiance * max(sky, vec3(0.0));
}

#endif
