// SPDX-License-Identifier: MIT
//
// Fixed-step ray marching:
//
//   L = sum_i T_i J_i (1 - e^-dtau_i) + T background,     T_i = e^-(dtau_0 + .. + dtau_(i-1))
//
// over `steps` equal steps. J is the source function, light scattered or emitted per unit of
// optical depth [W m^-2 sr^-1]. It is sampled at one point of the step and taken as constant in the
// step:
//
//   t0 |----x----|----x----|----x----|----x----| t1     x: sample, `place` = 0.5
//          dtau_0    dtau_1    dtau_2    dtau_3
//
// The integral over a step of constant J and extinction is exact: J (1 - e^-dtau). (S. Hillaire,
// "Physically Based and Unified Volumetric Rendering in Frostbite", SIGGRAPH 2015, has it as S (1 -
// e^(-sigma dt)) / sigma.) With samples in the middle of the steps the error is of second order in
// the step length where the medium is smooth. A dithered start moves the samples to another place,
// the same in all steps of a ray.
//
// One thread is one ray. A dispatch marches some rays over some of their steps: few enough for
// drivers that limit loops (renderer/compute.h), and to let Ctrl-C take effect in between. The
// state of an unfinished ray is kept in a buffer.
//
// Used by march.comp and by the march pass of the real-time pipeline.
#ifndef NEPH_MARCH_GLSL
#define NEPH_MARCH_GLSL

#extension GL_KHR_shader_subgroup_vote : require

#include "march_lamp_steps.glsl"
#include "march_run.glsl"

// Multiple scattering for the march. The content depends on LIGHTING: texels of traced light (light
// and collisions), cells of diffused light (flux and fluence), or the table of slab light.
layout(std430, binding = 8) readonly buffer HigherOrders {
    vec4 higher_orders[];
};

#include "diffused_light.glsl"
#include "slab_light.glsl"

// Running sums of a ray: radiance of the media (scattered.xyz); optical depth, in scattered.w when
// it is the same for all channels, else in depth.xyz; and the sum of distance [m] times visible
// opacity. The visible opacities add up to 1 - T.
struct Sums {
    Sum scattered, depth;
    float distance_m;
};

Sums sums_zero() { return Sums(sum_zero(), sum_zero(), 0.0); }

void sums_add(inout Sums sums, vec3 scattered, vec3 step_depth)
{
    sum_add(sums.scattered, vec4(scattered, step_depth.x));
    if (COLOURED)
        sum_add(sums.depth, vec4(step_depth, 0.0));
}

vec3 marched_depth(Sums sums)
{
    return COLOURED ? sums.depth.value.xyz : sums.scattered.value.www;
}

uint view_steps = 0; // steps of this ray inside the media's hull

#include "march_texture.glsl"

struct MarchState {
    Sums sums;
    uint density_evaluations;
    uint closed_forms;
    uint view_steps;
};

layout(std430, binding = 5) buffer States {
    MarchState states[];
};

#ifdef MARCH_STARTS_LATE
float march_from_m = 0.0; // start of the march: another pass renders the nearer part
#endif


// Light that a step sends to its near end, by the selected lighting model.
vec3 step_light(Mixture mixture, vec3 point_m, float step_m, vec3 step_depth)
{
    if (LIGHTING == HORIZON)
        return horizon_light(point_m) * step_m *
               vec3(phi(step_depth.x), phi(step_depth.y), phi(step_depth.z));
    return source_function(mixture, point_m) * fraction_lost(step_depth);
}

// Light that a step sends to the camera, for models in which every order has its own attenuation on
// the way there.
vec3 scaled_light(Mixture mixture, vec3 point_m, vec3 seen_depth, vec3 step_depth)
{
    if (LIGHTING == DIFFUSED)
        return diffused_light(mixture, point_m, seen_depth.x, step_depth.x);
    if (LIGHTING == SLAB)
        return slab_light(mixture, point_m, seen_depth.x, step_depth.x);
    if (LIGHTING == SIMILARITY)
        return similarity_light(mixture, point_m, seen_depth, step_depth);
    return fitted_octave_light(mixture, point_m, seen_depth, step_depth);
}

float least(vec3 channels) { return min(channels.x, min(channels.y, channels.z)); }

float mean(vec3 channels) { return COLOURED ? dot(channels, vec3(1.0 / 3.0)) : channels.x; }

