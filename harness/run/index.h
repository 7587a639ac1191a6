/* SPDX-License-Identifier: MIT
 *
 * The store's database, STORE/index/neph.sqlite: the frames, their costs and origins, and the
 * measurements of nightly runs (history.h).
 *
 * Files are the source of truth, and the database indexes them: each frame has its own record
 * (job.json), each finished run and each acceptance its own document. An older store is indexed by
 * reading it, a damaged database is set aside and rebuilt, and a killed run or a full disk costs no
 * more than the next run reads again.
 *
 * A database belongs to one host, as SQLite's WAL needs shared memory. Where several hosts use one
 * store, each has its own database on its own disk, built from the same files. NEPH_STORE_INDEX
 * names the folder for these databases (with a subfolder for each store), or is "none" on hosts
 * that render frames and read no history.
 */
#ifndef NEPH_HARNESS_RUN_INDEX_H
#define NEPH_HARNESS_RUN_INDEX_H

#include "harness/run/record.h"

enum neph_index_place {
    NEPH_INDEX_IN_STORE,
    NEPH_INDEX_ON_HOST, /* in the folder named by NEPH_STORE_INDEX */
    NEPH_INDEX_NONE,    /* the database must not be opened */
};

/* Reads NEPH_STORE_INDEX. */
enum neph_index_place neph_index_place(void);

/* Opens a store's database and refreshes it from frames and documents. The caller owns the store's
 * lock. `reads`: checks the whole database first (neph_database_check), which takes time; otherwise
 * damage shows when its rows are read. A damaged database is set aside as STORE/index/damaged-...,
 * with a warning on stderr. Free with neph_database_close(), and before any fork(): SQLite's locks
 * do not survive in two processes. Errors as of database.h, without NEPH_ERR_INPUT. */
enum neph_status neph_index_open(const char *store_folder, bool reads, struct neph_database **index,
                                 struct neph_diag *diag);

/* Checks the structure of the database and each finished run against its document. `*whole` is the
 * result, `why` the fault. Errors as of neph_history_check(). */
enum neph_status neph_index_check(struct neph_database *index, const char *store_folder,
                                  bool *whole, struct neph_diag *why, struct neph_diag *diag);

/* Whether the row of a frame equals its record. */
enum neph_status neph_index_agrees(struct neph_database *index, const char *key,
                                   const json_t *record, bool *agrees, struct neph_diag *diag);

/* The columns of the tables `environments` and `jobs`. */
extern const struct neph_record_form neph_index_environment_form, neph_index_job_form;

/* Sets the database aside, so that the next opening rebuilds it. The database must be closed in all
 * processes, and the caller owns the store's lock. */
enum neph_status neph_index_set_aside(const char *store_folder, const char *why,
                                      struct neph_diag *diag);

#endif
