/* SPDX-License-Identifier: MIT
 *
 * Floats as text for a page that opens from disk: exact to the bit and small. The browser's
 * DecompressionStream("deflate") unpacks them.
 *
 * Encoding: the bits of each float minus the bits of the float before it (modulo 2^32; the first
 * minus 0). Then the highest bytes of all differences, the next lower bytes, down to the lowest,
 * compressed by zlib (RFC 1950), as base64 (RFC 4648, section 4). Neighbouring pixels are similar,
 * so the high bytes are mostly equal; for half floats the low bytes are nearly all 0.
 */
#ifndef NEPH_BASE_PACKED_H
#define NEPH_BASE_PACKED_H

#include "base/status.h"

#include <stddef.h>

/* Pack `plane_count` planes of `pixel_count` floats each, concatenated to one row of floats.
 * `*text` ends with a NUL that `*length` does not count; the caller frees it. NEPH_ERR_MEMORY. */
enum neph_status neph_packed_floats(const float *const *planes, int plane_count, size_t pixel_count,
                                    char **text, size_t *length, struct neph_diag *diag);

#endif