// Whether steps in empty cells may be skipped: all media quantities are sampled at the step's
// point, so a step without density adds nothing.
const bool SKIPS_STEPS = SKIPS && VIEW_MARCHED == KINDS && !HAS_FOG;

// Whether the density of the only medium is sampled before all else in a step: a clear step then
// ends there.
const bool PASSES_CLEAR = KNOWN_MEDIA == 1u && VIEW_MARCHED == KINDS && !HAS_FOG &&
                          LIGHTING != HORIZON;

float met_per_m = 0.0; // extinction of the step that was sampled last

// Moves `i` on to the first step with extinction at its sample, or to `end`.
void pass_clear_steps(ViewRay ray, Steps steps, float place, uint end, inout uint i)
{
    TextureRay way;
    if (HAS_ONLY_TEXTURE)
        way = texture_ray(ray.origin_m, ray.direction);
    for (; i < end; i = step_after(steps, i)) {
        if (SKIPS)
            pass_empty_steps(steps, place, ray.origin_m, ray.direction, end, i);
        if (i == end)
            break;
        density_evaluations++;
        view_steps++;
        float t_m = step_point_m(steps, i, place);
        met_per_m = HAS_ONLY_TEXTURE ? way.full_per_m * texture_ray_density(way, t_m)
                                       : sampled_extinction_per_m(0, view_point_m(ray, t_m));
        if (met_per_m > 0.0)
            break;
    }
}

vec4 ahead[2]; // densities of the block of eight steps around step i

// Moves `i` on as pass_clear_steps() does, in a texture. Eight fetches are issued together, because
// a GPU would otherwise wait for each.
void pass_clear_texels(ViewRay ray, Steps steps, float place, uint end, inout uint i)
{
    TextureRay way = texture_ray(ray.origin_m, ray.direction);
    uint start = i;
    while (i < end) {
        uint turn = (i - make_nonuniform(run.first_step)) % 8u;
        if (turn == 0u)
            [[unroll]] for (uint k = 0; k < 8; k++)
                ahead[k / 4][k % 4] = texture_ray_density(way, step_point_m(steps, i + k, place));
        vec4 four = turn < 4u ? ahead[0] : ahead[1];
        met_per_m = way.full_per_m * four[turn % 4u];
        if (met_per_m > 0.0)
            break;
        i += turn % 4u == 0u && four == vec4(0.0) ? 4u : 1u;
    }
    i = min(i, end);
    uint looked_up = i - start + (i < end ? 1u : 0u);
    density_evaluations += looked_up;
    view_steps += looked_up;
}

// Not with empty-space skipping, where the next steps are not known in advance, and not on
// lavapipe, which does not wait for fetches.
const bool LOOKS_AHEAD = HAS_ONLY_TEXTURE && !SKIPS && !GROWS_BY_DEPTH &&
                         !STEPS_TOGETHER;

// A loop of its own, so that rays that have crossed clear air do their steps in the medium
// together. Returns whether a step was passed; the caller then adds a zero once, as in
// marched_optical_depth().
bool pass_clear(ViewRay ray, Steps steps, float place, uint end, inout uint i)
{
    uint start = i;
    if (LOOKS_AHEAD)
        pass_clear_texels(ray, steps, place, end, i);
    else
        pass_clear_steps(ray, steps, place, end, i);
    return i > start;
}

bool is_dark(vec3 through) { return all(lessThan(through, vec3(frame.early_out))); }

// --- rays of a subgroup in the same steps --------------------------------------------------------

// lavapipe executes a path with all eight lanes when one lane needs it. A ray that searches the
// next non-empty step while others are in the medium would occupy the whole subgroup. So all rays
// of a subgroup sample the same steps, advance together until one of them finds a medium, and then
// process the steps found.
const bool MARCHES_TOGETHER = STEPS_TOGETHER && PASSES_CLEAR && !SKIPS && !ENDS_EARLY &&
                              !GROWS_BY_DEPTH;

// Steps sampled at once, and which of them have extinction.
const uint TOGETHER = 4;
struct LookedUp {
    float per_m[TOGETHER];
    uint first, lit; // one bit per step
};

