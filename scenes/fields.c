/* SPDX-License-Identifier: MIT */
#include "scenes/fields.h"

#include "base/text.h"
#include "scenes/errors.h"
#include "scenes/spelling.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_FIELD_TYPE_COUNT == 11, "a new kind");

static enum neph_status read_value(struct neph_reader *reader, const yaml_node_t *node,
                                   const struct neph_field *field, void *target);

static void *place(void *target, size_t at)
{
    return (char *)target + at;
}

static int *get_count(const struct neph_field *field, void *target)
{
    return place(target, field->count_at);
}

/* Appends to a text in a buffer of `size` bytes, truncated to fit. */
static void append(char *buffer, size_t size, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

static void append(char *buffer, size_t size, const char *format, ...)
{
    const size_t used = strlen(buffer);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(buffer + used, size - used, format, arguments);
    va_end(arguments);
}

/* --- Path of the reader --- */

/* Both return the previous length of the path, for leave_key(). */
static size_t enter_key(struct neph_reader *reader, const char *key)
{
    const size_t before = strlen(reader->path);
    append(reader->path, sizeof(reader->path), "%s%s", before ? "." : "", key);
    return before;
}

static size_t enter_item(struct neph_reader *reader, int index)
{
    const size_t before = strlen(reader->path);
    append(reader->path, sizeof(reader->path), "[%d]", index);
    return before;
}

static void leave_key(struct neph_reader *reader, size_t before)
{
    reader->path[before] = '\0';
}

static const char *get_path(const struct neph_reader *reader)
{
    return *reader->path ? reader->path : "the scene";
}

struct neph_path neph_format_path(const char *format, ...)
{
    struct neph_path path;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(path.text, sizeof(path.text), format, arguments);
    va_end(arguments);
    return path;
}

bool neph_reader_has(const struct neph_reader *reader, const yaml_node_t *mapping, const char *key)
{
    return neph_document_value(reader->document, mapping, key, strlen(key));
}

/* --- Errors --- */

enum neph_status neph_refuse(const struct neph_reader *reader, const char *path, const char *format,
                             ...)
{
    char message[512], whole[2 * NEPH_FIELD_PATH_MAX];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof(message), format, arguments);
    va_end(arguments);
    snprintf(whole, sizeof(whole), "%s%s%s", reader->path,
             *reader->path && *path && *path != '[' ? "." : "", path);
    neph_fail(reader->diag, NEPH_ERR_INPUT, "%s%s%s", whole, *whole ? ": " : "", message);
    neph_document_locate(reader->document, neph_document_find(reader->document, whole),
                         reader->diag);
    neph_errors_attribute(reader->errors, whole);
    return NEPH_ERR_INPUT;
}

enum neph_status neph_keep_error(const struct neph_reader *reader, enum neph_status first,
                                 enum neph_status next)
{
    if (next)
        neph_errors_keep(reader->errors, next, reader->path);
    return first ? first : next;
}

bool neph_were_keys_read(const struct neph_reader *reader, const char *keys)
{
    return !neph_errors_are_full(reader->errors) &&
           !neph_errors_concern(reader->errors, reader->path, keys);
}

/* Adds the position to a message, and the field's note if there is no better hint. */
static enum neph_status refuse(const struct neph_reader *reader, const yaml_node_t *node,
                               const struct neph_field *field)
{
    neph_document_locate(reader->document, node, reader->diag);
    if (reader->diag && field->note && !*reader->diag->hint)
        neph_hint(reader->diag, "%s", field->note);
    return NEPH_ERR_INPUT;
}

static void describe_range(const struct neph_field *field, const char *what, char *text,
                           size_t size)
{
    append(text, size, "%s, %g to %g%s%s", what, field->minimum, field->maximum,
           *field->unit ? " " : "", field->unit);
}

