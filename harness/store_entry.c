/* SPDX-License-Identifier: MIT */
#include "harness/store_entry.h"

#include "base/files.h"
#include "base/hash.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const size_t record_limit_bytes = 1 << 20;

/* The hash over the record without the field that holds it: sorted, without spaces, numbers with 17
 * digits, which is the same text again after reading. */
static enum neph_status hash_record(const json_t *record, char hex[NEPH_HASH_HEX_SIZE],
                                    struct neph_diag *diag)
{
    json_t *rest = json_copy((json_t *)record); /* it takes non-const and changes nothing */
    if (rest)
        json_object_del(rest, "record_blake2b");
    char *text = rest ? json_dumps(rest, JSON_COMPACT | JSON_SORT_KEYS) : NULL;
    const enum neph_status status = text ? neph_hash(text, strlen(text), hex, diag)
                                         : neph_fail_memory(diag);
    free(text);
    json_decref(rest);
    return status;
}

static enum neph_status hash_frame(const char *folder, char hex[NEPH_HASH_HEX_SIZE],
                                   struct neph_diag *diag)
{
    char *path = neph_path_join(folder, "frame.exr");
    const enum neph_status status = path ? neph_hash_file(path, hex, diag) : neph_fail_memory(diag);
    free(path);
    return status;
}

enum neph_status neph_entry_write_record(const char *folder, const char *key, json_t *record,
                                         struct neph_diag *diag)
{
    char hex[NEPH_HASH_HEX_SIZE];
    char *path = neph_path_join(folder, "job.json"), *text = NULL;
    enum neph_status status = path ? hash_frame(folder, hex, diag) : neph_fail_memory(diag);
    if (!status && (json_object_set_new(record, "key", json_string(key)) != 0 ||
                    json_object_set_new(record, "frame_blake2b", json_string(hex)) != 0))
        status = neph_fail_memory(diag);
    if (!status)
        status = hash_record(record, hex, diag);
    if (!status && json_object_set_new(record, "record_blake2b", json_string(hex)) != 0)
        status = neph_fail_memory(diag);
    if (!status && !(text = json_dumps(record, JSON_INDENT(2))))
        status = neph_fail_memory(diag);
    if (!status)
        status = neph_file_write(path, text, strlen(text), diag);
    free(text);
    free(path);
    return status;
}

/* ---- checking -------------------------------------------------------------------------------- */

static enum neph_entry_state judge(enum neph_entry_state state, const char *what,
                                   char why[NEPH_ENTRY_WHY_BYTES])
{
    snprintf(why, NEPH_ENTRY_WHY_BYTES, "%s", what);
    return state;
}

/* A file that is not there or too large is a bad entry; one that cannot be read is not judged. */
static enum neph_entry_state judge_file(enum neph_status status, const struct neph_diag *diag,
                                        char why[NEPH_ENTRY_WHY_BYTES])
{
    const bool bad = status == NEPH_ERR_NOT_FOUND || status == NEPH_ERR_INPUT;
    return judge(bad ? NEPH_ENTRY_BAD : NEPH_ENTRY_UNREADABLE, diag->message, why);
}

static enum neph_entry_state read_record(const char *folder, json_t **record,
                                         char why[NEPH_ENTRY_WHY_BYTES])
{
    char *path = neph_path_join(folder, "job.json"), *text = NULL;
    size_t size;
    struct neph_diag diag = {.line = 0};
    json_error_t error;
    const enum neph_status status = path ? neph_file_read(path, record_limit_bytes, &text, &size,
                                                          &diag)
                                         : neph_fail_memory(&diag);
    free(path);
    if (status)
        return judge_file(status, &diag, why);
    *record = json_loadb(text, size, JSON_REJECT_DUPLICATES, &error);
    free(text);
    if (*record)
        return NEPH_ENTRY_GOOD;
    return json_error_code(&error) == json_error_out_of_memory
               ? judge(NEPH_ENTRY_UNREADABLE, "no memory for its record", why)
               : judge(NEPH_ENTRY_BAD, "its record (job.json) is damaged", why);
}

static bool holds(const json_t *record, const char *field, const char *text)
{
    const char *found = json_string_value(json_object_get(record, field));
    return found && strcmp(found, text) == 0;
}

static enum neph_entry_state check_record(const json_t *record, const char *key,
                                          char why[NEPH_ENTRY_WHY_BYTES])
{
    char hex[NEPH_HASH_HEX_SIZE];
    if (!json_object_get(record, "key") || !json_object_get(record, "record_blake2b"))
        return judge(NEPH_ENTRY_BAD,
                     "its record (job.json) is not signed: of an older neph, or cut short", why);
    if (!holds(record, "key", key))
        return judge(NEPH_ENTRY_BAD, "it belongs to another job", why);
    struct neph_diag diag = {.line = 0};
    if (hash_record(record, hex, &diag))
        return judge(NEPH_ENTRY_UNREADABLE, diag.message, why);
    return holds(record, "record_blake2b", hex)
               ? NEPH_ENTRY_GOOD
               : judge(NEPH_ENTRY_BAD, "its record (job.json) was changed", why);
}

static enum neph_entry_state check_frame(const char *folder, const json_t *record,
                                         char why[NEPH_ENTRY_WHY_BYTES])
{
    char hex[NEPH_HASH_HEX_SIZE];
    struct neph_diag diag = {.line = 0};
    const enum neph_status status = hash_frame(folder, hex, &diag);
    if (status)
        return judge_file(status, &diag, why);
    return holds(record, "frame_blake2b", hex)
               ? NEPH_ENTRY_GOOD
               : judge(NEPH_ENTRY_BAD, "its frame (frame.exr) was changed or is damaged", why);
}

enum neph_entry_state neph_entry_check(const char *folder, const char *key, json_t **record,
                                       char why[NEPH_ENTRY_WHY_BYTES])
{
    json_t *found = NULL;
    if (!neph_path_exists(folder))
        return NEPH_ENTRY_ABSENT;
    if (!neph_path_is_dir(folder))
        return judge(NEPH_ENTRY_BAD, "it is no folder", why);
    enum neph_entry_state state = read_record(folder, &found, why);
    if (state == NEPH_ENTRY_GOOD)
        state = check_record(found, key, why);
    if (state == NEPH_ENTRY_GOOD)
        state = check_frame(folder, found, why);
    if (state == NEPH_ENTRY_GOOD)
        *record = found;
    else
        json_decref(found);
    return state;
}
