// SPDX-License-Identifier: MIT
//
// A point or spot light (scenes/lights.h). A point light has cosines below -1. Positions are
// relative to the camera.
#ifndef NEPH_LAMP_GLSL
#define NEPH_LAMP_GLSL

struct Lamp {
    vec3 position_m;
    float inner_cosine;
    vec3 axis; // unit, away from the light
    float outer_cosine;
    vec3 intensity; // W/sr
    float padding;
};

#endif
