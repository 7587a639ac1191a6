#version 450
// SPDX-License-Identifier: MIT
//
// The path tracer's kernel for forced first collisions, one thread per item. Every sample collides
// on the view ray, with a weight equal to the ray's opacity. Collisions are stratified over the
// samples of a batch. Order 1 is the sunlight that they scatter towards the camera, with exact
// transmittance. Emission at the collision is added to the higher orders.
//
// A fog layer or other medium k is chosen in proportion to the light that it would absorb without
// the others, the collision is drawn in it, and the transmittance of the others is a weight:
//
//   L = sum_k integral sigma_k T_k (prod_(j != k) T_j) J dt
//
// The weight is at most the number of layers and media. If LIT, choice and place are drawn by the
// light instead (tracer_lit.glsl). If OPEN, that light is a guess (tracer_guess.glsl), and the
// paths estimate the transmittance.
#extension GL_GOOGLE_include_directive : require

#include "tracer_guess.glsl"
#include "tracer_lamps.glsl"

layout(local_size_x = 64) in;

struct Choice {
    uint medium, layer;
    float depth; // optical depth of the view ray in it, scalar
    float u;     // uniform number, renewed
    vec3 total;  // sum of the absorbed fractions, per channel
};

Choice choose(uint pixel, uint hero, float u)
{
    Choice choice = Choice(0, 0, 0.0, 0.5, vec3(0.0));
    for (uint m = 0; m < media_count(); m++)
        for (uint l = 0; l < medium_layer_count(m); l++)
            choice.total += colour_absorbed_fraction(frame.media[m].extinction_color *
                                                     depths[pixel * PARTS + m * LAYERS_MAX + l]);
    float target = u * choice.total[hero];
    bool is_found = false;
    for (uint m = 0; m < media_count(); m++)
        for (uint l = 0; l < medium_layer_count(m); l++) {
            float depth = depths[pixel * PARTS + m * LAYERS_MAX + l];
            float part = absorbed_fraction(frame.media[m].extinction_color[hero] * depth);
            if (is_found || part <= 0.0)
                continue;
            is_found = target < part;
            choice.medium = m;
            choice.layer = l;
            choice.depth = depth;
            choice.u = clamp(target / part, 1e-9, 1.0 - exp2(-24.0));
            target -= part;
        }
    return choice;
}

First first_collision(uint pixel, ViewRay ray, uint hero, float u)
{
    First first = no_first();
    Choice choice = choose(pixel, hero, u);
    if (choice.total[hero] <= 0.0 || choice.depth <= 0.0)
        return first;
    uint m = choice.medium;
    vec3 color = frame.media[m].extinction_color;
    float t0_m = 0.0, t1_m = view_length_m(pixel);
    if (!clip_medium(m, ray.origin_m, ray.direction, t0_m, t1_m))
        return first;
    float part = absorbed_fraction(color[hero] * choice.depth);
    float depth = min(-log_1_plus(-choice.u * part) / color[hero], choice.depth);
    first.medium = m;
    first.t_m = view_free_path_m(pixel, m, choice.layer, ray, t0_m, t1_m, depth);
    vec3 others = other_media_depth(m, choice.layer, ray, first.t_m);
    first.weight = choice.total * colour_transmittance(others);
    if (COLOURED) { // p = color e^(-color depth) / total; bounded by e^30, more than occurs
        vec3 density = color / max(choice.total, vec3(1e-30)) *
                       exp(min((color[hero] - color) * depth, vec3(30.0)));
        first.channels = density / density[hero];
    }
    return first;
}

// --- by light -----------------------------------------------------------------------------------

// Absorbed fraction of one medium or layer, mean of the channels. If MEDIA_DIFFER: equal for all
// bright media, so that each is sampled.
float mean_absorbed_fraction(uint pixel, uint m, uint l)
{
    if (MEDIA_DIFFER)
        return is_bright(m) && depths[pixel * PARTS + m * LAYERS_MAX + l] > 0.0 ? 1.0 : 0.0;
    vec3 parts = colour_absorbed_fraction(frame.media[m].extinction_color *
                                          depths[pixel * PARTS + m * LAYERS_MAX + l]);
    return average_channels(parts);
}

// The chosen medium or layer.
struct Part {
    uint medium, layer;
    float lit_chance, other_chance; // probabilities that it is chosen, by light and otherwise
    float u;                        // uniform number, renewed
};

// Sums over all media and layers: light (over the brightest one's), and absorbed fractions.
struct Whole {
    float most_log_light;
    float light, absorbed;
};

Whole sum_media_light(uint pixel)
{
    Whole whole = Whole(2.0 * DARK, 0.0, 0.0);
    for (uint m = 0; m < media_count(); m++)
        for (uint l = 0; l < medium_layer_count(m); l++)
            whole.most_log_light =
                max(whole.most_log_light, lits[lit_table(pixel, m, l)].log_whole);
    for (uint m = 0; m < media_count(); m++)
        for (uint l = 0; l < medium_layer_count(m); l++) {
            float log_light = lits[lit_table(pixel, m, l)].log_whole - whole.most_log_light;
            whole.light += exp(max(log_light, EXPONENT_MIN));
            whole.absorbed += mean_absorbed_fraction(pixel, m, l);
        }
    return whole;
}

