#version 450
// SPDX-License-Identifier: MIT
//
// The second step. Its output uses memory that belongs to the temporal gradient when that is on.
#extension GL_GOOGLE_include_directive : require

#define ATROUS_STEP 2
#define INPUT RT_HISTORY_BEFORE
#define OUTPUT RT_KEPT_RAY
#include "atrous.glsl"
