/* SPDX-License-Identifier: MIT
 *
 * A shader with its specialization constants built in, and without what they leave unused. A driver
 * does the same, but only after it has translated the whole, of which most is for other media and
 * other techniques; and so it does at each start.
 */
#ifndef NEPH_RENDERER_SPECIALIZE_H
#define NEPH_RENDERER_SPECIALIZE_H

#include "base/status.h"

#include <stddef.h>
#include <stdint.h>

/* SPIR-V of the same meaning as `words` with specialization constants 0 .. count-1 of these 32
 * bits, and no OpSpecConstant left; constants from `count` on have the shader's own value. `words`
 * is valid and of GLSL. Only what decides nothing goes: floating-point arithmetic stays as it is.
 * For the caller to free. NEPH_ERR_MEMORY only. */
enum neph_status neph_specialize(const uint32_t *words, size_t size_bytes,
                                 const uint32_t *constants, int count, uint32_t **specialized,
                                 size_t *specialized_bytes, struct neph_diag *diag);

#endif