static void describe_words(const struct neph_field *field, char *text, size_t size)
{
    append(text, size, "one of ");
    for (int i = 0; field->words[i]; i++)
        append(text, size, "%s%s", i ? ", " : "", field->words[i]);
}

static void describe_keys(const struct neph_field *fields, char *text, size_t size)
{
    for (int i = 0; fields[i].key; i++)
        append(text, size, "%s%s", i ? ", " : "", fields[i].key);
}

void neph_field_describe(const struct neph_field *field, char *text, size_t size)
{
    *text = '\0';
    switch (field->type) {
    case NEPH_NUMBER:
        describe_range(field, "a number", text, size);
        break;
    case NEPH_WHOLE:
        describe_range(field, "a whole number", text, size);
        break;
    case NEPH_THREE:
    case NEPH_WHOLES:
        describe_range(field, "3 numbers such as [0, 1, 0]", text, size);
        break;
    case NEPH_FLAG:
        append(text, size, "true or false");
        break;
    case NEPH_WORD:
        describe_words(field, text, size);
        break;
    case NEPH_TEXT:
        if (field->words)
            describe_words(field, text, size);
        else
            append(text, size, "a text of %d to %d bytes", field->least, field->most);
        break;
    case NEPH_RECORD:
        append(text, size, "a mapping with the keys ");
        describe_keys(field->record->fields, text, size);
        break;
    case NEPH_NUMBERS:
        append(text, size, "a list of %d to %d numbers", field->least, field->most);
        describe_range(field, "", text, size);
        break;
    case NEPH_ENTRIES:
    case NEPH_LIST:
        append(text, size, "a list of %d to %d entries", field->least, field->most);
        break;
    case NEPH_FIELD_TYPE_COUNT:
        break;
    }
}

static void describe_node(const yaml_node_t *node, char *text, size_t size)
{
    char quote[NEPH_QUOTE_SIZE];
    *text = '\0';
    if (node->type == YAML_MAPPING_NODE)
        append(text, size, "a mapping");
    else if (node->type == YAML_SEQUENCE_NODE)
        append(text, size, "a list of %td",
               node->data.sequence.items.top - node->data.sequence.items.start);
    else if (!*neph_document_text(node))
        append(text, size, "nothing");
    else
        append(text, size, "'%s'", neph_document_quote(neph_document_text(node), quote));
}

static enum neph_status refuse_value(const struct neph_reader *reader, const yaml_node_t *node,
                                     const struct neph_field *field)
{
    char expected[512], found[128];
    neph_field_describe(field, expected, sizeof(expected));
    describe_node(node, found, sizeof(found));
    neph_fail(reader->diag, NEPH_ERR_INPUT, "%s: found %s, expected %s", get_path(reader), found,
              expected);
    return refuse(reader, node, field);
}

static void hint_spelling(const struct neph_reader *reader, const struct neph_spelling *spelling)
{
    if (spelling->nearest)
        neph_hint(reader->diag, "did you mean '%s'?", spelling->nearest);
}

/* --- Scalars --- */

/* Decimal only: no nan, no inf, no hexadecimal, nothing after the number. */
static bool is_number(const char *text)
{
    char *end;
    strtod(text, &end);
    return end > text && !*end && !text[strspn(text, "+-.0123456789eE")];
}

/* No leading zero: YAML 1.1 would read 010 as eight. */
static bool is_whole(const char *text)
{
    const char *start = text + (*text == '-' || *text == '+');
    const size_t digits = strspn(start, "0123456789");
    return digits > 0 && !start[digits] && (*start != '0' || digits == 1);
}

static bool is_plain(const yaml_node_t *node)
{
    return node->type == YAML_SCALAR_NODE && node->data.scalar.style == YAML_PLAIN_SCALAR_STYLE;
}

