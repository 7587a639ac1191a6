// SPDX-License-Identifier: MIT
//
// Guessed first collisions, if OPEN: the distribution of tracer_lit.glsl from guessed optical
// depths (CPU version: truth/guess.h). The guess only decides where to sample: densities at the
// places are exact, and the path estimates transmittances, so the result is unbiased.
#ifndef NEPH_TRACER_GUESS_GLSL
#define NEPH_TRACER_GUESS_GLSL

#include "tracer_lit.glsl"

// Densities per cell of the table, and the number of segments of a ray.
const uint GUESS_PLACES = 6;
const uint GUESS_STRETCHES = GUESS_PLACES * (LIT_EDGES - 1u);

// The guess of a pixel. Its table of light has the same index.
struct Guess {
    float t0_m, stretch_m; // start of the first segment; length of each
    uint is_known;         // 0: free flights have no higher variance
    // Guessed optical depths, mean of the channels: from the camera to each segment, and from the
    // cells' edges to the sun.
    float depth[GUESS_STRETCHES + 1u];
    float sun_depth[LIT_EDGES];
    // If MEDIA_DIFFER, `depth` is the integral of the weighted extinction, and the optical depths
    // from the camera are here.
    float weight[MEDIA_MAX];
    float view_depth[LIT_EDGES];
};

layout(std430, binding = 13) buffer Guesses {
    Guess guesses[];
};

// The segment that contains a depth.
uint guess_stretch(uint pixel, float depth)
{
    uint low = 0, high = GUESS_STRETCHES;
    while (high - low > 1u) {
        uint middle = (low + high) / 2u;
        if (guesses[pixel].depth[middle] <= depth)
            low = middle;
        else
            high = middle;
    }
    return low;
}

// Extinction for drawing; if MEDIA_DIFFER, times the medium's weight.
float drawn_per_m(uint pixel, uint m, vec3 point_m)
{
    float weight = MEDIA_DIFFER ? guesses[pixel].weight[m] : 1.0;
    float color = average_channels(frame.media[m].extinction_color);
    return weight > 0.0 ? weight * color * medium_extinction_per_m(m, point_m) : 0.0;
}

float total_per_m(uint pixel, vec3 point_m)
{
    if (!MEDIA_DIFFER)
        return average_channels(scene_extinction_per_m(KINDS, point_m));
    float sum_per_m = 0.0;
    for (uint m = 0; m < media_count(); m++)
        sum_per_m += drawn_per_m(pixel, m, point_m);
    return sum_per_m;
}

// Chooses a medium by its part of `all_per_m`; MEDIA_MAX: none.
uint pick_medium(uint pixel, vec3 point_m, float all_per_m, float u)
{
    uint picked = MEDIA_MAX;
    float left_per_m = u * all_per_m;
    for (uint m = 0; m < media_count(); m++) {
        float own_per_m = drawn_per_m(pixel, m, point_m);
        if (own_per_m > 0.0 && left_per_m >= 0.0)
            picked = m;
        left_per_m -= own_per_m;
    }
    return picked;
}

// A guessed first collision: u.x gives the place, u.y the medium.
First guessed_collision(uint pixel, ViewRay ray, vec2 u)
{
    First first = no_first();
    if (guesses[pixel].is_known == 0u) {
        first.medium = MEDIA_MAX;
        return first;
    }
    LitPlace place = lit_place(LitChoice(pixel, LIT_SHARE, 1.0 - LIT_SHARE, 1.0), u.x);
    uint i = guess_stretch(pixel, place.x);
    float start = guesses[pixel].depth[i], own = guesses[pixel].depth[i + 1u] - start;
    float stretches = float(i) + clamp((place.x - start) / own, 0.0, 1.0);
    float stretch_m = guesses[pixel].stretch_m;
    first.t_m = guesses[pixel].t0_m + stretches * stretch_m;
    vec3 point_m = view_point_m(ray, first.t_m);
    float all_per_m = total_per_m(pixel, point_m);
    uint m = pick_medium(pixel, point_m, all_per_m, u.y);
    if (m == MEDIA_MAX)
        return first;
    vec3 color = frame.media[m].extinction_color;
    first.medium = m;
    first.weight = color / average_channels(color) *
                   (all_per_m * stretch_m / (place.density * own));
    first.view_depth = place.x;
    float cells = stretches / float(GUESS_PLACES);
    uint cell = min(uint(cells), LIT_EDGES - 2u);
    first.sun_depth = mix(guesses[pixel].sun_depth[cell], guesses[pixel].sun_depth[cell + 1u],
                          cells - float(cell));
    if (MEDIA_DIFFER) {
        first.weight /= guesses[pixel].weight[m];
        first.view_depth = mix(guesses[pixel].view_depth[cell],
                               guesses[pixel].view_depth[cell + 1u], cells - float(cell));
    }
    return first;
}

#endif
