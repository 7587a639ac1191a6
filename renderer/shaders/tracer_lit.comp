#version 450
// SPDX-License-Identifier: MIT
//
// The path tracer's kernel before the first collisions, where light is scattered once: the sunlight
// that arrives from places on the view ray, without solids, which only make it less. One thread per
// pixel, fog layer or other medium, and edge of its table.
#extension GL_GOOGLE_include_directive : require

#include "tracer_lit.glsl"
#include "free_path.glsl"

layout(local_size_x = 64) in;

shared float log_light[64];

// Optical depth of the whole way sun - place - camera.
vec3 way(uint m, uint l, vec3 direction, float t_m, float x)
{
    vec3 sum = frame.media[m].extinction_color * x +
               scene_optical_depth(t_m * direction, frame.sun_direction, FAR_M);
    return sum + others_depth(m, l, direction, t_m);
}

float find_log_light(uint pixel, uint m, uint l, uint edge)
{
    float depth = depths[pixel * PARTS + m * LAYERS_MAX + l];
    vec3 color = frame.media[m].extinction_color;
    vec3 direction = pixel_ray(run.first_pixel + pixel);
    float t0_m = 0.0, t1_m = scene_hit(vec3(0.0), direction).t_m;
    if (depth <= 0.0 || color == vec3(0.0) ||
        !clip_medium(m, vec3(0.0), direction, t0_m, t1_m))
        return DARK;
    // Inside: the end may be infinitely far.
    float x = min(lit_edge(edge, lit_last(color, depth)), depth * (1.0 - 1e-5));
    vec3 lost = way(m, l, direction, medium_free_path(m, l, direction, t0_m, t1_m, x), x);
    float least = min(lost.r, min(lost.g, lost.b));
    vec3 light = frame.sun_irradiance * color * colour_transmittance(lost - least);
    float result = log(max(light.r + light.g + light.b, 1e-30)) - least;
    return result > DARK ? result : DARK; // also where it is no number
}

// The table of edges that lie at `first` in the shared array.
void complete(uint table, uint first, float last)
{
    float most = DARK, sum = 0.0;
    for (uint i = 0; i < LIT_EDGES; i++)
        most = max(most, log_light[first + i]);
    for (uint i = 0; i < LIT_EDGES; i++) {
        float a = max(log_light[first + i] - most, EXPONENT_MIN);
        lits[table + i] = a;
        lits[table + LIT_EDGES + i] = sum;
        if (i + 1u == LIT_EDGES)
            break;
        float b = max(log_light[first + i + 1u] - most, EXPONENT_MIN);
        sum += (lit_edge(i + 1u, last) - lit_edge(i, last)) * exp(max(a, b)) * phi(abs(b - a));
    }
    for (uint i = 1; i < LIT_EDGES; i++)
        lits[table + LIT_EDGES + i] /= max(sum, 1e-30);
    lits[table + LIT_EDGES] = most + log(max(sum, 1e-30));
}

void main()
{
    uint edge = gl_GlobalInvocationID.x % LIT_EDGES, number = gl_GlobalInvocationID.x / LIT_EDGES;
    uint l = number % lit_layers(), m = number / lit_layers() % frame.medium_count;
    uint pixel = number / (lit_layers() * frame.medium_count);
    bool is_any = pixel < run.pixel_count;
    bool is_part = is_any && l < layers_of(m);
    log_light[gl_LocalInvocationID.x] = is_part ? find_log_light(pixel, m, l, edge) : DARK;
    barrier();
    if (!is_any || edge != 0)
        return;
    float depth = is_part ? depths[pixel * PARTS + m * LAYERS_MAX + l] : 0.0;
    complete(lit_table(pixel, m, l), gl_LocalInvocationID.x,
             lit_last(frame.media[m].extinction_color, depth));
}
