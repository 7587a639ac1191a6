/* SPDX-License-Identifier: MIT
 *
 * Maintenance of the store: check and repair, eviction, export as JSON.
 */
#ifndef NEPH_HARNESS_RUN_STORE_KEEP_H
#define NEPH_HARNESS_RUN_STORE_KEEP_H

#include "harness/json.h"
#include "harness/run/store.h"

/* A fault of a frame, a document of the history, or the database. */
struct neph_store_fault {
    const char *key, *why; /* key "": the database; for a document the name of its file */
    bool of_baseline;      /* an accepted run has used the frame */
    bool removed;          /* for a document or the database: rewritten */
    bool is_document;
};

/* Called once for each fault. */
typedef void neph_store_report(const struct neph_store_fault *fault, void *context);

struct neph_store_sums {
    int64_t frames, bytes; /* number of entries in frames/, and their size */
    int64_t nights, acceptances;
    int64_t bad;
};

/* Checks all frames against their records, and the database against the frames and the documents of
 * nightly runs and acceptances. `repairs`:
 *
 * - removes bad frames, which the next run renders again;
 * - rewrites a damaged acceptance from its copy or its row;
 * - rebuilds a damaged database, after damaged documents of nightly runs were rewritten from its
 *   rows.
 *
 * NEPH_ERR_NOT_FOUND or NEPH_ERR_IO: a run's document is missing or cannot be read. The database is
 * not rebuilt then, as that run would be lost. */
enum neph_status neph_store_check(struct neph_store *store, bool repairs, neph_store_report *tell,
                                  void *context, struct neph_store_sums *sums,
                                  struct neph_diag *diag);

struct neph_store_gc {
    int64_t frames_before, bytes_before, frames_removed, bytes_removed;
    int64_t bytes_of_baselines, bytes_in_use; /* not removed: part of a baseline; in use */
    int64_t frames_that_stayed;               /* selected, but removing failed */
    bool fits;                                /* the remaining frames are within the limit */
};

/* Removes frames, the least recently used first, until all frames take at most `limit_bytes`.
 * Frames that an accepted run has used stay, whatever their age. So do frames used within the last
 * `spare_s` seconds, as another process may be about to read them. */
enum neph_status neph_store_gc(struct neph_store *store, int64_t limit_bytes, double spare_s,
                               struct neph_store_gc *result, struct neph_diag *diag);

/* {"format": "neph-store-1", "environments", "jobs", "nights", "acceptances"}: all rows except
 * those of an unfinished run. For json_decref(). */
enum neph_status neph_store_export(struct neph_store *store, json_t **document,
                                   struct neph_diag *diag);

/* Last use of a frame, in seconds of file time; 0: the frame does not exist. */
int64_t neph_store_used_s(const struct neph_store *store, const char *key);

#endif
