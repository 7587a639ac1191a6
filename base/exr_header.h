/* SPDX-License-Identifier: MIT
 *
 * The raw headers of the parts of an OpenEXR file. Used for properties that the library does not
 * report, such as a compression it does not know, and for attributes that are copied without being
 * parsed. See "Header" in https://openexr.com/en/latest/OpenEXRFileLayout.html.
 */
#ifndef NEPH_BASE_EXR_HEADER_H
#define NEPH_BASE_EXR_HEADER_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    NEPH_EXR_PREFIX_BYTES = 8, /* magic number, version and flags, before the header */
    /* Feature flags. See "Version Field" in https://openexr.com/en/latest/OpenEXRFileLayout.html */
    NEPH_EXR_FLAG_DEEP = 0x800,
    NEPH_EXR_FLAG_MULTIPART = 0x1000,
};

/* An attribute; its pointers point into the bytes of the header. */
struct neph_exr_attribute {
    const char *name, *type;
    const unsigned char *value;
    uint32_t value_bytes;
    const char *start; /* the attribute's bytes, beginning with its name */
    size_t bytes;
};

/* The attribute at `*at`, which moves behind it. False at the zero byte that ends a header (`*at`
 * is then its index), and where the bytes end early or contain no attribute (`*at` is then `size`).
 */
bool neph_exr_next_attribute(const char *header, size_t size, size_t *at,
                             struct neph_exr_attribute *attribute);

/* Read the headers of an open file. Of a file without the flag for parts, the attributes without
 * the zero byte that ends them; of a multi-part file, the header of each part with its zero byte.
 * The caller frees `*headers`. Of a damaged header, the attributes before the damage.
 * NEPH_ERR_MEMORY, NEPH_ERR_IO (errno is set). */
enum neph_status neph_exr_read_headers(int fd, uint64_t file_bytes, char **headers, size_t *size,
                                       struct neph_diag *diag);

/* The header at `*at`, without its zero byte; `*at` moves to the next one. False: there are no
 * more. */
bool neph_exr_next_header(const char *headers, size_t size, size_t *at, const char **header,
                          size_t *bytes);

/* Integer and floats of a value, which must have 4 bytes (8 for a double) from `at` on. */
uint32_t neph_exr_u32(const unsigned char *at);
float neph_exr_f32(const unsigned char *at);
double neph_exr_f64(const unsigned char *at);

/* Append attributes to the header of a file in memory that has `chunk_count` chunks. `*file` is
 * reallocated. NEPH_ERR_MEMORY. */
enum neph_status neph_exr_add_attributes(char **file, uint64_t *file_bytes, int64_t chunk_count,
                                         const char *attributes, size_t bytes,
                                         struct neph_diag *diag);

#endif
