/* SPDX-License-Identifier: MIT
 *
 * Which build of the program this is: what its linker hashed, shaders included.
 */
#ifndef NEPH_BASE_BUILD_ID_H
#define NEPH_BASE_BUILD_ID_H

#include "base/status.h"

#define NEPH_BUILD_ID_SIZE 17 /* 16 hexadecimal digits and the NUL */

/* The first 64 bits of the note NT_GNU_BUILD_ID of the running program, which lies in memory: a
 * program that differs in a byte of code or data has another one (ld --build-id=sha1).
 * NEPH_ERR_IO: it was linked without. */
enum neph_status neph_build_id(char hex[NEPH_BUILD_ID_SIZE], struct neph_diag *diag);

#endif
