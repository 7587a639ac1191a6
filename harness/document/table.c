/* SPDX-License-Identifier: MIT */
#include "harness/document/table.h"

#include "base/text.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

enum cell_kind { WORD, NUMBER, COUNT, FLAG, VALUE, LEFT_OUT };

struct neph_table_cell {
    enum cell_kind kind;
    const char *word;  /* owned by the arena; NULL: none */
    const char *shown; /* owned by the arena; NULL: use the column's format */
    double number;
    long count;    /* or a flag (0, 1) */
    json_t *value; /* owned */
};

/* ---- filling --------------------------------------------------------------------------------- */

void neph_table_column(struct neph_table *table, struct neph_column column)
{
    const size_t count = (size_t)table->column_count;
    struct neph_column *all = neph_arena_allocate(&table->arena, count + 1, sizeof(*all));
    if (!all)
        return;
    if (count > 0)
        memcpy(all, table->columns, count * sizeof(*all));
    column.key = neph_arena_copy_text(&table->arena, column.key);
    column.title = neph_arena_copy_text(&table->arena, column.title);
    all[count] = column;
    table->columns = all;
    table->column_count++;
}

void neph_table_columns(struct neph_table *table, const struct neph_column *columns, int count)
{
    for (int c = 0; c < count; c++)
        neph_table_column(table, columns[c]);
}

static void add(struct neph_table *table, struct neph_table_cell cell)
{
    if (table->cell_count == table->cell_room) {
        const int room = table->cell_room ? 2 * table->cell_room : 64;
        struct neph_table_cell *grown = realloc(table->cells, (size_t)room * sizeof(*grown));
        if (!grown) {
            table->arena.is_short = true;
            json_decref(cell.value);
            return;
        }
        table->cells = grown;
        table->cell_room = room;
    }
    table->cells[table->cell_count++] = cell;
}

/* A cleaned copy, owned by the arena; NULL if `text` is NULL. */
static const char *clean_copy(struct neph_arena *arena, const char *text)
{
    char *clean = text ? neph_text_clean_copy(text) : NULL;
    const char *copy = neph_arena_copy_text(arena, clean);
    arena->is_short |= text && !clean;
    free(clean);
    return copy;
}

void neph_table_word(struct neph_table *table, const char *word)
{
    add(table, (struct neph_table_cell){.kind = WORD, .word = clean_copy(&table->arena, word)});
}

void neph_table_number(struct neph_table *table, double value)
{
    add(table, (struct neph_table_cell){.kind = NUMBER, .number = value});
}

void neph_table_count(struct neph_table *table, long value)
{
    add(table, (struct neph_table_cell){.kind = COUNT, .number = (double)value, .count = value});
}

void neph_table_flag(struct neph_table *table, bool value)
{
    add(table, (struct neph_table_cell){.kind = FLAG, .count = value});
}

void neph_table_value(struct neph_table *table, json_t *value)
{
    table->arena.is_short |= !value;
    add(table, (struct neph_table_cell){.kind = VALUE, .value = value, .shown = ""});
}

void neph_table_shown(struct neph_table *table, const char *format, ...)
{
    char shown[512];
    va_list arguments;
    if (table->arena.is_short || table->cell_count == 0)
        return;
    va_start(arguments, format);
    vsnprintf(shown, sizeof(shown), format, arguments);
    va_end(arguments);
    table->cells[table->cell_count - 1].shown = clean_copy(&table->arena, shown);
}

void neph_table_numbers(struct neph_table *table, int count, const double *values)
{
    for (int i = 0; i < count; i++)
        neph_table_number(table, values[i]);
}

void neph_table_fields(struct neph_table *table, const struct neph_field *fields, int count)
{
    for (int i = 0; i < count; i++)
        neph_table_column(table, fields[i].column);
}

void neph_table_field_cells(struct neph_table *table, const struct neph_field *fields, int count,
                            const void *of)
{
    for (int i = 0; i < count; i++)
        neph_table_number(table, *(const double *)((const char *)of + fields[i].at));
}

void neph_table_end_row(struct neph_table *table)
{
    while (!table->arena.is_short && table->cell_count % table->column_count != 0)
        add(table, (struct neph_table_cell){.kind = LEFT_OUT});
}

enum neph_status neph_table_check(const struct neph_table *table, struct neph_diag *diag)
{
    return neph_arena_check(&table->arena, diag);
}

void neph_table_finish(struct neph_table *table)
{
    for (int i = 0; i < table->cell_count; i++)
        json_decref(table->cells[i].value);
    free(table->cells);
    neph_arena_finish(&table->arena);
    *table = (struct neph_table){.cells = NULL};
}

/* ---- writing --------------------------------------------------------------------------------- */

static bool has_form(const struct neph_column *column, enum neph_table_forms form)
{
    const bool is_named = form == NEPH_TABLE_TEXT ? column->title != NULL : column->key != NULL;
    return is_named && (column->forms == 0 || column->forms & form);
}

static int row_count(const struct neph_table *table)
{
    return table->column_count > 0 ? table->cell_count / table->column_count : 0;
}

static const struct neph_table_cell *cell_at(const struct neph_table *table, int row, int column)
{
    return &table->cells[row * table->column_count + column];
}

enum { CELL_SIZE = 400 };

