#version 450
// SPDX-License-Identifier: MIT
//
// The first step of the a-trous filter. The history of the frame before has been read and makes
// room.
#extension GL_GOOGLE_include_directive : require

#define ATROUS_STEP 1
#define INPUT RT_HISTORY
#define OUTPUT RT_HISTORY_BEFORE
#include "atrous.glsl"
