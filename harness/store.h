/* SPDX-License-Identifier: MIT
 *
 * The content-addressed store of finished frames.
 *
 *   STORE/frames/<key>/   frame.exr, job.json, logs: complete, or not there at all
 *   STORE/failed/<key>/   logs and leavings of the last failed try
 *   STORE/resting/<key>   what an interrupted tracer had done
 *   STORE/tmp/            work in progress; what a killed run left is removed at the next opening
 *
 * A folder of frames/ appears by one rename after everything in it is on disk, and job.json holds
 * the hash of frame.exr, so neither a kill -9 nor a torn disk can make half a frame look finished.
 */
#ifndef NEPH_HARNESS_STORE_H
#define NEPH_HARNESS_STORE_H

#include "base/hash.h"
#include "base/status.h"
#include "harness/json.h"

#include <stdbool.h>

struct neph_store;

/* Open or create the store in `folder`, which must be free for it (base/owned.h): NEPH_ERR_USAGE
 * else. Free with neph_store_close. */
enum neph_status neph_store_open(const char *folder, struct neph_store **store,
                                 struct neph_diag *diag);
void neph_store_close(struct neph_store *store);

/* A finished frame: true when it is there and its hash is right. `*frame_path` (to free) and
 * `*record` (to json_decref) are the caller's. A damaged entry is removed and reported as absent.
 */
bool neph_store_find(struct neph_store *store, const char *key, char **frame_path, json_t **record);

/* The file where unfinished work on a key may rest from one run to the next; to free. NULL: no
 * memory. Whoever finishes the work removes it. */
char *neph_store_resting_place(const struct neph_store *store, const char *key);

/* Start work on a key: `*scratch` is a fresh, empty folder (to free) for neph_store_publish or
 * neph_store_abandon to end. */
enum neph_status neph_store_begin(struct neph_store *store, const char *key, char **scratch,
                                  struct neph_diag *diag);

/* Turn scratch/frame.exr into the finished frame of `key`. `record` is written as job.json with the
 * frame's hash added. Of the other files logs and inputs (.log .json .pov) are kept. */
enum neph_status neph_store_publish(struct neph_store *store, const char *key, const char *scratch,
                                    json_t *record, struct neph_diag *diag);

/* Keep the logs of a failed try under failed/ and remove the rest. `*kept` (to free) receives the
 * folder, or NULL. */
void neph_store_abandon(struct neph_store *store, const char *key, const char *scratch,
                        char **kept);

#endif
