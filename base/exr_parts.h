/* SPDX-License-Identifier: MIT
 *
 * The choice of one part of an OpenEXR file, for readers of its pixels and of its windows.
 */
#ifndef NEPH_BASE_EXR_PARTS_H
#define NEPH_BASE_EXR_PARTS_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>

struct neph_exr_part {
    int index;
    const char *header; /* its attributes, in the bytes of the headers */
    size_t header_bytes;
    bool is_deep;
    bool is_wanted; /* it has the name or the number that was asked for */
};

/* Choose a part of the headers (neph_exr_read_headers()): the only one, wanted or not; else the one
 * whose name, or whose number from 0, is `wanted`; for NULL the only flat part with three colour
 * channels (base/colour_names.h), else the only grey one. NEPH_ERR_INPUT lists the parts with their
 * types and channels. */
enum neph_status neph_exr_choose_part(const char *path, const char *headers, size_t size,
                                      const char *wanted, struct neph_exr_part *part,
                                      struct neph_diag *diag);

#endif
