/* SPDX-License-Identifier: MIT
 *
 * A table of results: filled once, written as Markdown for people, as CSV and as JSON.
 */
#ifndef NEPH_HARNESS_DOCUMENT_TABLE_H
#define NEPH_HARNESS_DOCUMENT_TABLE_H

#include "base/arena.h"
#include "harness/json.h"

#include <stdio.h>

/* The forms that contain a column, as bits. */
enum neph_table_forms {
    NEPH_TABLE_TEXT = 1,
    NEPH_TABLE_CSV = 2,
    NEPH_TABLE_JSON = 4,
    NEPH_TABLE_DATA = NEPH_TABLE_CSV | NEPH_TABLE_JSON,
    NEPH_TABLE_ALL = NEPH_TABLE_TEXT | NEPH_TABLE_DATA,
};

struct neph_column {
    const char *key;    /* name in CSV and JSON; NULL: the column is in neither */
    const char *title;  /* heading in Markdown, may be ""; NULL: the column is not shown */
    const char *format; /* printf format of numbers in Markdown, such as "%.3f"; NULL: a column of
                         * words */
    double scale;       /* factor for numbers in Markdown: 100 for percents; 0 means 1 */
    const char *none;   /* text in Markdown for NaN; NULL: "-" */
    int forms;          /* further restricts the forms of key and title; 0: no restriction */
    int width;          /* in neph_table_print_aligned(), as in "%*s": negative aligns left */
};

/* A column with the values of a double at this offset of a struct. */
struct neph_field {
    struct neph_column column;
    size_t at;
};

struct neph_table_cell;

/* Start from {0}; free with neph_table_finish(). Texts are copied. If memory runs short,
 * neph_table_check() reports it; until then such a table can still be filled and written. */
struct neph_table {
    struct neph_arena arena;
    struct neph_column *columns;
    struct neph_table_cell *cells; /* row by row */
    int column_count, cell_count, cell_room;
};

/* Add columns; all of them before the first cell. */
void neph_table_column(struct neph_table *table, struct neph_column column);
void neph_table_columns(struct neph_table *table, const struct neph_column *columns, int count);

/* Append a cell: rows are filled from left to right. A word is a text (NULL: none), cleaned
 * (base/text.h). A NaN number becomes an empty CSV cell and null in JSON. */
void neph_table_word(struct neph_table *table, const char *word);
void neph_table_number(struct neph_table *table, double value);
void neph_table_count(struct neph_table *table, long value);
void neph_table_flag(struct neph_table *table, bool value);

/* Append any JSON value and take it over; NULL: memory was short. The cell is empty in CSV; in
 * Markdown it shows the text of neph_table_shown(). */
void neph_table_value(struct neph_table *table, json_t *value);

/* Set the Markdown text of the last cell, in place of its column's format. */
void neph_table_shown(struct neph_table *table, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Append several numbers. */
void neph_table_numbers(struct neph_table *table, int count, const double *values);

/* Add columns of numbers that are members of a struct; append the cells of one such struct. */
void neph_table_fields(struct neph_table *table, const struct neph_field *fields, int count);
void neph_table_field_cells(struct neph_table *table, const struct neph_field *fields, int count,
                            const void *of);

/* End a row early: Markdown leaves its remaining cells out, CSV has empty fields, JSON has
 * nulls. */
void neph_table_end_row(struct neph_table *table);

/* NEPH_ERR_MEMORY: memory was short while the table was filled. */
enum neph_status neph_table_check(const struct neph_table *table, struct neph_diag *diag);

void neph_table_finish(struct neph_table *table);

/* Print Markdown: head, rule and rows; words are aligned left, numbers right. */
void neph_table_print(const struct neph_table *table, FILE *out);

/* Print for terminals, without Markdown: head and rows. Columns have their widths; a longer text
 * exceeds its column. */
void neph_table_print_aligned(const struct neph_table *table, FILE *out);

/* Print RFC 4180 CSV; numbers have nine digits. Lines end in `line_end`, "\r\n" or "\n"; words are
 * quoted where needed. */
void neph_table_print_csv(const struct neph_table *table, const char *line_end, FILE *out);

/* A list of objects with the columns' keys; NULL: memory was short. */
json_t *neph_table_json(const struct neph_table *table);

/* Add the members of one struct to `object`, which is taken over; returns it. NULL: memory was
 * short. */
json_t *neph_fields_json(json_t *object, const struct neph_field *fields, int count,
                         const void *of);

/* Print a CSV field: a word, quoted where needed; a number with nine digits, nothing for NaN. */
void neph_csv_word(const char *word, FILE *out);
void neph_csv_number(double value, FILE *out);

#endif
