/* SPDX-License-Identifier: MIT
 *
 * The tables for people: what scenes/README.md says of the keys.
 */
#include "scenes/fields.h"

#include <string.h>

static void print_range(const struct neph_field *field, const char *what, FILE *file)
{
    fprintf(file, "%s, %g..%g%s%s", what, field->minimum, field->maximum, *field->unit ? " " : "",
            field->unit);
}

static void print_words(const struct neph_field *field, FILE *file)
{
    for (int i = 0; field->words[i]; i++)
        fprintf(file, "%s`%s`", i ? ", " : "", field->words[i]);
}

static void print_value(const struct neph_field *field, FILE *file)
{
    switch (field->type) {
    case NEPH_FIELD_NUMBER:
        print_range(field, "number", file);
        break;
    case NEPH_FIELD_WHOLE:
        print_range(field, "whole number", file);
        break;
    case NEPH_FIELD_THREE:
        print_range(field, "3 numbers", file);
        break;
    case NEPH_FIELD_WHOLES:
        print_range(field, "3 whole numbers", file);
        break;
    case NEPH_FIELD_FLAG:
        fputs("`true`, `false`", file);
        break;
    case NEPH_FIELD_WORD:
        print_words(field, file);
        break;
    case NEPH_FIELD_TEXT:
        if (field->words)
            print_words(field, file);
        else
            fprintf(file, "text of %d..%d bytes", field->least, field->most);
        break;
    case NEPH_FIELD_NUMBERS:
        fprintf(file, "%d..%d ", field->least, field->most);
        print_range(field, "numbers", file);
        break;
    case NEPH_FIELD_ENTRIES:
    case NEPH_FIELD_LIST:
        fprintf(file, "list of %d..%d%s", field->least, field->most,
                field->is_ascending ? ", ascending" : "");
        break;
    case NEPH_FIELD_RECORD:
        break;
    }
}

static void print_default(const struct neph_field *field, FILE *file)
{
    const double standard = field->standard;
    if (!field->is_optional)
        fputs("needed", file);
    else if (field->absent)
        fputs(field->absent, file);
    else if (field->type == NEPH_FIELD_NUMBER || field->type == NEPH_FIELD_WHOLE)
        fprintf(file, "%g", standard);
    else if (field->type == NEPH_FIELD_THREE)
        fprintf(file, "[%g, %g, %g]", standard, standard, standard);
    else if (field->type == NEPH_FIELD_FLAG)
        fputs("`false`", file);
    else if (field->type == NEPH_FIELD_WORD)
        fprintf(file, "`%s`", field->words[0]);
    else if (field->type != NEPH_FIELD_RECORD)
        fputs("none", file);
}

static bool is_text_same(const char *a, const char *b)
{
    return a == b || (a && b && !strcmp(a, b));
}

/* Whether but for their keys both rows say the same. */
static bool is_same(const struct neph_field *a, const struct neph_field *b)
{
    return b->key && a->type == b->type && a->minimum == b->minimum && a->maximum == b->maximum &&
           a->is_optional == b->is_optional && (!a->is_optional || a->standard == b->standard) &&
           !a->record && !a->words && is_text_same(a->unit, b->unit) &&
           is_text_same(a->note, b->note) && is_text_same(a->absent, b->absent);
}

/* The row of a mapping may say nothing that its keys do not. */
static bool is_mute(const struct neph_field *field)
{
    return field->type == NEPH_FIELD_RECORD && !field->note && !field->absent;
}

/* Returns the last of the fields that share the line. */
static const struct neph_field *print_line(const struct neph_field *field, const char *path,
                                           const char *dot, FILE *file)
{
    fprintf(file, "| `%s`", path);
    for (; is_same(field, &field[1]); field++)
        fprintf(file, ", `%s%s`", dot, field[1].key);
    fputs(" | ", file);
    print_value(field, file);
    fputs(" | ", file);
    print_default(field, file);
    fprintf(file, " | %s |\n", field->note ? field->note : "");
    return field;
}

void neph_fields_print(const struct neph_field *fields, const char *owner, FILE *file)
{
    const char *dot = *owner ? "." : "";
    for (; fields->key; fields++) {
        const bool is_list = fields->type == NEPH_FIELD_LIST || fields->type == NEPH_FIELD_ENTRIES;
        const struct neph_path path = neph_at("%s%s%s", owner, dot, fields->key);
        if (!is_mute(fields))
            fields = print_line(fields, path.text, dot, file);
        if (fields->record)
            neph_fields_print(fields->record->fields,
                              neph_at("%s%s", path.text, is_list ? "[]" : "").text, file);
    }
}
