// SPDX-License-Identifier: MIT
//
// Where on the view ray sunlight is scattered that still has a way to go: what truth/lit_flight.h
// says, for each fog layer or other medium by itself, in optical depths x of it alone. Against the
// light free flights end near the camera, but the light is at the far side.
#ifndef NEPH_TRACER_LIT_GLSL
#define NEPH_TRACER_LIT_GLSL

#include "tracer_way.glsl"

// With light from all around, too, or of the media themselves, half of all collisions are free
// flights, which are good for that. Guesses (OPEN) earn less trust. If MEDIA_DIFFER, what is not
// chosen by light is shared out evenly to the media: it must suffice for a channel of its own.
const bool AMBIENT = ENVIRONMENT || EMITS || MEDIA_DIFFER;
const float LIT_SHARE = AMBIENT ? 0.45 : OPEN ? 0.8 : 0.9;
const float FREE_SHARE = AMBIENT ? 0.5 : OPEN ? 0.1 : 0.05; // the rest is even in x

const uint LIT_EDGES = NEPH_GPU_LIT_EDGES;

// The light of a pixel and one layer of a medium; of a pixel and all its media, if OPEN.
struct LitTable {
    float x[LIT_EDGES];
    float log_light[LIT_EDGES]; // over the brightest's
    float below[LIT_EDGES];     // the part of the light before each edge
    float log_whole;            // of all the light
};

layout(std430, binding = 12) buffer Lits {
    LitTable lits[];
};

const float DARK = -1e4; // for a logarithm of light

uint lit_table(uint pixel, uint m, uint l)
{
    return (pixel * frame.medium_count + m) * LAYERS + l;
}

// The light of a cell: the integral of a log-linear function.
float cell_light(float width, float log_a, float log_b)
{
    return width * exp(max(max(log_a, log_b), EXPONENT_MIN)) * phi(abs(log_b - log_a));
}

// Places are even in tables that have no light.
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

// --- drawing ------------------------------------------------------------------------------------

// A table, the chances that it is chosen for its light and otherwise, and the mean over the
// channels of the extinction that x = 1 has.
struct LitChoice {
    uint table;
    float lit_chance, other_chance;
    float mean_color;
};

struct LitPlace {
    float x;
    float density; // probability density of it, the choice of the table included
};

// The probability that a place lies before x and is chosen otherwise than by light.
float other_below(LitChoice choice, float x, float last)
{
    const float free = FREE_SHARE / (1.0 - LIT_SHARE);
    float flown =
        absorbed_fraction(choice.mean_color * x) / absorbed_fraction(choice.mean_color * last);
    return choice.other_chance * mix(x / last, flown, free);
}

// Where in 0..1 the integral of e^(slope x) reaches the part u of the whole.
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
    // Never at the end: a fog without bounds is FAR_M away there, where its sunlight is lost.
    float inside = last * (1.0 - exp2(-20.0));
    return LitPlace(min(mix(x0, x1, place), inside), (lit * shape + other) / (x1 - x0));
}

#endif
