// SPDX-License-Identifier: MIT
//
// The march for a special case (SUNLIT_TEXTURE): the only medium is a grey grid in a texture, and
// the only light is the sun. Quantities that are constant along a ray are applied at its end, so a
// step sums scalars, not colours, and sun rays are computed in texture coordinates. The samples are
// the same as in march(). Sums are plain, not compensated; the difference is below the error of the
// texture unit's interpolation weights.
//
// This path is limited by instructions: a texture unit delivers a sample in the time of some 60
// multiply-adds.
#ifndef NEPH_MARCH_TEXTURE_GLSL
#define NEPH_MARCH_TEXTURE_GLSL

#include "march_light.glsl"

const bool IS_SUNLIT = SUNLIT_TEXTURE && HAS_ONLY_TEXTURE && !LAMPS && !HAS_VEIL && !COLOURED;
const bool IS_SUMMED = TRANSMITTANCE == MARCHED && SUN == MARCHED && !CACHES_SUN && !MAPS_SHADOW;
const bool HAS_EQUAL_STEPS = !ENDS_EARLY && !GROWS && !GROWS_BY_DEPTH && !CONES_SUN_RAYS;
const bool PASSES_STEPS = STEPS_TOGETHER && SKIPS;
const bool IS_BY_PLACE = LIGHTING == SINGLE || LIGHTING == TRACED || LIGHTING == OCTAVES;
const bool MARCHES_TEXTURE = !TURNED_MEDIA && IS_SUNLIT && IS_SUMMED && HAS_EQUAL_STEPS &&
                             !PASSES_STEPS && IS_BY_PLACE;

// --- towards the sun --------------------------------------------------------------------------

// Sun rays from all places along a view ray. A sun ray leaves the medium's bounds at the nearest of
// three faces; its distance to each face is linear in the place on the view ray.
struct SunWay {
    vec3 exit_m, exit_per_m;
    vec3 per_m; // in texture coordinates
};

SunWay sun_way(ViewRay ray)
{
    vec3 sun = to_sun();
    bvec3 is_level = lessThan(abs(sun), vec3(PARALLEL));
    vec3 inverse = 1.0 / mix(sun, vec3(1.0), is_level);
    vec3 face_m = mix(frame.media[0].low_m, frame.media[0].high_m, greaterThan(sun, vec3(0.0)));
    SunWay way;
    way.exit_m = mix((face_m - ray.origin_m) * inverse, vec3(FAR_M), is_level);
    way.exit_per_m = mix(-ray.direction * inverse, vec3(0.0), is_level);
    way.per_m = texture_ray(vec3(0.0), sun).per_m;
    return way;
}

// One sample on a sun ray. With empty-space skipping empty cells are not fetched; without it
// several fetches are in flight.
float tap(vec3 place, float t_m, vec3 point_m)
{
    if (SKIPS && shapes_are_empty(point_m + t_m * to_sun()))
        return 0.0;
    if (SKIPS)
        density_evaluations++;
    return grid_texture_at(0, place);
}

// The sum of `count` samples from `next_m` on; the compile-time count lets all fetches be in flight
// together. Each sample is in the middle of a step, and the next step is `growth` times as long.
float add_taps(vec3 place, vec3 per_m, vec3 point_m, const uint count, float growth,
               inout float next_m, inout float length_m)
{
    float densities[RAY_TAPS_MAX], lengths_m[RAY_TAPS_MAX], sum = 0.0;
    float middle_m = next_m + 0.5 * length_m; // of the first step
    vec3 first = place + middle_m * per_m, step = length_m * per_m;
    [[unroll]] for (uint k = 0; k < count; k++) {
        float t_m = GROWS_SUN_RAYS ? next_m + 0.5 * length_m : middle_m + float(k) * length_m;
        vec3 at = GROWS_SUN_RAYS ? place + t_m * per_m : first + float(k) * step;
        densities[k] = tap(at, t_m, point_m);
        lengths_m[k] = length_m;
        if (GROWS_SUN_RAYS) {
            next_m += length_m;
            length_m *= growth;
        }
    }
    if (!GROWS_SUN_RAYS)
        next_m += float(count) * length_m;
    [[unroll]] for (uint k = 0; k < count; k++)
        sum += GROWS_SUN_RAYS ? lengths_m[k] * densities[k] : densities[k];
    return sum;
}

