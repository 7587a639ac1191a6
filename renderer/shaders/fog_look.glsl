// SPDX-License-Identifier: MIT
//
// The fog of game engines in closed form: truth/fog_look.h in float32, which has the formulas. Both
// models are one function here, in base 2: Filament's natural exponent is Unreal's times ln 2, and
// what is left between them is where the series begins, and from where a start counts.
//
// Guards, by name: what the engines' own code meets here is no number or infinite.
#ifndef NEPH_FOG_LOOK_GLSL
#define NEPH_FOG_LOOK_GLSL

#include "numbers.glsl"

// enum neph_fog_model
const uint FOG_UNREAL = 0;
const uint FOG_FILAMENT = 1;

const float LN2 = 0.693147180559945;

// Unreal's: an exponent below it is taken to be that.
const float UNREAL_EXPONENT_MIN = -127.0;

// |F| up to which a mean is a series, in base 2.
const float UNREAL_LEVEL = 0.01;
const float FILAMENT_LEVEL = 0.00125 / LN2;

// 2^70 per metre is opaque within any step of a float32, and times FAR_M still one: 2^127 d of the
// engines is infinite from d = 2 on, and infinity times a length of 0 no number.
const float LOG_DENSITY_MAX = 70.0;

// A ray goes over no ground that is as upright: twice FAR_M over it is still a float32.
const float UPRIGHT = 1e-20;

// Where exp2 of a float32 is 0 on all devices.
const float LOG_DENSITY_MIN = -126.0;

// The extinction at the observer's height over (ln 2)^2 is mantissa 2^log_density [1/m]: a whole
// power of 2 costs no digits.
struct FogLookLayer {
    float mantissa; // 1/2..1
    float log_density; // whole
    float falloff_per_m; // base 2
    float exponent; // falloff * (the observer's height - the layer's), of whatever sign and size
};

struct FogLook {
    FogLookLayer layers[NEPH_GPU_LAYERS_MAX];
    vec3 inscattering; // the sky's light in it [W m^-2 sr^-1]
    float max_opacity;
    vec3 directional; // [W m^-2 sr^-1]; 0 without a sun
    float directional_exponent;
    float directional_start_m;
    float start_m; // where fog begins, for whatever reason
    float end_m; // where it ends, over ground; FAR_M and more: nowhere
    float cutoff_m; // FAR_M and more: nowhere
    float observer_drop_m; // >= 0: so far below the camera
    float hand_over_m; // nearer by depth froxels have it (march_veil.glsl); 0: nowhere
    uint layer_count;
    uint model;
};

struct FogLookLight {
    float through; // transmittance
    vec3 volume; // added [W m^-2 sr^-1]
};

// The mean of 2^-(F t) over t in 0..1, F >= 0.
float mean_of_decay(float exponent, uint model)
{
    if (exponent > (model == FOG_UNREAL ? UNREAL_LEVEL : FILAMENT_LEVEL))
        return phi(LN2 * exponent);
    return model == FOG_UNREAL ? 1.0 - 0.5 * LN2 * exponent : 1.0;
}

// Where the density grows along the way it is taken at its other end, and the mean from there: the
// exponential is the largest that occurs. But the series is of the near end, as the engines have
// it.
float fog_look_depth_of(FogLookLayer layer, float rise_m, float k_y, float length_m, uint model)
{
    float before = layer.falloff_per_m * rise_m;
    float along = layer.falloff_per_m * (length_m * k_y);
    float log_density = layer.log_density - before;
    if (model == FOG_UNREAL) {
        log_density -= max(0.0, UNREAL_EXPONENT_MIN - (layer.exponent + before));
        along = max(along, UNREAL_EXPONENT_MIN);
    }
    float level = model == FOG_UNREAL ? UNREAL_LEVEL : FILAMENT_LEVEL;
    float mean = mean_of_decay(along, model);
    if (along < -level) {
        log_density -= along;
        mean = phi(-LN2 * along);
    }
    if (log_density < LOG_DENSITY_MIN)
        return 0.0;
    return layer.mantissa * exp2(min(log_density, LOG_DENSITY_MAX)) * (LN2 * mean * length_m);
}

// From a place so far above the observer.
float fog_look_depth(FogLook look, float rise_m, float k_y, float length_m)
{
    float depth = 0.0;
    for (uint l = 0; l < look.layer_count; l++)
        depth += fog_look_depth_of(look.layers[l], rise_m, k_y, length_m, look.model);
    return depth;
}

// cos^exponent towards the light, else 0: pow(0, 0) may be anything. And pow near 1 is as blunt as
// its logarithm, which may be off by 2^-21 there.
float fog_lobe(float cosine, float exponent)
{
    if (cosine <= 0.0)
        return 0.0;
    return exp(max(exponent * log_1_plus(min(cosine, 1.0) - 1.0), EXPONENT_MIN));
}

// Depth in base 2; `begun` is the part of it that glows.
FogLookLight fog_look_light(FogLook look, float cosine, float depth, float begun)
{
    float opacity = min(absorbed_fraction(LN2 * depth), look.max_opacity);
    float glow = fog_lobe(cosine, look.directional_exponent) *
                 absorbed_fraction(LN2 * (depth * begun));
    return FogLookLight(max(transmittance(LN2 * depth), 1.0 - look.max_opacity),
                        look.inscattering * opacity + look.directional * glow);
}

// The fog between the camera and something at a distance; there is none before what is at the
// camera, where the engines' rsqrt(0) is infinite.
FogLookLight fog_look_along(FogLook look, vec3 direction, float length_m, vec3 light_direction)
{
    if (look.observer_drop_m > 0.0 && length_m < FAR_M) {
        vec3 seen_m = direction * length_m + vec3(0.0, look.observer_drop_m, 0.0);
        length_m = length(seen_m);
        direction = length_m > 0.0 ? seen_m / length_m : direction;
    }
    float end_m = look.end_m / max(length(direction.xz), UPRIGHT);
    float seen_m = min(length_m, end_m) - look.start_m;
    if (length_m <= 0.0 || length_m > look.cutoff_m || seen_m <= 0.0)
        return FogLookLight(1.0, vec3(0.0));
    float cosine = dot(direction, light_direction);
    if (look.model == FOG_UNREAL) {
        float depth = fog_look_depth(look, look.start_m * direction.y, direction.y, seen_m);
        return fog_look_light(look, cosine, depth,
                              max(0.0, 1.0 - look.directional_start_m / seen_m));
    }
    float depth = fog_look_depth(look, 0.0, direction.y, length_m) * (seen_m / length_m);
    return fog_look_light(look, cosine, depth,
                          max(0.0, length_m - look.directional_start_m) / seen_m);
}

#endif
