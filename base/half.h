/* SPDX-License-Identifier: MIT
 *
 * Half floats (IEEE 754 binary16).
 */
#ifndef NEPH_BASE_HALF_H
#define NEPH_BASE_HALF_H

#include <stdint.h>

/* The value of a half, exactly; infinities and NaN stay what they are. */
float neph_half_to_float(uint16_t half);

#endif
