/* SPDX-License-Identifier: MIT
 *
 * JSON in files, and its digest.
 */
#ifndef NEPH_HARNESS_JSON_FILE_H
#define NEPH_HARNESS_JSON_FILE_H

#include "base/hash.h"
#include "harness/json.h"

/* Write a file of JSON, whole or not at all, in the layout `flags` of jansson. NEPH_ERR_MEMORY also
 * when `json` is NULL. */
enum neph_status neph_json_write(const json_t *json, size_t flags, const char *path,
                                 struct neph_diag *diag);

/* Read a file of at most `limit_bytes`. `*json`, to json_decref: NULL when it is no JSON, or has a
 * key twice. Errors as of neph_file_read(). */
enum neph_status neph_json_read(const char *path, size_t limit_bytes, json_t **json,
                                struct neph_diag *diag);

/* BLAKE2b of what it says, whatever the order of its keys and its layout. */
enum neph_status neph_json_digest(const json_t *json, char digest[NEPH_HASH_HEX_SIZE],
                                  struct neph_diag *diag);

#endif
