// SPDX-License-Identifier: MIT
//
// The height fog of Unreal Engine and of Filament in closed form. truth/fog_look.h has the formulas
// and sources; this is their float32 version, used by fog_look.comp and by the ray marcher
// (march_veil.glsl).
//
// Both models are one function in base 2: Filament's natural exponent is Unreal's times ln 2. Two
// differences remain: the exponent below which a series replaces the closed form, and the point
// from which the start distance counts.
//
// The engines' own code produces NaN or infinity for some inputs. Each guard against that is a
// named constant.
#ifndef NEPH_FOG_LOOK_GLSL
#define NEPH_FOG_LOOK_GLSL

#include "numbers.glsl"

// enum neph_fog_model
const uint FOG_UNREAL = 0;
const uint FOG_FILAMENT = 1;

const float LN2 = 0.693147180559945;

// Lower bound of the exponents in Unreal's code.
const float UNREAL_EXPONENT_MIN = -127.0;

// |F| up to which the mean is computed from its series, in base 2.
const float UNREAL_LEVEL = 0.01;
const float FILAMENT_LEVEL = 0.00125 / LN2;

// Upper bound of the log2 density. 2^70 per metre is opaque within any step of a float32, and times
// FAR_M it is still a float32. The engines' bound 2^127 d is infinite for d >= 2, and infinity
// times a length of 0 is NaN.
const float LOG_DENSITY_MAX = 70.0;

// Lower bound of a direction's horizontal component. Rays below it count as vertical; 2 FAR_M over
// it is still a float32.
const float UPRIGHT = 1e-20;

// exp2() is 0 below this on all devices.
const float LOG_DENSITY_MIN = -126.0;

// A layer. Its extinction at the observer's height, over (ln 2)^2, is mantissa 2^log_density [1/m].
// Splitting off a whole power of 2 costs no digits.
struct FogLookLayer {
    float mantissa; // 1/2..1
    float log_density; // a whole number
    float falloff_per_m; // base 2
    float exponent; // falloff * (observer's height - layer's height): any sign and size
};

struct FogLook {
    FogLookLayer layers[NEPH_GPU_LAYERS_MAX];
    vec3 inscattering; // radiance of the sky that the fog scatters [W m^-2 sr^-1]
    float max_opacity;
    vec3 directional; // [W m^-2 sr^-1]; 0 without a sun
    float directional_exponent;
    float directional_start_m;
    float start_m; // start of the fog, for any reason
    float end_m; // end of the fog, in horizontal distance; FAR_M or more: none
    float cutoff_m; // no fog on surfaces beyond; FAR_M or more: none
    float observer_drop_m; // = 0: height of the camera above the observer
    float hand_over_m; // eye depth up to which froxels have the fog (march_veil.glsl); 0: none
    uint layer_count;
    uint model;
};

struct FogLookLight {
    float through; // transmittance
    vec3 volume; // added radiance [W m^-2 sr^-1]
};

// The mean of 2^-(F t) over t in 0..1, F >= 0:
//
//   (1 - 2^-F) / (F ln 2) = phi(F ln 2)
//
// or its series for small F, as the engines have it: 1 - F ln 2 / 2 (Unreal), 1 (Filament).
float mean_of_decay(float exponent, uint model)
{
    if (exponent > (model == FOG_UNREAL ? UNREAL_LEVEL : FILAMENT_LEVEL))
        return phi(LN2 * exponent);
    return model == FOG_UNREAL ? 1.0 - 0.5 * LN2 * exponent : 1.0;
}

// Optical depth of a layer in base 2. Where the density grows along the ray, the integral starts
// from the far end, so that the exponential is the largest one that occurs. The series is taken at
// the near end, as in the engines.
float fog_look_layer_depth(FogLookLayer layer, float rise_m, float k_y, float length_m, uint model)
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

// Optical depth in base 2 of a ray that starts `rise_m` above the observer.
float fog_look_depth(FogLook look, float rise_m, float k_y, float length_m)
{
    float depth = 0.0;
    for (uint l = 0; l < look.layer_count; l++)
        depth += fog_look_layer_depth(look.layers[l], rise_m, k_y, length_m, look.model);
    return depth;
}

// The directional lobe: cos^exponent towards the light, else 0. GLSL leaves pow(0, 0) undefined.
// pow() of a number near 1 has the error of its logarithm, up to 2^-21; log_1_plus() is exact
// there.
float fog_lobe(float cosine, float exponent)
{
    if (cosine <= 0.0)
        return 0.0;
    return exp(max(exponent * log_1_plus(min(cosine, 1.0) - 1.0), EXPONENT_MIN));
}

// Radiance and transmittance of an optical depth in base 2. `begun` is the fraction of the depth
// that the directional light applies to.
FogLookLight fog_look_light(FogLook look, float cosine, float depth, float begun)
{
    float opacity = min(absorbed_fraction(LN2 * depth), look.max_opacity);
    float glow = fog_lobe(cosine, look.directional_exponent) *
                 absorbed_fraction(LN2 * (depth * begun));
    return FogLookLight(max(transmittance(LN2 * depth), 1.0 - look.max_opacity),
                        look.inscattering * opacity + look.directional * glow);
}

// The fog between the camera and a surface at a distance. A surface at distance 0 gets no fog; the
// engines compute rsqrt(0) there.
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
