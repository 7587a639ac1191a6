/* SPDX-License-Identifier: MIT */
#include "harness/json.h"

#include "base/files.h"
#include "base/text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void neph_json_add(json_t **list, json_t *item)
{
    if (json_array_append_new(*list, item) == 0)
        return;
    json_decref(*list);
    *list = NULL;
}

void neph_json_set(json_t **object, const char *key, json_t *item)
{
    if (json_object_set_new(*object, key, item) == 0)
        return;
    json_decref(*object);
    *object = NULL;
}

static enum neph_status fail(struct neph_diag *diag)
{
    return neph_fail(diag, NEPH_ERR_INTERNAL,
                     "a result cannot be put into JSON: a text is not UTF-8, a number is not "
                     "finite, or memory is short");
}

enum neph_status neph_json_append(json_t *list, json_t *item, struct neph_diag *diag)
{
    return json_array_append_new(list, item) == 0 ? NEPH_OK : fail(diag);
}

enum neph_status neph_json_put(json_t *object, const char *key, json_t *item,
                               struct neph_diag *diag)
{
    return json_object_set_new(object, key, item) == 0 ? NEPH_OK : fail(diag);
}

enum neph_status neph_json_check(const json_t *json, struct neph_diag *diag)
{
    return json ? NEPH_OK : fail(diag);
}

const char *neph_json_text(const json_t *object, const char *key)
{
    const char *text = json_string_value(json_object_get(object, key));
    return text ? text : "";
}

double neph_json_real(const json_t *object, const char *key)
{
    const json_t *value = json_object_get(object, key);
    return json_is_number(value) ? json_number_value(value) : NAN;
}

json_t *neph_json_number(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

json_t *neph_json_cleaned(const char *text)
{
    char *clean = neph_text_clean_copy(text);
    json_t *string = clean ? json_string(clean) : NULL;
    free(clean);
    return string;
}

enum neph_status neph_json_print(json_t *json, struct neph_diag *diag)
{
    enum neph_status status = neph_json_check(json, diag);
    const bool written = !status && json_dumpf(json, stdout, JSON_INDENT(2)) == 0;
    if (!status && !written && !ferror(stdout)) /* what stdout does not take is told at the end */
        status = neph_json_check(NULL, diag);
    if (!status)
        putchar('\n');
    json_decref(json);
    return status;
}
