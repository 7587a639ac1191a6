#version 450
// SPDX-License-Identifier: MIT
//
// The first step of the a-trous filter. Its output overwrites the history of the frame before,
// which is no longer needed.
#extension GL_GOOGLE_include_directive : require

#define ATROUS_STEP 1
#define INPUT RT_HISTORY
#define OUTPUT RT_HISTORY_BEFORE
#include "atrous.glsl"
