// SPDX-License-Identifier: MIT
//
// The planet's atmosphere in the ray marcher, from precomputed tables (renderer/sky/tables.h). The
// air is not marched: it is part of the veil (march_veil.glsl), it attenuates sunlight, and it
// illuminates surfaces.
#ifndef NEPH_MARCH_SKY_GLSL
#define NEPH_MARCH_SKY_GLSL

#include "shortcuts.glsl"

#define SKY_BINDING 9
#include "sky_aerial.glsl"
#include "sky_view.glsl"

const bool HAS_SKY = (SHORTCUTS & 64u) != 0u;
// The sky illuminates media, from a table of views at their centre.
const bool SKY_LIGHTS = (SHORTCUTS & 128u) != 0u;

// A point relative to the camera in the coordinates of the tables.
struct SkySpot {
    vec3 vertical;
    float altitude_m, sun_cosine;
};

// The coordinates of a point; its altitude is computed without cancellation (globe.glsl).
SkySpot sky_spot(vec3 point_m)
{
    SkyPlace camera = eye.places[0];
    float r_m = air.radius_m + camera.altitude_m;
    Globe globe = Globe(camera.vertical, r_m, camera.altitude_m, air.radius_m);
    vec3 vertical = normalize(camera.vertical * r_m + point_m);
    return SkySpot(vertical, max(0.0, globe_altitude_m(globe, point_m)),
                   dot(vertical, to_sun()));
}

// Irradiance of a surface by the sky and the ground around it [W/m^2]: the spherical-harmonic
// moments of the radiance field times the moments of the clamped cosine, which are pi, 2 pi / 3, pi
// / 4, 0, -pi / 24 for degrees 0 to 4 (neph_sky_irradiance()).
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
