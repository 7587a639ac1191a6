// SPDX-License-Identifier: MIT
//
// Exponential height fog: extinction, exact optical depth, its inverse, and the part of a ray that
// is worth marching. Used by the ray marcher and the path tracer.
//
// A fog is a sum of layers with extinction(y) = extinction e^(-falloff (y - height)). Homogeneous
// fog is one layer of falloff 0. Heights are relative to the camera.
#ifndef NEPH_FOG_GLSL
#define NEPH_FOG_GLSL

#include "numbers.glsl"
#include "stretch.glsl"

struct FogLayer {
    float extinction_per_m; //  0, at the reference height
    float falloff_per_m;    // = 0
    float height_m;         // the reference height
    float exponent_max;     // upper bound of the exponent: 1e20 per metre is opaque within any
                            // step, and times FAR_M it is still a float32
};

float fog_extinction_per_m(FogLayer layer, float y_m)
{
    float exponent = -layer.falloff_per_m * (y_m - layer.height_m);
    return layer.extinction_per_m * exp(clamp(exponent, EXPONENT_MIN, layer.exponent_max));
}

// Exact optical depth from height y over a length L (<= FAR_M) along a direction with the vertical
// component k_y. With falloff b and extinction a the integral is
//
//   tau = a e^(-b y) (1 - e^(-b k_y L)) / (b k_y)
//
// This form cancels for level rays and is 0 * inf for a camera high above the fog. The code
// integrates from the denser end of the ray instead: the exponential there is the largest one that
// occurs, and the remaining factor is L phi(|b k_y| L) with phi(x) = (1 - e^-x) / x in (0, 1].
float fog_optical_depth(FogLayer layer, float y_m, float k_y, float length_m)
{
    float rate_per_m = layer.falloff_per_m * k_y; //  0: the fog gets thinner along the ray
    float dense_y_m = rate_per_m >= 0.0 ? y_m : y_m + k_y * length_m;
    float decay = abs(rate_per_m) * length_m;
    return fog_extinction_per_m(layer, dense_y_m) * (length_m * phi(decay));
}

// Ends of the useful part of a ray, between which the march steps are placed: the part starts where
// the optical depth reaches THIN, and ends where less than THIN is left, or behind OPAQUE, where
// e^-16 = 1.1e-7 of the light is transmitted.
const float THIN = 1e-7;
const float OPAQUE = 16.0;

// Optical depth that counts as opaque. A lighting model with a weaker attenuation raises it.
float opaque_depth = OPAQUE;

// Approximate distance (to 3 %; it only places the ends of a march) within which a ray meets the
// optical depth `optical_depth` of the layer; FAR_M when it never does:
//
//   L = -ln(1 - z) / r,    r = falloff k_y,    z = r optical_depth / extinction(y)
//
// Computed in logarithms, because the extinction may be as small as e^-10000.
float fog_distance_to(FogLayer layer, float y_m, float k_y, float optical_depth)
{
    float rate_per_m = layer.falloff_per_m * k_y;
    float log_extinction =
        log(layer.extinction_per_m) - layer.falloff_per_m * (y_m - layer.height_m);
    float log_straight = log(optical_depth) - log_extinction; // as if the fog were homogeneous
    float log_z = log(max(abs(rate_per_m), 1e-30)) + log_straight;
    if (log_z < -3.0)
        return exp(clamp(log_straight, EXPONENT_MIN, log(FAR_M)));
    if (rate_per_m > 0.0)
        return log_z < 0.0 ? -log(1.0 - exp(log_z)) / rate_per_m : FAR_M;
    float log_1_plus_z = log_z < 20.0 ? log(1.0 + exp(log_z)) : log_z;
    return min(log_1_plus_z / abs(rate_per_m), FAR_M);
}

// Distance at which a ray that leaves the fog upwards has only the optical depth `thin` before it
// (<= 0: less already at its start); FAR_M for other rays.
float fog_distance_to_thin_end(FogLayer layer, float y_m, float k_y, float thin)
{
    float rate_per_m = layer.falloff_per_m * k_y;
    if (rate_per_m <= 1e-30)
        return FAR_M;
    float log_extinction =
        log(layer.extinction_per_m) - layer.falloff_per_m * (y_m - layer.height_m);
    return min((log_extinction - log(rate_per_m) - log(thin)) / rate_per_m, FAR_M);
}

// Exact free path: the distance within which a ray from height y meets the optical depth
// `optical_depth` of a layer; FAR_M when it never does. Same formula as fog_distance_to(),
// evaluated in logarithms only where the extinction underflows float32.
float fog_free_path(FogLayer layer, float y_m, float k_y, float optical_depth)
{
    float rate_per_m = layer.falloff_per_m * k_y;
    float exponent = -layer.falloff_per_m * (y_m - layer.height_m);
    if (exponent < -60.0) {
        if (rate_per_m >= 0.0)
            return FAR_M;
        float log_z = log(-rate_per_m) + log(optical_depth / layer.extinction_per_m) - exponent;
        float length_m = log_z > 15.0 ? log_z : log(1.0 + exp(max(log_z, EXPONENT_MIN)));
        return min(length_m / -rate_per_m, FAR_M);
    }
    float straight_m = optical_depth / fog_extinction_per_m(layer, y_m);
    float z = rate_per_m * straight_m;
    if (z >= 1.0)
        return FAR_M;
    return abs(z) < 1e-6 ? min(straight_m, FAR_M)
                         : min(-log_1_plus(-z) / rate_per_m, FAR_M);
}

// --- along a ray --------------------------------------------------------------------------------

float fog_layer_optical_depth(FogLayer layer, vec3 origin_m, vec3 direction, float t0_m, float t1_m)
{
    return fog_optical_depth(layer, origin_m.y + t0_m * direction.y, direction.y, t1_m - t0_m);
}

// Ray parameter at which the ray has met an optical depth since t0.
float fog_layer_free_path_m(FogLayer layer, vec3 origin_m, vec3 direction, float t0_m,
                            float optical_depth)
{
    return t0_m + fog_free_path(layer, origin_m.y + t0_m * direction.y, direction.y, optical_depth);
}

// Extends `hull` by the useful part of the ray in this layer: more than THIN of optical depth is
// left, and less than `opaque_depth` has been met. THIN is tested in the channel with the largest
// extinction, opacity in the smallest positive one. A channel without extinction does not extend
// the part, but sees the background, so `opaque_m` is only set when all channels have extinction.
void fog_layer_include(FogLayer layer, vec3 color, vec3 origin_m, vec3 direction, Stretch inside,
                       inout Stretch hull, inout float opaque_m)
{
    float most = max(color.r, max(color.g, color.b));
    float y_m = origin_m.y + inside.t0_m * direction.y;
    float start_m = inside.t0_m;
    if (layer.falloff_per_m * direction.y < 0.0)
        start_m += fog_distance_to(layer, y_m, direction.y, THIN / most);
    float thin_m = fog_distance_to_thin_end(layer, y_m, direction.y, THIN / most);
    float dark_m = inside.t0_m + fog_distance_to(layer, y_m, direction.y,
                                                 opaque_depth / least_positive(color));
    // A fog that ends before it is opaque hides nothing.
    if (dark_m < inside.t1_m && all(greaterThan(color, vec3(0.0))))
        opaque_m = min(opaque_m, dark_m);
    include(hull, start_m, min(min(inside.t1_m, inside.t0_m + thin_m), dark_m));
}

#endif