// Removes and returns the first step with extinction.
uint take_step(inout LookedUp steps)
{
    uint k = uint(findLSB(steps.lit));
    vec2 pair = (k & 2u) == 0u ? vec2(steps.per_m[0], steps.per_m[1])
                               : vec2(steps.per_m[2], steps.per_m[3]);
    met_per_m = (k & 1u) == 0u ? pair.x : pair.y;
    steps.lit &= steps.lit - 1u;
    return steps.first + k;
}

// Samples steps from `i` on, until a ray finds extinction or to `end`.
void look_up_together(ViewRay ray, Steps steps, float place, uint end, inout uint i,
                      inout LookedUp found)
{
    TextureRay way;
    if (HAS_ONLY_TEXTURE)
        way = texture_ray(ray.origin_m, ray.direction);
    for (;;) {
        found.first = i;
        found.lit = 0u;
        [[unroll]] for (uint k = 0; k < TOGETHER; k++) {
            float t_m = step_point_m(steps, i + k, place);
            found.per_m[k] = HAS_ONLY_TEXTURE
                                 ? way.full_per_m * texture_ray_density(way, t_m)
                                 : sampled_extinction_per_m(0, view_point_m(ray, t_m));
            if (found.per_m[k] > 0.0 && i + k < end)
                found.lit |= 1u << k;
        }
        uint count = min(TOGETHER, end - i);
        density_evaluations += count;
        view_steps += count;
        i += count;
        if (subgroupAny(i == end || found.lit != 0u)) // one vote only: renderer/spirv_loops.h
            break;
    }
}

// Adds one step to the sums. With PASSES_CLEAR the extinction of the only medium is in met_per_m.
void march_step(ViewRay ray, Steps steps, uint i, float place, inout Sums sums)
{
    float step_m = step_length_m(steps, i);
    vec3 start_m = view_point_m(ray, step_start_m(steps, i));
    float point_distance_m = step_point_m(steps, i, place);
    vec3 point_m = view_point_m(ray, point_distance_m);
    Mixture mixture = sample_mixture(point_m, PASSES_CLEAR, met_per_m);
    vec3 step_depth = mixture.marched_per_m * step_m;
    if (TRANSMITTANCE == EXACT)
        step_depth += exact_optical_depth(start_m, ray.direction, step_m);
    vec3 through = fraction_through(marched_depth(sums));
    sums.distance_m += point_distance_m * mean(through * fraction_lost(step_depth));
    vec3 scattered = vec3(0.0);
    if (kept_scatters)
        scattered = SCALES_VIEW
                        ? scaled_light(mixture, point_m, marched_depth(sums), step_depth)
                        : step_light(mixture, point_m, step_m, step_depth) * through;
    if (LAMPS && make_nonuniform(frame.scatters_lamps) != 0)
        scattered += lamps_step_light(mixture, ray, steps.stretch, step_start_m(steps, i), step_m,
                                      step_depth) *
                     through;
    if (kept_emits)
        scattered += mixture.glow * fraction_lost(step_depth) * through;
    if (HAS_VEIL && step_depth != vec3(0.0))
        scattered = behind_veil(ray.direction, point_distance_m, scattered,
                                through * fraction_lost(step_depth));
    sums_add(sums, scattered, step_depth);
}

