#version 450
// SPDX-License-Identifier: MIT
//
// Fixed-step ray marching at full resolution, the baseline of every volumetric renderer:
//
//   L = sum_i T_i J_i (1 - e^-dtau_i) + T background,     T_i = e^-(dtau_0 + .. + dtau_(i-1))
//
// over `steps` equal steps. J is the source function (in-scattered sunlight per unit of optical
// depth, W m^-2 sr^-1), taken at the middle of the step and constant along it; its integral over
// the step against the extinction within the step is exact. (Hillaire, "Physically Based and
// Unified Volumetric Rendering in Frostbite", SIGGRAPH 2015: S (1 - e^(-sigma dt)) / sigma.)
// The error is of second order in the step where the medium is smooth.
//
// One thread is one pixel. A dispatch is a run of pixels in raster order and a run of their steps,
// short enough for drivers that limit loops (renderer/compute.h) and for Ctrl-C in between; the
// state of a march that is not at its end waits in a buffer.
#extension GL_GOOGLE_include_directive : require

#include "march_light.glsl"

layout(local_size_x = 64) in;

layout(push_constant) uniform Run {
    uint first_pixel;
    uint pixel_count;
    uint first_step;
    uint end_step;
} run;

struct Pixel {
    vec3 radiance; // with everything
    float eye_depth_m; // FAR_M for the sky
    vec3 volume; // in-scattered alone
    uint density_evaluations;
    vec3 transmittance;
    uint closed_forms;
};

layout(std430, binding = 5) writeonly buffer Pixels {
    Pixel pixels[];
};

// What a march has come to: in-scattered radiance (xyz of `scattered`) and optical depth (its w when
// that is the same in all channels, else xyz of `depth`).
struct Sums {
    Sum scattered, depth;
};

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

struct State {
    Sums sums;
    uint density_evaluations;
    uint closed_forms;
    uvec2 padding;
};

layout(std430, binding = 6) buffer States {
    State states[];
};

// What a step adds at its near end, by the chosen model.
vec3 step_light(Mixture mixture, vec3 middle_m, float step_m, vec3 step_depth)
{
    if (LIGHTING == HORIZON)
        return horizon_light(middle_m) * step_m *
               vec3(phi(step_depth.x), phi(step_depth.y), phi(step_depth.z));
    return source_function(mixture, middle_m) * fraction_lost(step_depth);
}

// March the steps of this run along a view ray of some length, onto the sums.
//
// The transmittance to a step is always that of the steps before it, never an independent closed
// form of the whole distance: adjacent closed forms add up to it anyway, and so the weights of the
// source function telescope to 1 - T in both modes.
void march(vec3 direction, float length_m, inout Sums sums)
{
    Stretch stretch = scene_stretch(vec3(0.0), direction, length_m);
    if (stretch.t1_m <= stretch.t0_m)
        return;
    look_along(direction);
    float step_m = (stretch.t1_m - stretch.t0_m) / float(frame.steps);
    for (uint i = run.first_step; i < run.end_step; i++) {
        vec3 start_m = (stretch.t0_m + float(i) * step_m) * direction;
        vec3 middle_m = (stretch.t0_m + (float(i) + 0.5) * step_m) * direction;
        Mixture mixture = mixture_at(middle_m);
        vec3 step_depth = mixture.marched_per_m * step_m;
        if (TRANSMITTANCE == EXACT)
            step_depth += exact_optical_depth(start_m, direction, step_m);
        vec3 scattered = vec3(0.0);
        if (frame.scatters != 0)
            scattered = step_light(mixture, middle_m, step_m, step_depth) *
                        fraction_through(marched_depth(sums));
        sums_add(sums, scattered, step_depth);
    }
}

// Sunlight reflected by a Lambertian surface, towards anywhere.
vec3 surface_radiance(Hit hit, vec3 point_m)
{
    vec3 albedo = solids[hit.solid].albedo.rgb;
    float cosine = dot(solid_normal(solids[hit.solid], point_m), frame.sun_direction);
    if (cosine <= 0.0 || albedo == vec3(0.0) || frame.sun_irradiance == vec3(0.0))
        return vec3(0.0);
    return albedo / PI * cosine * sunlight(point_m, hit.solid);
}

Pixel finished_pixel(vec3 direction, Hit hit, Sums sums)
{
    vec3 optical_depth = IS_SOLVED ? exact_optical_depth(vec3(0.0), direction, hit.t_m)
                                   : marched_depth(sums);
    vec3 behind = hit.solid == NO_SOLID ? frame.background
                                        : surface_radiance(hit, hit.t_m * direction);
    Pixel pixel;
    pixel.volume = sums.scattered.value.xyz;
    pixel.transmittance = fraction_through(optical_depth);
    if (LIGHTING == HORIZON)
        pixel.volume *= fraction_lost(optical_depth);
    pixel.radiance = pixel.volume + pixel.transmittance * behind;
    pixel.eye_depth_m =
        hit.solid == NO_SOLID ? FAR_M : hit.t_m * dot(direction, frame.camera_forward);
    pixel.density_evaluations = density_evaluations;
    pixel.closed_forms = closed_forms;
    return pixel;
}

void main()
{
    uint thread = gl_GlobalInvocationID.x;
    if (thread >= run.pixel_count)
        return;
    uint pixel = run.first_pixel + thread;
    vec3 direction = camera_ray(pixel % frame.width_px, pixel / frame.width_px);
    Hit hit = scene_hit(vec3(0.0), direction);

    Sums sums = Sums(sum_zero(), sum_zero());
    if (run.first_step > 0) {
        sums = states[thread].sums;
        density_evaluations = states[thread].density_evaluations;
        closed_forms = states[thread].closed_forms;
    }
    // With a closed-form transmittance and no scattering there is nothing to march for.
    if (!IS_SOLVED || frame.scatters != 0)
        march(direction, hit.t_m, sums);

    if (run.end_step < frame.steps)
        states[thread] = State(sums, density_evaluations, closed_forms, uvec2(0));
    else
        pixels[thread] = finished_pixel(direction, hit, sums);
}
