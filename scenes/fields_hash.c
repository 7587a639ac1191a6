/* SPDX-License-Identifier: MIT
 *
 * The tables for stores and variants: the text of the hash, and keys in the syntax of scene files.
 */
#include "scenes/fields.h"
#include "scenes/hash_text.h"

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_FIELD_TYPE_COUNT == 11, "a new kind");
_Static_assert(NEPH_HASHING_COUNT == 6, "a new kind");

static void hash_record(const struct neph_record *record, const void *value, FILE *text)
{
    if (record->hash)
        record->hash(value, text);
    else
        neph_fields_hash(record->fields, value, text);
}

static void hash_list(const struct neph_field *field, const void *value, int count, FILE *text)
{
    if (field->type == NEPH_NUMBERS)
        for (int i = 0; i < count; i++)
            neph_put_number(text, field->hash_name ? field->hash_name : field->key,
                            ((const double *)value)[i]);
    else
        for (int i = 0; i < count; i++)
            hash_record(field->record, (const char *)value + (size_t)i * field->record->size, text);
}

static void hash_value(const struct neph_field *field, const void *target, FILE *text)
{
    const char *name = field->hash_name ? field->hash_name : field->key;
    const void *value = (const char *)target + field->at;
    const int *count = (const void *)((const char *)target + field->count_at);
    switch (field->type) {
    case NEPH_NUMBER:
        neph_put_number(text, name, *(const double *)value);
        break;
    case NEPH_THREE:
        neph_put_vec3(text, name, *(const struct neph_vec3 *)value);
        break;
    case NEPH_WHOLE:
    case NEPH_WORD:
        neph_put_number(text, name, *(const int *)value);
        break;
    case NEPH_WHOLES:
        neph_put_three(text, name, ((const int *)value)[0], ((const int *)value)[1],
                       ((const int *)value)[2]);
        break;
    case NEPH_FLAG:
        neph_put_number(text, name, *(const bool *)value);
        break;
    case NEPH_TEXT:
        neph_put_text(text, name, *(const char *const *)value);
        break;
    case NEPH_RECORD:
        hash_record(field->record, value, text);
        break;
    case NEPH_LIST:
        hash_list(field, *(const void *const *)value, *count, text);
        break;
    case NEPH_NUMBERS:
    case NEPH_ENTRIES:
        hash_list(field, value, *count, text);
        break;
    case NEPH_FIELD_TYPE_COUNT:
        break;
    }
}

/* Whether a number, three of them, a flag, or any of these in a record is not 0. */
static bool is_set(const struct neph_field *field, const void *target)
{
    const void *value = (const char *)target + field->at;
    const struct neph_vec3 *three = value;
    if (field->type == NEPH_RECORD) {
        const struct neph_field *row = field->record->fields;
        while (row->key && !is_set(row, value))
            row++;
        return row->key;
    }
    if (field->type == NEPH_FLAG)
        return *(const bool *)value;
    if (field->type == NEPH_WHOLE || field->type == NEPH_WORD)
        return *(const int *)value != 0;
    if (field->type == NEPH_THREE && (three->y != 0.0 || three->z != 0.0))
        return true;
    return *(const double *)value != 0.0;
}

static double number_at(const struct neph_field *field, const void *target)
{
    return *(const double *)(const void *)((const char *)target + field->at);
}

void neph_fields_hash(const struct neph_field *fields, const void *target, FILE *text)
{
    for (bool is_hashed = false; fields->key; fields++) {
        if (fields->hashing == NEPH_HASHED_AS_THREE) {
            neph_put_three(text, fields->hash_name, number_at(fields, target),
                           number_at(fields + 1, target), number_at(fields + 2, target));
            fields += 2;
            continue;
        }
        if (fields->hashing != NEPH_HASHED_WITH_LAST)
            is_hashed = fields->hashing == NEPH_HASHED ||
                        (fields->hashing == NEPH_HASHED_IF_SET && is_set(fields, target));
        if (is_hashed)
            hash_value(fields, target, text);
    }
}

void neph_fields_write(const struct neph_field *fields, const void *target, FILE *out)
{
    const char *before = "";
    for (; fields->key; fields++) {
        const double *numbers = (const void *)((const char *)target + fields->at);
        if (fields->hashing == NEPH_HASHED_IF_SET && !is_set(fields, target))
            continue;
        fprintf(out, "%s%s: ", before, fields->key);
        if (fields->type == NEPH_THREE)
            fprintf(out, "[%.17g, %.17g, %.17g]", numbers[0], numbers[1], numbers[2]);
        else if (fields->type == NEPH_FLAG)
            fprintf(out, "%s", *(const bool *)(const void *)numbers ? "true" : "false");
        else
            fprintf(out, "%.17g", numbers[0]);
        before = ", ";
    }
}
