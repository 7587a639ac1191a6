/* SPDX-License-Identifier: MIT */
#include "tests/neph_test.h"

#include "base/written.h"
#include "harness/document/table.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

struct row {
    double bias, noise;
};

static void fill(struct neph_table *table)
{
    static const struct neph_column fixed[] = {
        {.key = "scene", .title = "scene"},
        {.key = "frames", .title = "frames", .format = "%g"},
        {.title = "", .forms = NEPH_TABLE_TEXT},
        {.key = "moves"},
        {.key = "range", .title = "range", .forms = NEPH_TABLE_TEXT | NEPH_TABLE_JSON},
    };
    static const struct neph_field numbers[] = {
        {{.key = "bias", .title = "bias, %", .format = "%+.1f", .scale = 100.0},
         offsetof(struct row, bias)},
        {{.key = "noise", .title = "noise", .format = "%.3f", .none = "none"},
         offsetof(struct row, noise)},
    };
    static const struct row rows[] = {{0.125, NAN}, {NAN, 0.25}};
    neph_table_columns(table, fixed, 5);
    neph_table_fields(table, numbers, 2);
    neph_table_word(table, "fog, \"thin\"");
    neph_table_count(table, 3);
    neph_table_word(table, "left out");
    neph_table_flag(table, true);
    neph_table_value(table, json_pack("[f,f]", 1.5, 2.0));
    neph_table_shown(table, "%g to %d", 1.5, 2);
    neph_table_field_cells(table, numbers, 2, &rows[0]);
    neph_table_word(table, "cloud");
    neph_table_count(table, 0);
    neph_table_shown(table, "all %d", 7);
    neph_table_word(table, NULL);
    neph_table_flag(table, false);
    neph_table_value(table, json_null());
    neph_table_field_cells(table, numbers, 2, &rows[1]);
}

static void print(const void *table, FILE *out)
{
    neph_table_print(table, out);
}

static void print_csv(const void *table, FILE *out)
{
    neph_table_print_csv(table, "\r\n", out);
}

static void test_one_table_is_written_in_three_forms(void **state)
{
    struct neph_table table = {.cells = NULL};
    char *text, *csv;
    fill(&table);
    assert_int_equal(neph_table_check(&table, NULL), NEPH_OK);
    assert_int_equal(neph_write_to_text(print, &table, &text, NULL), NEPH_OK);
    assert_string_equal(text, "| scene | frames | | range | bias, % | noise |\n"
                              "| --- | ---: | --- | --- | ---: | ---: |\n"
                              "| fog, \"thin\" | 3 | left out | 1.5 to 2 | +12.5 | none |\n"
                              "| cloud | all 7 | | | - | 0.250 |\n");
    assert_int_equal(neph_write_to_text(print_csv, &table, &csv, NULL), NEPH_OK);
    assert_string_equal(csv, "scene,frames,moves,bias,noise\r\n"
                             "\"fog, \"\"thin\"\"\",3,1,0.125,\r\n"
                             "cloud,0,0,,0.25\r\n");
    json_t *list = neph_table_json(&table);
    char *json = json_dumps(list, JSON_COMPACT);
    assert_string_equal(
        json, "[{\"scene\":\"fog, \\\"thin\\\"\",\"frames\":3,\"moves\":true,\"range\":[1.5,2.0],"
              "\"bias\":0.125,\"noise\":null},"
              "{\"scene\":\"cloud\",\"frames\":0,\"moves\":false,\"range\":null,"
              "\"bias\":null,\"noise\":0.25}]");
    free(json);
    json_decref(list);
    free(csv);
    free(text);
    neph_table_finish(&table);
}

static void test_words_are_cleaned(void **state)
{
    struct neph_table table = {.cells = NULL};
    char *text;
    neph_table_column(&table, (struct neph_column){.key = "name", .title = "name"});
    neph_table_word(&table, "a\x1b[31mb");
    assert_int_equal(neph_write_to_text(print, &table, &text, NULL), NEPH_OK);
    assert_null(strchr(text, '\x1b'));
    free(text);
    neph_table_finish(&table);
}

static void print_aligned(const void *table, FILE *out)
{
    neph_table_print_aligned(table, out);
}

/* A text that is longer than its column moves the columns behind it. */
static void test_columns_of_a_width(void **state)
{
    static const struct neph_column columns[] = {
        {.title = "scene", .width = -7},
        {.key = "hidden", .width = 9},
        {.title = "z", .format = "%+.1f", .width = 6},
        {.title = " verdict"},
    };
    struct neph_table table = {.cells = NULL};
    char *text;
    neph_table_columns(&table, columns, 4);
    for (int row = 0; row < 2; row++) {
        neph_table_word(&table, row == 0 ? "fog" : "two_layer_fog");
        neph_table_number(&table, 1.0);
        neph_table_number(&table, row == 0 ? 2.25 : NAN);
        neph_table_word(&table, "agrees");
        neph_table_shown(&table, " agrees");
    }
    assert_int_equal(neph_write_to_text(print_aligned, &table, &text, NULL), NEPH_OK);
    assert_string_equal(text, "scene        z  verdict\n"
                              "fog       +2.2  agrees\n"
                              "two_layer_fog      -  agrees\n");
    free(text);
    neph_table_finish(&table);
}

static void test_a_row_may_end_early(void **state)
{
    const struct neph_field field = {{.key = "b", .title = "b", .format = "%g"}, 0};
    const double value = 0.5;
    struct neph_table table = {.cells = NULL};
    char *text, *csv;
    neph_table_column(&table, (struct neph_column){.key = "a", .title = "a"});
    neph_table_fields(&table, &field, 1);
    neph_table_word(&table, "left out");
    neph_table_end_row(&table);
    neph_table_word(&table, "there");
    neph_table_field_cells(&table, &field, 1, &value);
    neph_table_end_row(&table);
    assert_int_equal(neph_write_to_text(print, &table, &text, NULL), NEPH_OK);
    assert_int_equal(neph_write_to_text(print_csv, &table, &csv, NULL), NEPH_OK);
    assert_string_equal(text, "| a | b |\n| --- | ---: |\n| left out |\n| there | 0.5 |\n");
    assert_string_equal(csv, "a,b\r\nleft out,\r\nthere,0.5\r\n");
    json_t *rows = neph_table_json(&table),
           *object = neph_fields_json(json_object(), &field, 1, &value);
    assert_true(json_is_null(json_object_get(json_array_get(rows, 0), "b")));
    assert_true(json_real_value(json_object_get(object, "b")) == value);
    json_decref(object);
    json_decref(rows);
    free(csv);
    free(text);
    neph_table_finish(&table);
}

#include "tests/main.h"
