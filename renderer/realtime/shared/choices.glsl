// SPDX-License-Identifier: MIT
//
// The settings that are choices, and which numbers are 0, known before a shader is compiled: what
// was not chosen costs nothing. On lavapipe that is most of the cost, because it runs both sides of
// every branch.
#ifndef NEPH_REALTIME_CHOICES_GLSL
#define NEPH_REALTIME_CHOICES_GLSL

#include "names.h"

// Whether the choices are constants; else they are read from the view.
layout(constant_id = RT_SPECIALISED_CONSTANT) const bool SPECIALISED = false;

// A hexadecimal digit for each number of the view, eight to a constant, the lowest first: the
// choice, or whether the number is other than 0; of taa_jitter_length itself, up to 15.
// DIGITS_OF(s) is the constant of a number whose index is one: known before any function is
// inlined, so that excluded code never is.
#include "settings/realtime_digits.glsl"
#define known_choice(s) int(DIGITS_OF(s) >> (4 * ((s) & 7)) & 15u)

#endif
