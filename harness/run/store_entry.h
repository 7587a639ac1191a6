/* SPDX-License-Identifier: MIT
 *
 * One entry of the store: a folder with frame.exr and job.json, the record of the job. The record
 * holds the key of the job, the hashes of the frame and of other results (*.json) and a hash over
 * the rest of itself, so that neither another job's entry nor an edited number is taken for what
 * was measured. This is no protection against somebody who computes the hashes anew.
 */
#ifndef NEPH_HARNESS_RUN_STORE_ENTRY_H
#define NEPH_HARNESS_RUN_STORE_ENTRY_H

#include "base/status.h"
#include "harness/json.h"

#include <stdbool.h>

enum neph_entry_state {
    NEPH_ENTRY_ABSENT,
    NEPH_ENTRY_GOOD,
    NEPH_ENTRY_BAD,        /* not what the key says, or damaged */
    NEPH_ENTRY_UNREADABLE, /* it cannot be told: no permission, a failing disk, no memory */
};

enum { NEPH_ENTRY_WHY_BYTES = 1200 };

/* Whether a name is a key: the name of an entry in frames/. */
bool neph_entry_is_key(const char *name);

/* Look whether `folder` is the whole entry of `key`. `*record` is the caller's when it is; `why`
 * receives the reason, in words that follow the entry's name, when it is bad or unreadable. */
enum neph_entry_state neph_entry_check(const char *folder, const char *key, json_t **record,
                                       char why[NEPH_ENTRY_WHY_BYTES]);

/* Look at the record alone: it is there, of this key, and as it was signed. Its files may be
 * anything. */
enum neph_entry_state neph_entry_read(const char *folder, const char *key, json_t **record,
                                      char why[NEPH_ENTRY_WHY_BYTES]);

/* Sign `record` ("key", "frame_blake2b", "results_blake2b", "record_blake2b" are added to it) for
 * frame.exr, the *.json and the pictures in `folder` and write it there as job.json. */
enum neph_status neph_entry_write_record(const char *folder, const char *key, json_t *record,
                                         struct neph_diag *diag);

/* Whether the record, which may be NULL, lists this file in "pictures". */
bool neph_entry_has_picture(const json_t *record, const char *name);

#endif
