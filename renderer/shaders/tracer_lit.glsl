// SPDX-License-Identifier: MIT
//
// The distribution of first collisions by the light that they scatter (CPU version:
// truth/lit_flight.h), per fog layer or other medium, over its own optical depth x.
//
// Against the light, free flights end near the camera, but the light comes from the far side:
//
//   density of      ^ \  free flight             light  /
//   collisions      |  \___                         ___/
//                   |      \________       ________/
//                   +------------------------------------> x
//                 camera                              far side
//
// The density is a mixture of the light itself, log-linear between edges of a table; free flight,
// which bounds the weights; and a uniform part, which finds light that starts between two edges.
#ifndef NEPH_TRACER_LIT_GLSL
#define NEPH_TRACER_LIT_GLSL

#include "tracer_way.glsl"

// Shares of the mixture. With light from all directions or emission, half of the collisions are
// free flights, which suit it. Guesses (OPEN) get a smaller share of light. If MEDIA_DIFFER, the
// other share is divided evenly among media, and must suffice for light that only one medium has.
const bool AMBIENT = ENVIRONMENT || EMITS || MEDIA_DIFFER;
const float LIT_SHARE = AMBIENT ? 0.45 : OPEN ? 0.8 : 0.9;
const float FREE_SHARE = AMBIENT ? 0.5 : OPEN ? 0.1 : 0.05; // the remaining share is uniform in x

const uint LIT_EDGES = NEPH_GPU_LIT_EDGES;

// Light of a pixel and one layer of a medium; if OPEN, of a pixel and all its media.
struct LitTable {
    float x[LIT_EDGES];
    float log_light[LIT_EDGES]; // relative to the brightest edge
    float below[LIT_EDGES];     // fraction of the light before each edge
    float log_whole;            // log of the whole light
};

layout(std430, binding = 12) buffer Lits {
    LitTable lits[];
};

const float DARK = -1e4; // logarithm that stands for no light

uint lit_table(uint pixel, uint m, uint l)
{
    return (pixel * frame.medium_count + m) * LAYERS + l;
}

// Light of a cell: the integral of a log-linear function.
float cell_light(float width, float log_a, float log_b)
{
    return width * exp(max(max(log_a, log_b), EXPONENT_MIN)) * phi(abs(log_b - log_a));
}

// Normalizes a table. Without light its density is uniform.
void lit_complete(uint table, float x[LIT_EDGES], float log_light[LIT_EDGES])
{
    float most = DARK, sum = 0.0;
    for (uint i = 0; i < LIT_EDGES; i++)
        most = max(most, log_light[i]);
    bool is_dark = most <= DARK;
    for (uint i = 0; i < LIT_EDGES; i++)
        log_light[i] = is_dark ? 0.0 : max(log_light[i] - most, EXPONENT_MIN);
    for (uint i = 0; i < LIT_EDGES; i++) {
        lits[table].x[i] = x[i];
        lits[table].log_light[i] = log_light[i];
        lits[table].below[i] = sum;
        if (i + 1u < LIT_EDGES)
            sum += cell_light(x[i + 1u] - x[i], log_light[i], log_light[i + 1u]);
    }
    for (uint i = 0; i < LIT_EDGES; i++)
        lits[table].below[i] /= max(sum, 1e-30);
    lits[table].log_whole = most + log(max(sum, 1e-30));
}

// --- sampling -----------------------------------------------------------------------------------

// A table; the probabilities that it is chosen by light and otherwise; and the mean over channels
// of the extinction for x = 1.
struct LitChoice {
    uint table;
    float lit_chance, other_chance;
    float mean_color;
};

struct LitPlace {
    float x;
    float density; // probability density, with the choice of the table
};

// Probability that a place is before x and not chosen by light.
float other_below(LitChoice choice, float x, float last)
{
    const float free = FREE_SHARE / (1.0 - LIT_SHARE);
    float flown =
        absorbed_fraction(choice.mean_color * x) / absorbed_fraction(choice.mean_color * last);
    return choice.other_chance * mix(x / last, flown, free);
}

// The place in 0..1 at which the integral of e^(slope x) reaches the fraction u.
float exponential_quantile(float slope, float u)
{
    float size = abs(slope);
    float from_dense = slope > 0.0 ? 1.0 - u : u;
    float x = from_dense;
    if (size > 1e-3)
        x = -log_1_plus(-min(from_dense * size * phi(size), 1.0 - exp2(-24.0))) / size;
    return slope > 0.0 ? 1.0 - x : x;
}

LitPlace lit_place(LitChoice choice, float u)
{
    uint table = choice.table;
    float last = lits[table].x[LIT_EDGES - 1u];
    float target = u * (choice.lit_chance + choice.other_chance);
    uint low = 0, high = LIT_EDGES - 1u;
    while (high - low > 1u) {
        uint middle = (low + high) / 2u;
        if (choice.lit_chance * lits[table].below[middle] +
                other_below(choice, lits[table].x[middle], last) <= target)
            low = middle;
        else
            high = middle;
    }
    float x0 = lits[table].x[low], x1 = lits[table].x[high];
    float lit = choice.lit_chance * (lits[table].below[high] - lits[table].below[low]);
    float other_before = other_below(choice, x0, last);
    float other = max(other_below(choice, x1, last) - other_before, 1e-30);
    float a = lits[table].log_light[low], b = lits[table].log_light[high];
    target = max(target - choice.lit_chance * lits[table].below[low] - other_before, 0.0);
    float place = target < lit ? exponential_quantile(b - a, target / lit)
                               : min((target - lit) / other, 1.0);
    float shape = exp(max(mix(a, b, place) - max(a, b), EXPONENT_MIN)) / phi(abs(b - a));
    // Never at the end: an unbounded fog is FAR_M away there, and its sunlight has no digits.
    float inside = last * (1.0 - exp2(-20.0));
    return LitPlace(min(mix(x0, x1, place), inside), (lit * shape + other) / (x1 - x0));
}

#endif