/* Reads a number, or one number of a list. */
static enum neph_status read_number(const struct neph_reader *reader, const yaml_node_t *node,
                                    const struct neph_field *field, bool is_of_list, double *number)
{
    const bool whole = field->type == NEPH_WHOLE || field->type == NEPH_WHOLES;
    if (!is_plain(node) || !(whole ? is_whole : is_number)(neph_document_text(node))) {
        struct neph_field one = *field;
        if (is_of_list)
            one.type = whole ? NEPH_WHOLE : NEPH_NUMBER;
        return refuse_value(reader, node, &one);
    }
    *number = strtod(neph_document_text(node), NULL);
    if (*number >= field->minimum && *number <= field->maximum)
        return NEPH_OK;
    char quote[NEPH_QUOTE_SIZE];
    neph_fail(reader->diag, NEPH_ERR_INPUT, "%s: %s is outside %g to %g%s%s", get_path(reader),
              neph_document_quote(neph_document_text(node), quote), field->minimum, field->maximum,
              *field->unit ? " " : "", field->unit);
    return refuse(reader, node, field);
}

static enum neph_status read_flag(const struct neph_reader *reader, const yaml_node_t *node,
                                  const struct neph_field *field, bool *flag)
{
    const char *text = is_plain(node) ? neph_document_text(node) : "";
    *flag = !strcmp(text, "true");
    return *flag || !strcmp(text, "false") ? NEPH_OK : refuse_value(reader, node, field);
}

static enum neph_status read_word(const struct neph_reader *reader, const yaml_node_t *node,
                                  const struct neph_field *field, int *index)
{
    if (node->type != YAML_SCALAR_NODE)
        return refuse_value(reader, node, field);
    struct neph_spelling spelling = neph_spelling_init(neph_document_text(node));
    for (*index = 0; field->words[*index]; ++*index) {
        if (!strcmp(spelling.word, field->words[*index]))
            return NEPH_OK;
        neph_spelling_offer(&spelling, field->words[*index]);
    }
    const enum neph_status status = refuse_value(reader, node, field);
    hint_spelling(reader, &spelling);
    return status;
}

static enum neph_status read_text(const struct neph_reader *reader, const yaml_node_t *node,
                                  const struct neph_field *field, const char **text)
{
    int index;
    const enum neph_status status = field->words ? read_word(reader, node, field, &index) : NEPH_OK;
    if (status)
        return status;
    if (node->type != YAML_SCALAR_NODE)
        return refuse_value(reader, node, field);
    const int size = (int)node->data.scalar.length;
    if (!field->words && (size < field->least || size > field->most))
        return refuse_value(reader, node, field);
    *text = neph_arena_copy_text(reader->arena, neph_document_text(node));
    return neph_arena_check(reader->arena, reader->diag);
}

/* --- Lists --- */

/* -1 when it is not a list, or too short or too long. */
static int get_length(const yaml_node_t *node, int least, int most)
{
    if (node->type != YAML_SEQUENCE_NODE)
        return -1;
    const ptrdiff_t length = node->data.sequence.items.top - node->data.sequence.items.start;
    return length < least || length > most ? -1 : (int)length;
}

static const yaml_node_t *get_item(const struct neph_reader *reader, const yaml_node_t *list,
                                   int index)
{
    return yaml_document_get_node(&reader->document->yaml, list->data.sequence.items.start[index]);
}

static enum neph_status read_numbers(struct neph_reader *reader, const yaml_node_t *node,
                                     const struct neph_field *field, int count, double *numbers)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < count && !neph_errors_are_full(reader->errors); i++) {
        const size_t before = enter_item(reader, i);
        const yaml_node_t *item = get_item(reader, node, i);
        status = neph_keep_error(reader, status,
                                 read_number(reader, item, field, true, &numbers[i]));
        leave_key(reader, before);
    }
    return status;
}

static enum neph_status read_wholes(struct neph_reader *reader, const yaml_node_t *node,
                                    const struct neph_field *field, int wholes[3])
{
    double numbers[3] = {0.0};
    const enum neph_status status = read_numbers(reader, node, field, 3, numbers);
    for (int i = 0; i < 3 && !status; i++)
        wholes[i] = (int)numbers[i];
    return status;
}

