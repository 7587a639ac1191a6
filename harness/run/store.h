/* SPDX-License-Identifier: MIT
 *
 * The content-addressed store of finished frames.
 *
 *   STORE/frames/<key>/   frame.exr, job.json, logs: complete, or absent
 *   STORE/failed/<key>/   logs and other files of the last failed try, until the key succeeds
 *   STORE/resting/<key>   checkpoint of an interrupted tracer
 *   STORE/index/          the database (index.h)
 *   STORE/history/        measurements of nightly runs (history.h)
 *   STORE/tmp/            work in progress (base/scratch.h)
 *
 * A folder of frames/ appears by one rename, after its files and then their names are on disk. An
 * entry is used only if its record has the right key and the hashes of frame and record match
 * (store_entry.h). So a kill -9, a power failure or a mix-up never results in a wrong frame, a part
 * of a frame or wrong times. The modification time of a record is the last use of its frame:
 * eviction (store_keep.h) begins with the oldest.
 *
 * Any number of processes, also in several containers, can use one store at the same time. Each has
 * its own work folders, protected by locks; common files are changed under the lock
 * STORE/.neph-lock, for moments. Opening the store removes work of killed processes, failed tries
 * of keys that have succeeded since, and checkpoints that are finished or 30 days old. Versions of
 * neph older than the locks must not use the store at the same time.
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

/* Opens or creates the store in `folder`. NEPH_ERR_USAGE: the folder belongs to something else
 * (base/owned.h). A store without a database gets one. A database that cannot be written, for
 * example on a full disk, is reported on stderr and skipped; the next run refreshes it. Free with
 * neph_store_close(), which refreshes the database again. */
enum neph_status neph_store_open(const char *folder, struct neph_store **store,
                                 struct neph_diag *diag);
void neph_store_close(struct neph_store *store);

const char *neph_store_folder(const struct neph_store *store);

/* Opens the refreshed database (index.h). Free with neph_database_close(), and before any fork().
 */
enum neph_status neph_store_index(const struct neph_store *store, struct neph_database **index,
                                  struct neph_diag *diag);

/* Sets a damaged database aside, with `why` in the message, and rebuilds it. */
enum neph_status neph_store_rebuild_index(const struct neph_store *store, const char *why,
                                          struct neph_database **index, struct neph_diag *diag);

/* Finds a finished frame; true: it is there and matches its key. The caller frees `*frame_path` and
 * decrefs `*record`. A wrong entry is removed and an unreadable one is kept, both with a line on
 * stderr; both count as absent. */
bool neph_store_find(struct neph_store *store, const char *key, char **frame_path, json_t **record);

/* The key of a frame in the store, from its path; "" for any other path. */
void neph_store_key_from_path(const char *frame_path, char key[NEPH_HASH_HEX_SIZE]);

/* The checkpoint file of a key, for unfinished work from one run to the next. The run that finishes
 * the work removes it. */
struct neph_path neph_store_checkpoint_path(const struct neph_store *store, const char *key);

/* Starts work: `*scratch` is a new, empty folder. The caller ends it with neph_scratch_destroy() in
 * any case. */
enum neph_status neph_store_begin(struct neph_store *store, struct neph_scratch **scratch,
                                  struct neph_diag *diag);

/* Publishes scratch/frame.exr as the finished frame of `key`. `record` is written as job.json with
 * its signature (store_entry.h). Of the other files logs and inputs (.log .json .pov) are kept, and
 * the images that the record lists in "pictures", such as ["flip_0.png", ...]. If another run has
 * published a good entry first, that entry stays; a bad one is replaced. */
enum neph_status neph_store_publish(struct neph_store *store, const char *key,
                                    const struct neph_scratch *scratch, json_t *record,
                                    struct neph_diag *diag);

/* Removes a frame, unless it was used after `unused_since_s` (file time; 0: in any case). `why` is
 * printed on stderr; NULL: no message. Returns whether the frame is gone. */
bool neph_store_remove(struct neph_store *store, const char *key, int64_t unused_since_s,
                       const char *why);

/* Removes an engine's files from the folder, except logs and inputs (*.log, *.json, *.pov,
 * frame.exr), of which NEPH_KEPT_ENTRIES files with NEPH_KEPT_BYTES in all stay. NEPH_ERR_IO. */
enum neph_status neph_store_clean(const struct neph_scratch *scratch, struct neph_diag *diag);

/* Keeps the logs of a failed try under failed/. `*kept` (to free) is that folder, or NULL. */
void neph_store_abandon(struct neph_store *store, const char *key,
                        const struct neph_scratch *scratch, char **kept);

#endif
