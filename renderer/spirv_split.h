/* SPDX-License-Identifier: MIT
 *
 * Rewrites loops so that a validation layer of 2023 can add its checks. The layer splits a block at
 * each memory access that it checks. If the block is the header of a loop, the back edge still
 * targets the header's label, whose block has no OpLoopMerge any more. That is invalid SPIR-V, and
 * drivers refuse it (docs/devices.md).
 */
#ifndef NEPH_RENDERER_SPIRV_SPLIT_H
#define NEPH_RENDERER_SPIRV_SPLIT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Make an equivalent module in which a loop header contains only its phis: its other instructions
 * are moved to a block of their own, and a loop of one block gets a third block for its back edge.
 * `words` is a valid module; the caller frees `*split`. False: no memory. */
bool neph_spirv_split_loops(const uint32_t *words, size_t size_bytes, uint32_t **split,
                            size_t *split_bytes);

#endif
