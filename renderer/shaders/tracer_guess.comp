#version 450
// SPDX-License-Identifier: MIT
//
// The path tracer's kernel that prepares guessed first collisions (tracer_guess.glsl), for single
// scattering in scenes with a medium without closed form: optical depths along the pixel's ray and
// to the sun, guessed from a few densities, and the table of light that follows. One thread per
// pixel and edge of its table.
#extension GL_GOOGLE_include_directive : require

#include "tracer_guess.glsl"

layout(local_size_x = 64) in;

// Densities per medium on a ray to the sun.
const uint SUN_PLACES = 12;

// Threshold for the light of free flights, mean square over squared mean; above it, a guess has the
// lower variance.
const float SPREAD_MAX = 4.0;

// Optical depths of the segments in the cell behind each thread's edge.
shared float own_depths[64 * GUESS_PLACES];
shared float sun_depths[64];

// If MEDIA_DIFFER: the optical depth of each bright medium in the cell behind each thread's edge;
// the weight of each medium per pixel; and the weighted depths, which replace `own_depths` for
// drawing.
shared float medium_depths[64 * MEDIA_MAX];
shared float weights[64 / LIT_EDGES * MEDIA_MAX];
shared float drawn[64 * GUESS_PLACES];

// The part of a ray in a medium; tight for media without closed form.
Stretch clip_to_medium(uint m, vec3 origin_m, vec3 direction, float length_m)
{
    Stretch inside = Stretch(0.0, length_m);
    if (!clip_medium(m, origin_m, direction, inside.t0_m, inside.t1_m))
        return Stretch(0.0, 0.0);
    if (is_among(OPEN_KINDS, m))
        shape_narrow(frame.media[m].kind, frame.media[m].shape, origin_m, direction, inside);
    return inside;
}

// Hull of all media on the view ray; empty when there are none, or when it is unbounded.
Stretch find_hull(uint pixel, ViewRay ray)
{
    float length_m = view_length_m(pixel);
    Stretch hull = Stretch(length_m, 0.0);
    for (uint m = 0; m < media_count(); m++) {
        if (MEDIA_DIFFER && !is_bright(m))
            continue;
        Stretch inside = clip_to_medium(m, ray.origin_m, ray.direction, length_m);
        include(hull, inside.t0_m, inside.t1_m);
    }
    return hull.t1_m < 0.5 * FAR_M ? hull : Stretch(0.0, 0.0);
}

float guess_sun_depth(vec3 point_m)
{
    float sum = average_channels(scene_optical_depth(point_m, to_sun(), FAR_M));
    for (uint m = 0; m < media_count(); m++) {
        if (!is_among(OPEN_KINDS, m))
            continue;
        Stretch inside = clip_to_medium(m, point_m, to_sun(), FAR_M);
        float step_m = max(inside.t1_m - inside.t0_m, 0.0) / float(SUN_PLACES);
        float color = average_channels(frame.media[m].extinction_color);
        for (uint i = 0; step_m > 0.0 && i < SUN_PLACES; i++) {
            vec3 at_m = point_m + (inside.t0_m + (float(i) + 0.5) * step_m) * to_sun();
            sum += step_m * color * medium_extinction_per_m(m, at_m);
        }
    }
    return sum;
}

// The depth of a segment for drawing. If MEDIA_DIFFER, smoothed over the neighbours, because a
// medium may start or end anywhere in a segment.
float stretch_depth(uint first, uint i)
{
    uint at = first * GUESS_PLACES + i;
    if (!MEDIA_DIFFER)
        return own_depths[at];
    float before = i > 0u ? drawn[at - 1u] : 0.0;
    float behind = i + 1u < GUESS_STRETCHES ? drawn[at + 1u] : 0.0;
    return 0.5 * drawn[at] + 0.25 * (before + behind);
}

// Cumulative depths. Each segment gets at least 5 % of the mean, so that media between the sampled
// densities are found, too.
void sum_depths(uint pixel, uint first)
{
    float sum = 0.0;
    for (uint i = 0; i < GUESS_STRETCHES; i++)
        sum += stretch_depth(first, i);
    float least = sum > 0.0 ? 0.05 * sum / float(GUESS_STRETCHES) : 1e-6;
    float depth = 0.0;
    guesses[pixel].depth[0] = 0.0;
    for (uint i = 0; i < GUESS_STRETCHES; i++) {
        depth += max(stretch_depth(first, i), least);
        guesses[pixel].depth[i + 1u] = depth;
    }
}

