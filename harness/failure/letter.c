/* SPDX-License-Identifier: MIT */
#include "harness/failure/letter.h"

#include "harness/json.h"

#include <math.h>

/* ---- writing --------------------------------------------------------------------------------- */

static json_t *cell_json(const struct neph_failure_cell *cell)
{
    return json_pack("{s:o, s:b, s:i, s:o, s:s?, s:s?}", "value", neph_json_number(cell->value),
                     "infinite", isinf(cell->value) != 0, "verdict", (int)cell->verdict, "why",
                     neph_json_cleaned(cell->why), "exhibit", cell->exhibit, "frame_key",
                     cell->frame_key);
}

char *neph_failure_letter_write(const struct neph_failure_letter *letter,
                                const struct neph_failure_suite *suite)
{
    json_t *cells = json_array();
    for (int r = 0; r < letter->row_count; r++)
        neph_json_add(&cells, cell_json(&suite->rows[letter->first_row + r].cells[letter->column]));
    json_t *json = json_pack("{s:i, s:i, s:i, s:f, s:i, s:f, s:o}", "row", letter->first_row,
                             "column", letter->column, "frames", letter->frame_count, "seconds",
                             letter->seconds, "references", letter->reference_count, "reference_s",
                             letter->reference_s, "cells", cells);
    char *text = json_dumps(json, JSON_COMPACT);
    json_decref(json);
    return text;
}

/* ---- reading --------------------------------------------------------------------------------- */

static const char *kept_text(struct neph_failure_suite *suite, const json_t *cell, const char *key)
{
    return neph_arena_text(&suite->arena, json_string_value(json_object_get(cell, key)));
}

static bool read_cell(const json_t *json, struct neph_failure_suite *suite,
                      struct neph_failure_cell *cell)
{
    const json_int_t verdict = json_integer_value(json_object_get(json, "verdict"));
    const bool is_infinite = json_is_true(json_object_get(json, "infinite"));
    if (verdict < 0 || verdict >= NEPH_FAILURE_VERDICTS ||
        !json_is_string(json_object_get(json, "why")))
        return false;
    *cell = (struct neph_failure_cell){
        .value = is_infinite ? INFINITY : neph_json_real(json, "value"),
        .verdict = (enum neph_failure_verdict)verdict,
        .why = kept_text(suite, json, "why"),
        .exhibit = kept_text(suite, json, "exhibit"),
        .frame_key = kept_text(suite, json, "frame_key"),
    };
    return true;
}

static bool read_letter(const json_t *json, struct neph_failure_suite *suite,
                        struct neph_failure_letter *letter)
{
    const json_t *cells = json_object_get(json, "cells");
    *letter = (struct neph_failure_letter){
        .first_row = (int)json_integer_value(json_object_get(json, "row")),
        .row_count = (int)json_array_size(cells),
        .column = (int)json_integer_value(json_object_get(json, "column")),
        .frame_count = (int)json_integer_value(json_object_get(json, "frames")),
        .seconds = neph_json_real(json, "seconds"),
        .reference_count = (int)json_integer_value(json_object_get(json, "references")),
        .reference_s = neph_json_real(json, "reference_s"),
    };
    if (letter->row_count < 1 || letter->first_row < 0 || letter->column < 0 ||
        letter->column >= suite->column_count ||
        letter->first_row + letter->row_count > suite->row_count)
        return false;
    for (int r = 0; r < letter->row_count; r++)
        if (!read_cell(json_array_get(cells, (size_t)r), suite,
                       &suite->rows[letter->first_row + r].cells[letter->column]))
            return false;
    return true;
}

enum neph_status neph_failure_letter_read(const char *text, struct neph_failure_suite *suite,
                                          struct neph_failure_letter *letter,
                                          struct neph_diag *diag)
{
    json_t *json = json_loads(text, 0, NULL);
    const bool is_read = json && read_letter(json, suite, letter);
    json_decref(json);
    return is_read ? NEPH_OK
                   : neph_fail(diag, NEPH_ERR_INTERNAL, "a process told what is no result: %.60s",
                               text);
}
