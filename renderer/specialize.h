/* SPDX-License-Identifier: MIT
 *
 * Shader specialization: a shader with its specialization constants built in, by SPIRV-Tools'
 * optimiser. The passes have this order: remove the code that the constants exclude, function by
 * function; inline the remaining code; simplify. Inlining first would multiply the code of all
 * other media and methods. Not for other folders.
 */
#ifndef NEPH_RENDERER_SPECIALIZE_H
#define NEPH_RENDERER_SPECIALIZE_H

#include "base/status.h"

#include <stddef.h>
#include <stdint.h>

/* SPIR-V equivalent to `words` with specialization constants 0 .. count-1 of these 32 bits;
 * constants from `count` on keep the shader's default. Loops are not unrolled. The caller frees
 * `*specialized`. NEPH_ERR_INTERNAL: the optimiser refuses the shader, with its message. From any
 * thread. */
enum neph_status neph_specialize(const uint32_t *words, size_t size_bytes,
                                 const uint32_t *constants, int count, uint32_t **specialized,
                                 size_t *specialized_bytes, struct neph_diag *diag);

/* Other inputs of the result: the optimiser's version and its passes. */
const char *neph_specialize_version(void);

#endif
