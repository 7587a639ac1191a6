/* SPDX-License-Identifier: MIT
 *
 * Random texts that cannot be guessed: the token of a server, the nonce of an acceptance.
 */
#ifndef NEPH_HARNESS_SERVE_SECRET_H
#define NEPH_HARNESS_SERVE_SECRET_H

#include "base/status.h"

/* Twice so many hexadecimal digits, and a zero. NEPH_ERR_IO: the system has no random numbers. */
enum { NEPH_SECRET_BYTES = 32, NEPH_SECRET_TEXT_SIZE = 2 * NEPH_SECRET_BYTES + 1 };

enum neph_status neph_secret_draw(char text[NEPH_SECRET_TEXT_SIZE], struct neph_diag *diag);

#endif
