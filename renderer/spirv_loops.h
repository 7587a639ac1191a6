/* SPDX-License-Identifier: MIT
 *
 * What a turn of a loop makes and nobody carries on, but is asked for after the loop. Threads of a
 * subgroup leave a loop one after the other, and lavapipe (Mesa 22.3.6, whose llvmpipe does not
 * close its loops: it has no phis where they are left) lets those that have left go along with the
 * rest: what is carried from turn to turn is kept for them, all else is computed anew, from what
 * they hold by then, and what is read from a storage buffer is 0. So
 *
 *     do value = read[i++]; while (value < limit);
 *
 * leaves 0 in all threads but the last. A loop that is left by a vote of the subgroup alone loses
 * nothing. docs/devices.md tells what to write in its place.
 */
#ifndef NEPH_RENDERER_SPIRV_LOOPS_H
#define NEPH_RENDERER_SPIRV_LOOPS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Ids of the module; 0: there is none. */
struct neph_spirv_lost {
    uint32_t value, header; /* what is asked for, and the label of the loop that makes it */
};

/* The first such value of a valid module of one that spirv-opt has made (-O): without it values are
 * kept in variables, and nothing is found. Errs on the side of finding one. False: no memory. */
bool neph_spirv_find_lost(const uint32_t *words, size_t size_bytes, struct neph_spirv_lost *lost);

#endif
