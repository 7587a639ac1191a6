// SPDX-License-Identifier: MIT
//
// The atmosphere of a planet on the device: data, the lookup of its tables, and the march of a ray
// through the air. renderer/sky/ is the CPU reference, renderer/sky/tables.h the C side.
//
// The tables are stored in one buffer, in this order:
//
//   sun       transmittance to the sun, by altitude and sun angle (sky_sun.comp)
//   field     scattered light: moments of its distribution over directions, by altitude and sun
//             angle; and the irradiance of the ground (sky_gather.comp, sky_sum.comp)
//   views     everything visible from a place, by direction (sky_view.comp)
//   aerial    the air in front of the camera, by froxel (sky_aerial.comp)
//
// The tables follow E. Bruneton and F. Neyret, "Precomputed Atmospheric Scattering", EGSR 2008, and
// S. Hillaire, "A scalable and production ready sky and atmosphere rendering technique", EGSR 2020.
// renderer/sky/field.h says how the field differs from both.
#ifndef NEPH_SKY_GLSL
#define NEPH_SKY_GLSL

#include "phase.glsl"

struct SkyLayer {
    vec3 extinction_per_m; // at density 1
    uint is_tent;          // 0: exponential; 1: tent
    vec3 scattering_per_m;
    float middle_m; // tent: altitude of the peak
    float scale_m;  // scale height; tent: half its width
    uint phase_kind;
    float g;
    // Per degree: the fraction of a moment that one scattering keeps.
    float legendre[NEPH_GPU_SKY_DEGREE_MAX + 1];
};

struct SkyAir {
    vec3 ground_albedo;
    float radius_m; // of the ground
    float top_m;    // altitude of the upper end of the air
    uint layer_count;
    uint degree;               // highest degree of the field's moments
    uint altitudes, suns;      // nodes of the field
    uint sun_altitudes, sun_cosines; // nodes of the transmittance to the sun
    float deepest_root;        // lower end of the field's axis of sun angles: sky_among_suns()
    uint field_first;          // index of the field's first node
    SkyLayer layers[NEPH_GPU_MEDIA_MAX];
    float norms[NEPH_GPU_SKY_MOMENTS_MAX]; // of the spherical harmonics
};

// A place with a table of views (sky_view.glsl).
struct SkyPlace {
    vec3 vertical;
    float altitude_m;
    uint first; // index of the table's first node
};

struct SkyEye {
    vec3 right;
    float half_width; // of the image plane at distance 1
    vec3 up;
    float half_height;
    vec3 forward;
    uint width_px;
    vec3 sun_direction;
    uint height_px;
    vec3 sun_irradiance;
    uint steps;
    uint scatters, has_field;
    uint elevations, azimuths; // nodes of a table of views, per half; 0: none
    uint aerial_columns, aerial_rows, aerial_slices; // nodes of the aerial table; 0: none
    float aerial_far_m;
    uint aerial_first;
    uint is_shaded; // 0 or 1: something shadows the air
    uint place_count;
    // The camera, and the point at which media are lit by the sky.
    SkyPlace places[NEPH_GPU_SKY_PLACES];
};

#ifndef SKY_BINDING
#define SKY_BINDING 0
#endif

layout(std430, binding = SKY_BINDING) readonly buffer Sky {
    SkyAir air;
    SkyEye eye;
};

