// SPDX-License-Identifier: MIT
//
// Fog: layers of extinction(y) = extinction e^(-falloff (y - height)), which add. Homogeneous fog
// is one layer of falloff 0. Heights are relative to the camera.
#ifndef NEPH_FOG_GLSL
#define NEPH_FOG_GLSL

#include "numbers.glsl"
#include "stretch.glsl"

struct FogLayer {
    float extinction_per_m; // > 0, at the reference height
    float falloff_per_m;    // >= 0
    float height_m;         // the reference height
    float exponent_max;     // where extinction would pass 1e20 per metre: opaque within any step,
                            // and times FAR_M still a float32
};

float fog_extinction_per_m(FogLayer layer, float y_m)
{
    float exponent = -layer.falloff_per_m * (y_m - layer.height_m);
    return layer.extinction_per_m * exp(clamp(exponent, EXPONENT_MIN, layer.exponent_max));
}

// Exact optical depth from height y over a length (<= FAR_M) along a direction with vertical
// component k_y. The textbook a e^(-b y) (1 - e^(-b k L)) / (b k) cancels for level rays and is
// 0 * inf for a camera high above the fog. Taken from the *denser* end, the exponential is the
// largest one that occurs and phi, in (0, 1], does the rest.
float fog_optical_depth(FogLayer layer, float y_m, float k_y, float length_m)
{
    float rate_per_m = layer.falloff_per_m * k_y; // > 0: thins out along the ray
    float dense_y_m = rate_per_m >= 0.0 ? y_m : y_m + k_y * length_m;
    float decay = abs(rate_per_m) * length_m;
    return fog_extinction_per_m(layer, dense_y_m) * (length_m * phi(decay));
}

// The parts of a ray that a fixed number of steps would be wasted on: before the first THIN of
// optical depth has been met, after all but THIN has been, and behind OPAQUE of it, where
// e^-16 = 1.1e-7 of the light comes through.
const float THIN = 1e-7;
const float OPAQUE = 16.0;

// As much, unless some light comes through better than its optical depth tells.
float opaque_depth = OPAQUE;

// Roughly (3 %, it only places the ends of a march) the distance within which a ray meets
// `optical_depth` of the layer, FAR_M when it never does: -ln(1 - z) / rate with
// z = rate optical_depth / extinction. In logarithms, because extinction may be e^-10000 here.
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

// Where the optical depth still to come falls to `thin` on a ray that leaves the fog upwards
// (<= 0: it is less already); FAR_M on other rays.
float fog_distance_to_thin_end(FogLayer layer, float y_m, float k_y, float thin)
{
    float rate_per_m = layer.falloff_per_m * k_y;
    if (rate_per_m <= 1e-30)
        return FAR_M;
    float log_extinction =
        log(layer.extinction_per_m) - layer.falloff_per_m * (y_m - layer.height_m);
    return min((log_extinction - log(rate_per_m) - log(thin)) / rate_per_m, FAR_M);
}

// The distance within which a ray from height y meets exactly `optical_depth` of a layer; FAR_M
// when it never does: -ln(1 - z) / r, with r = falloff k_y and z = r optical_depth / extinction.
// In logarithms where extinction leaves float32.
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

// Where a ray has met an optical depth since t0.
float fog_layer_free_path_m(FogLayer layer, vec3 origin_m, vec3 direction, float t0_m,
                            float optical_depth)
{
    return t0_m + fog_free_path(layer, origin_m.y + t0_m * direction.y, direction.y, optical_depth);
}

// Add to the hull where a layer has more than THIN optical depth left and is not OPAQUE. What is
// thin must be so in the strongest channel, what is opaque in the weakest; a channel that does not
// see the fog at all does not make it longer, but sees what is behind.
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
    if (dark_m < inside.t1_m && all(greaterThan(color, vec3(0.0)))) // a fog that ends hides nothing
        opaque_m = min(opaque_m, dark_m);
    include(hull, start_m, min(min(inside.t1_m, inside.t0_m + thin_m), dark_m));
}

#endif
