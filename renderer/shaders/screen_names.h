// SPDX-License-Identifier: MIT
//
// Names that the shaders of the screen, their twins in C and its table of options have in common:
// this file is both GLSL and C. What a setting means is said once, in renderer/screen/options.c;
// `neph engines screen` prints it.
#ifndef NEPH_SCREEN_NAMES_H
#define NEPH_SCREEN_NAMES_H

// --- settings: index in the table of options --------------------------------------------------

#define SCREEN_AO 0
#define SCREEN_AO_RADIUS_M 1
#define SCREEN_AO_FALLOFF 2
#define SCREEN_AO_DIRECTIONS 3
#define SCREEN_AO_STEPS 4
#define SCREEN_AO_STEP_POWER 5
#define SCREEN_AO_THICKNESS 6
#define SCREEN_AO_SLICES 7
#define SCREEN_AO_NOISE 8
#define SCREEN_AO_BIAS 9
#define SCREEN_AO_BLUR_PX 10
#define SCREEN_AO_POWER 11
#define SCREEN_AO_INTENSITY 12
#define SCREEN_AO_PLACES 13
#define SCREEN_AO_SUM 14
#define SCREEN_TARGETS 15
#define SCREEN_SETTING_COUNT 16

// --- choices ----------------------------------------------------------------------------------

#define SCREEN_AO_OFF 0
#define SCREEN_AO_SSAO 1
#define SCREEN_AO_UNREAL 2
#define SCREEN_AO_GTAO 3

#define SCREEN_SLICES_RAY 0
#define SCREEN_SLICES_AXIS 1

#define SCREEN_PLACES_PIXEL 0
#define SCREEN_PLACES_PLANE 1

#define SCREEN_SUM_RATIO 0
#define SCREEN_SUM_MEAN 1

#define SCREEN_FLOAT32 0
#define SCREEN_FLOAT16 1

// --- targets, a pixel each ----------------------------------------------------------------------

#define SCREEN_DEPTH 0      // linear eye depth [m], always 32 bits; FAR_M for the sky
#define SCREEN_NORMAL 1     // of the surface, in the camera's axes (right, up, forward)
#define SCREEN_BASE 2       // RGB: base colour
#define SCREEN_DIRECT 3     // RGB: radiance towards the camera without any indirect light
#define SCREEN_OPEN 4       // x: share of the hemisphere that is open, by cosine
#define SCREEN_OPEN_SMOOTH 5 // x: after the blur
#define SCREEN_PICTURE 6    // RGB: with everything
#define SCREEN_TARGET_COUNT 7

// Words of a texel where it has four channels, by SCREEN_TARGETS.
#define SCREEN_WORDS_32 4
#define SCREEN_WORDS_16 2

#endif
