/* SPDX-License-Identifier: MIT */
#include "harness/json_file.h"

#include "base/files.h"

#include <stdlib.h>
#include <string.h>

enum neph_status neph_json_write(const json_t *json, size_t flags, const char *path,
                                 struct neph_diag *diag)
{
    char *text = json ? json_dumps(json, flags) : NULL;
    const enum neph_status status = text ? neph_file_write(path, text, strlen(text), diag)
                                         : neph_fail_memory(diag);
    free(text);
    return status;
}

enum neph_status neph_json_read(const char *path, size_t limit_bytes, json_t **json,
                                struct neph_diag *diag)
{
    char *text = NULL;
    size_t size;
    const enum neph_status status = neph_file_read(path, limit_bytes, &text, &size, diag);
    if (!status)
        *json = json_loadb(text, size, JSON_REJECT_DUPLICATES, NULL);
    free(text);
    return status;
}

enum neph_status neph_json_digest(const json_t *json, char digest[NEPH_HASH_HEX_SIZE],
                                  struct neph_diag *diag)
{
    char *text = json ? json_dumps(json, JSON_COMPACT | JSON_SORT_KEYS) : NULL;
    const enum neph_status status = text ? neph_hash(text, strlen(text), digest, diag)
                                         : neph_fail_memory(diag);
    free(text);
    return status;
}
