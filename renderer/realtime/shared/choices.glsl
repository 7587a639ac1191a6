// SPDX-License-Identifier: MIT
//
// Choices as constants, together with the information which numbers are 0: they are known before a
// shader is compiled, so that code for other choices costs nothing. On lavapipe that is most of the
// cost, because it executes both sides of every branch.
#ifndef NEPH_REALTIME_CHOICES_GLSL
#define NEPH_REALTIME_CHOICES_GLSL

#include "names.h"

// Whether the choices are constants; else they are read from the view.
layout(constant_id = RT_SPECIALISED_CONSTANT) const bool SPECIALISED = false;

// A hexadecimal digit for each number of the view, eight to a constant, the lowest first. The digit
// is the choice; for a number whether it differs from 0; for taa_jitter_length its value, up to 15.
// DIGITS_OF(s) is the constant with the digit of a constant index s. It is known before functions
// are inlined, so that excluded code is never inlined.
#include "settings/realtime_digits.glsl"
#define known_choice(s) int(DIGITS_OF(s) >> (4 * ((s) & 7)) & 15u)

#endif
