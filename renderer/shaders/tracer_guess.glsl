// SPDX-License-Identifier: MIT
//
// Where on the view ray sunlight is scattered once, if OPEN: what truth/guess.h says. The
// distribution of tracer_lit.glsl is made from a guess of the optical depths, which only says where
// to look: densities at the places are exact, and the path estimates transmittances without bias.
#ifndef NEPH_TRACER_GUESS_GLSL
#define NEPH_TRACER_GUESS_GLSL

#include "tracer_lit.glsl"

// Densities are looked up at so many places of each cell of the table.
const uint GUESS_PLACES = 6;
const uint GUESS_STRETCHES = GUESS_PLACES * (LIT_EDGES - 1u);

// The guess of a pixel, whose table of light has the same number.
struct Guess {
    float t0_m, stretch_m; // where the first stretch begins; length of each
    uint is_known;         // 0: free flights are as good
    // Guessed optical depths, mean of the channels: from the camera to each stretch, and from the
    // edges of the cells to the sun.
    float depth[GUESS_STRETCHES + 1u];
    float sun_depth[LIT_EDGES];
    // If MEDIA_DIFFER `depth` holds no optical depths but what places are drawn by: extinction times
    // the weight of its medium. The optical depths from the camera are here.
    float weight[MEDIA_MAX];
    float view_depth[LIT_EDGES];
};

layout(std430, binding = 13) buffer Guesses {
    Guess guesses[];
};

// The stretch that a depth lies in.
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

// What places in a medium are drawn by.
float drawn_per_m(uint pixel, uint m, vec3 point_m)
{
    float weight = MEDIA_DIFFER ? guesses[pixel].weight[m] : 1.0;
    float color = mean_of(frame.media[m].extinction_color);
    return weight > 0.0 ? weight * color * medium_extinction_per_m(m, point_m) : 0.0;
}

float total_per_m(uint pixel, vec3 point_m)
{
    if (!MEDIA_DIFFER)
        return mean_of(scene_extinction_per_m(KINDS, point_m));
    float sum_per_m = 0.0;
    for (uint m = 0; m < media_count(); m++)
        sum_per_m += drawn_per_m(pixel, m, point_m);
    return sum_per_m;
}

// By its share of `all_per_m`; MEDIA_MAX: there is none.
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

// u.x decides on the place, u.y on the medium.
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
    first.weight = color / mean_of(color) * (all_per_m * stretch_m / (place.density * own));
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
