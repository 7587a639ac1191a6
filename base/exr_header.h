/* SPDX-License-Identifier: MIT
 *
 * The header of a single-part OpenEXR file in its bytes: for what the library does not tell, such
 * as a compression that it does not know, and for attributes that are kept without being read.
 * See "Header" in https://openexr.com/en/latest/OpenEXRFileLayout.html.
 */
#ifndef NEPH_BASE_EXR_HEADER_H
#define NEPH_BASE_EXR_HEADER_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { NEPH_EXR_PREFIX_BYTES = 8 }; /* magic number, version and flags, before the header */

/* An attribute; all of it points into the bytes of the header. */
struct neph_exr_attribute {
    const char *name, *type;
    const unsigned char *value;
    uint32_t value_bytes;
    const char *start; /* of its bytes, from its name on */
    size_t bytes;
};

/* The attribute at `*at`, which moves behind it. False at the zero byte that ends a header, which
 * `*at` is at then; and where the bytes end before or hold no attribute (`*at` is `size` then). */
bool neph_exr_next_attribute(const char *header, size_t size, size_t *at,
                             struct neph_exr_attribute *attribute);

/* Read the attributes of an open file, without the byte that ends them. `*bytes` is to be freed. A
 * damaged header has those before the damage. NEPH_ERR_MEMORY, NEPH_ERR_IO (errno is set). */
enum neph_status neph_exr_read_header(int fd, uint64_t file_bytes, char **header, size_t *size,
                                      struct neph_diag *diag);

/* Integers and floats of a value, which has to have 4 (8) bytes from `at` on. */
uint32_t neph_exr_u32(const unsigned char *at);
float neph_exr_f32(const unsigned char *at);
double neph_exr_f64(const unsigned char *at);

/* Put bytes of further attributes at the end of the header of a file in memory, which has
 * `chunk_count` chunks. `*file` is reallocated. NEPH_ERR_MEMORY. */
enum neph_status neph_exr_add_attributes(char **file, uint64_t *file_bytes, int64_t chunk_count,
                                         const char *attributes, size_t bytes,
                                         struct neph_diag *diag);

#endif
