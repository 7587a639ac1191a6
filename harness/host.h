/* SPDX-License-Identifier: MIT
 *
 * The machine that this runs on.
 */
#ifndef NEPH_HARNESS_HOST_H
#define NEPH_HARNESS_HOST_H

#include "harness/json.h"

/* {"cpu", "cores", "memory_bytes"}; NULL when memory is short. */
json_t *neph_host_json(void);

enum { NEPH_HOST_CLASS_SIZE = 288 };

/* "<processor> x <cores>": machines of one name may be compared for speed. */
void neph_host_class(char text[NEPH_HOST_CLASS_SIZE]);

#endif
