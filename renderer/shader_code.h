/* SPDX-License-Identifier: MIT
 *
 * A shader as "shaders/NAME.comp.inc" holds it (renderer/pack_shader.py): not inlined, its
 * functions in SSA form, its specialization constants open, and packed. Not for other folders.
 */
#ifndef NEPH_RENDERER_SHADER_CODE_H
#define NEPH_RENDERER_SHADER_CODE_H

#include "base/status.h"

#include <stddef.h>
#include <stdint.h>

/* The bits of a specialization constant that the shader reads; 0: it does not have the constant. */
uint32_t neph_shader_constant_bits(const uint32_t *code, int constant);

/* Its SPIR-V. For the caller to free. NEPH_ERR_INTERNAL: `code` is not what pack_shader.py
 * writes. */
enum neph_status neph_shader_unpack(const uint32_t *code, size_t code_bytes, uint32_t **words,
                                    size_t *size_bytes, struct neph_diag *diag);

#endif