static enum neph_status read_record(struct neph_reader *reader, const yaml_node_t *node,
                                    const struct neph_record *record, void *target)
{
    return record->read ? record->read(reader, node, record, target)
                        : neph_read_fields(reader, node, record->fields, target);
}

static enum neph_status read_entries(struct neph_reader *reader, const yaml_node_t *node,
                                     const struct neph_record *record, int count, char *entries)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < count && !neph_errors_are_full(reader->errors); i++) {
        const size_t before = enter_item(reader, i);
        char *entry = entries + (size_t)i * record->size;
        status = neph_keep_error(reader, status,
                                 read_record(reader, get_item(reader, node, i), record, entry));
        leave_key(reader, before);
    }
    return status;
}

/* Checks that the first field of the entries ascends. */
static enum neph_status check_order(const struct neph_reader *reader,
                                    const struct neph_record *record, int count,
                                    const char *entries)
{
    const struct neph_field *first = &record->fields[0];
    double before = -INFINITY;
    for (int i = 0; i < count; i++) {
        const char *value = entries + (size_t)i * record->size + first->at;
        const double own = first->type == NEPH_WHOLE ? *(const int *)value : *(const double *)value;
        if (!(own > before))
            return neph_refuse(reader, neph_format_path("[%d].%s", i, first->key).text,
                               "%g is not above the %s of the one before, %g", own, first->key,
                               before);
        before = own;
    }
    return NEPH_OK;
}

static enum neph_status read_list(struct neph_reader *reader, const yaml_node_t *node,
                                  const struct neph_field *field, int count, void *target)
{
    char **list = place(target, field->at);
    if (count == 0)
        return NEPH_OK;
    *list = neph_arena_allocate(reader->arena, (size_t)count, field->record->size);
    if (!*list)
        return neph_fail_memory(reader->diag);
    *get_count(field, target) = count;
    const enum neph_status status = read_entries(reader, node, field->record, count, *list);
    return status || !field->is_ascending ? status
                                          : check_order(reader, field->record, count, *list);
}

static enum neph_status read_sequence(struct neph_reader *reader, const yaml_node_t *node,
                                      const struct neph_field *field, void *target)
{
    const bool three = field->type == NEPH_THREE || field->type == NEPH_WHOLES;
    const int count = get_length(node, three ? 3 : field->least, three ? 3 : field->most);
    void *value = place(target, field->at);
    if (count < 0)
        return refuse_value(reader, node, field);
    if (field->type == NEPH_LIST)
        return read_list(reader, node, field, count, target);
    if (field->type == NEPH_WHOLES)
        return read_wholes(reader, node, field, value);
    if (!three)
        *get_count(field, target) = count;
    return field->type == NEPH_ENTRIES ? read_entries(reader, node, field->record, count, value)
                                       : read_numbers(reader, node, field, count, value);
}

/* --- Mappings --- */

static enum neph_status read_value(struct neph_reader *reader, const yaml_node_t *node,
                                   const struct neph_field *field, void *target)
{
    void *value = place(target, field->at);
    double number = 0.0;
    enum neph_status status;
    switch (field->type) {
    case NEPH_NUMBER:
        return read_number(reader, node, field, false, value);
    case NEPH_WHOLE:
        status = read_number(reader, node, field, false, &number);
        if (!status) /* else it may exceed the range of int */
            *(int *)value = (int)number;
        return status;
    case NEPH_FLAG:
        return read_flag(reader, node, field, value);
    case NEPH_WORD:
        return read_word(reader, node, field, value);
    case NEPH_TEXT:
        return read_text(reader, node, field, value);
    case NEPH_RECORD:
        if (node->type != YAML_MAPPING_NODE)
            return refuse_value(reader, node, field);
        return read_record(reader, node, field->record, value);
    case NEPH_THREE:
    case NEPH_WHOLES:
    case NEPH_NUMBERS:
    case NEPH_ENTRIES:
    case NEPH_LIST:
    case NEPH_FIELD_TYPE_COUNT:
        break;
    }
    return read_sequence(reader, node, field, target);
}

