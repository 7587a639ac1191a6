/* SPDX-License-Identifier: MIT
 *
 * The store's database, STORE/index/neph.sqlite: what the frames are, what they have cost, where
 * they were made, and what nights have measured (history.h).
 *
 * Files are the truth and the database finds them: each frame carries its own record (job.json),
 * each finished night and each acceptance is a document of its own. So a store of before the
 * database is taken over by reading it, a damaged database is set aside beside the new one, and a
 * run that is killed, or finds the disk full, loses no more than the next run reads again.
 *
 * A database is of one host: SQLite's log wants memory that all its users share. In a store that
 * several hosts work in each has its own, on its own disk, made of the same files: the variable
 * NEPH_STORE_INDEX names the folder for it (a folder in it for each store), or is "none" where
 * frames are made and nothing is asked.
 */
#ifndef NEPH_HARNESS_RUN_INDEX_H
#define NEPH_HARNESS_RUN_INDEX_H

#include "harness/run/record.h"

enum neph_index_place {
    NEPH_INDEX_IN_STORE,
    NEPH_INDEX_OF_HOST, /* in the folder that NEPH_STORE_INDEX names */
    NEPH_INDEX_NONE,    /* it is not to be opened */
};

enum neph_index_place neph_index_place(void);

/* Open the database of a store, whose lock the caller holds, and bring it up to date with its
 * frames and documents. `reads`: all of it is read first (neph_database_check), which takes time;
 * else damage shows when its rows are asked for. A damaged one is set aside as
 * STORE/index/damaged-..., with a line on stderr. Free with neph_database_close(), and before any
 * fork(): SQLite's locks do not live in two processes. Errors as of database.h, but never
 * NEPH_ERR_INPUT. */
enum neph_status neph_index_open(const char *store_folder, bool reads, struct neph_database **index,
                                 struct neph_diag *diag);

/* Look closely: the form of the database, and each finished night against its document. `*whole`
 * tells, and `why` what is wrong. Errors as of neph_history_check(). */
enum neph_status neph_index_check(struct neph_database *index, const char *store_folder,
                                  bool *whole, struct neph_diag *why, struct neph_diag *diag);

/* Whether the row of a frame says what its record says. */
enum neph_status neph_index_agrees(struct neph_database *index, const char *key,
                                   const json_t *record, bool *agrees, struct neph_diag *diag);

/* The columns of environments and jobs. */
extern const struct neph_record_form neph_index_environment_form, neph_index_job_form;

/* Set a database that is not whole aside, to be made again when it is opened next. Nobody may have
 * it open, and the caller holds the store's lock. */
enum neph_status neph_index_renew(const char *store_folder, const char *why,
                                  struct neph_diag *diag);

#endif
