/* SPDX-License-Identifier: MIT
 *
 * A check for values that lavapipe loses: computed in a loop iteration, not carried by a phi, and
 * used after the loop. Threads of a subgroup leave a loop at different iterations. lavapipe (Mesa
 * 22.3.6; llvmpipe inserts no phis at loop exits) keeps executing threads that have left. For these
 * it preserves values carried from iteration to iteration, but recomputes all others from their
 * later inputs, and reads of storage buffers return 0. So
 *
 *     do value = read[i++]; while (value < limit);
 *
 * leaves 0 in all threads except the last. Loops whose exit is uniform (a subgroup vote) lose
 * nothing. docs/devices.md has the replacement to write.
 */
#ifndef NEPH_RENDERER_SPIRV_LOOPS_H
#define NEPH_RENDERER_SPIRV_LOOPS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Ids of the module; 0: none. */
struct neph_spirv_lost {
    uint32_t value, header; /* the value used after the loop; the label of its loop */
};

/* Find the first such value of a valid module that spirv-opt has optimised (-O). Without it values
 * are in variables, and nothing is found. May report a value that is not lost, but misses none.
 * False: no memory. */
bool neph_spirv_find_lost(const uint32_t *words, size_t size_bytes, struct neph_spirv_lost *lost);

#endif
