/* SPDX-License-Identifier: MIT
 *
 * Which values of a module, and which ways through it, its specialization constants decide.
 */
#ifndef NEPH_RENDERER_SPIRV_FOLD_H
#define NEPH_RENDERER_SPIRV_FOLD_H

#include "renderer/spirv.h"

/* Fills is_known and value of the ids, taken and is_reachable of the blocks. Constants from `count`
 * on have the shader's own value. False: no memory. */
bool neph_spirv_fold(struct neph_spirv_module *module, const uint32_t *constants, int count);

/* Whether a block is ever left for another one. Labels of both. */
bool neph_spirv_goes(const struct neph_spirv_module *module, uint32_t from, uint32_t to);

#endif
