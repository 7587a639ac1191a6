/* SPDX-License-Identifier: MIT
 *
 * The content-addressed store of finished frames.
 *
 *   STORE/frames/<key>/   frame.exr, job.json, logs: complete, or not there at all
 *   STORE/failed/<key>/   logs and leavings of the last failed try, until the key succeeds
 *   STORE/resting/<key>   what an interrupted tracer had done
 *   STORE/index/          the database that finds all of it (index.h)
 *   STORE/history/        what nights have measured (history.h)
 *   STORE/tmp/            work in progress (base/scratch.h)
 *
 * A folder of frames/ appears by one rename after everything in it, files and then names, is on
 * disk. An entry is used only if its record says that it is of this key and the hashes of frame and
 * record are right (store_entry.h); so neither a kill -9, nor a torn disk, nor a mix-up can make
 * another frame, half of one, or other seconds look like what was measured. The time of change of a
 * record is when its frame was last used: eviction (store_keep.h) begins with the oldest.
 *
 * Any number of runs, also in several containers, may work in one store at the same time. Each has
 * folders of its own, known to be in use by their locks; what is of all is changed under the lock
 * STORE/.neph-lock, held for moments. Opening removes what is left of killed runs, tries that
 * failed before the key succeeded, and rests of finished keys or that nobody went on with for 30
 * days. Versions of neph from before the locks must not work in it at the same time.
 */
#ifndef NEPH_HARNESS_RUN_STORE_H
#define NEPH_HARNESS_RUN_STORE_H

#include "base/hash.h"
#include "base/path.h"
#include "base/scratch.h"
#include "base/status.h"
#include "harness/json.h"

#include <stdbool.h>

struct neph_store;
struct neph_database;

/* Open or create the store in `folder`, which must be free for it (base/owned.h): NEPH_ERR_USAGE
 * else. A store of before the database is taken over; a database that cannot be written, as on a
 * full disk, is named on stderr and does without: the next run brings it up to date. Free with
 * neph_store_close, which does so, too. */
enum neph_status neph_store_open(const char *folder, struct neph_store **store,
                                 struct neph_diag *diag);
void neph_store_close(struct neph_store *store);

const char *neph_store_folder(const struct neph_store *store);

/* The database, up to date (index.h). Free with neph_database_close(), and before any fork(). */
enum neph_status neph_store_index(const struct neph_store *store, struct neph_database **index,
                                  struct neph_diag *diag);

/* Set a database aside of which `why` is known, and make it again. */
enum neph_status neph_store_renew_index(const struct neph_store *store, const char *why,
                                        struct neph_database **index, struct neph_diag *diag);

/* A finished frame: true when it is there and what its key says. `*frame_path` (to free) and
 * `*record` (to json_decref) are the caller's. An entry that is something else is removed, with a
 * line on stderr, and one that cannot be read is left alone, with a line; both count as absent. */
bool neph_store_find(struct neph_store *store, const char *key, char **frame_path, json_t **record);

/* The key of a frame in the store, from its path; "" when the path is none of those. */
void neph_store_key_of(const char *frame_path, char key[NEPH_HASH_HEX_SIZE]);

/* The file where unfinished work on a key may rest from one run to the next. Whoever finishes the
 * work removes it. */
struct neph_path neph_store_resting_place(const struct neph_store *store, const char *key);

/* Start work: `*scratch` is a fresh, empty folder, for the caller to end with
 * neph_scratch_destroy() in any case. */
enum neph_status neph_store_begin(struct neph_store *store, struct neph_scratch **scratch,
                                  struct neph_diag *diag);

/* Turn scratch/frame.exr into the finished frame of `key`. `record` is written as job.json with its
 * signature added (store_entry.h). Of the other files logs and inputs (.log .json .pov) are kept,
 * and the pictures that the record lists by name, ["flip_0.png", ...], in "pictures". If another
 * run was first and its entry is good, that one stays; a bad one is replaced. */
enum neph_status neph_store_publish(struct neph_store *store, const char *key,
                                    const struct neph_scratch *scratch, json_t *record,
                                    struct neph_diag *diag);

/* Take a frame away, unless somebody has used it after `unused_since_s` of the clock of files (0:
 * in any case). `why` is told on stderr; NULL: that is no news. Whether it is gone. */
bool neph_store_remove(struct neph_store *store, const char *key, int64_t unused_since_s,
                       const char *why);

/* Remove what an engine has left in the folder, but for its logs and inputs (*.log, *.json, *.pov,
 * frame.exr), of which NEPH_KEPT_BYTES in NEPH_KEPT_ENTRIES files stay. NEPH_ERR_IO. */
enum neph_status neph_store_clean(const struct neph_scratch *scratch, struct neph_diag *diag);

/* Keep the logs of a failed try under failed/. `*kept` (to free) receives the folder, or NULL. */
void neph_store_abandon(struct neph_store *store, const char *key,
                        const struct neph_scratch *scratch, char **kept);

#endif