// Marches the steps of this dispatch along a view ray. Media are sampled at `place` (0..1) of each
// step.
//
// The transmittance to a step is always the product over the steps before it, never an independent
// closed form of the whole distance. Closed forms of adjacent steps add up to that anyway, so in
// both modes the weights of the source function telescope to 1 - T.
void march(ViewRay ray, float length_m, float place, inout Sums sums)
{
    if (SEES_DEEP)
        opaque_depth = DEEP;
    Stretch stretch = scene_stretch(ray.origin_m, ray.direction, length_m);
#ifdef MARCH_STARTS_LATE
    stretch.t0_m = max(stretch.t0_m, march_from_m);
#endif
    if (stretch.t1_m <= stretch.t0_m)
        return;
    set_view_ray(ray);
    if (MARCHES_TEXTURE) {
        march_texture(ray, stretch, place, sums);
        return;
    }
    Steps steps = make_view_steps(stretch);
    uint end = make_nonuniform(run.end_step), done = make_nonuniform(run.first_step);
    steps.end = end;
    LookedUp found;
    found.lit = 0u;
    for (uint i = make_nonuniform(run.first_step);;) {
        if (GROWS_BY_DEPTH)
            steps.span = span_behind(least(marched_depth(sums)));
        if (SKIPS_STEPS && !PASSES_CLEAR) {
            if (pass_empty_steps(steps, place, ray.origin_m, ray.direction, end, i))
                sums_add(sums, vec3(0.0), vec3(0.0)); // as in marched_optical_depth()
            if (i == end)
                break;
        }
        if (ENDS_EARLY && is_dark(fraction_through(marched_depth(sums))))
            break;
        if (MARCHES_TOGETHER) {
            look_up_together(ray, steps, place, end, i, found);
        } else if (PASSES_CLEAR) {
            if (pass_clear(ray, steps, place, end, i))
                sums_add(sums, vec3(0.0), vec3(0.0));
            if (i == end)
                break;
        } else {
            view_steps++;
        }
        // Left at its end: else lavapipe executes the last iteration to its end without any thread.
        for (;;) {
            bool is_lit = !MARCHES_TOGETHER || found.lit != 0u;
            uint at = i;
            if (MARCHES_TOGETHER)
                at = take_step(found);
            if (is_lit) {
                if (MARCHES_TOGETHER && at > done)
                    sums_add(sums, vec3(0.0), vec3(0.0));
                march_step(ray, steps, at, place, sums);
                done = at + 1;
            }
            if (found.lit == 0u)
                break;
        }
        if (!MARCHES_TOGETHER)
            i = step_after(steps, i);
        if (i >= end)
            break;
    }
    if (MARCHES_TOGETHER && done < end)
        sums_add(sums, vec3(0.0), vec3(0.0));
}

// The sums of the dispatch before.
Sums sums_at_start(uint thread)
{
    if (make_nonuniform(run.first_step) == 0)
        return sums_zero();
    density_evaluations = states[thread].density_evaluations;
    closed_forms = states[thread].closed_forms;
    view_steps = states[thread].view_steps;
    Sums sums = states[thread].sums;
    if (!COLOURED)
        sums.depth = sum_zero(); // constant, so that it occupies no register along the ray
    return sums;
}

void sums_keep(uint thread, Sums sums)
{
    states[thread] = MarchState(sums, density_evaluations, closed_forms, view_steps);
}

// Optical depth of the whole view ray.
vec3 view_optical_depth(ViewRay ray, float length_m, Sums sums)
{
    return IS_SOLVED ? exact_optical_depth(ray.origin_m, ray.direction, length_m)
                     : marched_depth(sums);
}

// Traced light per unit of opacity at an image position: bilinear interpolation of the sums of four
// texels.
vec3 higher_light(vec2 place_px)
{
    ivec2 size = ivec2(light_size(uvec2(frame.width_px, frame.height_px), frame.light_texel_px));
    vec2 place = place_px / float(frame.light_texel_px) - 0.5;
    vec2 low = floor(place), part = place - low;
    vec4 sum = vec4(0.0);
    for (int i = 0; i < 4; i++) {
        ivec2 step = ivec2(i & 1, i >> 1);
        ivec2 at = clamp(ivec2(low) + step, ivec2(0), size - 1);
        vec2 weight = mix(1.0 - part, part, vec2(step));
        sum += weight.x * weight.y * higher_orders[at.x + size.x * at.y];
    }
    // Negative where a subtracted estimate exceeds the light found (light_walk.comp).
    return sum.w > 0.0 ? max(sum.rgb, vec3(0.0)) / sum.w : vec3(0.0);
}

// Mean distance of the visible medium [m]; FAR_M where nothing of it is visible.
float view_distance_m(Sums sums)
{
    float share = mean(fraction_lost(marched_depth(sums)));
    return share > 0.0 ? sums.distance_m / share : FAR_M;
}

// Radiance of the media along the whole ray, with multiple scattering that is added per pixel.
vec3 view_scattered(Sums sums, vec3 optical_depth, ViewRay ray, vec2 place_px)
{
    vec3 scattered = sums.scattered.value.xyz;
    if (LIGHTING == HORIZON)
        scattered *= fraction_lost(optical_depth);
    if (LIGHTING == TRACED) {
        vec3 higher = fraction_lost(optical_depth) * higher_light(place_px);
        if (HAS_VEIL)
            higher = behind_veil(ray.direction, view_distance_m(sums), higher, vec3(0.0));
        scattered += higher;
    }
    return scattered;
}

