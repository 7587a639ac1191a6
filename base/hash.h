/* SPDX-License-Identifier: MIT
 *
 * BLAKE2b-256 through libsodium. `b2sum -l 256` computes the same.
 */
#ifndef NEPH_BASE_HASH_H
#define NEPH_BASE_HASH_H

#include "base/status.h"

#include <stddef.h>

#define NEPH_HASH_HEX_SIZE 65 /* 64 hexadecimal digits and the NUL */

enum neph_status neph_hash(const void *data, size_t size, char hex[NEPH_HASH_HEX_SIZE],
                           struct neph_diag *diag);
enum neph_status neph_hash_file(const char *path, char hex[NEPH_HASH_HEX_SIZE],
                                struct neph_diag *diag);

#endif
