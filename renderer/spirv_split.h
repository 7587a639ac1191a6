/* SPDX-License-Identifier: MIT
 *
 * Loops as a validation layer of 2023 can add checks to them. It divides a block at each access to
 * memory that it checks. Where that block is the header of a loop, the loop's back edge still goes
 * to the header's label, which is then a block without OpLoopMerge: that is invalid SPIR-V, and
 * drivers refuse it (docs/devices.md).
 */
#ifndef NEPH_RENDERER_SPIRV_SPLIT_H
#define NEPH_RENDERER_SPIRV_SPLIT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A module of the same meaning, in which the header of a loop has only its phis: everything else of
 * it is in a block of its own, and a loop of one block gets a third one for its back edge. `words`
 * is a valid module; `*split` is for the caller to free. False: no memory. */
bool neph_spirv_split_loops(const uint32_t *words, size_t size_bytes, uint32_t **split,
                            size_t *split_bytes);

#endif
