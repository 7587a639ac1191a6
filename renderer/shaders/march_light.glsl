// SPDX-License-Identifier: MIT
//
// Extinction and in-scattered light of a march step: optical depths along a ray and towards the
// sun, the mixture of the media at a point, and eight lighting models:
//
//   single          sunlight scattered once: physical, but incomplete
//   octaves         multiple scattering as a sum of scaled single scatterings. Octave i has the
//                   scattering a^i, the optical depth b^i towards the sun and the phase function of
//                   g c^i; the attenuation to the camera is not scaled. (M. Wrenninge, C. Kulla,
//                   V. Lundqvist, "Oz: The Great and Volumetric", SIGGRAPH 2013; S. Hillaire,
//                   SIGGRAPH 2016 and 2020.) Non-physical: does not conserve energy
//   octaves_fitted  octaves with a, b, c from a medium's g and albedo, fitted to the path tracer;
//                   b^i also scales the attenuation to the camera (renderer/octaves_fitted.h).
//                   Non-physical
//   traced          single, and all higher orders from traced paths (traced_light.glsl): physical
//   diffused        single, and higher orders by diffusion on a coarse grid (diffused_light.glsl):
//                   physical, approximate
//   slab            single, and higher orders of a slab across the sunlight (slab_light.glsl):
//                   non-physical
//   similarity      single, and octaves of the similar medium (similarity_light()): non-physical
//   horizon         the light of Horizon Zero Dawn's clouds (A. Schneider, "The Real-time
//                   Volumetric Cloudscapes of Horizon: Zero Dawn", SIGGRAPH 2015) as later
//                   published for engines (horizon_light()), in arbitrary units: non-physical
#ifndef NEPH_MARCH_LIGHT_GLSL
#define NEPH_MARCH_LIGHT_GLSL

#include "cloud_shadow.glsl"
#include "grid_texture.glsl"
#include "march_veil.glsl"
#include "sun_cache.glsl"
#include "traced_light.glsl"

// enum neph_march_mode: the source of an optical depth
const uint EXACT = 0;   // closed form, for kinds of media that have one
const uint MARCHED = 1; // sum over steps, with the extinction at the middle of each step
layout(constant_id = 2) const uint TRANSMITTANCE = EXACT; // along the view ray
layout(constant_id = 3) const uint SUN = EXACT;           // towards the sun

// enum neph_march_lighting
const uint SINGLE = 0;
const uint OCTAVES = 1;
const uint HORIZON = 2;
const uint OCTAVES_FITTED = 3;
const uint TRACED = 4;
const uint DIFFUSED = 5;
const uint SIMILARITY = 6;
const uint SLAB = 7;
layout(constant_id = 4) const uint LIGHTING = SINGLE;
const bool NEEDS_MEDIA = LAMPS || LIGHTING == OCTAVES || LIGHTING == OCTAVES_FITTED ||
                         LIGHTING == DIFFUSED || LIGHTING == SIMILARITY || LIGHTING == SLAB;

// Models in which every order has its own attenuation along the view ray.
const bool SCALES_VIEW = LIGHTING == OCTAVES_FITTED || LIGHTING == DIFFUSED ||
                         LIGHTING == SIMILARITY || LIGHTING == SLAB;

// Similar media are thinner than the original, at g = 0.9 by a factor of 5 to 10. With these models
// fogs are marched down to an optical depth at which the similar medium transmits e^-12.
const bool SEES_DEEP = SCALES_VIEW && LIGHTING != OCTAVES_FITTED;
const float DEEP = 8.0 * OPAQUE;

// Kinds of media for which optical depths are summed over steps. The others have closed forms.
const uint VIEW_MARCHED = KINDS & (TRANSMITTANCE == EXACT ? OPEN_KINDS : ~0u);
const bool IS_SOLVED = TRANSMITTANCE == EXACT && VIEW_MARCHED == 0u; // the view needs no march
const uint SUN_MARCHED = KINDS & (SUN == EXACT ? OPEN_KINDS : ~0u);

