/* SPDX-License-Identifier: MIT
 *
 * A shader in the form of "shaders/NAME.comp.inc" (renderer/pack_shader.py): not inlined, functions
 * in SSA form, specialization constants open, packed. Not for other folders.
 */
#ifndef NEPH_RENDERER_SHADER_CODE_H
#define NEPH_RENDERER_SHADER_CODE_H

#include "base/status.h"

#include <stddef.h>
#include <stdint.h>

/* The bits of a specialization constant that the shader reads; 0: it does not have the constant. */
uint32_t neph_shader_constant_bits(const uint32_t *code, int constant);

/* Its SPIR-V. The caller frees `*words`. NEPH_ERR_INTERNAL: `code` was not written by
 * pack_shader.py. */
enum neph_status neph_shader_unpack(const uint32_t *code, size_t code_bytes, uint32_t **words,
                                    size_t *size_bytes, struct neph_diag *diag);

#endif
