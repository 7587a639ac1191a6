/* SPDX-License-Identifier: MIT
 *
 * Compares the documents of nightly runs and acceptances with their rows in the database, and
 * repairs them (history.h).
 */
#ifndef NEPH_HARNESS_RUN_HISTORY_CHECK_H
#define NEPH_HARNESS_RUN_HISTORY_CHECK_H

#include "harness/run/database.h"

/* A damaged or changed document. */
struct neph_history_fault {
    const char *document; /* its file in STORE/history/ */
    const char *why;
    bool mended;
};

typedef void neph_history_report(const struct neph_history_fault *fault, void *context);

/* Compares the rows of each finished run with its document. NEPH_ERR_INPUT: they differ; the
 * message names the first such run. NEPH_ERR_NOT_FOUND: a document is missing. NEPH_ERR_IO: a
 * document cannot be read. */
enum neph_status neph_history_check(struct neph_database *index, const char *store_folder,
                                    struct neph_diag *diag);

/* Writes damaged documents again from their rows, where these can be read. Call this before the
 * database is rebuilt, so that no run is lost. Errors as of neph_history_check(), without
 * NEPH_ERR_INPUT; on an error keep the database as it is. */
enum neph_status neph_history_repair(struct neph_database *index, const char *store_folder,
                                     struct neph_diag *diag);

/* Compares each acceptance's document, copy and row. `mends`: rewrites the damaged, missing or
 * different ones from the correct one: two that agree, else the document, else the copy.
 * NEPH_ERR_IO: a file cannot be read or written. */
enum neph_status neph_history_check_acceptances(struct neph_database *index,
                                                const char *store_folder, bool mends,
                                                neph_history_report *tell, void *context,
                                                struct neph_diag *diag);

/* Reports damaged documents of runs without rows, which neither a nightly run nor a repair can use.
 */
enum neph_status neph_history_check_torn(struct neph_database *index, const char *store_folder,
                                         neph_history_report *tell, void *context,
                                         struct neph_diag *diag);

/* Compares the currently accepted runs (by the last acceptance of all series and the later ones)
 * with their documents, and the documents with the digests of the acceptances. */
enum neph_status neph_history_check_baseline(struct neph_database *index, const char *store_folder,
                                             neph_history_report *tell, void *context,
                                             struct neph_diag *diag);

#endif