const uint FITTED_OCTAVES = NEPH_GPU_FITTED_OCTAVES;

// Read once per thread, as in to_sun().
uint kept_sun_steps = make_nonuniform(frame.sun_steps);
uint kept_octave_count = make_nonuniform(frame.octave_count);
vec3 kept_octave_factors = frame.octave_factors;
bool kept_emits = make_nonuniform(frame.emits) != 0;
bool kept_scatters = make_nonuniform(frame.scatters) != 0;

// Cost counters of this pixel.
uint density_evaluations = 0;
uint closed_forms = 0;

// Transmittance and absorbed fraction: one exponential for grey extinction, else three.
vec3 fraction_through(vec3 optical_depth)
{
    return COLOURED ? transmittance(optical_depth) : vec3(transmittance(optical_depth.x));
}

vec3 fraction_lost(vec3 optical_depth)
{
    return COLOURED ? absorbed_fraction(optical_depth) : vec3(absorbed_fraction(optical_depth.x));
}

vec3 exact_optical_depth(vec3 origin_m, vec3 direction, float length_m)
{
    closed_forms++;
    return scene_optical_depth(origin_m, direction, length_m);
}

// scene_optical_depth() restricted to the kinds of media in `kinds`.
vec3 exact_optical_depth_by_kind(uint kinds, vec3 origin_m, vec3 direction, float length_m)
{
    closed_forms++;
    vec3 optical_depth = vec3(0.0);
    [[unroll]] for (uint m = 0; m < media_count(); m++)
        if (is_among(kinds, m))
            optical_depth += frame.media[m].extinction_color *
                             medium_optical_depth(m, origin_m, direction, length_m);
    return grey(optical_depth);
}

// Number of samples that a sum over steps takes at once. Texture fetches are issued together,
// because a GPU would otherwise wait for each. Samples beyond the end are fetched and not added.
// With empty-space skipping the next steps are not known in advance.
const uint TAPS_MAX = 3;
const bool TAPS_IN_TURN = STEPS_TOGETHER && KNOWN_MEDIA == 1u && KINDS == 1u << MEDIUM_GRID;
uint taps() { return SKIPS ? 1 : TAPS_IN_TURN ? 2 : SAMPLES_TEXTURES ? TAPS_MAX : 1; }

// Samples one after the other: with a single grid this saves a CPU every other loop iteration. In
// other scenes the inner loops would exceed the iterations that a dispatch may have
// (renderer/march_split.c).
void add_taps_in_turn(uint kinds, vec3 origin_m, vec3 direction, Steps steps, uint i, inout Sum sum)
{
    [[unroll]] for (uint k = 0; k < taps(); k++) {
        vec3 extinction_per_m = sampled_extinctions_per_m(
            kinds, origin_m + step_point_m(steps, i + k, 0.5) * direction);
        if (i + k < steps.count) {
            sum_add(sum, vec4(extinction_per_m * steps.step_m, 0.0));
            density_evaluations++;
        }
    }
}

void add_taps(uint kinds, vec3 origin_m, vec3 direction, Steps steps, uint i, inout Sum sum)
{
    if (TAPS_IN_TURN) {
        add_taps_in_turn(kinds, origin_m, direction, steps, i, sum);
        return;
    }
    vec3 extinction_per_m[TAPS_MAX];
    [[unroll]] for (uint k = 0; k < taps(); k++)
        extinction_per_m[k] = sampled_extinctions_per_m(
            kinds, origin_m + step_point_m(steps, i + k, 0.5) * direction);
    [[unroll]] for (uint k = 0; k < taps(); k++)
        if (i + k < steps.count) {
            sum_add(sum, vec4(extinction_per_m[k] * steps.step_m, 0.0));
            density_evaluations++;
        }
}

// Loops below are left at the end of an iteration: where the last lane leaves at the start,
// lavapipe still executes the iteration to its end without any thread.

