/* SPDX-License-Identifier: MIT
 *
 * Records: structs as JSON objects and as database rows.
 */
#include "harness/run/record.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

/* Fails to compile when a kind is added, as the tables and switches of this file need it. */
_Static_assert(NEPH_RECORD_KIND_COUNT == 4, "a new kind");

/* A member occupies as many bytes as the values of its columns. */
enum { SIZE = sizeof(union neph_database_value) };
_Static_assert(SIZE == sizeof(const char *) && SIZE == sizeof(int64_t) && SIZE == sizeof(double),
               "a member of one column has the size of its value");

static const char column_types[] = {[NEPH_RECORD_TEXT] = 's',
                                    [NEPH_RECORD_INTEGER] = 'i',
                                    [NEPH_RECORD_PAIR] = 'i',
                                    [NEPH_RECORD_REAL] = 'd'};

const struct neph_record_form neph_record_text_form = {sizeof(const char *),
                                                       {{"", 0, NEPH_RECORD_TEXT, false}}};

static int count_fields(const struct neph_record_form *form)
{
    int count = 0;
    while (count < NEPH_RECORD_FIELDS && form->fields[count].name)
        count++;
    return count;
}

static int count_columns(const struct neph_record_field *field)
{
    return field->kind == NEPH_RECORD_PAIR ? 2 : 1;
}

/* Copy a member to the values of its columns, and back. */
static void copy_member_to_values(const struct neph_record_field *field, const void *record,
                                  union neph_database_value *values)
{
    memcpy(values, (const char *)record + field->at, (size_t)count_columns(field) * SIZE);
}

static void copy_values_to_member(const struct neph_record_field *field, void *record,
                                  const union neph_database_value *values)
{
    memcpy((char *)record + field->at, values, (size_t)count_columns(field) * SIZE);
}

/* ---- JSON ------------------------------------------------------------------------------------ */

static json_t *field_json(const struct neph_record_field *field,
                          const union neph_database_value *values)
{
    switch (field->kind) {
    case NEPH_RECORD_INTEGER:
        return json_integer(values[0].integer);
    case NEPH_RECORD_PAIR:
        return json_pack("[I, I]", (json_int_t)values[0].integer, (json_int_t)values[1].integer);
    case NEPH_RECORD_REAL:
        return field->may_lack ? neph_json_number(values[0].real) : json_real(values[0].real);
    case NEPH_RECORD_TEXT:
        return json_string(values[0].text);
    case NEPH_RECORD_KIND_COUNT:
        break;
    }
    return NULL;
}

json_t *neph_record_json(const struct neph_record_form *form, const void *record)
{
    json_t *json = form->fields[0].name[0] ? json_object() : NULL;
    for (int i = 0, count = count_fields(form); i < count; i++) {
        const struct neph_record_field *field = &form->fields[i];
        union neph_database_value values[2];
        copy_member_to_values(field, record, values);
        if (!field->name[0])
            return field_json(field, values);
        if (field->kind != NEPH_RECORD_TEXT || !field->may_lack || values[0].text[0])
            neph_json_set(&json, field->name, field_json(field, values));
    }
    return json;
}

static void read_field(const struct neph_record_field *field, const json_t *value,
                       struct neph_arena *arena, union neph_database_value *values)
{
    const char *text = json_string_value(value);
    const double nothing = field->may_lack ? NAN : 0.0;
    switch (field->kind) {
    case NEPH_RECORD_INTEGER:
        values[0].integer = json_integer_value(value);
        break;
    case NEPH_RECORD_PAIR:
        for (size_t i = 0; i < 2; i++)
            values[i].integer = json_integer_value(json_array_get(value, i));
        break;
    case NEPH_RECORD_REAL:
        values[0].real = json_is_number(value) ? json_number_value(value) : nothing;
        break;
    case NEPH_RECORD_TEXT:
        text = text ? text : "";
        values[0].text = arena ? neph_arena_copy_text(arena, text) : text;
        break;
    case NEPH_RECORD_KIND_COUNT:
        break;
    }
}

void neph_record_read(const struct neph_record_form *form, const json_t *json,
                      struct neph_arena *arena, void *record)
{
    for (int i = 0, count = count_fields(form); i < count; i++) {
        const struct neph_record_field *field = &form->fields[i];
        union neph_database_value values[2];
        read_field(field, field->name[0] ? json_object_get(json, field->name) : json, arena,
                   values);
        copy_values_to_member(field, record, values);
    }
}

/* ---- rows ------------------------------------------------------------------------------------ */

