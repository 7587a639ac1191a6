/* SPDX-License-Identifier: MIT
 *
 * Keeping a store: is all of it whole, room for more, and all that is known of it as JSON.
 */
#ifndef NEPH_HARNESS_RUN_STORE_KEEP_H
#define NEPH_HARNESS_RUN_STORE_KEEP_H

#include "harness/json.h"
#include "harness/run/store.h"

/* What is wrong with one frame, with a document of the history, or with the database. */
struct neph_store_fault {
    const char *key, *why; /* key "": of the database; of a document the name of its file */
    bool of_baseline;      /* a night that was accepted has used it */
    bool removed;          /* of a document or the database: written anew */
    bool is_document;
};

/* Called for each that is found. */
typedef void neph_store_tell(const struct neph_store_fault *fault, void *context);

struct neph_store_sums {
    int64_t frames, bytes; /* entries of frames/, and what is in them */
    int64_t nights, acceptances;
    int64_t bad;
};

/* Read all frames and hold them against their records, and the database against the frames and the
 * documents of the nights and of the acceptances. `repairs` removes frames that are bad, which the
 * next run that wants them renders anew, writes a torn acceptance anew from its copy or its row,
 * and makes the database again where it is not whole, after a document of a night that is torn was
 * written anew from it. NEPH_ERR_NOT_FOUND, or NEPH_ERR_IO: a night's document is missing, or
 * cannot be read; nothing is made again then, as that night would be lost. */
enum neph_status neph_store_check(struct neph_store *store, bool repairs, neph_store_tell *tell,
                                  void *context, struct neph_store_sums *sums,
                                  struct neph_diag *diag);

struct neph_store_gc {
    int64_t frames_before, bytes_before, frames_removed, bytes_removed;
    int64_t bytes_of_baselines, bytes_in_use; /* which were not touched */
    int64_t frames_that_stayed;               /* were to be removed, and could not be */
    bool fits;                                /* what is left is within the limit */
};

/* Remove frames, the longest unused first, until all frames take at most `limit_bytes`. Those that
 * an accepted night has used stay, whatever their age, and so do those that anybody used within the
 * last `spare_s` seconds: a run may be about to read them. */
enum neph_status neph_store_gc(struct neph_store *store, int64_t limit_bytes, double spare_s,
                               struct neph_store_gc *result, struct neph_diag *diag);

/* {"format": "neph-store-1", "environments", "jobs", "nights", "acceptances"}: all rows but a night
 * that goes on. To json_decref. */
enum neph_status neph_store_export(struct neph_store *store, json_t **document,
                                   struct neph_diag *diag);

/* When a frame was last used, in seconds of the clock of files; 0: it is not there. */
int64_t neph_store_used_s(const struct neph_store *store, const char *key);

#endif
