#version 450
// SPDX-License-Identifier: MIT
//
// The path tracer's kernel that prepares first collisions by light (tracer_lit.glsl): the sunlight
// that arrives at the camera from places on the view ray. Shadows of solids are left out; they only
// reduce light. One thread per pixel, fog layer or other medium, and edge of its table.
#extension GL_GOOGLE_include_directive : require

#include "tracer_lit.glsl"

layout(local_size_x = 64) in;

shared float log_light[64];

// Depth of the last edge: beyond it the light of all channels is below float32.
float lit_last(vec3 color, float depth)
{
    return min(depth, -EXPONENT_MIN / least_positive(color));
}

// Edges of the table: evenly spaced up to a depth of 8. Deeper tables are exponential towards both
// ends, so that the first and last cells are below 1.
float lit_edge(uint i, float last)
{
    float at = float(i) / float(LIT_EDGES - 1u);
    float from_end = 2.0 * min(at, 1.0 - at);
    float stretch = 1.45 * log(max(last / 8.0, 1.0));
    float part = from_end;
    if (stretch > 0.01)
        part = (exp(stretch * from_end) - 1.0) / (exp(stretch) - 1.0);
    return last * (at <= 0.5 ? 0.5 * part : 1.0 - 0.5 * part);
}

// Optical depth of the whole way sun - place - camera.
vec3 way(uint m, uint l, ViewRay ray, float t_m, float x)
{
    vec3 sum = frame.media[m].extinction_color * x +
               scene_optical_depth(view_point_m(ray, t_m), to_sun(), FAR_M);
    return sum + other_media_depth(m, l, ray, t_m);
}

// The first and the last edge are evaluated slightly inside. The faces of a medium are there, and
// along a face a sun ray's side would be decided by the last bit; the last edge may also be at
// infinity.
float lit_inside(uint edge, float last)
{
    const float inside = 1.0 / 64.0; // of a cell
    if (edge == 0u)
        return inside * lit_edge(1u, last);
    if (edge == LIT_EDGES - 1u)
        return last - inside * (last - lit_edge(LIT_EDGES - 2u, last));
    return lit_edge(edge, last);
}

// log of the sum over channels of light after an optical depth.
float log_sum(vec3 light, vec3 lost)
{
    if (light == vec3(0.0))
        return DARK;
    float least = min(lost.r, min(lost.g, lost.b));
    vec3 left = light * colour_transmittance(lost - least);
    return log(max(left.r + left.g + left.b, 1e-30)) - least;
}

// If MEDIA_DIFFER: log of all light that a medium sends, summed over channels.
float log_sent(uint m, uint l, ViewRay ray, float t_m, float x)
{
    Source source = make_source(m);
    vec3 color = frame.media[m].extinction_color;
    float ambient = log_sum(source.ambient * color, color * x + other_media_depth(m, l, ray, t_m));
    float sun = log_sum(source.sun * color, way(m, l, ray, t_m, x));
    float less = max(-abs(ambient - sun), EXPONENT_MIN);
    return max(ambient, sun) + log(1.0 + exp(less));
}

float find_log_light(uint pixel, uint m, uint l, uint edge)
{
    float depth = depths[pixel * PARTS + m * LAYERS_MAX + l];
    vec3 color = frame.media[m].extinction_color;
    ViewRay ray = pixel_ray(run.first_pixel + pixel);
    float t0_m = 0.0, t1_m = view_length_m(pixel);
    if (depth <= 0.0 || color == vec3(0.0) ||
        !clip_medium(m, ray.origin_m, ray.direction, t0_m, t1_m))
        return DARK;
    float x = lit_inside(edge, lit_last(color, depth));
    float t_m = view_free_path_m(pixel, m, l, ray, t0_m, t1_m, x);
    float result = MEDIA_DIFFER ? log_sent(m, l, ray, t_m, x)
                                : log_sum(frame.sun_irradiance * color, way(m, l, ray, t_m, x));
    return result > DARK ? result : DARK; // also for NaN
}

void main()
{
    uint edge = gl_GlobalInvocationID.x % LIT_EDGES, number = gl_GlobalInvocationID.x / LIT_EDGES;
    uint l = number % LAYERS, m = number / LAYERS % frame.medium_count;
    uint pixel = number / (LAYERS * frame.medium_count);
    bool is_any = pixel < run.pixel_count;
    bool is_part = is_any && l < medium_layer_count(m);
    log_light[gl_LocalInvocationID.x] = is_part ? find_log_light(pixel, m, l, edge) : DARK;
    barrier();
    if (!is_any || edge != 0)
        return;
    float depth = is_part ? depths[pixel * PARTS + m * LAYERS_MAX + l] : 0.0;
    float last = lit_last(frame.media[m].extinction_color, depth);
    float x[LIT_EDGES], own[LIT_EDGES];
    for (uint i = 0; i < LIT_EDGES; i++) {
        x[i] = lit_edge(i, last);
        own[i] = log_light[gl_LocalInvocationID.x + i];
    }
    lit_complete(lit_table(pixel, m, l), x, own);
}
