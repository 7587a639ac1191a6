/* SPDX-License-Identifier: MIT
 *
 * The identity of the running program: the hash that the linker made of code, data and embedded
 * shaders.
 */
#ifndef NEPH_BASE_BUILD_ID_H
#define NEPH_BASE_BUILD_ID_H

#include "base/status.h"

#define NEPH_BUILD_ID_SIZE 17 /* 16 hexadecimal digits and the NUL */

/* The first 64 bits of the note NT_GNU_BUILD_ID of the running program, read from memory. Programs
 * that differ in one byte of code or data have different ids (ld --build-id=sha1). NEPH_ERR_IO: the
 * program was linked without a build id. */
enum neph_status neph_build_id(char hex[NEPH_BUILD_ID_SIZE], struct neph_diag *diag);

#endif
