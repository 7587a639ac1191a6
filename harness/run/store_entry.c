/* SPDX-License-Identifier: MIT
 *
 * Records of the store's entries: signing and checking.
 */
#include "harness/run/store_entry.h"

#include "base/files.h"
#include "base/path.h"
#include "base/text.h"
#include "harness/json_file.h"

#include <stdlib.h>
#include <string.h>

static const size_t record_limit_bytes = 1 << 20;

/* Hashes the record without the hash's own field: keys sorted, no spaces, numbers with 17 digits,
 * which give the same text again after reading. */
static enum neph_status hash_record(const json_t *record, char hex[NEPH_HASH_HEX_SIZE],
                                    struct neph_diag *diag)
{
    json_t *rest = json_copy((json_t *)record); /* json_copy() takes a non-const pointer and changes
                                                   nothing */
    if (rest)
        json_object_del(rest, "record_blake2b");
    const enum neph_status status = neph_json_digest(rest, hex, diag);
    json_decref(rest);
    return status;
}

static enum neph_status hash_file(const char *folder, const char *name,
                                  char hex[NEPH_HASH_HEX_SIZE], struct neph_diag *diag)
{
    return neph_hash_file(neph_path_in(folder, name).text, hex, diag);
}

bool neph_entry_is_key(const char *name)
{
    return strlen(name) == NEPH_HASH_HEX_SIZE - 1 &&
           strspn(name, "0123456789abcdef") == NEPH_HASH_HEX_SIZE - 1;
}

bool neph_entry_has_picture(const json_t *record, const char *name)
{
    const json_t *pictures = json_object_get(record, "pictures");
    for (size_t i = 0; i < json_array_size(pictures); i++) {
        const char *picture = json_string_value(json_array_get(pictures, i));
        if (picture && strcmp(picture, name) == 0)
            return true;
    }
    return false;
}

static bool is_result(const json_t *record, const char *name)
{
    const char *dot = strrchr(name, '.');
    const bool is_json = dot && strcmp(dot, ".json") == 0;
    return (is_json && strcmp(name, "job.json") != 0) || neph_entry_has_picture(record, name);
}

/* {"flicker.json": hash, ...}: measurements and images beside the frame. */
static enum neph_status hash_results(const char *folder, const json_t *record, json_t **results,
                                     struct neph_diag *diag)
{
    json_t *hashes = json_object();
    char hex[NEPH_HASH_HEX_SIZE];
    struct neph_arena arena = {NULL};
    struct neph_names names;
    enum neph_status status = neph_dir_list(folder, &arena, &names, diag);
    for (int i = 0; i < names.count && !status; i++) {
        if (!is_result(record, names.list[i]))
            continue;
        status = hash_file(folder, names.list[i], hex, diag);
        if (!status)
            neph_json_set(&hashes, names.list[i], json_string(hex));
    }
    neph_arena_finish(&arena);
    if (!status)
        status = neph_json_check(hashes, diag);
    if (status)
        json_decref(hashes);
    else
        *results = hashes;
    return status;
}

static enum neph_status sign(const char *folder, const char *key, json_t *record,
                             struct neph_diag *diag)
{
    char hex[NEPH_HASH_HEX_SIZE];
    json_t *results = NULL;
    enum neph_status status = neph_json_put(record, "key", json_string(key), diag);
    if (!status)
        status = hash_file(folder, "frame.exr", hex, diag);
    if (!status)
        status = neph_json_put(record, "frame_blake2b", json_string(hex), diag);
    if (!status)
        status = hash_results(folder, record, &results, diag);
    if (!status)
        status = neph_json_put(record, "results_blake2b", results, diag);
    if (!status)
        status = hash_record(record, hex, diag);
    return status ? status : neph_json_put(record, "record_blake2b", json_string(hex), diag);
}

enum neph_status neph_entry_write_record(const char *folder, const char *key, json_t *record,
                                         struct neph_diag *diag)
{
    const enum neph_status status = sign(folder, key, record, diag);
    return status ? status
                  : neph_json_write(record, JSON_INDENT(2), neph_path_in(folder, "job.json").text,
                                    diag);
}

/* ---- checking -------------------------------------------------------------------------------- */

static enum neph_entry_state set_entry_state(enum neph_entry_state state, const char *what,
                                             char why[NEPH_ENTRY_WHY_BYTES])
{
    neph_text_format(why, NEPH_ENTRY_WHY_BYTES, "%s", what);
    return state;
}

/* A missing or oversized file makes the entry bad; a file that cannot be read makes it unreadable.
 */