static struct neph_spelling find_spelling(const yaml_node_t *key, const struct neph_field *fields)
{
    struct neph_spelling spelling = neph_spelling_init(neph_document_text(key));
    for (int i = 0; fields[i].key; i++)
        neph_spelling_offer(&spelling, fields[i].key);
    return spelling;
}

static enum neph_status refuse_unknown(const struct neph_reader *reader, const yaml_node_t *key,
                                       const struct neph_field *fields)
{
    char quote[NEPH_QUOTE_SIZE], known[768] = "";
    const struct neph_spelling spelling = find_spelling(key, fields);
    describe_keys(fields, known, sizeof(known));
    neph_fail(reader->diag, NEPH_ERR_INPUT, "unknown key '%s' in %s; known keys: %s",
              neph_document_quote(spelling.word, quote), get_path(reader), known);
    hint_spelling(reader, &spelling);
    neph_document_locate(reader->document, key, reader->diag);
    return NEPH_ERR_INPUT;
}

static enum neph_status refuse_twice(const struct neph_reader *reader, const yaml_node_t *first,
                                     const yaml_node_t *key)
{
    neph_fail(reader->diag, NEPH_ERR_INPUT, "the key '%s' stands twice in %s",
              neph_document_text(key), get_path(reader));
    neph_hint(reader->diag, "its first value is on line %zu", first->start_mark.line + 1);
    neph_document_locate(reader->document, key, reader->diag);
    return NEPH_ERR_INPUT;
}

static enum neph_status refuse_missing(struct neph_reader *reader, const yaml_node_t *mapping,
                                       const struct neph_field *field)
{
    char expected[512];
    const size_t before = enter_key(reader, field->key);
    neph_field_describe(field, expected, sizeof(expected));
    neph_fail(reader->diag, NEPH_ERR_INPUT, "missing key '%s': expected %s", reader->path,
              expected);
    neph_errors_attribute(reader->errors, reader->path);
    leave_key(reader, before);
    return refuse(reader, mapping, field);
}

static const struct neph_field *find_field(const struct neph_field *fields, const char *key)
{
    while (fields->key && strcmp(fields->key, key))
        fields++;
    return fields->key ? fields : NULL;
}

static enum neph_status read_pair(struct neph_reader *reader, const yaml_node_t *mapping,
                                  const yaml_node_pair_t *pair, const struct neph_field *fields,
                                  void *target)
{
    const yaml_node_t *key = yaml_document_get_node(&reader->document->yaml, pair->key);
    const yaml_node_t *value = yaml_document_get_node(&reader->document->yaml, pair->value);
    const char *name = neph_document_text(key);
    const struct neph_field *field = find_field(fields, name);
    if (!field)
        return refuse_unknown(reader, key, fields);
    const yaml_node_t *first = neph_document_value(reader->document, mapping, name, strlen(name));
    if (first != value)
        return refuse_twice(reader, first, key);
    const size_t before = enter_key(reader, name);
    const enum neph_status status = neph_keep_error(reader, NEPH_OK,
                                                    read_value(reader, value, field, target));
    leave_key(reader, before);
    return status;
}

/* Whether the mapping has an unknown key whose nearest known key is this one. */
static bool is_misspelled(const struct neph_reader *reader, const yaml_node_t *mapping,
                          const struct neph_field *fields, const struct neph_field *field)
{
    for (const yaml_node_pair_t *pair = mapping->data.mapping.pairs.start;
         pair < mapping->data.mapping.pairs.top; pair++) {
        const yaml_node_t *key = yaml_document_get_node(&reader->document->yaml, pair->key);
        if (find_field(fields, neph_document_text(key)))
            continue;
        const struct neph_spelling spelling = find_spelling(key, fields);
        if (spelling.nearest && !strcmp(spelling.nearest, field->key))
            return true;
    }
    return false;
}

