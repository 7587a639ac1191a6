// SPDX-License-Identifier: MIT
//
// What lies between the camera and all that is marched, and is no medium of the march: the look of
// a height fog in closed form (fog_look.glsl), and the air of a planet by tables (march_sky.glsl).
// What is found at a distance t is seen through the veil before it: it loses what that takes, and
// the veil adds its own light, as far as the place hides what is behind it. As
//
//   L = sum_i T_i (1 - e^-dtau_i) (A(t_i) + T_veil(t_i) J_i) + T (A(D) + T_veil(D) L_behind)
//
// this is the transport equation of veil and media together, with A(t) = integral of T_veil j_veil
// up to t: by parts, the integral of T dA is T(D) A(D) less that of A dT. So no order of layers
// needs to be known, and where a medium is cut in two, nothing changes. Fog is put before air: it
// lies near the ground, where the camera is. What it leaves out: media cast no shadow on a look,
// and scatter no light to a veil.
#ifndef NEPH_MARCH_VEIL_GLSL
#define NEPH_MARCH_VEIL_GLSL

#include "march_sky.glsl"

const bool HAS_FOG_LOOK = (SHORTCUTS & 1024u) != 0u;
const bool HAS_VEIL = HAS_SKY || HAS_FOG_LOOK;

// What it adds, and what comes through.
struct Veil {
    vec3 light, through;
};

// A veil before another.
Veil veil_before(Veil near, Veil far)
{
    return Veil(near.light + near.through * far.light, near.through * far.through);
}

// Where froxels have the fog, as a medium, its look begins on the plane on which they end.
FogLook fog_behind_froxels(vec3 direction)
{
    FogLook look = frame.fog_look;
    float slope = 1.0 / max(dot(direction, frame.camera_forward), UPRIGHT);
    look.start_m = max(look.start_m, look.hand_over_m * slope);
    return look;
}

Veil fog_veil(vec3 direction, float distance_m)
{
    FogLookLight fog = fog_look_along(fog_behind_froxels(direction), direction, distance_m,
                                      to_sun());
    return Veil(fog.volume, vec3(fog.through));
}

Veil air_veil(vec3 direction, float distance_m)
{
    SkyVeil air = sky_veil(direction, distance_m);
    return Veil(frame.sun_irradiance * air.light, air.through);
}

Veil veil_to(vec3 direction, float distance_m)
{
    if (!HAS_FOG_LOOK)
        return air_veil(direction, distance_m);
    Veil fog = fog_veil(direction, distance_m);
    return HAS_SKY ? veil_before(fog, air_veil(direction, distance_m)) : fog;
}

// Radiance seen through the veil before it, of something as opaque.
vec3 behind_veil(vec3 direction, float distance_m, vec3 radiance, vec3 opacity)
{
    Veil veil = veil_to(direction, distance_m);
    return veil.through * radiance + veil.light * opacity;
}

// The fog of a look as it lies, without any control: what light loses on its way to a place.
float fog_look_sun_depth(vec3 point_m)
{
    float rise_m = point_m.y + frame.fog_look.observer_drop_m;
    return LN2 * fog_look_depth(frame.fog_look, rise_m, to_sun().y, FAR_M);
}

vec3 kept_irradiance = frame.sun_irradiance; // read once for a thread, as to_sun()

// Sunlight that comes to a place through what veils it [W/m^2].
vec3 sun_at(vec3 point_m)
{
    vec3 irradiance = kept_irradiance;
    if (HAS_SKY) {
        SkySpot spot = sky_spot(point_m);
        irradiance *= sky_sun_transmittance(spot.altitude_m, spot.sun_cosine);
    }
    if (HAS_FOG_LOOK)
        irradiance *= transmittance(fog_look_sun_depth(point_m));
    return irradiance;
}

#endif
