/* SPDX-License-Identifier: MIT */
#include "base/hash.h"

#include "base/files.h"

#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <sodium.h>

enum {
    DIGEST_BYTES = 32,
    READ_BYTES = 1 << 18,
};

static enum neph_status start(struct neph_diag *diag)
{
    if (sodium_init() < 0) /* picks the fastest code for this CPU; later calls do nothing */
        return neph_fail(diag, NEPH_ERR_INTERNAL, "libsodium cannot be initialised");
    return NEPH_OK;
}

static void to_hex(const unsigned char digest[DIGEST_BYTES], char hex[NEPH_HASH_HEX_SIZE])
{
    sodium_bin2hex(hex, NEPH_HASH_HEX_SIZE, digest, DIGEST_BYTES);
}

enum neph_status neph_hash(const void *data, size_t size, char hex[NEPH_HASH_HEX_SIZE],
                           struct neph_diag *diag)
{
    enum neph_status status = start(diag);
    if (status)
        return status;
    unsigned char digest[DIGEST_BYTES];
    crypto_generichash(digest, sizeof(digest), data, size, NULL, 0);
    to_hex(digest, hex);
    return NEPH_OK;
}

/* Hash the bytes of `fd` up to its end. False: errno has the reason. */
static bool absorb_file(crypto_generichash_state *state, int fd, unsigned char *buffer)
{
    for (;;) {
        ssize_t got = read(fd, buffer, READ_BYTES);
        if (got == 0)
            return true;
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0)
            return false;
        crypto_generichash_update(state, buffer, (size_t)got);
    }
}

enum neph_status neph_hash_file(const char *path, char hex[NEPH_HASH_HEX_SIZE],
                                struct neph_diag *diag)
{
    enum neph_status status = start(diag);
    if (status)
        return status;
    int fd = -1;
    unsigned char *buffer = malloc(READ_BYTES);
    if (!buffer) {
        status = neph_fail_memory(diag);
        goto done;
    }
    status = neph_file_open(path, &fd, NULL, diag);
    if (status)
        goto done;
    crypto_generichash_state state;
    crypto_generichash_init(&state, NULL, 0, DIGEST_BYTES);
    if (!absorb_file(&state, fd, buffer)) {
        status = neph_fail(diag, NEPH_ERR_IO, "cannot read '%s': %s", path, strerror(errno));
        goto done;
    }
    unsigned char digest[DIGEST_BYTES];
    crypto_generichash_final(&state, digest, sizeof(digest));
    to_hex(digest, hex);
done:
    if (fd >= 0)
        close(fd);
    free(buffer);
    return status;
}
