/* SPDX-License-Identifier: MIT
 *
 * Records: structs that are at the same time objects of JSON and rows of the database. A form lists
 * the members of a struct in the order of the row's columns; their names are those in JSON:
 *
 *     #define STEP(member) NEPH_RECORD_FIELD(struct step, member)
 *     static const struct neph_record_form step_form = {sizeof(struct step),
 *                                                       {STEP(name), STEP(wall_s)}};
 *
 * A form whose only field has the name "" is a text in JSON, and not an object.
 */
#ifndef NEPH_HARNESS_RUN_RECORD_H
#define NEPH_HARNESS_RUN_RECORD_H

#include "base/arena.h"
#include "harness/json.h"
#include "harness/run/database.h"

#include <stddef.h>

enum neph_record_kind {
    NEPH_RECORD_TEXT,    /* const char *; "" where there is none */
    NEPH_RECORD_INTEGER, /* int64_t */
    NEPH_RECORD_PAIR,    /* int64_t[2]: a list in JSON, and two columns */
    NEPH_RECORD_REAL,    /* double; JSON cannot have one that is not finite */
    NEPH_RECORD_KIND_COUNT,
};

struct neph_record_field {
    const char *name;
    size_t at;
    enum neph_record_kind kind;
    bool may_lack; /* JSON leaves a text out where it is "", and has null for a real that is NaN */
};

/* Place and kind of a member; one of another type does not compile. */
#define NEPH_RECORD_MEMBER(record, member)                                                         \
    .at = offsetof(record, member), .kind = _Generic(&((record *)0)->member,                       \
                                                     const char **: NEPH_RECORD_TEXT,              \
                                                     int64_t *: NEPH_RECORD_INTEGER,               \
                                                     int64_t (*)[2]: NEPH_RECORD_PAIR,             \
                                                     double *: NEPH_RECORD_REAL)

/* A field with the name of its member; and one that may lack. */
#define NEPH_RECORD_FIELD(record, member)                                                          \
    {                                                                                              \
        .name = #member, NEPH_RECORD_MEMBER(record, member)                                        \
    }
#define NEPH_RECORD_OPTIONAL(record, member)                                                       \
    {                                                                                              \
        .name = #member, NEPH_RECORD_MEMBER(record, member), .may_lack = true                      \
    }

/* More fields than these do not compile. */
enum { NEPH_RECORD_FIELDS = 16, NEPH_RECORD_COLUMNS = 2 * NEPH_RECORD_FIELDS };

struct neph_record_form {
    size_t size; /* of the struct */
    struct neph_record_field fields[NEPH_RECORD_FIELDS];
};

/* The form of a text by itself, a const char *. */
extern const struct neph_record_form neph_record_text_form;

/* A struct as JSON; NULL: it cannot be. */
json_t *neph_record_json(const struct neph_record_form *form, const void *record);

/* Read a struct from JSON, whose texts it borrows; with an `arena` it gets copies of them. A value
 * that is missing is "", 0, or NaN if it may lack. */
void neph_record_read(const struct neph_record_form *form, const json_t *json,
                      struct neph_arena *arena, void *record);

/* Read it from the columns of a row, from `column` on. Its texts live until the next row; with an
 * `arena` it gets copies of them. */
void neph_record_row(const struct neph_record_form *form, struct neph_query *row, int column,
                     struct neph_arena *arena, void *record);

bool neph_record_is_equal(const struct neph_record_form *form, const void *a, const void *b);

/* Records in an array. */
struct neph_records {
    void *list;
    int count;
};

/* The rows of a question as records of the arena, with copies of their texts. */
enum neph_status neph_record_select(struct neph_database *database, struct neph_arena *arena,
                                    const struct neph_record_form *form,
                                    struct neph_records *records, struct neph_diag *diag,
                                    const char *question, const char *types, ...);

/* A question whose answer is one text, of the arena; "" when there is no row. */
enum neph_status neph_record_text(struct neph_database *database, struct neph_arena *arena,
                                  const char **text, struct neph_diag *diag, const char *question,
                                  const char *types, ...);

/* The rows of a question as a list of JSON. NULL: a row is damaged. */
enum neph_status neph_record_list(struct neph_database *database,
                                  const struct neph_record_form *form, json_t **list,
                                  struct neph_diag *diag, const char *question, const char *types,
                                  ...);

/* Carry out a statement whose ? are `first`, an integer, and then the columns of the record. */
enum neph_status neph_record_put(struct neph_database *database, struct neph_diag *diag,
                                 const char *statement, int64_t first,
                                 const struct neph_record_form *form, const void *record);

#endif