enum neph_status neph_read_fields(struct neph_reader *reader, const yaml_node_t *node,
                                  const struct neph_field *fields, void *target)
{
    const struct neph_record record = {.fields = fields};
    const struct neph_field whole = {.type = NEPH_RECORD, .record = &record};
    if (node->type != YAML_MAPPING_NODE)
        return refuse_value(reader, node, &whole);
    neph_fields_default(fields, target);
    enum neph_status status = NEPH_OK;
    for (const yaml_node_pair_t *pair = node->data.mapping.pairs.start;
         pair < node->data.mapping.pairs.top && !neph_errors_are_full(reader->errors); pair++)
        status = neph_keep_error(reader, status, read_pair(reader, node, pair, fields, target));
    for (int i = 0; fields[i].key && !neph_errors_are_full(reader->errors); i++)
        if (!fields[i].standard && !neph_reader_has(reader, node, fields[i].key) &&
            !is_misspelled(reader, node, fields, &fields[i]))
            status = neph_keep_error(reader, status, refuse_missing(reader, node, &fields[i]));
    return status;
}

enum neph_status neph_read_choice(struct neph_reader *reader, const yaml_node_t *node,
                                  const struct neph_field *fields, void *target, const char *what)
{
    char keys[512] = "";
    int given = 0;
    const enum neph_status status = neph_read_fields(reader, node, fields, target);
    for (int i = 0; fields[i].key && !status; i++)
        given += neph_reader_has(reader, node, fields[i].key);
    if (status || given == 1)
        return status;
    describe_keys(fields, keys, sizeof(keys));
    return neph_refuse(reader, "", "%s is exactly one of %s", what, keys);
}

/* --- Defaults --- */

/* Words have index 0. */
static void set_default(const struct neph_field *field, void *target)
{
    void *value = place(target, field->at);
    double numbers[3] = {0.0};
    if (field->type == NEPH_RECORD && !field->record->read)
        neph_fields_default(field->record->fields, value);
    if (!field->standard)
        return;
    if (sscanf(field->standard, "[%lf, %lf, %lf]", &numbers[0], &numbers[1], &numbers[2]) != 3)
        numbers[0] = strtod(field->standard, NULL);
    if (field->type == NEPH_NUMBER)
        *(double *)value = numbers[0];
    else if (field->type == NEPH_THREE)
        memcpy(value, numbers, sizeof(numbers));
    else if (field->type == NEPH_WHOLES)
        for (int i = 0; i < 3; i++)
            ((int *)value)[i] = (int)numbers[i];
    else if (field->type == NEPH_WHOLE || field->type == NEPH_WORD)
        *(int *)value = (int)numbers[0];
    else if (field->type == NEPH_FLAG)
        *(bool *)value = false;
}

void neph_fields_default(const struct neph_field *fields, void *target)
{
    for (; fields->key; fields++)
        set_default(fields, target);
}

/* --- Checks --- */

bool neph_is_identifier(const char *text)
{
    return strspn(text, NEPH_NAME_CHARACTERS) == strlen(text);
}

/* Shorter directions are refused: their normalised form would be noise. */
#define DIRECTION_MIN 1e-9

enum neph_status neph_check_direction(const struct neph_reader *reader, const char *path,
                                      struct neph_vec3 direction)
{
    return neph_vec3_length(direction) < DIRECTION_MIN
               ? neph_refuse(reader, path, "a direction of length 0; give one such as [0, 1, 0]")
               : NEPH_OK;
}

bool neph_has_control(const char *text, const char *except)
{
    const size_t length = strlen(text);
    const bool has_line = strchr(text, '\n') && !strchr(except, '\n');
    return has_line || strchr(text, '\t') || neph_text_first_unfit(text, length) < length;
}