Part choose_lit(uint pixel, float u)
{
    Whole whole = sum_media_light(pixel);
    Part part = Part(0, 0, 0.0, 0.0, 0.5);
    bool is_found = false;
    for (uint m = 0; m < media_count(); m++)
        for (uint l = 0; l < medium_layer_count(m); l++) {
            float absorbed = mean_absorbed_fraction(pixel, m, l);
            if (is_found || absorbed <= 0.0)
                continue;
            float log_light = lits[lit_table(pixel, m, l)].log_whole - whole.most_log_light;
            part.medium = m;
            part.layer = l;
            part.lit_chance = LIT_SHARE * exp(max(log_light, EXPONENT_MIN)) / whole.light;
            part.other_chance = (1.0 - LIT_SHARE) * absorbed / whole.absorbed;
            float chance = part.lit_chance + part.other_chance;
            is_found = u < chance;
            part.u = clamp(u / chance, 0.0, 1.0 - exp2(-24.0));
            u -= chance;
        }
    return part;
}

First lit_collision(uint pixel, ViewRay ray, float u)
{
    First first = no_first();
    Part part = choose_lit(pixel, u);
    uint m = part.medium;
    vec3 color = frame.media[m].extinction_color;
    float depth = depths[pixel * PARTS + m * LAYERS_MAX + part.layer];
    float t0_m = 0.0, t1_m = view_length_m(pixel);
    if (part.other_chance <= 0.0 || depth <= 0.0 ||
        !clip_medium(m, ray.origin_m, ray.direction, t0_m, t1_m))
        return first;
    LitChoice choice = LitChoice(lit_table(pixel, m, part.layer), part.lit_chance,
                                 part.other_chance, average_channels(color));
    LitPlace place = lit_place(choice, part.u);
    first.medium = m;
    first.t_m = view_free_path_m(pixel, m, part.layer, ray, t0_m, t1_m, place.x);
    vec3 way = color * place.x + other_media_depth(m, part.layer, ray, first.t_m);
    first.weight = color * colour_transmittance(way) / place.density;
    return first;
}

// Order 1: sunlight scattered at a first collision.
vec3 scattered_once(First first, ViewRay ray)
{
    vec3 point_m = view_point_m(ray, first.t_m);
    if (first.weight == vec3(0.0) || frame.sun_irradiance == vec3(0.0) ||
        !sees_sun(point_m, NO_SOLID))
        return vec3(0.0);
    uint m = first.medium;
    vec3 phase = phase_rgb_per_sr(frame.media[m].phase_kind, frame.media[m].g, ray.direction,
                                  to_sun());
    vec3 arriving = colour_transmittance(scene_optical_depth(point_m, to_sun(), FAR_M));
    return first.weight * channel_weights(first.channels) * frame.media[m].albedo *
           frame.sun_irradiance * (phase * arriving);
}

// Lamp light scattered once on the view ray, at a place of its own.
vec3 lamplight_scattered_once(uint pixel, ViewRay ray, uint sample_index, float stratified_u)
{
    uvec4 key = sample_key(run.first_pixel + pixel, run.first_sample + sample_index);
    vec2 u = vec2(uniform_from(pcg4d(key.wzyx).xyz).x, stratified_u);
    LampPlace place = draw_lamp_place(ray.origin_m, ray.direction,
                                      view_length_m(pixel), u, run.first_pixel + pixel);
    if (place.density_per_m <= 0.0)
        return vec3(0.0);
    vec3 point_m = view_point_m(ray, place.t_m);
    vec3 light = lamplight_at(place, point_m, ray.direction);
    if (light == vec3(0.0))
        return vec3(0.0);
    vec3 depth = scene_optical_depth(ray.origin_m, ray.direction, place.t_m) +
                 scene_optical_depth(point_m, place.to_lamp, place.distance_m);
    return light * colour_transmittance(depth);
}

// Emission at a first collision.
vec3 emitted(First first)
{
    if (!EMITS || first.weight == vec3(0.0))
        return vec3(0.0);
    return first.weight * channel_weights(first.channels) * frame.media[first.medium].glow;
}

void main()
{
    uint item = gl_GlobalInvocationID.x;
    uint pixel = item / run.samples;
    if (pixel >= run.pixel_count)
        return;
    uint sample_index = item % run.samples;
    ViewRay ray = pixel_ray(run.first_pixel + pixel);
    uvec3 bits = pcg3d(sample_key(run.first_pixel + pixel, run.first_sample + sample_index).xyz);
    float u = (float(sample_index % BATCH_SAMPLES / 2) + uniform_from(bits).x) / float(STRATA);
    if (SOBOL) {
        uvec2 pair = low_discrepancy(run.first_pixel + pixel, run.first_sample + sample_index,
                                     PAIR_PLACE);
        bits.y = pair.y;
        u = uniform_from(pair.xxx).x;
    }
    if (GUESSED) {
        firsts[item] = guessed_collision(pixel, ray, vec2(u, uniform_from(bits).y));
        return;
    }
    First first = LIT ? lit_collision(pixel, ray, u)
                      : first_collision(pixel, ray, choose_hero(bits), u);
    firsts[item] = first;
    vec3 order1 = FIRST_BY_PATH ? vec3(0.0) : scattered_once(first, ray);
    if (LAMPS && make_nonuniform(frame.scatters_lamps) != 0u)
        order1 += lamplight_scattered_once(pixel, ray, sample_index, u);
    results[item] = Result(vec4(order1, 0.0), vec4(emitted(first), 0.0), vec4(0.0));
    check_loops();
}
