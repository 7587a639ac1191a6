/* SPDX-License-Identifier: MIT
 *
 * jansson, whose failures cannot be overlooked. It gives NULL for text that is not UTF-8, for a
 * number that is not finite and for want of memory, and a NULL that is put into a list is a row
 * that is lost. So the harness includes this header in place of jansson's, the compiler refuses to
 * ignore what jansson's own functions say, and these here carry a failure on:
 *
 * - neph_json_add() and neph_json_set() turn the whole list or object into NULL, to be found by
 *   whoever it is given to: json_pack() makes NULL of a NULL;
 * - neph_json_append() and neph_json_put() return a status, where the list is somebody else's.
 */
#ifndef NEPH_HARNESS_JSON_H
#define NEPH_HARNESS_JSON_H

#include "base/status.h"

#include <jansson.h>

#define NEPH_MUST_USE __attribute__((warn_unused_result))
int json_array_append_new(json_t *array, json_t *value) NEPH_MUST_USE;
static inline int json_array_append(json_t *array, json_t *value) NEPH_MUST_USE;
int json_array_extend(json_t *array, json_t *other) NEPH_MUST_USE;
int json_object_set_new(json_t *object, const char *key, json_t *value) NEPH_MUST_USE;
static inline int json_object_set(json_t *object, const char *key, json_t *value) NEPH_MUST_USE;
int json_object_update(json_t *object, json_t *other) NEPH_MUST_USE;
int json_dumpf(const json_t *json, FILE *output, size_t flags) NEPH_MUST_USE;
#undef NEPH_MUST_USE

/* Append `item`, or set `key` to it, and take it over. If that cannot be done, or `item` is NULL,
 * the list is destroyed and becomes NULL; a list that is NULL stays so. */
void neph_json_add(json_t **list, json_t *item);
void neph_json_set(json_t **object, const char *key, json_t *item);

/* Append `item`, or set `key` to it, and take it over. NEPH_ERR_INTERNAL: that cannot be done, or
 * one of them is NULL. */
enum neph_status neph_json_append(json_t *list, json_t *item, struct neph_diag *diag);
enum neph_status neph_json_put(json_t *object, const char *key, json_t *item,
                               struct neph_diag *diag);

/* NEPH_OK when there is one; NEPH_ERR_INTERNAL when it could not be made. */
enum neph_status neph_json_check(const json_t *json, struct neph_diag *diag);

/* The text at `key`; "" when there is none. */
const char *neph_json_text(const json_t *object, const char *key);

/* The number at `key`; NaN when there is none. */
double neph_json_real(const json_t *object, const char *key);

/* A number, or JSON null of one that is not finite: nothing was measured. */
json_t *neph_json_number(double value);

/* A string of any bytes, cleaned (base/text.h): for texts that are only to be read. A path that is
 * to be opened again must not be changed, and is refused before (neph_cli_check_folder). */
json_t *neph_json_cleaned(const char *text);

/* JSON on stdout, indented, with a newline at the end; consumes the reference. NEPH_ERR_INTERNAL:
 * it is NULL, because it could not be made. */
enum neph_status neph_json_print(json_t *json, struct neph_diag *diag)
    __attribute__((warn_unused_result));

#endif