float sun_texels_together(SunWay way, vec3 place, float all_m); // march_texture_cpu.glsl

// Sum over a sun ray of density (relative to the full one) times length [m], from the place at t_m
// on the view ray.
float sun_texels(SunWay way, vec3 place, vec3 point_m, float t_m)
{
    vec3 exits_m = way.exit_m + t_m * way.exit_per_m;
    float all_m = max(min(exits_m.x, min(exits_m.y, exits_m.z)), 0.0);
    if (STEPS_TOGETHER)
        return sun_texels_together(way, place, all_m);
    uint count = kept_sun_steps, i = 0;
    float growth = GROWS_SUN_RAYS ? frame.sun_growth : 1.0;
    float first_m = all_m * (GROWS_SUN_RAYS ? frame.sun_first_part : 1.0 / float(count));
    float next_m = 0.0, length_m = first_m, sum = 0.0;
    for (; i + 6 <= count; i += 6)
        sum += add_taps(place, way.per_m, point_m, 6, growth, next_m, length_m);
    if (i + 4 <= count) {
        sum += add_taps(place, way.per_m, point_m, 4, growth, next_m, length_m);
        i += 4;
    }
    for (; i < count; i++)
        sum += add_taps(place, way.per_m, point_m, 1, growth, next_m, length_m);
    if (!SKIPS)
        density_evaluations += count;
    return GROWS_SUN_RAYS ? sum : first_m * sum;
}

const float PER_E = 1.44269504; // log2(e)

const float LEAST_EXPONENT = -60.0;
float transmittance_from_exp2(float exponent)
{
    return DROPS_SMALL_NUMBERS && exponent < LEAST_EXPONENT ? 0.0 : exp2(exponent);
}

// Transmittance of the sunlight times phase function, summed over octaves [1/sr].
float texture_light(float sun_depth)
{
    float exponent = -PER_E * sun_depth;
    if (LIGHTING != OCTAVES)
        return phase_towards_camera_per_sr[0].x * transmittance_from_exp2(exponent);
    float sum = 0.0;
    [[unroll]] for (uint i = 0; i < KEPT_PHASES; i++) {
        sum += kept_phases_per_sr[i].x * transmittance_from_exp2(exponent);
        exponent *= kept_octave_factors.y;
    }
    return sum;
}

// --- along the view ray -------------------------------------------------------------------------

// 1 - e^-x for x >= 0, given e^-x. Below 1/8 the difference would cancel; five terms of the series
// are accurate to 1e-7 there.
float lost_fraction(float x, float through)
{
    float thin = x * (1.0 - x * (1.0 / 2.0 - x * (1.0 / 6.0 - x * (1.0 / 24.0 - x / 120.0))));
    return x < 0.125 ? thin : 1.0 - through;
}

// A block of eight steps, and which of them have density.
const uint BLOCK_STEPS = 8;
struct Block {
    float densities[BLOCK_STEPS];
    uint lit;
};

void fetch_block(vec3 place, vec3 step, float t_m, float step_m, ViewRay ray, uint count,
                 inout Block block)
{
    block.lit = 0u;
    [[unroll]] for (uint k = 0; k < BLOCK_STEPS; k++) {
        bool is_empty = SKIPS && shapes_are_empty(ray.origin_m +
                                                  (t_m + float(k) * step_m) * ray.direction);
        block.densities[k] = is_empty ? 0.0 : grid_texture_at(0, place + float(k) * step);
        if (SKIPS && !is_empty && k < count) {
            density_evaluations++;
            view_steps++;
        }
    }
    [[unroll]] for (uint k = 0; k < BLOCK_STEPS; k++)
        block.lit |= block.densities[k] > 0.0 ? 1u << k : 0u;
    if (count < BLOCK_STEPS)
        block.lit &= (1u << count) - 1u;
    if (!SKIPS) {
        density_evaluations += min(count, BLOCK_STEPS);
        view_steps += min(count, BLOCK_STEPS);
    }
}