static enum neph_entry_state state_from_file_error(enum neph_status status,
                                                   const struct neph_diag *diag,
                                                   char why[NEPH_ENTRY_WHY_BYTES])
{
    const bool bad = status == NEPH_ERR_NOT_FOUND || status == NEPH_ERR_INPUT;
    return set_entry_state(bad ? NEPH_ENTRY_BAD : NEPH_ENTRY_UNREADABLE, diag->message, why);
}

static enum neph_entry_state read_record(const char *folder, json_t **record,
                                         char why[NEPH_ENTRY_WHY_BYTES])
{
    char *text = NULL;
    size_t size;
    struct neph_diag diag = {.line = 0};
    json_error_t error;
    const enum neph_status status = neph_file_read(neph_path_in(folder, "job.json").text,
                                                   record_limit_bytes, &text, &size, &diag);
    if (status)
        return state_from_file_error(status, &diag, why);
    *record = json_loadb(text, size, JSON_REJECT_DUPLICATES, &error);
    free(text);
    if (*record)
        return NEPH_ENTRY_GOOD;
    return json_error_code(&error) == json_error_out_of_memory
               ? set_entry_state(NEPH_ENTRY_UNREADABLE, "out of memory for its record", why)
               : set_entry_state(NEPH_ENTRY_BAD, "its record (job.json) is damaged", why);
}

static bool has_field_text(const json_t *record, const char *field, const char *text)
{
    const char *found = json_string_value(json_object_get(record, field));
    return found && strcmp(found, text) == 0;
}

static enum neph_entry_state check_record(const json_t *record, const char *key,
                                          char why[NEPH_ENTRY_WHY_BYTES])
{
    char hex[NEPH_HASH_HEX_SIZE];
    if (!json_object_get(record, "key") || !json_object_get(record, "record_blake2b"))
        return set_entry_state(
            NEPH_ENTRY_BAD,
            "its record (job.json) is not signed: cut short, changed by hand, or of an older neph",
            why);
    if (!has_field_text(record, "key", key))
        return set_entry_state(NEPH_ENTRY_BAD, "it belongs to another job", why);
    struct neph_diag diag = {.line = 0};
    if (hash_record(record, hex, &diag))
        return set_entry_state(NEPH_ENTRY_UNREADABLE, diag.message, why);
    return has_field_text(record, "record_blake2b", hex)
               ? NEPH_ENTRY_GOOD
               : set_entry_state(NEPH_ENTRY_BAD, "its record (job.json) was changed", why);
}

static enum neph_entry_state check_file(const char *folder, const char *name, const json_t *hash,
                                        char why[NEPH_ENTRY_WHY_BYTES])
{
    char hex[NEPH_HASH_HEX_SIZE];
    struct neph_diag diag = {.line = 0};
    const char *expected = json_string_value(hash);
    const enum neph_status status = hash_file(folder, name, hex, &diag);
    if (status)
        return state_from_file_error(status, &diag, why);
    if (expected && strcmp(expected, hex) == 0)
        return NEPH_ENTRY_GOOD;
    neph_text_format(why, NEPH_ENTRY_WHY_BYTES, "its %s was changed or is damaged", name);
    return NEPH_ENTRY_BAD;
}

static enum neph_entry_state check_files(const char *folder, const json_t *record,
                                         char why[NEPH_ENTRY_WHY_BYTES])
{
    const char *name;
    json_t *hash, *results = json_object_get(record, "results_blake2b");
    enum neph_entry_state state = check_file(folder, "frame.exr",
                                             json_object_get(record, "frame_blake2b"), why);
    json_object_foreach(results, name, hash) if (state == NEPH_ENTRY_GOOD)
        state = check_file(folder, name, hash, why);
    return state;
}

enum neph_entry_state neph_entry_read(const char *folder, const char *key, json_t **record,
                                      char why[NEPH_ENTRY_WHY_BYTES])
{
    json_t *found = NULL;
    if (!neph_path_exists(folder))
        return NEPH_ENTRY_ABSENT;
    if (!neph_path_is_dir(folder))
        return set_entry_state(NEPH_ENTRY_BAD, "it is no folder", why);
    enum neph_entry_state state = read_record(folder, &found, why);
    if (state == NEPH_ENTRY_GOOD)
        state = check_record(found, key, why);
    if (state == NEPH_ENTRY_GOOD)
        *record = found;
    else
        json_decref(found);
    return state;
}

enum neph_entry_state neph_entry_check(const char *folder, const char *key, json_t **record,
                                       char why[NEPH_ENTRY_WHY_BYTES])
{
    json_t *found = NULL;
    enum neph_entry_state state = neph_entry_read(folder, key, &found, why);
    if (state != NEPH_ENTRY_GOOD)
        return state;
    state = check_files(folder, found, why);
    if (state == NEPH_ENTRY_GOOD)
        *record = found;
    else
        json_decref(found);
    return state;
}