// Optical depth through a texture as the only medium, along a stretch with steps that each are
// `growth` times as long as the one before. A plain sum, because steps in clear air do not change
// it.
const uint RAY_TAPS_MAX = 6;
uint ray_taps() { return SKIPS ? 1 : RAY_TAPS_MAX; }

float texture_optical_depth(vec3 origin_m, vec3 direction, Stretch stretch, uint count,
                            float first_m, float growth)
{
    TextureRay ray = texture_ray(origin_m, direction);
    float sum = 0.0, next_m = stretch.t0_m, length_m = first_m;
    for (uint i = 0;;) {
        float densities[RAY_TAPS_MAX], lengths_m[RAY_TAPS_MAX];
        [[unroll]] for (uint k = 0; k < ray_taps(); k++) {
            float t_m = next_m + 0.5 * length_m;
            bool counts = i + k < count && !(SKIPS && shapes_are_empty(origin_m + t_m * direction));
            densities[k] = SKIPS && !counts ? 0.0 : texture_ray_density(ray, t_m);
            lengths_m[k] = counts ? length_m : 0.0;
            next_m += length_m;
            length_m *= growth;
        }
        [[unroll]] for (uint k = 0; k < ray_taps(); k++) {
            sum += lengths_m[k] * densities[k];
            density_evaluations += lengths_m[k] > 0.0 ? 1u : 0u;
        }
        i += ray_taps();
        if (i >= count)
            break;
    }
    return ray.full_per_m * sum;
}

// Optical depth by a sum over equal steps. Where empty steps were skipped, a zero is added once:
// the compensated sum may still change its last bit then, but not by further zeros. The result
// equals the sum without skipping.
vec3 marched_optical_depth(uint kinds, vec3 origin_m, vec3 direction, float length_m,
                           uint step_count)
{
    Stretch stretch = scene_stretch(kinds, origin_m, direction, length_m);
    if (stretch.t1_m <= stretch.t0_m)
        return vec3(0.0);
    Steps steps = equal_steps(stretch, step_count);
    if (HAS_ONLY_TEXTURE)
        return grey(medium_color(0)) *
               texture_optical_depth(origin_m, direction, stretch, step_count, steps.step_m, 1.0);
    Sum sum = sum_zero();
    for (uint i = 0;;) {
        if (SKIPS && (kinds & FOG_KINDS) == 0u) {
            if (pass_empty_steps(steps, 0.5, origin_m, direction, step_count, i))
                sum_add(sum, vec4(0.0));
            if (i == step_count)
                break;
        }
        add_taps(kinds, origin_m, direction, steps, i, sum);
        i += taps();
        if (i >= step_count)
            break;
    }
    return grey(sum.value.xyz);
}

// Two vectors perpendicular to a direction and to each other; unit, if the direction is.
void frame_across(vec3 direction, out vec3 right, out vec3 up)
{
    right = normalize(abs(direction.y) < 0.9 ? cross(direction, vec3(0.0, 1.0, 0.0))
                                             : cross(direction, vec3(1.0, 0.0, 0.0)));
    up = cross(right, direction);
}

// Position of sun step i at the distance t_m: on the sun ray, or in a cone around it, in a
// sunflower pattern (golden angle), which covers a disc evenly for any number of points.
vec3 sun_tap_m(vec3 point_m, float t_m, uint i)
{
    vec3 tap_m = point_m + t_m * to_sun();
    if (!CONES_SUN_RAYS)
        return tap_m;
    vec3 right, up;
    frame_across(to_sun(), right, up);
    float angle = 2.39996323 * float(i);
    float width_m = t_m * frame.sun_cone * sqrt((float(i) + 0.5) / float(kept_sun_steps));
    return tap_m + width_m * (cos(angle) * right + sin(angle) * up);
}

