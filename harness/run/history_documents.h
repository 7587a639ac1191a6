/* SPDX-License-Identifier: MIT
 *
 * The document files of STORE/history/: names, reading, writing, rows. Internal to history.c and
 * history_check.c.
 */
#ifndef NEPH_HARNESS_RUN_HISTORY_DOCUMENTS_H
#define NEPH_HARNESS_RUN_HISTORY_DOCUMENTS_H

#include "base/files.h"
#include "base/hash.h"
#include "base/path.h"
#include "harness/json.h"
#include "harness/run/database.h"

enum neph_document {
    NEPH_DOCUMENT_NIGHT,
    NEPH_DOCUMENT_ACCEPTANCE,
    NEPH_DOCUMENT_COPY, /* of an acceptance */
    NEPH_DOCUMENT_COUNT,
};

/* The file of a document in STORE/history/. */
struct neph_path neph_document_path(const char *store_folder, enum neph_document kind,
                                    int64_t number);

/* The names in STORE/history/, sorted; an empty list where there is no such folder. */
enum neph_status neph_history_list(const char *store_folder, struct neph_arena *arena,
                                   struct neph_names *names, struct neph_diag *diag);

/* The number in the file name; -1: the file is of another kind. */
int64_t neph_document_number(const char *name, enum neph_document kind);

/* For json_decref(). NEPH_ERR_INPUT: the file is no complete document of this kind; else errors as
 * of neph_file_read(). */
enum neph_status neph_document_read(const char *path, enum neph_document kind, json_t **document,
                                    struct neph_diag *diag);

/* Writes or replaces a document. */
enum neph_status neph_document_write(const char *store_folder, enum neph_document kind,
                                     int64_t number, const json_t *document,
                                     struct neph_diag *diag);

/* Inserts all rows of a document, or none. */
enum neph_status neph_document_insert(struct neph_database *index, enum neph_document kind,
                                      int64_t number, const json_t *document,
                                      struct neph_diag *diag);

/* Digest of a run's document; "" when it is missing or damaged. */
enum neph_status neph_document_digest_night(const char *store_folder, int64_t night,
                                            char digest[NEPH_HASH_HEX_SIZE],
                                            struct neph_diag *diag);

#endif
