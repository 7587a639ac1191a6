/* SPDX-License-Identifier: MIT */
#include "harness/run/record.h"

#include <string.h>

_Static_assert(sizeof(union neph_database_value) == sizeof(const char *) &&
                   sizeof(union neph_database_value) == sizeof(int64_t) &&
                   sizeof(union neph_database_value) == sizeof(double),
               "all members have one size");

/* The columns of a field. */
static int count(const struct neph_record_field *field)
{
    return field->type == 'p' ? 2 : 1;
}

/* In terms of database.h. */
static char column_type(const struct neph_record_field *field)
{
    return strchr("ip", field->type) ? 'i' : strchr("dn", field->type) ? 'd' : 's';
}

static void get(const struct neph_record_field *field, const void *record,
                union neph_database_value values[2])
{
    memcpy(values, (const char *)record + field->at, (size_t)count(field) * sizeof(*values));
}

static void set(const struct neph_record_field *field, void *record,
                const union neph_database_value values[2])
{
    memcpy((char *)record + field->at, values, (size_t)count(field) * sizeof(*values));
}

static json_t *field_json(const struct neph_record_field *field,
                          const union neph_database_value values[2])
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

json_t *neph_record_json(const struct neph_record_field *fields, const void *record)
{
    json_t *json = json_object();
    for (; fields->name; fields++) {
        union neph_database_value values[2];
        get(fields, record, values);
        if (fields->type != 'o' || values[0].text[0])
            neph_json_set(&json, fields->name, field_json(fields, values));
    }
    return json;
}

void neph_record_read(const struct neph_record_field *fields, const json_t *json, void *record)
{
    for (; fields->name; fields++) {
        const json_t *found = json_object_get(json, fields->name);
        union neph_database_value values[2] = {{.text = neph_json_text(json, fields->name)}};
        if (fields->type == 'i')
            values[0].integer = json_integer_value(found);
        else if (fields->type == 'd')
            values[0].real = json_number_value(found);
        else if (fields->type == 'n')
            values[0].real = neph_json_real(json, fields->name);
        for (size_t i = 0; fields->type == 'p' && i < 2; i++)
            values[i].integer = json_integer_value(json_array_get(found, i));
        set(fields, record, values);
    }
}

void neph_record_row(const struct neph_record_field *fields, struct neph_query *row, int column,
                     void *record)
{
    for (; fields->name; fields++) {
        union neph_database_value values[2];
        for (int i = 0; i < count(fields); i++, column++) {
            if (column_type(fields) == 'i')
                values[i].integer = neph_query_integer(row, column);
            else if (column_type(fields) == 'd')
                values[i].real = neph_query_real(row, column);
            else
                values[i].text = neph_query_text(row, column);
        }
        set(fields, record, values);
    }
}

enum neph_status neph_record_list(struct neph_database *database, struct neph_diag *diag,
                                  const char *question, int64_t first,
                                  const struct neph_record_field *fields, json_t **list)
{
    const bool is_text = !fields[0].name[0];
    json_t *rows = json_array();
    struct neph_query *query = neph_query(database, diag, question, "i", first);
    while (neph_query_next(query)) {
        union neph_database_value record[NEPH_RECORD_COLUMNS];
        if (!is_text)
            neph_record_row(fields, query, 0, record);
        neph_json_add(&rows, is_text ? json_string(neph_query_text(query, 0))
                                     : neph_record_json(fields, record));
    }
    const enum neph_status status = neph_query_end(query, NEPH_OK);
    if (status)
        json_decref(rows);
    else
        *list = rows;
    return status;
}

bool neph_record_is_equal(const struct neph_record_field *fields, const void *a, const void *b)
{
    bool same = true;
    for (; same && fields->name; fields++) {
        union neph_database_value of_a[2], of_b[2];
        get(fields, a, of_a);
        get(fields, b, of_b);
        for (int i = 0; i < count(fields); i++)
            same = same && (column_type(fields) == 's'   ? strcmp(of_a[i].text, of_b[i].text) == 0
                            : column_type(fields) == 'i' ? of_a[i].integer == of_b[i].integer
                                                         : of_a[i].real == of_b[i].real);
    }
    return same;
}

enum neph_status neph_record_put(struct neph_database *database, struct neph_diag *diag,
                                 const char *statement, int64_t first,
                                 const struct neph_record_field *fields, const void *record)
{
    union neph_database_value values[NEPH_RECORD_COLUMNS] = {{.integer = first}};
    char types[NEPH_RECORD_COLUMNS + 1] = "i";
    for (int at = 1; fields->name; fields++) {
        get(fields, record, &values[at]);
        for (int i = 0; i < count(fields); i++)
            types[at++] = column_type(fields);
    }
    return neph_database_put(database, diag, statement, types, values);
}