#ifdef SKY_IS_FILLED
layout(std430, binding = SKY_BINDING + 1) buffer SkyNodes {
#else
layout(std430, binding = SKY_BINDING + 1) readonly buffer SkyNodes {
#endif
    vec4 sky_nodes[];
};

// Kernels that fill tables are specialized for the number of layers and moments: their loops
// unroll, and their arrays are in registers. Other kernels read both numbers.
#ifdef SKY_IS_KNOWN
#define SKY_UNROLL [[unroll]]
layout(constant_id = 0) const uint SKY_LAYERS = 1u;
layout(constant_id = 1) const uint SKY_DEGREE = 0u;
uint sky_layers() { return SKY_LAYERS; }
uint sky_degree() { return SKY_DEGREE; }
#else
#define SKY_UNROLL
uint sky_layers() { return air.layer_count; }
uint sky_degree() { return air.degree; }
#endif

vec3 sky_sun_node(uint index) { return sky_nodes[index].rgb; }
vec3 sky_field_node(uint index) { return sky_nodes[air.field_first + index].rgb; }

// Arc functions with an error of 2e-7; drivers may be off by 1e-4. For small x the series of asin;
// else asin x = pi / 2 - 2 asin(sqrt((1 - x) / 2)).
float sky_short_asin(float x)
{
    float s = x * x;
    return x * (1.0 + s * (1.0 / 6.0 + s * (3.0 / 40.0 + s * (15.0 / 336.0 + s * (105.0 / 3456.0 +
           s * (945.0 / 42240.0 + s * (10395.0 / 599040.0 + s * (135135.0 / 9676800.0))))))));
}

float sky_acos(float x)
{
    float a = min(abs(x), 1.0);
    float angle = a > 0.5 ? 2.0 * sky_short_asin(sqrt(0.5 * (1.0 - a)))
                          : 0.5 * PI - sky_short_asin(a);
    return x < 0.0 ? PI - angle : angle;
}

float sky_asin(float x)
{
    return abs(x) > 0.5 ? 0.5 * PI - sky_acos(x) : sky_short_asin(x);
}

// --- coordinates of tables ----------------------------------------------------------------------

// r^2 - radius^2, without cancellation.
float sky_growth_m2(float altitude_m) { return altitude_m * (2.0 * air.radius_m + altitude_m); }

// The node below a coordinate 0..1 of an axis; returns the fraction to the next node.
float sky_among(float part, uint nodes, out uint low)
{
    float place = clamp(part, 0.0, 1.0) * float(nodes - 1u);
    low = min(uint(place), nodes - 2u);
    return place - float(low);
}

// Length of a ray to the upper end of the air; the ray misses the ground.
float sky_length_to_top_m(float altitude_m, float cosine)
{
    float rise_m = (air.radius_m + altitude_m) * cosine;
    float left_m2 = max(sky_growth_m2(air.top_m) - sky_growth_m2(altitude_m), 0.0);
    float root_m = sqrt(rise_m * rise_m + left_m2);
    return rise_m > 0.0 ? left_m2 / (rise_m + root_m) : root_m - rise_m;
}

// Transmittance to the sun; 0 where the ground hides the sun. The axes are lengths (Bruneton and
// Neyret 2008, section 4), so that nodes are dense at the horizon:
//
//   y = distance to the horizon / its maximum
//   x = (length to the top - shortest) / (longest - shortest)      for this altitude
vec3 sky_sun_transmittance(float altitude_m, float sun_cosine)
{
    float horizon_m = sqrt(sky_growth_m2(altitude_m)), most_m = sqrt(sky_growth_m2(air.top_m));
    if (sun_cosine * (air.radius_m + altitude_m) < -horizon_m)
        return vec3(0.0);
    float shortest_m = air.top_m - altitude_m;
    float spread_m = max(horizon_m + most_m - shortest_m, 1e-9);
    uint i, j;
    float x = sky_among((sky_length_to_top_m(altitude_m, sun_cosine) - shortest_m) / spread_m,
                        air.sun_cosines, i);
    float y = sky_among(horizon_m / most_m, air.sun_altitudes, j);
    uint low = j * air.sun_cosines + i, high = low + air.sun_cosines;
    return mix(mix(sky_sun_node(low), sky_sun_node(low + 1u), x),
               mix(sky_sun_node(high), sky_sun_node(high + 1u), x), y);
}

uint sky_moments() { return (sky_degree() + 1u) * (sky_degree() + 2u) / 2u; }

// Coordinate of the sun's elevation. Its square root, with sign, makes nodes dense at the horizon.
float sky_among_suns(float sun_cosine, out uint low)
{
    float part = sky_asin(sun_cosine) * (2.0 / PI);
    float root = sqrt(abs(part)) * (part < 0.0 ? -1.0 : 1.0);
    return sky_among((root - air.deepest_root) / (1.0 - air.deepest_root), air.suns, low);
}

// Irradiance of the ground by scattered light only; stored behind the moments.
vec3 sky_field_ground(float sun_cosine)
{
    uint i;
    float x = sky_among_suns(sun_cosine, i);
    uint first = air.altitudes * air.suns * sky_moments();
    return mix(sky_field_node(first + i), sky_field_node(first + i + 1u), x);
}

// --- geometry of a ray --------------------------------------------------------------------------

struct SkyRay {
    float altitude_m, cosine; // at its start
    float sun_cosine;         // cosine of the sun to the vertical at the start
    float toward_sun;         // cosine between ray and sun
    float phases[NEPH_GPU_MEDIA_MAX]; // phase functions of the layers at that angle
};

// The part of a ray in the air, as two legs from its lowest point (or the ground):
//
//    start o                    o upper end
//           \  fall_m  climb_m /
//            \                /
//             '------o------'      lowest point: low_m, low_t_m
//      ___________________________ ground
//
// Steps are at equal distances of the square root of the climb, so they are dense at the lowest
// point.
struct SkyPath {
    float low_m, low_t_m;  // altitude of the lowest point, and its ray parameter
    float rise_m;          // radius times |cosine| there
    float fall_m, climb_m; // descent from the start to there, and climb from there
    uint falls, climbs;    // steps of the two legs
    float length_m;        // to the ground; FAR_M: misses the ground
};

// Distance from the lowest point at which the path has climbed.
float sky_distance_m(SkyPath path, float climb_m)
{
    float growth_m2 = climb_m * (2.0 * (air.radius_m + path.low_m) + climb_m);
    return growth_m2 > 0.0
               ? growth_m2 / (path.rise_m + sqrt(path.rise_m * path.rise_m + growth_m2))
               : 0.0;
}

// Distance to the ground; FAR_M: the ray misses it.
float sky_length_m(SkyRay ray)
{
    float rise_m = (air.radius_m + ray.altitude_m) * ray.cosine;
    float above_m2 = sky_growth_m2(ray.altitude_m), slant_m2 = rise_m * rise_m - above_m2;
    return rise_m < 0.0 && slant_m2 >= 0.0 ? above_m2 / (sqrt(slant_m2) - rise_m) : FAR_M;
}

SkyPath sky_path(SkyRay ray, uint steps)
{
    float r_m = air.radius_m + ray.altitude_m, rise_m = r_m * ray.cosine;
    float slant_m2 = rise_m * rise_m - sky_growth_m2(ray.altitude_m);
    float high_m = min(ray.altitude_m, air.top_m), length_m = sky_length_m(ray);
    if (length_m < FAR_M)
        return SkyPath(0.0, length_m, sqrt(slant_m2), high_m, 0.0, steps, 0u, length_m);
    bool turns = rise_m < 0.0;
    float low_m = ray.altitude_m;
    if (turns)
        low_m -= rise_m * rise_m / (r_m + sqrt((r_m - rise_m) * (r_m + rise_m)));
    uint of_leg = low_m >= air.top_m ? 0u : turns ? (steps + 1u) / 2u : steps;
    return SkyPath(low_m, turns ? -rise_m : 0.0, turns ? 0.0 : rise_m, high_m - low_m,
                   air.top_m - low_m, turns ? of_leg : 0u, of_leg, FAR_M);
}

// --- scattered light ----------------------------------------------------------------------------

float sky_density(SkyLayer layer, float altitude_m)
{
    return layer.is_tent != 0u
               ? max(0.0, 1.0 - abs(altitude_m - layer.middle_m) / layer.scale_m)
               : transmittance(max(0.0, altitude_m) / layer.scale_m);
}

// Light of the field that is scattered once more, into the unit vector with the components x
// (horizontally towards the sun) and z (up): the sum over spherical harmonics of the moment times
// the scattering of its degree. The Legendre and azimuth factors are computed by recurrence.
vec3 sky_scatter_field(float altitude_m, float sun_cosine, float x, float z,
                       vec3 scattering_per_m[NEPH_GPU_SKY_DEGREE_MAX + 1])
{
    uint i, j, count = sky_moments();
    float along = sky_among_suns(sun_cosine, i);
    float up = sky_among(sqrt(max(0.0, altitude_m) / air.top_m), air.altitudes, j);
    uint low = (j * air.suns + i) * count, high = low + air.suns * count;
    float across2 = max(0.0, 1.0 - z * z), wave = 1.0, before = 0.0, start = 1.0;
    vec3 source = vec3(0.0);
    SKY_UNROLL for (uint m = 0u; m <= sky_degree(); m++) {
        float legendre = start, lower = 0.0;
        SKY_UNROLL for (uint l = m; l <= sky_degree(); l++) {
            uint k = l * (l + 1u) / 2u + m;
            vec3 moment = mix(mix(sky_field_node(low + k), sky_field_node(low + count + k), along),
                              mix(sky_field_node(high + k), sky_field_node(high + count + k),
                                  along), up);
            source += air.norms[k] * legendre * wave * scattering_per_m[l] * moment;
            float next = (float(2u * l + 1u) * z * legendre - float(l + m) * lower) /
                         float(l + 1u - m);
            lower = legendre;
            legendre = next;
        }
        float next = m == 0u ? x : 2.0 * x * wave - across2 * before;
        before = wave;
        wave = next;
        start *= float(2u * m + 1u);
    }
    return source;
}

// --- along a ray --------------------------------------------------------------------------------

struct SkyLight {
    vec3 radiance; // of the media only; sky_walk() adds the ground's
    vec3 volume;
    vec3 transmittance;
    float length_m; // to the ground; FAR_M: misses the ground
};

// Adds the light of one step, with source and extinction constant along it.
void sky_step(SkyRay ray, float altitude_m, float cosine, float sun_cosine, float length_m,
              bool scatters, bool has_field, inout SkyLight light)
{
    vec3 extinction_per_m = vec3(0.0), source = vec3(0.0);
    vec3 by_degree[NEPH_GPU_SKY_DEGREE_MAX + 1];
    for (uint l = 0u; l <= NEPH_GPU_SKY_DEGREE_MAX; l++)
        by_degree[l] = vec3(0.0);
    SKY_UNROLL for (uint n = 0u; n < sky_layers(); n++) {
        float density = sky_density(air.layers[n], altitude_m);
        vec3 scattering_per_m = density * air.layers[n].scattering_per_m;
        extinction_per_m += density * air.layers[n].extinction_per_m;
        source += ray.phases[n] * scattering_per_m;
        SKY_UNROLL for (uint l = 0u; l <= sky_degree(); l++)
            by_degree[l] += air.layers[n].legendre[l] * scattering_per_m;
    }
    source *= scatters ? sky_sun_transmittance(altitude_m, sun_cosine) : vec3(0.0);
    if (has_field) {
        float sun_sine = sqrt(max(1e-12, 1.0 - sun_cosine * sun_cosine));
        float across = sqrt(max(0.0, 1.0 - cosine * cosine));
        float x = clamp((ray.toward_sun - cosine * sun_cosine) / sun_sine, -across, across);
        source += sky_scatter_field(altitude_m, sun_cosine, x, cosine, by_degree);
    }
    vec3 depth = extinction_per_m * length_m;
    vec3 reached_m = length_m * vec3(phi(depth.r), phi(depth.g), phi(depth.b));
    light.volume += light.transmittance * source * reached_m;
    light.transmittance *= transmittance(depth);
}

// Marches steps first..end-1 of a path.
void sky_walk_steps(SkyRay ray, SkyPath path, uint first, uint end, bool scatters, bool has_field,
                    inout SkyLight light)
{
    float sun_m = (air.radius_m + ray.altitude_m) * ray.sun_cosine;
    for (uint i = first; i < end; i++) {
        bool falls = i < path.falls;
        uint steps = falls ? path.falls : path.climbs;
        uint k = falls ? steps - 1u - i : i - path.falls;
        float whole_m = falls ? path.fall_m : path.climb_m;
        float x0 = float(k) / float(steps), x1 = float(k + 1u) / float(steps);
        float x = 0.5 * (x0 + x1), climb_m = whole_m * x * x;
        float length_m = sky_distance_m(path, whole_m * x1 * x1) -
                         sky_distance_m(path, whole_m * x0 * x0);
        float from_low_m = sky_distance_m(path, climb_m);
        float r_m = air.radius_m + path.low_m + climb_m;
        float t_m = path.low_t_m + (falls ? -from_low_m : from_low_m);
        float cosine = (path.rise_m + from_low_m) / r_m;
        sky_step(ray, path.low_m + climb_m, falls ? -cosine : cosine,
                 (sun_m + t_m * ray.toward_sun) / r_m, length_m, scatters, has_field, light);
    }
}

// Adds light reflected by the ground.
void sky_add_ground(SkyRay ray, bool has_field, inout SkyLight light)
{
    float sun_m = (air.radius_m + ray.altitude_m) * ray.sun_cosine;
    float sun_cosine = (sun_m + light.length_m * ray.toward_sun) / air.radius_m;
    vec3 irradiance = max(0.0, sun_cosine) * sky_sun_transmittance(0.0, sun_cosine);
    if (has_field)
        irradiance += sky_field_ground(sun_cosine);
    light.radiance += light.transmittance * air.ground_albedo / PI * irradiance;
}

// Light along a ray for a sun of irradiance 1. `scatters`: the media scatter sunlight; `has_field`:
// and light that was scattered before.
SkyLight sky_walk(SkyRay ray, uint steps, bool scatters, bool has_field)
{
    SkyPath path = sky_path(ray, steps);
    SkyLight light = SkyLight(vec3(0.0), vec3(0.0), vec3(1.0), path.length_m);
    sky_walk_steps(ray, path, 0u, path.falls + path.climbs, scatters, has_field, light);
    light.radiance = light.volume;
    if (path.length_m < FAR_M)
        sky_add_ground(ray, has_field, light);
    return light;
}

// Phase functions of all layers between two unit vectors.
void sky_find_phases(inout SkyRay ray, vec3 view, vec3 sun)
{
    SKY_UNROLL for (uint n = 0u; n < sky_layers(); n++)
        ray.phases[n] = phase_per_sr(air.layers[n].phase_kind, air.layers[n].g, view, sun);
}

#endif