// Optical depth towards the sun with few steps of growing length, because the nearby medium matters
// most. (A. Schneider, "The Real-time Volumetric Cloudscapes of Horizon: Zero Dawn", SIGGRAPH 2015,
// has six steps in a cone.)
vec3 grown_sun_depth(uint kinds, vec3 point_m)
{
    Stretch stretch = scene_stretch(kinds, point_m, to_sun(), FAR_M);
    if (stretch.t1_m <= stretch.t0_m)
        return vec3(0.0);
    uint count = kept_sun_steps;
    float next_m = stretch.t0_m, length_m = frame.sun_first_part * (stretch.t1_m - stretch.t0_m);
    if (HAS_ONLY_TEXTURE && !CONES_SUN_RAYS)
        return grey(medium_color(0)) *
               texture_optical_depth(point_m, to_sun(), stretch, count, length_m,
                                     frame.sun_growth);
    Sum sum = sum_zero();
    for (uint i = 0;;) {
        vec3 tap_m = sun_tap_m(point_m, next_m + 0.5 * length_m, i);
        if (!SKIPS || (kinds & FOG_KINDS) != 0u || !shapes_are_empty(tap_m)) {
            sum_add(sum, vec4(sampled_extinctions_per_m(kinds, tap_m) * length_m, 0.0));
            density_evaluations++;
        }
        next_m += length_m;
        length_m *= frame.sun_growth;
        if (++i >= count)
            break;
    }
    return grey(sum.value.xyz);
}

vec3 marched_sun_depth(uint kinds, vec3 point_m)
{
    return GROWS_SUN_RAYS ? grown_sun_depth(kinds, point_m)
                           : marched_optical_depth(kinds, point_m, to_sun(), FAR_M,
                                                   kept_sun_steps);
}

vec3 sun_optical_depth(vec3 point_m)
{
    vec3 optical_depth = vec3(0.0);
    if (SUN == EXACT)
        optical_depth = exact_optical_depth(point_m, to_sun(), FAR_M);
    if (SUN_MARCHED != 0u)
        optical_depth += marched_sun_depth(SUN_MARCHED, point_m);
    return optical_depth;
}

vec3 sun_optical_depth_by_kind(uint kinds, vec3 point_m)
{
    vec3 optical_depth = vec3(0.0);
    if (SUN == EXACT && (kinds & ~OPEN_KINDS) != 0u)
        optical_depth = exact_optical_depth_by_kind(kinds, point_m, to_sun(), FAR_M);
    if ((SUN_MARCHED & kinds) != 0u)
        optical_depth += marched_sun_depth(SUN_MARCHED & kinds, point_m);
    return optical_depth;
}

// Whether the last point of mixture_at() is in a shape: the shadow map is too coarse there.
bool is_in_shape = true;

// For points outside of shapes: fogs are computed here, shapes come from the shadow map where it
// covers the point.
vec3 sun_depth_outside_shapes(vec3 point_m)
{
    vec3 depth;
    if (!MAPS_SHADOW || !find_mapped_sun_depth(point_m, depth))
        return sun_optical_depth(point_m);
    return HAS_FOG ? depth + sun_optical_depth_by_kind(KINDS & FOG_KINDS, point_m) : depth;
}

// Optical depth towards the sun for a sample of a medium: fogs are computed here, shapes come from
// the sun cache, if there is one.
vec3 sample_sun_depth(vec3 point_m)
{
    if (MAPS_SHADOW && !is_in_shape)
        return sun_depth_outside_shapes(point_m);
    if (!CACHES_SUN)
        return sun_optical_depth(point_m);
    return sun_optical_depth_by_kind(KINDS & FOG_KINDS, point_m) + cached_sun_depth(point_m);
}

// Sunlight that reaches a point [W/m^2].
vec3 sunlight(vec3 point_m, uint on_solid)
{
    if (!sees_sun(point_m, on_solid))
        return vec3(0.0);
    return sun_at(point_m) * fraction_through(sun_depth_outside_shapes(point_m));
}

// The combined properties of all media at a point.
struct Mixture {
    vec3 extinction_per_m;
    vec3 marched_per_m; // extinction of the media in VIEW_MARCHED
    vec3 scattering; // sum of scattering coefficient times phase function [1/(m sr)]
    vec3 glow; // mean of the media's glow, weighted with extinction [W m^-2 sr^-1]
};

