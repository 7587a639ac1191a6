// SPDX-License-Identifier: MIT
//
// Where on the view ray sunlight is scattered that still has a way to go: what truth/lit_flight.h
// says, for each fog layer or other medium by itself, in optical depths x of it alone. Against the
// light free flights end near the camera, but the light is at the far side.
#ifndef NEPH_TRACER_LIT_GLSL
#define NEPH_TRACER_LIT_GLSL

#include "tracer.glsl"

// Light is scattered once, and the sun shines. With light from all around, too, half of all
// collisions are free flights, which are good for that.
layout(constant_id = 11) const bool LIT = false;
const float LIT_SHARE = ENVIRONMENT ? 0.45 : 0.9;
const float FREE_SHARE = ENVIRONMENT ? 0.5 : 0.05; // the rest is even in x

const uint LIT_EDGES = 16; // NEPH_TRACER_LIT_EDGES

// Per pixel, medium and layer: logarithms of the light at the edges, over the brightest's; then the
// part of the light before each edge, but in the place of the first, which is 0, the logarithm of
// the whole.
layout(std430, binding = 12) buffer Lits {
    float lits[];
};

const float DARK = -1e4; // for a logarithm of light

uint lit_layers() { return has_kind(MEDIUM_HEIGHT_FOG) ? LAYERS_MAX : 1u; }

uint lit_table(uint pixel, uint m, uint l)
{
    return 2u * LIT_EDGES * ((pixel * frame.medium_count + m) * lit_layers() + l);
}

// Behind this no channel's light leaves float32.
float lit_last(vec3 color, float depth)
{
    return min(depth, -EXPONENT_MIN / least_positive(color));
}

// Two ladders back to back: even up to a depth of 8, exponential beyond, so that the first and last
// cells stay below 1.
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

#endif
