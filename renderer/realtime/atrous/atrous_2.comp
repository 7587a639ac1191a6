#version 450
// SPDX-License-Identifier: MIT
//
// The second, by way of memory that the temporal gradient would need.
#extension GL_GOOGLE_include_directive : require

#define ATROUS_STEP 2
#define INPUT RT_HISTORY_BEFORE
#define OUTPUT RT_KEPT_RAY
#include "atrous.glsl"