// This pixel's view ray. The sun is directional, so phase functions are constant along the ray.
vec3 view_origin_m, view_direction;
vec3 phase_towards_camera_per_sr[MEDIA_MAX]; // by channel
// Scattering coefficients at the last point of mixture_at() [1/m]; only with NEEDS_MEDIA.
vec3 scattering_per_m[MEDIA_MAX];

// The phase function with its anisotropy scaled by `part` (phase_cut_per_sr()).
vec3 flattened_phase_per_sr(uint m, float part)
{
    return phase_cut_per_sr(make_nonuniform(frame.media[m].phase_kind), frame.media[m].g, part,
                            phase_towards_camera_per_sr[m], view_direction, to_sun());
}

// Phase functions of the first octaves of the only medium, computed once per ray. With
// SUMS_CHANNELS they include the contributions a^i: the octaves are then one sum for all channels,
// with different rounding.
const bool KEEPS_PHASES = LIGHTING == OCTAVES && KNOWN_MEDIA == 1u;
const uint KEPT_PHASES = NEPH_GPU_KEPT_PHASES;
vec3 kept_phases_per_sr[KEPT_PHASES];

const bool SUMS_CHANNELS = KEEPS_PHASES && HAS_ONLY_TEXTURE && !COLOURED;

void keep_phases()
{
    float contribution = 1.0, part = 1.0; // a^i, c^i
    [[unroll]] for (uint i = 0; i < KEPT_PHASES; i++) {
        kept_phases_per_sr[i] = vec3(0.0);
        if (i < kept_octave_count)
            kept_phases_per_sr[i] = contribution * flattened_phase_per_sr(0, part);
        if (SUMS_CHANNELS)
            contribution *= kept_octave_factors.x;
        part *= kept_octave_factors.z;
    }
}

void set_view_ray(ViewRay ray)
{
    view_origin_m = ray.origin_m;
    view_direction = ray.direction;
    [[unroll]] for (uint m = 0; m < media_count(); m++)
        phase_towards_camera_per_sr[m] = phase_rgb_per_sr(
            make_nonuniform(frame.media[m].phase_kind), frame.media[m].g, ray.direction, to_sun());
    if (KEEPS_PHASES)
        keep_phases();
}

// Lower bound of divisors. Without extinction nothing scatters or emits, so the quotient is 0.
const vec3 LEAST = vec3(1e-37);

