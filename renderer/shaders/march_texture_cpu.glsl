// SPDX-License-Identifier: MIT
//
// march_texture.glsl for lavapipe (STEPS_TOGETHER): the same samples, in loops that all lanes leave
// at the same time. There is no empty-space skipping here (PASSES_STEPS).
#ifndef NEPH_MARCH_TEXTURE_CPU_GLSL
#define NEPH_MARCH_TEXTURE_CPU_GLSL

// --- towards the sun --------------------------------------------------------------------------

// Equal steps, six samples per iteration. lavapipe leaves the loop only at its end.
float equal_taps(vec3 place, vec3 per_m, uint count, float step_m)
{
    vec3 step = step_m * per_m;
    float sum = 0.0;
    for (uint i = 0;;) {
        vec3 first = place + (float(i) + 0.5) * step;
        [[unroll]] for (uint k = 0; k < RAY_TAPS_MAX; k++) {
            float density = grid_texture_at(0, first + float(k) * step);
            sum += i + k < count ? density : 0.0;
        }
        i += RAY_TAPS_MAX;
        if (i >= count)
            break;
    }
    return step_m * sum;
}

float grown_taps(vec3 place, vec3 per_m, uint count, float first_m)
{
    float sum = 0.0, next_m = 0.0, length_m = first_m;
    for (uint i = 0;;) {
        [[unroll]] for (uint k = 0; k < RAY_TAPS_MAX; k++) {
            float density = grid_texture_at(0, place + (next_m + 0.5 * length_m) * per_m);
            sum += i + k < count ? length_m * density : 0.0;
            next_m += length_m;
            length_m *= frame.sun_growth;
        }
        i += RAY_TAPS_MAX;
        if (i >= count)
            break;
    }
    return sum;
}

float sun_texels_together(SunWay way, vec3 place, float all_m)
{
    uint count = kept_sun_steps;
    density_evaluations += count;
    return GROWS_SUN_RAYS ? grown_taps(place, way.per_m, count, all_m * frame.sun_first_part)
                          : equal_taps(place, way.per_m, count, all_m / float(count));
}

// --- along the view ray -----------------------------------------------------------------------

// Four steps, and which of them have density.
const uint STEPS_AT_ONCE = 4;

uint fetch_four(vec3 place, vec3 step, uint count, out vec4 densities)
{
    uint lit = 0u;
    [[unroll]] for (uint k = 0; k < STEPS_AT_ONCE; k++)
        densities[k] = grid_texture_at(0, place + float(k) * step);
    [[unroll]] for (uint k = 0; k < STEPS_AT_ONCE; k++)
        lit |= densities[k] > 0.0 ? 1u << k : 0u;
    if (count < STEPS_AT_ONCE)
        lit &= (1u << count) - 1u;
    density_evaluations += min(count, STEPS_AT_ONCE);
    view_steps += min(count, STEPS_AT_ONCE);
    return lit;
}

float density_of_four(vec4 densities, uint k)
{
    vec2 pair = (k & 1u) != 0u ? densities.yw : densities.xz;
    return (k & 2u) != 0u ? pair.y : pair.x;
}

void add_steps_together(ViewRay ray, float first_m, float step_m, TextureRay way,
                        float per_full_m, inout TextureSums sums)
{
    SunWay sun = sun_way(ray);
    vec3 first = way.start + first_m * way.per_m, step = step_m * way.per_m;
    uint end = make_nonuniform(run.end_step), lit;
    for (uint i = make_nonuniform(run.first_step);;) {
        float t_m;
        vec3 place;
        vec4 densities;
        for (;;) { // until a ray finds density
            t_m = first_m + float(i) * step_m;
            place = first + float(i) * step;
            lit = fetch_four(place, step, end - i, densities);
            i += STEPS_AT_ONCE;
            if (subgroupAny(i >= end || lit != 0u)) // a vote and nothing else, as in march.glsl
                break;
        }
        for (;;) { // left at its end: see march_light.glsl
            uint k = uint(findLSB(lit));
            if (lit != 0u)
                add_lit_step(ray, t_m + float(k) * step_m, place + float(k) * step, per_full_m,
                             per_full_m * step_m * density_of_four(densities, k), sun, sums);
            lit &= lit - 1u;
            if (lit == 0u)
                break;
        }
        if (i >= end)
            break;
    }
}

#endif
