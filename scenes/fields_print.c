/* SPDX-License-Identifier: MIT
 *
 * Prints the tables as Markdown: the reference of keys in scenes/README.md.
 */
#include "scenes/fields.h"

#include <string.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_FIELD_TYPE_COUNT == 11, "a new kind");

static bool is_text_same(const char *a, const char *b)
{
    return a == b || (a && b && !strcmp(a, b));
}

/* Whether both rows differ only in their keys. */
static bool is_same(const struct neph_field *a, const struct neph_field *b)
{
    return b->key && a->type == b->type && a->minimum == b->minimum && a->maximum == b->maximum &&
           !a->record && !a->words && is_text_same(a->unit, b->unit) &&
           is_text_same(a->note, b->note) && is_text_same(a->standard, b->standard);
}

/* The row of a mapping that adds nothing to the rows of its keys. */
static bool has_no_text(const struct neph_field *field)
{
    return field->type == NEPH_RECORD && !field->note && !(field->standard && *field->standard);
}

/* Returns the last of the fields that share the line. */
static const struct neph_field *print_line(const struct neph_field *field, const char *path,
                                           const char *dot, FILE *file)
{
    char value[256] = "";
    fprintf(file, "| `%s`", path);
    for (; is_same(field, &field[1]); field++)
        fprintf(file, ", `%s%s`", dot, field[1].key);
    if (field->type != NEPH_RECORD)
        neph_field_describe(field, value, sizeof(value));
    fprintf(file, " | %s | %s | %s |\n", value, field->standard ? field->standard : "needed",
            field->note ? field->note : "");
    return field;
}

void neph_fields_print(const struct neph_field *fields, const char *owner, FILE *file)
{
    const char *dot = *owner ? "." : "";
    for (; fields->key; fields++) {
        const bool is_list = fields->type == NEPH_LIST || fields->type == NEPH_ENTRIES;
        const struct neph_path path = neph_format_path("%s%s%s", owner, dot, fields->key);
        if (!has_no_text(fields))
            fields = print_line(fields, path.text, dot, file);
        if (fields->record)
            neph_fields_print(fields->record->fields,
                              neph_format_path("%s%s", path.text, is_list ? "[]" : "").text, file);
    }
}
