/* SPDX-License-Identifier: MIT */
#include "base/checkpoint.h"

#include "base/files.h"
#include "base/hash.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The first line is padded with spaces to this length, so that the layout of the file is known
 * before the hash. */
enum { line_bytes = 160 };

static void put_double(unsigned char bytes[8], double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof(bits));
    for (int i = 0; i < 8; i++)
        bytes[i] = (unsigned char)(bits >> (8 * i));
}

static double get_double(const unsigned char bytes[8])
{
    uint64_t bits = 0;
    for (int i = 0; i < 8; i++)
        bits |= (uint64_t)bytes[i] << (8 * i);
    double value;
    memcpy(&value, &bits, sizeof(value));
    return value;
}

static void print_line(char line[line_bytes + 1], size_t identity_bytes, size_t count,
                       const char *hash)
{
    char text[line_bytes];
    snprintf(text, sizeof(text), "neph-checkpoint 1 %zu %zu %s", identity_bytes, count, hash);
    snprintf(line, line_bytes + 1, "%-*s\n", line_bytes - 1, text);
}

enum neph_status neph_checkpoint_write(const char *path, const char *identity, const double *values,
                                       size_t count, struct neph_diag *diag)
{
    const size_t identity_bytes = strlen(identity);
    const size_t body_bytes = identity_bytes + 8 * count;
    char *file = malloc(line_bytes + body_bytes + 1);
    if (!file)
        return neph_fail_memory(diag);
    char *body = file + line_bytes;
    memcpy(body, identity, identity_bytes);
    for (size_t i = 0; i < count; i++)
        put_double((unsigned char *)body + identity_bytes + 8 * i, values[i]);
    char hash[NEPH_HASH_HEX_SIZE], line[line_bytes + 1];
    enum neph_status status = neph_hash(body, body_bytes, hash, diag);
    if (!status) {
        print_line(line, identity_bytes, count, hash);
        memcpy(file, line, line_bytes);
        status = neph_file_write(path, file, line_bytes + body_bytes, diag);
    }
    free(file);
    return status;
}

static enum neph_status refuse(const char *path, const char *why, struct neph_diag *diag)
{
    neph_fail(diag, NEPH_ERR_INPUT, "the checkpoint '%s' %s", path, why);
    neph_hint(diag, "remove it to start again, or name another file");
    return NEPH_ERR_INPUT;
}

/* The first line must equal, byte for byte, the line that would be written for this body. */
static enum neph_status check_whole(const char *path, const char *file, size_t size,
                                    struct neph_diag *diag)
{
    size_t identity_bytes, count;
    if (size < line_bytes ||
        sscanf(file, "neph-checkpoint 1 %zu %zu ", &identity_bytes, &count) != 2)
        return refuse(path, "is not a checkpoint of this version", diag);
    char hash[NEPH_HASH_HEX_SIZE], line[line_bytes + 1];
    const enum neph_status status = neph_hash(file + line_bytes, size - line_bytes, hash, diag);
    if (status)
        return status;
    print_line(line, identity_bytes, count, hash);
    const size_t body_bytes = size - line_bytes;
    if (memcmp(line, file, line_bytes) != 0 || identity_bytes > body_bytes ||
        count != (body_bytes - identity_bytes) / 8 || (body_bytes - identity_bytes) % 8 != 0)
        return refuse(path, "is damaged or truncated", diag);
    return NEPH_OK;
}

static enum neph_status check_identity(const char *path, const char *found, size_t found_bytes,
                                       const char *identity, struct neph_diag *diag)
{
    if (found_bytes == strlen(identity) && memcmp(found, identity, found_bytes) == 0)
        return NEPH_OK;
    char why[900];
    const int shown = found_bytes < 400 ? (int)found_bytes : 400;
    snprintf(why, sizeof(why), "belongs to '%.*s', not to '%.400s'", shown, found, identity);
    return refuse(path, why, diag);
}

enum neph_status neph_checkpoint_read(const char *path, const char *identity, double *values,
                                      size_t count, struct neph_diag *diag)
{
    char *file;
    size_t size;
    /* The limit allows for a file of another computation, so that it is refused for its identity
     * and not for its size. */
    enum neph_status status = neph_file_read(path, line_bytes + 65536 + 4 * (8 * count + 8), &file,
                                             &size, diag);
    if (status)
        return status;
    size_t found_bytes = 0, found_count = 0;
    status = check_whole(path, file, size, diag);
    if (!status) {
        sscanf(file, "neph-checkpoint 1 %zu %zu ", &found_bytes, &found_count);
        status = check_identity(path, file + line_bytes, found_bytes, identity, diag);
    }
    if (!status && found_count != count)
        status = refuse(path, "has another number of values", diag);
    for (size_t i = 0; !status && i < count; i++)
        values[i] = get_double((const unsigned char *)file + line_bytes + found_bytes + 8 * i);
    free(file);
    return status;
}
