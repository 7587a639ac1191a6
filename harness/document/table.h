/* SPDX-License-Identifier: MIT
 *
 * A table of results: filled once, written as Markdown for people, as CSV and as JSON.
 */
#ifndef NEPH_HARNESS_DOCUMENT_TABLE_H
#define NEPH_HARNESS_DOCUMENT_TABLE_H

#include "base/arena.h"
#include "harness/json.h"

#include <stdio.h>

/* The forms that have a column, as bits. */
enum neph_table_forms {
    NEPH_TABLE_TEXT = 1,
    NEPH_TABLE_CSV = 2,
    NEPH_TABLE_JSON = 4,
    NEPH_TABLE_DATA = NEPH_TABLE_CSV | NEPH_TABLE_JSON,
    NEPH_TABLE_ALL = NEPH_TABLE_TEXT | NEPH_TABLE_DATA,
};

struct neph_column {
    const char *key;    /* its name in CSV and JSON; NULL: it is in neither */
    const char *title;  /* its name for people, "" included; NULL: they do not see it */
    const char *format; /* of its numbers for people, as "%.3f"; NULL: a column of words */
    double scale;       /* of its numbers for people: 100 for percents; 0 means 1 */
    const char *none;   /* for people, where a number is NaN; NULL: "-" */
    int forms;          /* of those that key and title allow; 0: all of them */
    int width;          /* of neph_table_print_aligned(), as of "%*s": negative: on the left */
};

/* A column of a double at this offset of a struct. */
struct neph_field {
    struct neph_column column;
    size_t at;
};

struct neph_table_cell;

/* Start from {0}; free with neph_table_finish(). Texts are copied. A failure of memory is kept and
 * told by neph_table_check(); a table that has one may be filled on and written. */
struct neph_table {
    struct neph_arena arena;
    struct neph_column *columns;
    struct neph_table_cell *cells; /* row after row */
    int column_count, cell_count, cell_room;
};

/* Columns come before the first cell. */
void neph_table_column(struct neph_table *table, struct neph_column column);
void neph_table_columns(struct neph_table *table, const struct neph_column *columns, int count);

/* The next cell: of a row from left to right, then of the next row. A word is a text (NULL: none),
 * cleaned (base/text.h); a number that is NaN is an empty cell of CSV and null in JSON. */
void neph_table_word(struct neph_table *table, const char *word);
void neph_table_number(struct neph_table *table, double value);
void neph_table_count(struct neph_table *table, long value);
void neph_table_flag(struct neph_table *table, bool value);

/* Any JSON, which is taken over; NULL: memory was short. CSV has nothing of it, and people see what
 * neph_table_shown() says. */
void neph_table_value(struct neph_table *table, json_t *value);

/* The text for people of the cell before, in place of its column's format. */
void neph_table_shown(struct neph_table *table, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Several numbers. */
void neph_table_numbers(struct neph_table *table, int count, const double *values);

/* Columns of numbers that are members of a struct, and the cells of one such struct. */
void neph_table_fields(struct neph_table *table, const struct neph_field *fields, int count);
void neph_table_field_cells(struct neph_table *table, const struct neph_field *fields, int count,
                            const void *of);

/* Leave out the remaining cells of a row: it is shorter for people, has empty fields of CSV, and
 * nulls in JSON. */
void neph_table_end_row(struct neph_table *table);

/* NEPH_ERR_MEMORY: memory was short while it was filled. */
enum neph_status neph_table_check(const struct neph_table *table, struct neph_diag *diag);

void neph_table_finish(struct neph_table *table);

/* Head, rule and rows: words on the left, numbers on the right. */
void neph_table_print(const struct neph_table *table, FILE *out);

/* The same without Markdown, for terminals: head and rows, columns of their widths, which longer
 * texts exceed. */
void neph_table_print_aligned(const struct neph_table *table, FILE *out);

/* RFC 4180, numbers with nine digits. Lines end in `line_end`, "\r\n" or "\n"; words in quotes
 * where they need them. */
void neph_table_print_csv(const struct neph_table *table, const char *line_end, FILE *out);

/* A list of objects, keyed as the columns; NULL: memory was short. */
json_t *neph_table_json(const struct neph_table *table);

/* An object, which is taken over, with the members of one struct; NULL: memory was short. */
json_t *neph_fields_json(json_t *object, const struct neph_field *fields, int count,
                         const void *of);

/* A field of CSV in quotes where it needs them; a number of nine digits, nothing for NaN. */
void neph_csv_word(const char *word, FILE *out);
void neph_csv_number(double value, FILE *out);

#endif