void neph_record_row(const struct neph_record_form *form, struct neph_query *row, int column,
                     struct neph_arena *arena, void *record)
{
    for (int i = 0, count = count_fields(form); i < count; i++) {
        const struct neph_record_field *field = &form->fields[i];
        union neph_database_value values[2];
        for (int k = 0; k < count_columns(field); k++, column++) {
            if (column_types[field->kind] == 'i')
                values[k].integer = neph_query_integer(row, column);
            else if (column_types[field->kind] == 'd')
                values[k].real = neph_query_real(row, column);
            else
                values[k].text = neph_query_text(row, column);
        }
        if (arena && field->kind == NEPH_RECORD_TEXT)
            values[0].text = neph_arena_copy_text(arena, values[0].text);
        copy_values_to_member(field, record, values);
    }
}

/* Reads all rows and ends the query. */
static enum neph_status read_rows(struct neph_query *query, struct neph_arena *arena,
                                  const struct neph_record_form *form, struct neph_records *records,
                                  struct neph_diag *diag)
{
    char *list = NULL;
    int count = 0, room = 0;
    while (neph_query_next(query)) {
        list = neph_arena_grow_list(arena, list, count, &room, form->size);
        if (!list)
            break;
        neph_record_row(form, query, 0, arena, list + (size_t)count++ * form->size);
    }
    *records = (struct neph_records){list, list ? count : 0};
    return neph_query_end(query, neph_arena_check(arena, diag));
}

enum neph_status neph_record_select(struct neph_database *database, struct neph_arena *arena,
                                    const struct neph_record_form *form,
                                    struct neph_records *records, struct neph_diag *diag,
                                    const char *question, const char *types, ...)
{
    va_list values;
    va_start(values, types);
    struct neph_query *query = neph_query_list(database, diag, question, types, values);
    va_end(values);
    return read_rows(query, arena, form, records, diag);
}

enum neph_status neph_record_list(struct neph_database *database,
                                  const struct neph_record_form *form, json_t **list,
                                  struct neph_diag *diag, const char *question, const char *types,
                                  ...)
{
    struct neph_arena arena = {NULL};
    struct neph_records records;
    json_t *rows = json_array();
    va_list values;
    va_start(values, types);
    struct neph_query *query = neph_query_list(database, diag, question, types, values);
    va_end(values);
    const enum neph_status status = read_rows(query, &arena, form, &records, diag);
    for (int i = 0; i < records.count; i++)
        neph_json_add(&rows,
                      neph_record_json(form, (const char *)records.list + (size_t)i * form->size));
    neph_arena_finish(&arena);
    if (status)
        json_decref(rows);
    else
        *list = rows;
    return status;
}

enum neph_status neph_record_text(struct neph_database *database, struct neph_arena *arena,
                                  const char **text, struct neph_diag *diag, const char *question,
                                  const char *types, ...)
{
    va_list values;
    va_start(values, types);
    struct neph_query *query = neph_query_list(database, diag, question, types, values);
    va_end(values);
    *text = neph_query_next(query) ? neph_arena_copy_text(arena, neph_query_text(query, 0)) : "";
    return neph_query_end(query, neph_arena_check(arena, diag));
}

bool neph_record_is_equal(const struct neph_record_form *form, const void *a, const void *b)
{
    bool same = true;
    for (int i = 0, count = count_fields(form); i < count; i++) {
        const struct neph_record_field *field = &form->fields[i];
        union neph_database_value of_a[2], of_b[2];
        copy_member_to_values(field, a, of_a);
        copy_member_to_values(field, b, of_b);
        for (int k = 0; k < count_columns(field); k++)
            same = same &&
                   (column_types[field->kind] == 's'   ? strcmp(of_a[k].text, of_b[k].text) == 0
                    : column_types[field->kind] == 'i' ? of_a[k].integer == of_b[k].integer
                                                       : of_a[k].real == of_b[k].real);
    }
    return same;
}

enum neph_status neph_record_put(struct neph_database *database, struct neph_diag *diag,
                                 const char *statement, int64_t first,
                                 const struct neph_record_form *form, const void *record)
{
    union neph_database_value values[NEPH_RECORD_COLUMNS + 1] = {{.integer = first}};
    char types[NEPH_RECORD_COLUMNS + 2] = "i";
    int at = 1;
    for (int i = 0, count = count_fields(form); i < count; i++) {
        const struct neph_record_field *field = &form->fields[i];
        copy_member_to_values(field, record, &values[at]);
        for (int k = 0; k < count_columns(field); k++)
            types[at++] = column_types[field->kind];
    }
    return neph_database_put(database, diag, statement, types, values);
}
