/* SPDX-License-Identifier: MIT
 *
 * Records: members of a struct that are at the same time fields of a JSON object and columns of a
 * row of the database. One table of fields says which, in the order of all three.
 */
#ifndef NEPH_HARNESS_RUN_RECORD_H
#define NEPH_HARNESS_RUN_RECORD_H

#include "harness/json.h"
#include "harness/run/database.h"

#include <stddef.h>

struct neph_record_field {
    const char *name; /* in JSON */
    /* s: a const char *, "" where there is none; o: the same, which JSON leaves out where it is "";
     * i: an int64_t; d: a double; n: a double that may be NaN, which is null; p: two int64_t, a
     * list in JSON and two columns. */
    char type;
    size_t at;
};

/* The row of a member that has the field's name. Tables end with a NULL name. */
#define NEPH_FIELD(type, of, member)                                                               \
    {                                                                                              \
#member, type, offsetof(struct of, member)                                                 \
    }
enum { NEPH_RECORD_COLUMNS = 24 };

/* A struct as JSON; NULL: it cannot be. */
json_t *neph_record_json(const struct neph_record_field *fields, const void *record);

/* Read a struct from JSON, whose texts it borrows. What is missing is "", 0 or NaN. */
void neph_record_read(const struct neph_record_field *fields, const json_t *json, void *record);

/* Read it from the columns of a row, from `column` on; its texts live until the next row. */
void neph_record_row(const struct neph_record_field *fields, struct neph_query *row, int column,
                     void *record);

/* The rows of a question whose ? is `first`, as a list of JSON: objects, or texts where the only
 * field has the name "". NULL: a row is damaged. */
enum neph_status neph_record_list(struct neph_database *database, struct neph_diag *diag,
                                  const char *question, int64_t first,
                                  const struct neph_record_field *fields, json_t **list);

bool neph_record_is_equal(const struct neph_record_field *fields, const void *a, const void *b);

/* Give a statement whose ? are `first`, an integer, and then the columns of the record. */
enum neph_status neph_record_put(struct neph_database *database, struct neph_diag *diag,
                                 const char *statement, int64_t first,
                                 const struct neph_record_field *fields, const void *record);

#endif
