/* SPDX-License-Identifier: MIT
 *
 * Reads the expectation list and searches it.
 */
#include "harness/stress/expectations.h"

#include "harness/data.h"

#include <stdlib.h>
#include <string.h>

/* Fails to compile when a kind is added, as the table of words needs a row for it. */
_Static_assert(NEPH_STRESS_EXPECTED_COUNT == 4, "a new kind");

/* Format id with version; ids keep the word of their first version. */
static const char format[] = "neph-failure-expectations-1";

/* NEPH_STRESS_PASSES: no word that an entry can have. */
static enum neph_stress_expected parse_expectation(const json_t *entry)
{
    static const char *const words[NEPH_STRESS_EXPECTED_COUNT] = {"", "fails", "flakes", "skips"};
    for (int e = NEPH_STRESS_FAILS; e < NEPH_STRESS_EXPECTED_COUNT; e++)
        if (strcmp(neph_json_text(entry, "is"), words[e]) == 0)
            return (enum neph_stress_expected)e;
    return NEPH_STRESS_PASSES;
}

static enum neph_status check_entry(const json_t *entry, size_t index, struct neph_diag *diag)
{
    static const char *const needed[] = {"scene", "measure", "reason"};
    for (size_t i = 0; i < sizeof(needed) / sizeof(needed[0]); i++)
        if (!*neph_json_text(entry, needed[i]))
            return neph_fail(diag, NEPH_ERR_INPUT, "expectation %zu has no '%s'", index, needed[i]);
    if (json_array_size(json_object_get(entry, "presets")) == 0)
        return neph_fail(diag, NEPH_ERR_INPUT, "expectation %zu names no preset", index);
    if (parse_expectation(entry) == NEPH_STRESS_PASSES)
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "expectation %zu: 'is' is fails, flakes or skips, not '%s'", index,
                         neph_json_text(entry, "is"));
    return NEPH_OK;
}

static enum neph_status read_list(const char *path, json_t **list, struct neph_diag *diag)
{
    json_error_t error;
    json_t *content = json_load_file(path, JSON_REJECT_DUPLICATES, &error);
    json_t *entries = json_object_get(content, "expectations");
    enum neph_status status = NEPH_OK;
    if (!content)
        status = neph_fail(diag, NEPH_ERR_INPUT, "%s", error.text);
    else if (strcmp(neph_json_text(content, "format"), format) != 0 || !json_is_array(entries))
        status = neph_fail(diag, NEPH_ERR_INPUT, "this is not a list of expectations (%s)", format);
    for (size_t i = 0; i < json_array_size(entries) && !status; i++)
        status = check_entry(json_array_get(entries, i), i, diag);
    if (status)
        neph_locate(diag, path, content ? 1 : error.line, content ? 1 : error.column);
    else
        *list = json_incref(entries);
    json_decref(content);
    return status;
}

enum neph_status neph_stress_expectations_load(const char *path, json_t **list,
                                               struct neph_diag *diag)
{
    char *own = path ? strdup(path)
                     : neph_data_renamed_path("scenes/studies/stress_expectations.json",
                                              "scenes/studies/failure_expectations.json");
    const enum neph_status status = own ? read_list(own, list, diag) : neph_fail_memory(diag);
    free(own);
    return status;
}

static bool list_has_text(const json_t *list, const char *text)
{
    for (size_t i = 0; i < json_array_size(list); i++) {
        const char *item = json_string_value(json_array_get(list, i));
        if (item && strcmp(item, text) == 0)
            return true;
    }
    return false;
}

static bool matches_place(const json_t *entry, const struct neph_stress_place *place)
{
    const char *over = neph_json_text(entry, "over");
    const json_t *points = json_object_get(entry, "points");
    return strcmp(neph_json_text(entry, "scene"), place->scene) == 0 &&
           strcmp(neph_json_text(entry, "measure"), place->measure) == 0 &&
           list_has_text(json_object_get(entry, "presets"), place->preset) &&
           (!*over || strcmp(over, place->over) == 0) &&
           (!points || list_has_text(points, place->point));
}

enum neph_stress_expected neph_stress_expected_at(const json_t *list,
                                                  const struct neph_stress_place *place,
                                                  const char **reason)
{
    *reason = "";
    for (size_t i = 0; i < json_array_size(list); i++) {
        const json_t *entry = json_array_get(list, i);
        if (!matches_place(entry, place))
            continue;
        *reason = neph_json_text(entry, "reason");
        return parse_expectation(entry);
    }
    return NEPH_STRESS_PASSES;
}