// log of the quantity that SPREAD_MAX bounds.
float log_spread(uint pixel)
{
    float squares[LIT_EDGES], most = DARK, sum = 0.0;
    for (uint i = 0; i < LIT_EDGES; i++) {
        squares[i] = -lits[pixel].x[i] - 2.0 * guesses[pixel].sun_depth[i];
        most = max(most, squares[i]);
    }
    for (uint i = 0; i + 1u < LIT_EDGES; i++)
        sum += cell_light(lits[pixel].x[i + 1u] - lits[pixel].x[i], squares[i] - most,
                          squares[i + 1u] - most);
    float free = absorbed_fraction(lits[pixel].x[LIT_EDGES - 1u]);
    return most + log(max(sum * free, 1e-30)) - 2.0 * lits[pixel].log_whole;
}

void complete(uint pixel, uint first)
{
    float x[LIT_EDGES], log_light[LIT_EDGES];
    for (uint i = 0; i < LIT_EDGES; i++) {
        x[i] = guesses[pixel].depth[i * GUESS_PLACES];
        log_light[i] = -x[i] - sun_depths[first + i];
        guesses[pixel].sun_depth[i] = sun_depths[first + i];
    }
    lit_complete(pixel, x, log_light);
    guesses[pixel].is_known = uint(log_spread(pixel) > log(SPREAD_MAX));
}

// --- if MEDIA_DIFFER ----------------------------------------------------------------------------

vec3 place_m(ViewRay ray, float from_m, float stretch_m, uint place)
{
    return view_point_m(ray, from_m + (float(place) + 0.5) * stretch_m);
}

// Depth of each medium in the thread's cell, which starts at `from_m`.
void sum_media(ViewRay ray, float from_m, float stretch_m, uint thread)
{
    for (uint m = 0; m < media_count(); m++) {
        float sum = 0.0;
        for (uint i = 0; i < GUESS_PLACES && is_bright(m); i++)
            sum += medium_extinction_per_m(m, place_m(ray, from_m, stretch_m, i));
        medium_depths[thread * MEDIA_MAX + m] =
            sum * stretch_m * average_channels(frame.media[m].extinction_color);
    }
}

uint medium_weight_index(uint thread, uint m) { return thread / LIT_EDGES * MEDIA_MAX + m; }

// Weights of the media: half of the samples are shared out evenly to bright media, half by their
// light. The weighted depth of the whole ray is 1.
void weigh_media(uint first)
{
    float depth_of[MEDIA_MAX], sent_of[MEDIA_MAX], sent = 0.0, count = 0.0;
    for (uint m = 0; m < media_count(); m++) {
        Source source = make_source(m);
        depth_of[m] = 0.0;
        for (uint i = 0; i + 1u < LIT_EDGES; i++)
            depth_of[m] += medium_depths[(first + i) * MEDIA_MAX + m];
        sent_of[m] = average_channels(source.sun + source.ambient);
        sent += sent_of[m] * depth_of[m];
        count += float(depth_of[m] > 0.0);
    }
    for (uint m = 0; m < media_count(); m++) {
        float even = depth_of[m] > 0.0 ? 0.5 / (count * depth_of[m]) : 0.0;
        weights[medium_weight_index(first, m)] = sent > 0.0 ? 0.5 * sent_of[m] / sent + even : 0.0;
    }
}

float weighed_per_m(uint thread, vec3 point_m)
{
    float sum_per_m = 0.0;
    for (uint m = 0; m < media_count(); m++) {
        float weight = weights[medium_weight_index(thread, m)] *
                       average_channels(frame.media[m].extinction_color);
        if (weight > 0.0)
            sum_per_m += weight * medium_extinction_per_m(m, point_m);
    }
    return sum_per_m;
}

// log of the light that the brightest media send from a place.
float log_sent(float sun_depth)
{
    float sun = 0.0, ambient = 0.0;
    for (uint m = 0; m < media_count(); m++) {
        Source source = make_source(m);
        sun = max(sun, average_channels(source.sun));
        ambient = max(ambient, average_channels(source.ambient));
    }
    return ambient > 0.0 ? log(ambient + sun * transmittance(sun_depth)) : -sun_depth;
}

