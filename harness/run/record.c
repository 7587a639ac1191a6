/* SPDX-License-Identifier: MIT */
#include "harness/run/record.h"

#include <stdio.h>
#include <string.h>

/* All members have the size of a value of the database. */
enum { SIZE = sizeof(union neph_database_value) };
_Static_assert(SIZE == sizeof(const char *) && SIZE == sizeof(int64_t) && SIZE == sizeof(double),
               "members have one size");

struct field {
    char type, column_type; /* the latter in terms of database.h */
    char name[32];
    int columns;
};

/* Take the next field from a text of them; false: there is none. */
static bool next(const char **fields, struct field *field)
{
    const char *at = *fields + strspn(*fields, " ");
    if (!*at)
        return false;
    const size_t length = strcspn(at, " ");
    field->type = *at;
    field->column_type = strchr("ip", *at) ? 'i' : strchr("dn", *at) ? 'd' : 's';
    field->columns = *at == 'p' ? 2 : 1;
    snprintf(field->name, sizeof(field->name), "%.*s", (int)length - 2, at + 2);
    *fields = at + length;
    return true;
}

/* Copy a record to values, and back; returns how many they are. */
static int get(const char *fields, const void *record, union neph_database_value *values)
{
    struct field field;
    int count = 0;
    while (next(&fields, &field))
        count += field.columns;
    memcpy(values, record, (size_t)count * SIZE);
    return count;
}

static void set(void *record, const union neph_database_value *values, int count)
{
    memcpy(record, values, (size_t)count * SIZE);
}

static json_t *field_json(const struct field *field, const union neph_database_value *values)
{
    switch (field->type) {
    case 'i':
        return json_integer(values[0].integer);
    case 'p':
        return json_pack("[I, I]", (json_int_t)values[0].integer, (json_int_t)values[1].integer);
    case 'd':
        return json_real(values[0].real);
    case 'n':
        return neph_json_number(values[0].real);
    default:
        return json_string(values[0].text);
    }
}

json_t *neph_record_json(const char *fields, const void *record)
{
    union neph_database_value values[NEPH_RECORD_COLUMNS], *at = values;
    struct field field;
    json_t *json = json_object();
    get(fields, record, values);
    for (; next(&fields, &field); at += field.columns)
        if (field.type != 'o' || at->text[0])
            neph_json_set(&json, field.name, field_json(&field, at));
    return json;
}

void neph_record_read(const char *fields, const json_t *json, struct neph_arena *arena,
                      void *record)
{
    union neph_database_value values[NEPH_RECORD_COLUMNS];
    struct field field;
    int count = 0;
    while (next(&fields, &field)) {
        const json_t *found = json_object_get(json, field.name);
        const char *text = neph_json_text(json, field.name);
        for (size_t i = 0; field.type == 'p' && i < 2; i++)
            values[count++].integer = json_integer_value(json_array_get(found, i));
        if (field.type == 'i')
            values[count++].integer = json_integer_value(found);
        else if (field.type == 'd')
            values[count++].real = json_number_value(found);
        else if (field.type == 'n')
            values[count++].real = neph_json_real(json, field.name);
        else if (field.type != 'p')
            values[count++].text = arena ? neph_arena_text(arena, text) : text;
    }
    set(record, values, count);
}

void neph_record_row(const char *fields, struct neph_query *row, int column, void *record)
{
    union neph_database_value values[NEPH_RECORD_COLUMNS];
    struct field field;
    int count = 0;
    while (next(&fields, &field))
        for (int i = 0; i < field.columns; i++, column++, count++) {
            if (field.column_type == 'i')
                values[count].integer = neph_query_integer(row, column);
            else if (field.column_type == 'd')
                values[count].real = neph_query_real(row, column);
            else
                values[count].text = neph_query_text(row, column);
        }
    set(record, values, count);
}

enum neph_status neph_record_list(struct neph_database *database, struct neph_diag *diag,
                                  const char *question, int64_t first, const char *fields,
                                  json_t **list)
{
    json_t *rows = json_array();
    struct neph_query *query = neph_query(database, diag, question, "i", first);
    while (neph_query_next(query)) {
        union neph_database_value record[NEPH_RECORD_COLUMNS];
        neph_record_row(fields, query, 0, record);
        neph_json_add(&rows, strcmp(fields, "s:") == 0 ? json_string(record[0].text)
                                                       : neph_record_json(fields, record));
    }
    const enum neph_status status = neph_query_end(query, NEPH_OK);
    if (status)
        json_decref(rows);
    else
        *list = rows;
    return status;
}

bool neph_record_is_equal(const char *fields, const void *a, const void *b)
{
    union neph_database_value of_a[NEPH_RECORD_COLUMNS], of_b[NEPH_RECORD_COLUMNS];
    struct field field;
    bool same = true;
    get(fields, a, of_a);
    get(fields, b, of_b);
    for (int at = 0; next(&fields, &field);)
        for (int i = 0; i < field.columns; i++, at++)
            same = same && (field.column_type == 's'   ? strcmp(of_a[at].text, of_b[at].text) == 0
                            : field.column_type == 'i' ? of_a[at].integer == of_b[at].integer
                                                       : of_a[at].real == of_b[at].real);
    return same;
}

enum neph_status neph_record_put(struct neph_database *database, struct neph_diag *diag,
                                 const char *statement, int64_t first, const char *fields,
                                 const void *record)
{
    union neph_database_value values[NEPH_RECORD_COLUMNS + 1] = {{.integer = first}};
    char types[NEPH_RECORD_COLUMNS + 2] = "i";
    struct field field;
    get(fields, record, &values[1]);
    for (int at = 1; next(&fields, &field);)
        for (int i = 0; i < field.columns; i++)
            types[at++] = field.column_type;
    return neph_database_put(database, diag, statement, types, values);
}
