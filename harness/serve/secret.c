/* SPDX-License-Identifier: MIT */
#include "harness/serve/secret.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/random.h>

enum neph_status neph_secret_draw(char text[NEPH_SECRET_TEXT_SIZE], struct neph_diag *diag)
{
    unsigned char bytes[NEPH_SECRET_BYTES];
    if (getrandom(bytes, sizeof(bytes), 0) != (ssize_t)sizeof(bytes))
        return neph_fail(diag, NEPH_ERR_IO, "no random numbers: %s", strerror(errno));
    for (int i = 0; i < NEPH_SECRET_BYTES; i++)
        snprintf(text + 2 * i, 3, "%02x", bytes[i]);
    return NEPH_OK;
}
