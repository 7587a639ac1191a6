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

#if RT_NUMBER_COUNT > 160
#error "more constants, please"
#endif

// A hexadecimal digit for each number of the view, eight to a constant, the lowest first: the choice, or
// whether the number is other than 0; of taa_jitter_length itself, up to 15.
layout(constant_id = 8) const uint DIGITS_0 = 0;
layout(constant_id = 9) const uint DIGITS_1 = 0;
layout(constant_id = 10) const uint DIGITS_2 = 0;
layout(constant_id = 11) const uint DIGITS_3 = 0;
layout(constant_id = 12) const uint DIGITS_4 = 0;
layout(constant_id = 13) const uint DIGITS_5 = 0;
layout(constant_id = 14) const uint DIGITS_6 = 0;
layout(constant_id = 15) const uint DIGITS_7 = 0;
layout(constant_id = 16) const uint DIGITS_8 = 0;
layout(constant_id = 17) const uint DIGITS_9 = 0;
layout(constant_id = 18) const uint DIGITS_10 = 0;
layout(constant_id = 19) const uint DIGITS_11 = 0;
layout(constant_id = 20) const uint DIGITS_12 = 0;
layout(constant_id = 21) const uint DIGITS_13 = 0;
layout(constant_id = 22) const uint DIGITS_14 = 0;
layout(constant_id = 23) const uint DIGITS_15 = 0;
layout(constant_id = 24) const uint DIGITS_16 = 0;
layout(constant_id = 25) const uint DIGITS_17 = 0;
layout(constant_id = 26) const uint DIGITS_18 = 0;
layout(constant_id = 27) const uint DIGITS_19 = 0;

// The constant of a setting whose index is one, and its digit: numbers that are known before any
// function is inlined, so that what they rule out never is.
#define DIGITS_OF(s)                                                                               \
    ((s) >> 3 == 0 ? DIGITS_0 : (s) >> 3 == 1 ? DIGITS_1 : (s) >> 3 == 2 ? DIGITS_2 :              \
     (s) >> 3 == 3 ? DIGITS_3 : (s) >> 3 == 4 ? DIGITS_4 : (s) >> 3 == 5 ? DIGITS_5 :              \
     (s) >> 3 == 6 ? DIGITS_6 : (s) >> 3 == 7 ? DIGITS_7 : (s) >> 3 == 8 ? DIGITS_8 :              \
     (s) >> 3 == 9 ? DIGITS_9 : (s) >> 3 == 10 ? DIGITS_10 : (s) >> 3 == 11 ? DIGITS_11 :          \
     (s) >> 3 == 12 ? DIGITS_12 : (s) >> 3 == 13 ? DIGITS_13 : (s) >> 3 == 14 ? DIGITS_14 :        \
     (s) >> 3 == 15 ? DIGITS_15 : (s) >> 3 == 16 ? DIGITS_16 : (s) >> 3 == 17 ? DIGITS_17 :        \
     (s) >> 3 == 18 ? DIGITS_18 : DIGITS_19)
#define known_choice(s) int(DIGITS_OF(s) >> (4 * ((s) & 7)) & 15u)

#endif
