/* SPDX-License-Identifier: MIT
 *
 * Records: structs that are at the same time objects of JSON and rows of the database. A text of
 * fields says how, with a word for each member in order: a letter, a colon and its name in JSON, as
 * in "s:name d:wall_s".
 *
 * s  a const char *; "" where there is none
 * o  the same; JSON leaves it out where it is ""
 * i  an int64_t
 * d  a double
 * n  a double, null where it is NaN
 * p  two int64_t: a list in JSON, and two columns
 */
#ifndef NEPH_HARNESS_RUN_RECORD_H
#define NEPH_HARNESS_RUN_RECORD_H

#include "base/arena.h"
#include "harness/json.h"
#include "harness/run/database.h"

/* The most columns of a record. */
enum { NEPH_RECORD_COLUMNS = 24 };

/* A struct as JSON; NULL: it cannot be. */
json_t *neph_record_json(const char *fields, const void *record);

/* Read a struct from JSON, whose texts it borrows; with an `arena` it gets copies of them. What is
 * missing is "", 0 or NaN. */
void neph_record_read(const char *fields, const json_t *json, struct neph_arena *arena,
                      void *record);

/* Read it from the columns of a row, from `column` on; its texts live until the next row. */
void neph_record_row(const char *fields, struct neph_query *row, int column, void *record);

/* The rows of a question whose ? is `first`, as a list of JSON: objects, or, for the fields "s:",
 * texts. NULL: a row is damaged. */
enum neph_status neph_record_list(struct neph_database *database, struct neph_diag *diag,
                                  const char *question, int64_t first, const char *fields,
                                  json_t **list);

bool neph_record_is_equal(const char *fields, const void *a, const void *b);

/* Carry out a statement whose ? are `first`, an integer, and then the columns of the record. */
enum neph_status neph_record_put(struct neph_database *database, struct neph_diag *diag,
                                 const char *statement, int64_t first, const char *fields,
                                 const void *record);

#endif
