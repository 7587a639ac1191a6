/* SPDX-License-Identifier: MIT
 *
 * A shader with its specialization constants built in, by SPIRV-Tools' optimiser. The order
 * matters: code that the constants rule out is removed first, function by function; the remaining
 * code is inlined; then it is simplified. Inlined first, it would be larger by all code for other
 * media and other techniques. Not for other folders.
 */
#ifndef NEPH_RENDERER_SPECIALIZE_H
#define NEPH_RENDERER_SPECIALIZE_H

#include "base/status.h"

#include <stddef.h>
#include <stdint.h>

/* SPIR-V of the same meaning as `words` with specialization constants 0 .. count-1 of these 32
 * bits; constants from `count` on have the shader's own value. Loops stay loops. For the caller to
 * free. NEPH_ERR_INTERNAL: the optimiser refuses it, with its words. From any thread. */
enum neph_status neph_specialize(const uint32_t *words, size_t size_bytes,
                                 const uint32_t *constants, int count, uint32_t **specialized,
                                 size_t *specialized_bytes, struct neph_diag *diag);

/* What the result depends on beside the arguments: the optimiser's version and its passes. */
const char *neph_specialize_version(void);

#endif
