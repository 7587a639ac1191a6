// SPDX-License-Identifier: MIT
//
// The veil: light and attenuation between the camera and the marched media by things that are not
// marched. These are a height fog in closed form (the game-engine model of fog_look.glsl) and the
// air of a planet from tables (march_sky.glsl).
//
// A step at the distance t is seen through the veil in front of it. The veil attenuates the step's
// light, and adds its own light in proportion to the opacity of the step, which hides the veil
// behind:
//
//   L = sum_i T_i (1 - e^-dtau_i) (A(t_i) + T_veil(t_i) J_i) + T (A(D) + T_veil(D) L_behind)
//
// with A(t) the integral of T_veil j_veil up to t. Integration by parts shows that this is the
// transport equation of veil and media together: the integral of T dA equals T(D) A(D) minus the
// integral of A dT. So media and veil need no sorting, and splitting a medium changes nothing.
//
// Fog is placed in front of the air, because it is near the ground, where the camera is. Two
// effects are neglected: media cast no shadow on a closed-form fog, and scatter no light into a
// veil.
#ifndef NEPH_MARCH_VEIL_GLSL
#define NEPH_MARCH_VEIL_GLSL

#include "march_sky.glsl"

const bool HAS_FOG_LOOK = (SHORTCUTS & 1024u) != 0u;
const bool HAS_VEIL = HAS_SKY || HAS_FOG_LOOK;

// Added radiance, and transmittance.
struct Veil {
    vec3 light, through;
};

// Composition of two veils.
Veil compose_veils(Veil near, Veil far)
{
    return Veil(near.light + near.through * far.light, near.through * far.through);
}

// Where froxels have the near fog as a medium, the closed form starts on the plane at which the
// froxels end.
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
    return HAS_SKY ? compose_veils(fog, air_veil(direction, distance_m)) : fog;
}

// Radiance of something with the given opacity, seen through the veil.
vec3 behind_veil(vec3 direction, float distance_m, vec3 radiance, vec3 opacity)
{
    Veil veil = veil_to(direction, distance_m);
    return veil.through * radiance + veil.light * opacity;
}

// Optical depth from a point to the sun of the closed-form fog, without its artistic controls.
float fog_look_sun_depth(vec3 point_m)
{
    float rise_m = point_m.y + frame.fog_look.observer_drop_m;
    return LN2 * fog_look_depth(frame.fog_look, rise_m, to_sun().y, FAR_M);
}

vec3 kept_irradiance = frame.sun_irradiance; // read once per thread, as in to_sun()

// Sunlight at a point after attenuation by air and closed-form fog [W/m^2].
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
