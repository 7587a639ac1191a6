/* SPDX-License-Identifier: MIT
 *
 * SQLite, as far as the store needs it: one file, written ahead (WAL, where the file system has
 * it), brought to the form of this program by numbered steps, and an error for all that goes wrong.
 * Statements are texts of ours with ? for what they are given; `types` has a letter for each: s a
 * text (NULL: NULL), i an int64_t, d a double (not finite: NULL).
 *
 * Several processes may have the file open; each waits ten seconds for another's write. Errors:
 * NEPH_ERR_INPUT: the file is damaged or no database; NEPH_ERR_USAGE: a later program has changed
 * its form; NEPH_ERR_IO: a full disk, no permission, or another process that does not end writing;
 * NEPH_ERR_MEMORY; NEPH_ERR_INTERNAL: a statement that is wrong.
 */
#ifndef NEPH_HARNESS_RUN_DATABASE_H
#define NEPH_HARNESS_RUN_DATABASE_H

#include "base/status.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>

struct neph_database;
struct neph_query;

/* Open or create `path`. `steps` are the statements that lead from form to form, NULL-terminated:
 * those that the file has not seen (its user_version counts them) are carried out, each whole or
 * not at all. Free with neph_database_close. */
enum neph_status neph_database_open(const char *path, const char *const *steps,
                                    struct neph_database **database, struct neph_diag *diag);
void neph_database_close(struct neph_database *database);

/* Read all of it: NEPH_ERR_INPUT when its form is damaged. `thorough`: hold its indices against the
 * rows, too. That a number in a row was changed it cannot tell. */
enum neph_status neph_database_check(struct neph_database *database, bool thorough,
                                     struct neph_diag *diag);

/* Carry out one statement. */
enum neph_status neph_database_do(struct neph_database *database, struct neph_diag *diag,
                                  const char *statement, const char *types, ...);

/* As neph_database_do(), with the values as a list. */
union neph_database_value {
    const char *text;
    int64_t integer;
    double real;
};
enum neph_status neph_database_put(struct neph_database *database, struct neph_diag *diag,
                                   const char *statement, const char *types,
                                   const union neph_database_value *values);

/* All that is done from _begin to _end is done whole or not at all. _end is called in any case,
 * with the status so far: after a failure, which it returns, nothing was done. They do not nest. */
enum neph_status neph_database_begin(struct neph_database *database, struct neph_diag *diag);
enum neph_status neph_database_end(struct neph_database *database, enum neph_status status,
                                   struct neph_diag *diag);

/* A question, whose rows are read with neph_query_next(). That it cannot be asked, too, is told by
 * neph_query_end(). */
struct neph_query *neph_query(struct neph_database *database, struct neph_diag *diag,
                              const char *statement, const char *types, ...);
struct neph_query *neph_query_list(struct neph_database *database, struct neph_diag *diag,
                                   const char *statement, const char *types, va_list values);

/* The next row: false when there is none, or after an error. */
bool neph_query_next(struct neph_query *query);

/* A column of the row, from 0. Texts live until the next row; "" and NaN of NULL. */
const char *neph_query_text(struct neph_query *query, int column);
int64_t neph_query_integer(struct neph_query *query, int column);
double neph_query_real(struct neph_query *query, int column);

/* To be called in any case. `status`, what went wrong with a row, or what went wrong with the
 * question. */
enum neph_status neph_query_end(struct neph_query *query, enum neph_status status);

/* A question whose answer is one number; 0 when there is no row. */
enum neph_status neph_database_count(struct neph_database *database, int64_t *count,
                                     struct neph_diag *diag, const char *statement,
                                     const char *types, ...);

#endif
