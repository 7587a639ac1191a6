/* SPDX-License-Identifier: MIT */
#include "harness/failure/message.h"

#include "harness/json.h"

#include <math.h>

char *neph_failure_write_message(const struct neph_failure_message *message,
                                 const struct neph_failure_suite *suite)
{
    json_t *cells = json_array();
    for (int r = 0; r < message->row_count; r++) {
        const struct neph_failure_row *row = &suite->rows[message->first_row + r];
        const struct neph_failure_cell *cell = &row->cells[message->column];
        neph_json_add(&cells,
                      json_pack("{s:o, s:b, s:i, s:o, s:s?, s:s?}", "value",
                                neph_json_number(cell->value), "infinite", isinf(cell->value) != 0,
                                "verdict", (int)cell->verdict, "why", neph_json_cleaned(cell->why),
                                "exhibit", cell->exhibit, "frame_key", cell->frame_key));
    }
    json_t *json = json_pack("{s:i, s:i, s:i, s:f, s:i, s:f, s:o}", "row", message->first_row,
                             "column", message->column, "frames", message->frame_count, "seconds",
                             message->seconds, "references", message->reference_count,
                             "reference_s", message->reference_s, "cells", cells);
    char *text = json_dumps(json, JSON_COMPACT);
    json_decref(json);
    return text;
}

static bool read_cell(json_t *json, struct neph_failure_suite *suite,
                      struct neph_failure_cell *cell)
{
    const char *why;
    int verdict, is_infinite;
    if (json_unpack(json, "{s:b, s:i, s:s}", "infinite", &is_infinite, "verdict", &verdict, "why",
                    &why) != 0 ||
        verdict < 0 || verdict >= NEPH_FAILURE_VERDICTS)
        return false;
    *cell = (struct neph_failure_cell){
        .value = is_infinite ? INFINITY : neph_json_real(json, "value"),
        .verdict = (enum neph_failure_verdict)verdict,
        .why = neph_arena_text(&suite->arena, why),
        .exhibit = neph_arena_text(&suite->arena,
                                   json_string_value(json_object_get(json, "exhibit"))),
        .frame_key = neph_arena_text(&suite->arena,
                                     json_string_value(json_object_get(json, "frame_key"))),
    };
    return true;
}

static bool read_message(json_t *json, struct neph_failure_suite *suite,
                         struct neph_failure_message *message)
{
    json_t *cells;
    if (json_unpack(json, "{s:i, s:i, s:i, s:F, s:i, s:F, s:o}", "row", &message->first_row,
                    "column", &message->column, "frames", &message->frame_count, "seconds",
                    &message->seconds, "references", &message->reference_count, "reference_s",
                    &message->reference_s, "cells", &cells) != 0)
        return false;
    message->row_count = (int)json_array_size(cells);
    bool is_read = message->row_count > 0 && message->first_row >= 0 && message->column >= 0 &&
                   message->column < suite->column_count &&
                   message->first_row + message->row_count <= suite->row_count;
    for (int r = 0; r < message->row_count && is_read; r++)
        is_read = read_cell(json_array_get(cells, (size_t)r), suite,
                            &suite->rows[message->first_row + r].cells[message->column]);
    return is_read;
}

enum neph_status neph_failure_read_message(const char *text, struct neph_failure_suite *suite,
                                           struct neph_failure_message *message,
                                           struct neph_diag *diag)
{
    json_t *json = json_loads(text, 0, NULL);
    const bool is_read = json && read_message(json, suite, message);
    json_decref(json);
    return is_read ? NEPH_OK
                   : neph_fail(diag, NEPH_ERR_INTERNAL, "a process told what is no result: %.60s",
                               text);
}
