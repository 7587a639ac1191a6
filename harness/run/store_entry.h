/* SPDX-License-Identifier: MIT
 *
 * One entry of the store: a folder with frame.exr and job.json, the record of the job. The record
 * has the job's key, the hashes of the frame and of other results (*.json), and a hash of itself.
 * So the entry of another job or an edited number is detected. The hashes are no protection against
 * a person who computes them again.
 */
#ifndef NEPH_HARNESS_RUN_STORE_ENTRY_H
#define NEPH_HARNESS_RUN_STORE_ENTRY_H

#include "base/status.h"
#include "harness/json.h"

#include <stdbool.h>

enum neph_entry_state {
    NEPH_ENTRY_ABSENT,
    NEPH_ENTRY_GOOD,
    NEPH_ENTRY_BAD,        /* another key, or damaged */
    NEPH_ENTRY_UNREADABLE, /* cannot be checked: no permission, a failing disk, no memory */
};

enum { NEPH_ENTRY_WHY_BYTES = 1200 };

/* Whether a name is a key, that is, the name of an entry in frames/. */
bool neph_entry_is_key(const char *name);

/* Checks that `folder` is the complete entry of `key`. When it is good, the caller owns `*record`;
 * when it is bad or unreadable, `why` has the reason, worded to follow the entry's name. */
enum neph_entry_state neph_entry_check(const char *folder, const char *key, json_t **record,
                                       char why[NEPH_ENTRY_WHY_BYTES]);

/* Like neph_entry_check(), without the files: checks that the record exists, has this key and is
 * unchanged. */
enum neph_entry_state neph_entry_read(const char *folder, const char *key, json_t **record,
                                      char why[NEPH_ENTRY_WHY_BYTES]);

/* Signs `record` for frame.exr, the *.json files and the images in `folder` (adds "key",
 * "frame_blake2b", "results_blake2b" and "record_blake2b") and writes it there as job.json. */
enum neph_status neph_entry_write_record(const char *folder, const char *key, json_t *record,
                                         struct neph_diag *diag);

/* Whether the record, which may be NULL, lists this file in "pictures". */
bool neph_entry_has_picture(const json_t *record, const char *name);

#endif
