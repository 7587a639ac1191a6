/* SPDX-License-Identifier: MIT
 *
 * Whether the documents of nights and acceptances and their rows in the database say the same, and
 * how they are mended when they do not (history.h).
 */
#ifndef NEPH_HARNESS_RUN_HISTORY_CHECK_H
#define NEPH_HARNESS_RUN_HISTORY_CHECK_H

#include "harness/run/database.h"

/* A document that is not as it was written. */
struct neph_history_fault {
    const char *document; /* its file in STORE/history/ */
    const char *why;
    bool mended;
};

typedef void neph_history_tell(const struct neph_history_fault *fault, void *context);

/* Whether the rows of each finished night say what its document says: NEPH_ERR_INPUT names the
 * first that does not. NEPH_ERR_NOT_FOUND: a document is missing; NEPH_ERR_IO: it cannot be
 * read. */
enum neph_status neph_history_check(struct neph_database *index, const char *store_folder,
                                    struct neph_diag *diag);

/* To be called before a database is made again, so that no night is lost: documents that are torn
 * are written anew from their rows, where these can be read. Errors as of neph_history_check(), but
 * never NEPH_ERR_INPUT: the database must then stay as it is. */
enum neph_status neph_history_mend(struct neph_database *index, const char *store_folder,
                                   struct neph_diag *diag);

/* Compare the document of each acceptance with its copy and its row. `mends`: write what is torn,
 * missing or different anew from the others: of document, copy and row two that agree are right,
 * else the document, then the copy. NEPH_ERR_IO: a file cannot be read or written. */
enum neph_status neph_history_check_acceptances(struct neph_database *index,
                                                const char *store_folder, bool mends,
                                                neph_history_tell *tell, void *context,
                                                struct neph_diag *diag);

/* Name the torn documents of nights that have no row: neither a night nor a repair can use them. */
enum neph_status neph_history_check_torn(struct neph_database *index, const char *store_folder,
                                         neph_history_tell *tell, void *context,
                                         struct neph_diag *diag);

/* Compare the nights that are accepted now, by the last acceptance of all and those after it, with
 * their documents, and these with the digest that the acceptance holds. */
enum neph_status neph_history_check_baseline(struct neph_database *index, const char *store_folder,
                                             neph_history_tell *tell, void *context,
                                             struct neph_diag *diag);

#endif