// The mixture at a point. `known_per_m` is the extinction of the only medium there, if `is_known`.
// The latter is a compile-time constant, so that lavapipe does not sample the medium again.
Mixture sample_mixture(vec3 point_m, const bool is_known, float known_per_m)
{
    bool only_fogs = !is_known && SKIPS && shapes_are_empty(point_m);
    if (!is_known && (!only_fogs || HAS_FOG))
        density_evaluations++;
    Mixture mixture = Mixture(vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    is_in_shape = !MAPS_SHADOW;
    [[unroll]] for (uint m = 0; m < media_count(); m++) {
        float density_per_m = is_known                  ? known_per_m
                              : only_fogs && !is_fog(m) ? 0.0
                                                        : sampled_extinction_per_m(m, point_m);
        vec3 extinction_per_m = grey(medium_color(m)) * density_per_m;
        vec3 scattered_per_m = extinction_per_m * medium_albedo(m);
        if (MAPS_SHADOW && !is_fog(m) && density_per_m > 0.0)
            is_in_shape = true;
        mixture.extinction_per_m += extinction_per_m;
        if (is_among(VIEW_MARCHED, m))
            mixture.marched_per_m += extinction_per_m;
        mixture.scattering += scattered_per_m * phase_towards_camera_per_sr[m];
        if (NEEDS_MEDIA)
            scattering_per_m[m] = scattered_per_m;
        if (kept_emits)
            mixture.glow += (frame.media[m].glow - mixture.glow) *
                            (extinction_per_m / max(mixture.extinction_per_m, LEAST));
    }
    mixture.extinction_per_m = grey(mixture.extinction_per_m);
    mixture.marched_per_m = grey(mixture.marched_per_m);
    return mixture;
}

Mixture mixture_at(vec3 point_m) { return sample_mixture(point_m, false, 0.0); }

// --- octaves --------------------------------------------------------------------------------

// Octaves of the only medium from the kept phase functions [1/(m sr)].
vec3 kept_octave_scattering(vec3 optical_depth)
{
    vec3 sum = vec3(0.0);
    vec2 scale = vec2(1.0); // a^i, b^i
    [[unroll]] for (uint i = 0; i < KEPT_PHASES; i++) {
        vec3 octave = scattering_per_m[0] * kept_phases_per_sr[i];
        if (i < kept_octave_count)
            sum += scale.x * octave * fraction_through(scale.y * optical_depth);
        scale *= kept_octave_factors.xy;
    }
    return sum;
}

// Octaves as one sum for all channels; the kept phase functions include a^i.
vec3 summed_octave_scattering(float optical_depth)
{
    float sum = 0.0, attenuation = 1.0; // b^i
    [[unroll]] for (uint i = 0; i < KEPT_PHASES; i++) {
        if (i < kept_octave_count)
            sum += kept_phases_per_sr[i].x * transmittance(attenuation * optical_depth);
        attenuation *= kept_octave_factors.y;
    }
    return sum * scattering_per_m[0];
}

// Octave model: the sum over octaves of scattering coefficient times phase function times
// transmittance towards the sun [1/(m sr)]:
//
//   sum_i  a^i  sigma_s  p(c^i g)  e^(-b^i tau_sun)
vec3 octave_scattering(vec3 optical_depth)
{
    vec3 sum = vec3(0.0);
    vec3 scale = vec3(1.0); // a^i, b^i, c^i
    if (KEEPS_PHASES) {
        sum = SUMS_CHANNELS ? summed_octave_scattering(optical_depth.x)
                              : kept_octave_scattering(optical_depth);
        [[unroll]] for (uint i = 0; i < KEPT_PHASES; i++)
            scale *= kept_octave_factors;
    }
    if (KEEPS_PHASES && !MANY_OCTAVES)
        return sum; // before the loop, which lavapipe would enter without any thread
    for (uint i = KEEPS_PHASES ? KEPT_PHASES : 0; i < kept_octave_count; i++) {
        vec3 octave = vec3(0.0);
        [[unroll]] for (uint m = 0; m < media_count(); m++)
            octave += scattering_per_m[m] * flattened_phase_per_sr(m, scale.z);
        sum += scale.x * octave * fraction_through(scale.y * optical_depth);
        scale *= kept_octave_factors;
    }
    return sum;
}

// --- source functions -----------------------------------------------------------------------

// Source function of sunlight, J = scattering / extinction * sunlight [W m^-2 sr^-1].
vec3 source_function(Mixture mixture, vec3 point_m)
{
    if (mixture.scattering == vec3(0.0) || !medium_sees_sun(point_m))
        return vec3(0.0);
    vec3 optical_depth = sample_sun_depth(point_m);
    vec3 scattered = LIGHTING == OCTAVES ? octave_scattering(optical_depth)
                                         : mixture.scattering * fraction_through(optical_depth);
    return sun_at(point_m) * scattered / max(mixture.extinction_per_m, LEAST);
}

// --- octaves, fitted -------------------------------------------------------------------------

// Fitted octaves: radiance that a step of optical depth `step_depth` behind `seen_depth` sends to
// the camera. Octave i attenuates both ways, from the sun and to the camera, with the factor b^i.
// So the sum is symmetric in eye and sun, as reciprocity requires.
vec3 fitted_octave_light(Mixture mixture, vec3 point_m, vec3 seen_depth, vec3 step_depth)
{
    if (mixture.scattering == vec3(0.0) || !medium_sees_sun(point_m))
        return vec3(0.0);
    vec3 way = sample_sun_depth(point_m) + seen_depth;
    vec3 sum = vec3(0.0);
    [[unroll]] for (uint m = 0; m < media_count(); m++) {
        vec3 scattered_per_m = scattering_per_m[m];
        float depth_part = 1.0, phase_part = 1.0; // b^i, c^i
        for (uint i = 0; i < FITTED_OCTAVES; i++) {
            vec3 own_step = depth_part * step_depth;
            vec3 share = COLOURED ? vec3(phi(own_step.x), phi(own_step.y), phi(own_step.z))
                                  : vec3(phi(own_step.x));
            sum += scattered_per_m * flattened_phase_per_sr(m, phase_part) *
                   fraction_through(depth_part * way) * share;
            scattered_per_m *= frame.media[m].octave_contribution;
            depth_part *= frame.media[m].octave_attenuation;
            phase_part *= frame.media[m].octave_eccentricity;
        }
    }
    return sun_at(point_m) * sum / max(mixture.extinction_per_m, LEAST) * step_depth;
}

// --- similarity ------------------------------------------------------------------------------

// Similarity: the quantities that media with the same appearance share (H. C. van de Hulst,
// "Multiple Light Scattering", 1980, chapter 14; D. R. Wyman, M. S. Patterson, B. C. Wilson, Appl.
// Opt. 28, 1989). The first is the mean cosine.
float medium_mean_cosine(uint m)
{
    return phase_mean_cosine(make_nonuniform(frame.media[m].phase_kind), frame.media[m].g);
}

// Delta-Eddington: the forward peak f = g^2 that counts as unscattered, and the mean cosine g' = g
// / (1 + g) of the other scattering.
float forward_peak_fraction(uint m)
{
    float g = max(medium_mean_cosine(m), 0.0);
    return g * g;
}

float similar_mean_cosine(uint m)
{
    float g = medium_mean_cosine(m);
    return g > 0.0 ? g / (1.0 + g) : g;
}

// Sums over the media at a point, first channel.
struct Similar {
    float extinction_per_m, scattering_per_m;
    float peak_per_m, onward_per_m; // scattering weighted with the peak and with the mean cosine
};

void similar_add(inout Similar sum, uint m, float scattering_per_m)
{
    sum.scattering_per_m += scattering_per_m;
    sum.peak_per_m += scattering_per_m * forward_peak_fraction(m);
    sum.onward_per_m += scattering_per_m * medium_mean_cosine(m);
}

Similar make_similar_medium(Mixture mixture)
{
    Similar sum = Similar(mixture.extinction_per_m.x, 0.0, 0.0, 0.0);
    [[unroll]] for (uint m = 0; m < media_count(); m++)
        similar_add(sum, m, scattering_per_m[m].x);
    return sum;
}

// Extinction of the similar medium over the original one: 1 - f albedo.
float similar_scale(Similar sum)
{
    return 1.0 - sum.peak_per_m / max(sum.extinction_per_m, LEAST.x);
}

// Similarity model: radiance that a step of optical depth `step_depth` behind `seen_depth` sends to
// the camera. It is single scattering of the original medium, plus the octaves of the similar
// medium minus that medium's single scattering. The octave factors are fitted to the similar
// medium.
vec3 similarity_light(Mixture mixture, vec3 point_m, vec3 seen_depth, vec3 step_depth)
{
    if (mixture.scattering == vec3(0.0) || !medium_sees_sun(point_m))
        return vec3(0.0);
    vec3 way = sample_sun_depth(point_m) + seen_depth;
    vec3 once = fraction_through(way) *
                vec3(phi(step_depth.x), phi(step_depth.y), phi(step_depth.z));
    vec3 sum = once * mixture.scattering;
    [[unroll]] for (uint m = 0; m < media_count(); m++) {
        float peak = forward_peak_fraction(m), g = similar_mean_cosine(m);
        vec3 octave = scattering_per_m[m] * (1.0 - peak);
        float depth_part = 1.0 - peak * dot(frame.media[m].albedo, vec3(1.0 / 3.0));
        sum -= octave * henyey_greenstein_per_sr(g, view_direction, to_sun()) * once;
        for (uint i = 0; i < FITTED_OCTAVES; i++) {
            vec3 own_step = depth_part * step_depth;
            vec3 share = COLOURED ? vec3(phi(own_step.x), phi(own_step.y), phi(own_step.z))
                                  : vec3(phi(own_step.x));
            sum += octave * henyey_greenstein_per_sr(g, view_direction, to_sun()) *
                   fraction_through(depth_part * way) * share;
            octave *= frame.media[m].octave_contribution;
            depth_part *= frame.media[m].octave_attenuation;
            g *= frame.media[m].octave_eccentricity;
        }
    }
    return sun_at(point_m) * sum / max(mixture.extinction_per_m, LEAST) * step_depth;
}

// --- horizon --------------------------------------------------------------------------------

float remap(float x, float a, float b, float c, float d) { return c + (x - a) * (d - c) / (b - a); }

// Beer's law with twice the density, not below 0.7 e^-0.5.
float horizon_beer(float density_to_sun)
{
    return max(exp(-2.0 * density_to_sun), 0.7 * exp(-0.5));
}

// The article's phase term: not normalized.
float horizon_phase()
{
    float towards_sun = max(dot(view_direction, to_sun()), 0.0);
    float forward = max(henyey_greenstein_per_sr(0.5, view_direction, to_sun()),
                        towards_sun * towards_sun);
    return mix(forward, henyey_greenstein_per_sr(-0.1, view_direction, to_sun()), 0.5);
}

// In-scatter probability. Below a relative height of 0.0622 the article raises a negative number to
// the power 0.8. On its GPU the result was the floor of horizon_light(); here it is 0, with the
// same effect.
float horizon_inscatter(HorizonSample cloud)
{
    float depth = pow(cloud.without_detail, remap(cloud.height, 0.3, 0.85, 0.5, 1.3)) + 0.05;
    return depth * pow(max(remap(cloud.height, 0.07, 0.14, 0.1, 1.0), 0.0), 0.8);
}

// Sum of the densities at two points towards the sun. The first is the point itself; the spacing is
// 1/40 of the view ray's way through the layer.
float horizon_density_to_sun(Horizon horizon, vec3 point_m, float density)
{
    float t0_m = 0.0, t1_m = FAR_M;
    globe_hull(horizon.globe, view_origin_m, view_direction, 0.0, horizon.thickness_m, t0_m, t1_m);
    vec3 next_m = point_m + 0.025 * max(t1_m - t0_m, 0.0) * to_sun();
    density_evaluations++;
    return density + horizon_density(horizon, next_m);
}

// Radiance per metre before the view's extinction. The article adds one such term per step, with a
// step of optical depth `density`. Here 1 / extinction_per_m takes the place of that step, so the
// march may have any other. The article's light has no unit; here 1 is a white surface in full sun.
//
// Faithful to the article otherwise: the floor, the lobe that is no phase function, light at points
// of the layer without density, and in view_scattered() (march.glsl) the multiplication of the sum
// with the layer's opacity, which attenuates the light a second time.
vec3 horizon_light(vec3 point_m)
{
    vec3 light = vec3(0.0);
    [[unroll]] for (uint m = 0; m < media_count(); m++) {
        Horizon horizon = frame.media[m].shape.horizon;
        if (!medium_contains(m, point_m))
            continue;
        HorizonSample cloud = horizon_sample(horizon, point_m);
        float to_sun = horizon_density_to_sun(horizon, point_m, cloud.density);
        float lit = max(0.4 * cloud.density,
                        horizon_beer(to_sun) * horizon_phase() * horizon_inscatter(cloud));
        light += lit * frame.media[m].extinction_per_m;
    }
    return frame.sun_irradiance / PI * light;
}

#endif