// Sunlight reflected by a Lambertian surface; the same in all directions.
vec3 sunlit_radiance(Hit hit, vec3 point_m)
{
    Surface surface = surface_at(hit.solid, point_m);
    float cosine = hit_cosine(hit.solid, surface.normal, to_sun());
    if (cosine <= 0.0 || surface.albedo == vec3(0.0) ||
        make_nonuniform(frame.sun_irradiance == vec3(0.0)))
        return vec3(0.0);
    return surface.albedo / PI * cosine * sunlight(point_m, hit.solid);
}

vec3 surface_radiance(Hit hit, vec3 point_m)
{
    vec3 radiance = sunlit_radiance(hit, point_m);
    if (LAMPS) {
        Surface surface = surface_at(hit.solid, point_m);
        radiance += surface.albedo * lamps_reflected(point_m, surface.normal, hit.solid);
    }
    return radiance;
}

// The light behind all marched media, seen through the veil (march_veil.glsl): the whole radiance,
// the veil's part of it, and the veil's transmittance.
struct Behind {
    vec3 radiance, veil, through;
};

// Irradiance of a solid by sky and ground. Solid 0 is the ground of the planet; its irradiance is
// in the tables.
vec3 solid_sky_irradiance(Hit hit, vec3 point_m)
{
    SkySpot spot = sky_spot(point_m);
    if (hit.solid != 0u || eye.has_field == 0u)
        return sky_irradiance(spot, surface_at(hit.solid, point_m).normal);
    return frame.sun_irradiance * sky_field_ground(spot.sun_cosine);
}

// Sky, ground or a solid behind the air. The table of views reaches to the ground; for other solids
// the air in front of them is looked up separately.
Behind sky_behind(Hit hit, ViewRay ray)
{
    SkyLight all = sky_look_up(eye.places[0], sky_ray_along(eye.places[0], ray.direction));
    if (eye.is_shaded != 0u) {
        vec3 shade = sky_veil_part(sky_froxel(ray.direction, hit.t_m), VEIL_SHADE);
        all.volume = max(all.volume - shade, vec3(0.0));
        all.radiance = max(all.radiance - shade, vec3(0.0));
    }
    if (hit.solid == NO_SOLID)
        return Behind(frame.sun_irradiance * all.radiance, frame.sun_irradiance * all.volume,
                      all.transmittance);
    vec3 point_m = view_point_m(ray, hit.t_m);
    vec3 from_sky = solid_sky_irradiance(hit, point_m);
    vec3 radiance = surface_radiance(hit, point_m) +
                    surface_at(hit.solid, point_m).albedo / PI * from_sky;
    if (hit.solid != 0u) {
        SkyVeil veil = sky_veil(ray.direction, hit.t_m);
        all.volume = veil.light;
        all.transmittance = veil.through;
    }
    vec3 added = frame.sun_irradiance * all.volume;
    return Behind(added + all.transmittance * radiance, added, all.transmittance);
}

vec3 clear_radiance_behind(Hit hit, ViewRay ray)
{
    return hit.solid == NO_SOLID ? frame.background
                                 : surface_radiance(hit, view_point_m(ray, hit.t_m));
}

Behind veiled_behind(Hit hit, ViewRay ray)
{
    Behind all = Behind(vec3(0.0), vec3(0.0), vec3(1.0));
    if (HAS_SKY)
        all = sky_behind(hit, ray);
    else
        all.radiance = clear_radiance_behind(hit, ray);
    if (HAS_FOG_LOOK) {
        Veil fog = fog_veil(ray.direction, hit.t_m);
        Veil veil = compose_veils(fog, Veil(all.veil, all.through));
        all = Behind(fog.light + fog.through * all.radiance, veil.light, veil.through);
    }
    return all;
}

// The radiance behind all media.
vec3 radiance_behind(Hit hit, ViewRay ray)
{
    return HAS_VEIL ? veiled_behind(hit, ray).radiance : clear_radiance_behind(hit, ray);
}

// Eye depth of a hit; rays start on the plane through the camera.
float hit_eye_depth_m(Hit hit, ViewRay ray)
{
    return hit.solid == NO_SOLID ? FAR_M : hit.t_m * dot(ray.direction, frame.camera_forward);
}

#endif
