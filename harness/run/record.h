/* SPDX-License-Identifier: MIT
 *
 * Records: structs that are JSON objects and database rows as well. A form lists the members of a
 * struct in the order of the row's columns; the JSON keys are the names of the members:
 *
 *     #define STEP(member) NEPH_RECORD_FIELD(struct step, member)
 *     static const struct neph_record_form step_form = {sizeof(struct step),
 *                                                       {STEP(name), STEP(wall_s)}};
 *
 * A form whose only field has the name "" is a string in JSON instead of an object.
 */
#ifndef NEPH_HARNESS_RUN_RECORD_H
#define NEPH_HARNESS_RUN_RECORD_H

#include "base/arena.h"
#include "harness/json.h"
#include "harness/run/database.h"

#include <stddef.h>

enum neph_record_kind {
    NEPH_RECORD_TEXT,    /* const char *; "" when missing */
    NEPH_RECORD_INTEGER, /* int64_t */
    NEPH_RECORD_PAIR,    /* int64_t[2]: a list in JSON, and two columns */
    NEPH_RECORD_REAL,    /* double; null in JSON when not finite */
    NEPH_RECORD_KIND_COUNT,
};

struct neph_record_field {
    const char *name;
    size_t at;
    enum neph_record_kind kind;
    bool may_lack; /* JSON omits a text that is "", and has null for a real that is NaN */
};

/* Offset and kind of a member; a member of any other type does not compile. */
#define NEPH_RECORD_MEMBER(record, member)                                                         \
    .at = offsetof(record, member), .kind = _Generic(&((record *)0)->member,                       \
                                                     const char **: NEPH_RECORD_TEXT,              \
                                                     int64_t *: NEPH_RECORD_INTEGER,               \
                                                     int64_t (*)[2]: NEPH_RECORD_PAIR,             \
                                                     double *: NEPH_RECORD_REAL)

/* A field named like its member, and the same for an optional one. */
#define NEPH_RECORD_FIELD(record, member)                                                          \
    {                                                                                              \
        .name = #member, NEPH_RECORD_MEMBER(record, member)                                        \
    }
#define NEPH_RECORD_OPTIONAL(record, member)                                                       \
    {                                                                                              \
        .name = #member, NEPH_RECORD_MEMBER(record, member), .may_lack = true                      \
    }

/* Limits; more fields do not compile. */
enum { NEPH_RECORD_FIELDS = 16, NEPH_RECORD_COLUMNS = 2 * NEPH_RECORD_FIELDS };

struct neph_record_form {
    size_t size; /* of the struct, in bytes */
    struct neph_record_field fields[NEPH_RECORD_FIELDS];
};

/* The form of a single text, a const char *. */
extern const struct neph_record_form neph_record_text_form;

/* A struct as JSON; NULL: out of memory. */
json_t *neph_record_json(const struct neph_record_form *form, const void *record);

/* Reads a struct from JSON. Its texts point into the JSON, or are copies in `arena`. A missing
 * value is "" or 0, or NaN when it is optional. */
void neph_record_read(const struct neph_record_form *form, const json_t *json,
                      struct neph_arena *arena, void *record);

/* Reads a struct from the columns of a row, from `column` on. Its texts are valid until the next
 * row, or are copies in `arena`. */
void neph_record_row(const struct neph_record_form *form, struct neph_query *row, int column,
                     struct neph_arena *arena, void *record);

/* Compares all columns; texts by content. */
bool neph_record_is_equal(const struct neph_record_form *form, const void *a, const void *b);

/* An array of records. */
struct neph_records {
    void *list;
    int count;
};

/* The rows of a query as records, with copies of their texts, in the arena. */
enum neph_status neph_record_select(struct neph_database *database, struct neph_arena *arena,
                                    const struct neph_record_form *form,
                                    struct neph_records *records, struct neph_diag *diag,
                                    const char *question, const char *types, ...);

/* The first text of a query, copied to the arena; "" when there is no row. */
enum neph_status neph_record_text(struct neph_database *database, struct neph_arena *arena,
                                  const char **text, struct neph_diag *diag, const char *question,
                                  const char *types, ...);

/* The rows of a query as a JSON list. NULL: a row is damaged. */
enum neph_status neph_record_list(struct neph_database *database,
                                  const struct neph_record_form *form, json_t **list,
                                  struct neph_diag *diag, const char *question, const char *types,
                                  ...);

/* Runs a statement whose "?" are the integer `first` and then the columns of the record. */
enum neph_status neph_record_put(struct neph_database *database, struct neph_diag *diag,
                                 const char *statement, int64_t first,
                                 const struct neph_record_form *form, const void *record);

#endif