// Whether free flights collide with bright media often enough in all channels that have light
// (truth/majorant_flight.c).
bool has_enough_free_flights(uint pixel, uint first)
{
    const float SUFFICE = 1.0 / 32.0;
    vec3 most = vec3(0.0), met = vec3(0.0);
    for (uint m = 0; m < media_count(); m++) {
        Source source = make_source(m);
        vec3 bright = source.sun + source.ambient;
        float chance = 0.0;
        for (uint i = 0; i + 1u < LIT_EDGES; i++) {
            float a = guesses[pixel].view_depth[i], b = guesses[pixel].view_depth[i + 1u];
            chance += medium_depths[(first + i) * MEDIA_MAX + m] * transmittance(a) * phi(b - a);
        }
        most = max(most, bright);
        met += bright * chance;
    }
    return all(greaterThanEqual(met, SUFFICE * most));
}

void complete_weighed(uint pixel, uint first)
{
    float x[LIT_EDGES], log_light[LIT_EDGES], view_depth = 0.0;
    for (uint i = 0; i < LIT_EDGES; i++) {
        x[i] = guesses[pixel].depth[i * GUESS_PLACES];
        log_light[i] = log_sent(sun_depths[first + i]) - view_depth;
        guesses[pixel].sun_depth[i] = sun_depths[first + i];
        guesses[pixel].view_depth[i] = view_depth;
        for (uint k = 0; k < GUESS_PLACES; k++)
            view_depth += own_depths[(first + i) * GUESS_PLACES + k];
    }
    lit_complete(pixel, x, log_light);
    bool is_any = false;
    for (uint m = 0; m < media_count(); m++) {
        float weight = weights[medium_weight_index(first, m)];
        guesses[pixel].weight[m] = weight;
        is_any = is_any || weight > 0.0;
    }
    guesses[pixel].is_known = uint(is_any && !has_enough_free_flights(pixel, first));
}

void main()
{
    uint edge = gl_GlobalInvocationID.x % LIT_EDGES, pixel = gl_GlobalInvocationID.x / LIT_EDGES;
    bool is_any = pixel < run.pixel_count;
    ViewRay ray = pixel_ray(run.first_pixel + pixel);
    Stretch hull = is_any ? find_hull(pixel, ray) : Stretch(0.0, 0.0);
    float stretch_m = (hull.t1_m - hull.t0_m) / float(GUESS_STRETCHES);
    bool is_seen = stretch_m > 0.0;
    uint thread = gl_LocalInvocationID.x;
    float from = float(edge * GUESS_PLACES);
    if (is_seen)
        sun_depths[thread] = guess_sun_depth(view_point_m(ray, hull.t0_m + from * stretch_m));
    for (uint i = 0; is_seen && i < GUESS_PLACES; i++) {
        vec3 at_m = view_point_m(ray, hull.t0_m + (from + float(i) + 0.5) * stretch_m);
        own_depths[thread * GUESS_PLACES + i] =
            stretch_m * average_channels(scene_extinction_per_m(KINDS, at_m));
    }
    float from_m = hull.t0_m + from * stretch_m;
    if (MEDIA_DIFFER && is_seen)
        sum_media(ray, from_m, stretch_m, thread);
    barrier();
    if (MEDIA_DIFFER && is_seen && edge == 0u)
        weigh_media(thread);
    barrier();
    for (uint i = 0; MEDIA_DIFFER && is_seen && i < GUESS_PLACES; i++)
        drawn[thread * GUESS_PLACES + i] =
            stretch_m * weighed_per_m(thread, place_m(ray, from_m, stretch_m, i));
    barrier();
    if (!is_any || edge != 0u)
        return;
    guesses[pixel].t0_m = hull.t0_m;
    guesses[pixel].stretch_m = stretch_m;
    guesses[pixel].is_known = 0u;
    if (!is_seen)
        return;
    sum_depths(pixel, thread);
    if (MEDIA_DIFFER)
        complete_weighed(pixel, thread);
    else
        complete(pixel, thread);
}
