/* SPDX-License-Identifier: MIT
 *
 * Floats as text for a page that opens from disk, exact to the bit and small: the browser's own
 * DecompressionStream("deflate") opens it.
 *
 * The bits of each float, less those of the float before it (modulo 2^32, the first less 0); the
 * highest bytes of these differences, then the next, and so on down to the lowest, as zlib
 * (RFC 1950), as base64 (RFC 4648, section 4). Neighbours in a picture are alike, so the high bytes
 * are mostly equal; of half floats the low ones are nearly all 0.
 */
#ifndef NEPH_BASE_PACKED_H
#define NEPH_BASE_PACKED_H

#include "base/status.h"

#include <stddef.h>

/* Pack planes of `pixel_count` floats each, one after the other, as one row of floats. `*text` ends
 * with a NUL that `*length` does not count; free it. NEPH_ERR_MEMORY. */
enum neph_status neph_packed_floats(const float *const *planes, int plane_count, size_t pixel_count,
                                    char **text, size_t *length, struct neph_diag *diag);

#endif
