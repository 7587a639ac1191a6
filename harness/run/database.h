/* SPDX-License-Identifier: MIT
 *
 * SQLite as the store uses it: one file, migrated by numbered steps, with an error for every
 * failure.
 *
 * The file is written ahead (WAL) where the file system supports that. Statements are constant
 * texts with "?" for each value. `types` has one letter for each value: s a text (NULL: NULL), i an
 * int64_t, d a double (not finite: NULL).
 *
 * Several processes may have the file open. Each waits up to 10 s for the write of another. Errors:
 *
 *   NEPH_ERR_INPUT      the file is damaged or is no database
 *   NEPH_ERR_USAGE      a later program has migrated the file
 *   NEPH_ERR_IO         full disk, no permission, or the write lock stayed taken
 *   NEPH_ERR_MEMORY     out of memory
 *   NEPH_ERR_INTERNAL   a wrong statement
 */
#ifndef NEPH_HARNESS_RUN_DATABASE_H
#define NEPH_HARNESS_RUN_DATABASE_H

#include "base/status.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>

struct neph_database;
struct neph_query;

/* Opens or creates `path`. `steps` are the migration statements, NULL-terminated. The steps that
 * the file does not have yet (its user_version is their number) run as one transaction. Free with
 * neph_database_close(). */
enum neph_status neph_database_open(const char *path, const char *const *steps,
                                    struct neph_database **database, struct neph_diag *diag);
void neph_database_close(struct neph_database *database);

/* Checks the whole file: NEPH_ERR_INPUT when its structure is damaged. `thorough`: also compares
 * the indices with the rows. A changed number in a row is not detected. */
enum neph_status neph_database_check(struct neph_database *database, bool thorough,
                                     struct neph_diag *diag);

/* Runs one statement. */
enum neph_status neph_database_do(struct neph_database *database, struct neph_diag *diag,
                                  const char *statement, const char *types, ...);

/* Like neph_database_do(), with the values as an array. */
union neph_database_value {
    const char *text;
    int64_t integer;
    double real;
};
enum neph_status neph_database_put(struct neph_database *database, struct neph_diag *diag,
                                   const char *statement, const char *types,
                                   const union neph_database_value *values);

/* A transaction: everything between _begin and _end is written completely or not at all. Call _end
 * in any case, with the status so far: a failure is returned, and nothing is written. Transactions
 * do not nest. */
enum neph_status neph_database_begin(struct neph_database *database, struct neph_diag *diag);
enum neph_status neph_database_end(struct neph_database *database, enum neph_status status,
                                   struct neph_diag *diag);

/* Starts a query, whose rows neph_query_next() reads. Errors of the start are returned by
 * neph_query_end(). */
struct neph_query *neph_query(struct neph_database *database, struct neph_diag *diag,
                              const char *statement, const char *types, ...);

/* Like neph_query(), with the values as a va_list. */
struct neph_query *neph_query_list(struct neph_database *database, struct neph_diag *diag,
                                   const char *statement, const char *types, va_list values);

/* Moves to the next row; false: there is none, or an error occurred. */
bool neph_query_next(struct neph_query *query);

/* A column of the row, from 0. Texts are valid until the next row. NULL reads as "", 0 or NaN. */
const char *neph_query_text(struct neph_query *query, int column);
int64_t neph_query_integer(struct neph_query *query, int column);
double neph_query_real(struct neph_query *query, int column);

/* Ends a query; call it in any case. Returns `status` where that is an error (one that the caller
 * met in a row), else the query's own status. */
enum neph_status neph_query_end(struct neph_query *query, enum neph_status status);

/* Runs a query whose result is one number; 0 when there is no row. */
enum neph_status neph_database_count(struct neph_database *database, int64_t *count,
                                     struct neph_diag *diag, const char *statement,
                                     const char *types, ...);

#endif