// Selecting among registers is cheaper than an index into memory.
float select_density(Block block, uint k)
{
    bool is_odd = (k & 1u) != 0u, is_upper = (k & 2u) != 0u;
    vec4 pairs = is_odd ? vec4(block.densities[1], block.densities[3], block.densities[5],
                               block.densities[7])
                        : vec4(block.densities[0], block.densities[2], block.densities[4],
                               block.densities[6]);
    vec2 halves = is_upper ? pairs.yw : pairs.xz;
    return k < 4u ? halves.x : halves.y;
}

// Sums of a ray, before the factors that are constant along it.
struct TextureSums {
    float light, distance_m, depth, through;
};

// Adds a step with density.
void add_lit_step(ViewRay ray, float t_m, vec3 place, float per_full_m, float step_depth,
                  SunWay sun, inout TextureSums sums)
{
    float through_step = exp2(-PER_E * step_depth);
    float seen = sums.through * lost_fraction(step_depth, through_step);
    vec3 point_m = view_point_m(ray, t_m);
    if (medium_sees_sun(point_m))
        sums.light += seen * texture_light(per_full_m * sun_texels(sun, place, point_m, t_m));
    sums.distance_m += t_m * seen;
    sums.depth += step_depth;
    sums.through *= through_step;
    if (DROPS_SMALL_NUMBERS && sums.through < 1e-18)
        sums.through = 0.0;
}

// All rays of a subgroup process the same eight steps, so their samples are close together. On an
// H100 this is 5 % faster than letting each ray advance to its own next non-empty step.
void add_steps(ViewRay ray, float first_m, float step_m, TextureRay way, float per_full_m,
               inout TextureSums sums)
{
    SunWay sun = sun_way(ray);
    vec3 first = way.start + first_m * way.per_m, step = step_m * way.per_m;
    uint end = run.end_step;
    Block block;
    for (uint i = run.first_step; i < end; i += BLOCK_STEPS) {
        float t_m = first_m + float(i) * step_m;
        vec3 place = first + float(i) * step;
        fetch_block(place, step, t_m, step_m, ray, end - i, block);
        for (; block.lit != 0u; block.lit &= block.lit - 1u) {
            uint k = uint(findLSB(block.lit));
            add_lit_step(ray, t_m + float(k) * step_m, place + float(k) * step, per_full_m,
                         per_full_m * step_m * select_density(block, k), sun, sums);
        }
    }
}

#include "march_texture_cpu.glsl"

// The steps of this dispatch; the same interface as march().
void march_texture(ViewRay ray, Stretch stretch, float place, inout Sums sums)
{
    TextureRay way = texture_ray(ray.origin_m, ray.direction);
    float step_m = (stretch.t1_m - stretch.t0_m) / float(frame.steps);
    float depth = sums.scattered.value.w;
    TextureSums own_sums = TextureSums(0.0, 0.0, depth, transmittance(depth));
    sums.scattered.excess = vec4(0.0); // constant, so that it occupies no register along the ray
    sums.depth = sum_zero();
    float first_m = stretch.t0_m + place * step_m;
    float per_full_m = way.full_per_m * frame.media[0].extinction_color.x;
    if (STEPS_TOGETHER)
        add_steps_together(ray, first_m, step_m, way, per_full_m, own_sums);
    else
        add_steps(ray, first_m, step_m, way, per_full_m, own_sums);
    vec3 light = own_sums.light * frame.sun_irradiance * frame.media[0].albedo;
    sums.scattered.value = vec4(sums.scattered.value.xyz + light, own_sums.depth);
    sums.distance_m += own_sums.distance_m;
}

#endif