/* The text of a cell in the Markdown form; numbers are formatted into `text`. */
static const char *cell_text(const struct neph_column *column, const struct neph_table_cell *cell,
                             char text[CELL_SIZE])
{
    if (cell->shown)
        return cell->shown;
    if (cell->kind == WORD)
        return cell->word ? cell->word : "";
    if (cell->kind == FLAG)
        return cell->count ? "yes" : "no";
    if (cell->kind == NUMBER && isnan(cell->number))
        return column->none ? column->none : "-";
    if (cell->kind == COUNT)
        snprintf(text, CELL_SIZE, "%ld", cell->count);
    else
        snprintf(text, CELL_SIZE, column->format ? column->format : "%g",
                 (column->scale != 0.0 ? column->scale : 1.0) * cell->number);
    return text;
}

/* Print the text and a space; nothing for an empty text. */
static void print_word(const char *word, FILE *out)
{
    fprintf(out, "%s%s", word, word[0] ? " " : "");
}

void neph_table_print(const struct neph_table *table, FILE *out)
{
    for (int c = 0; c < table->column_count; c++)
        if (has_form(&table->columns[c], NEPH_TABLE_TEXT)) {
            fputs("| ", out);
            print_word(table->columns[c].title, out);
        }
    fputs("|\n", out);
    for (int c = 0; c < table->column_count; c++)
        if (has_form(&table->columns[c], NEPH_TABLE_TEXT))
            fputs(table->columns[c].format ? "| ---: " : "| --- ", out);
    fputs("|\n", out);
    for (int row = 0; row < row_count(table); row++) {
        for (int c = 0; c < table->column_count; c++)
            if (has_form(&table->columns[c], NEPH_TABLE_TEXT) &&
                cell_at(table, row, c)->kind != LEFT_OUT) {
                char text[CELL_SIZE];
                fputs("| ", out);
                print_word(cell_text(&table->columns[c], cell_at(table, row, c), text), out);
            }
        fputs("|\n", out);
    }
}

void neph_table_print_aligned(const struct neph_table *table, FILE *out)
{
    for (int row = -1; row < row_count(table); row++) {
        const char *blank = "";
        for (int c = 0; c < table->column_count; c++) {
            const struct neph_column *column = &table->columns[c];
            char text[CELL_SIZE];
            if (!has_form(column, NEPH_TABLE_TEXT))
                continue;
            fprintf(out, "%s%*s", blank, column->width,
                    row < 0 ? column->title : cell_text(column, cell_at(table, row, c), text));
            blank = " ";
        }
        fputc('\n', out);
    }
}

void neph_csv_word(const char *word, FILE *out)
{
    if (!strpbrk(word, ",\"\r\n")) {
        fputs(word, out);
        return;
    }
    fputc('"', out);
    for (; *word; word++)
        fprintf(out, *word == '"' ? "\"\"" : "%c", *word);
    fputc('"', out);
}

void neph_csv_number(double value, FILE *out)
{
    if (!isnan(value))
        fprintf(out, "%.9g", value);
}

static void print_csv_cell(const struct neph_table_cell *cell, FILE *out)
{
    if (cell->kind == WORD)
        neph_csv_word(cell->word ? cell->word : "", out);
    else if (cell->kind == NUMBER)
        neph_csv_number(cell->number, out);
    else if (cell->kind != VALUE && cell->kind != LEFT_OUT)
        fprintf(out, "%ld", cell->count);
}

void neph_table_print_csv(const struct neph_table *table, const char *line_end, FILE *out)
{
    for (int row = -1; row < row_count(table); row++) {
        const char *comma = "";
        for (int c = 0; c < table->column_count; c++) {
            if (!has_form(&table->columns[c], NEPH_TABLE_CSV))
                continue;
            fputs(comma, out);
            comma = ",";
            if (row < 0)
                neph_csv_word(table->columns[c].key, out);
            else
                print_csv_cell(cell_at(table, row, c), out);
        }
        fputs(line_end, out);
    }
}

static json_t *cell_json(const struct neph_table_cell *cell)
{
    switch (cell->kind) {
    case WORD:
        return cell->word ? json_string(cell->word) : json_null();
    case NUMBER:
        return neph_json_number(cell->number);
    case COUNT:
        return json_integer(cell->count);
    case FLAG:
        return json_boolean(cell->count);
    case VALUE:
        return json_incref(cell->value);
    case LEFT_OUT:
        return json_null();
    }
    return NULL;
}

json_t *neph_table_json(const struct neph_table *table)
{
    json_t *rows = neph_table_check(table, NULL) ? NULL : json_array();
    for (int row = 0; row < row_count(table); row++) {
        json_t *object = json_object();
        for (int c = 0; c < table->column_count; c++)
            if (has_form(&table->columns[c], NEPH_TABLE_JSON))
                neph_json_set(&object, table->columns[c].key, cell_json(cell_at(table, row, c)));
        neph_json_add(&rows, object);
    }
    return rows;
}

json_t *neph_fields_json(json_t *object, const struct neph_field *fields, int count, const void *of)
{
    for (int i = 0; i < count; i++)
        neph_json_set(&object, fields[i].column.key,
                      neph_json_number(*(const double *)((const char *)of + fields[i].at)));
    return object;
}
