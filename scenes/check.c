/* SPDX-License-Identifier: MIT
 *
 * Keys, types, words and ranges. libcyaml knows the schema too, but it takes `maybe` for true, 1.5
 * for the integer 1, 010 for 8 and nan for a number, and does not say which words an enum allows;
 * so the walk comes first and libcyaml only fills the structs.
 */
#include "scenes/check.h"

#include <ctype.h>
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct walk {
    struct neph_document *document;
    struct neph_diag *diag;
    char path[NEPH_SCENE_PATH_MAX];    /* "media[0].homogeneous" */
    char pattern[NEPH_SCENE_PATH_MAX]; /* "media[].homogeneous" */
};

struct place {
    size_t path, pattern;
};

static enum neph_status walk_value(struct walk *walk, const yaml_node_t *node,
                                   const cyaml_schema_value_t *schema);

/* Append to a text in a buffer of `size` bytes; what does not fit is cut off. */
static void append(char *buffer, size_t size, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

static void append(char *buffer, size_t size, const char *format, ...)
{
    size_t used = strlen(buffer);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(buffer + used, size - used, format, arguments);
    va_end(arguments);
}

static struct place enter_key(struct walk *walk, const char *key)
{
    struct place place = {strlen(walk->path), strlen(walk->pattern)};
    const char *dot = place.path ? "." : "";
    append(walk->path, sizeof(walk->path), "%s%s", dot, key);
    append(walk->pattern, sizeof(walk->pattern), "%s%s", dot, key);
    return place;
}

static struct place enter_item(struct walk *walk, unsigned index)
{
    struct place place = {strlen(walk->path), strlen(walk->pattern)};
    append(walk->path, sizeof(walk->path), "[%u]", index);
    append(walk->pattern, sizeof(walk->pattern), "[]");
    return place;
}

static void leave(struct walk *walk, struct place place)
{
    walk->path[place.path] = '\0';
    walk->pattern[place.pattern] = '\0';
}

static const char *here(const struct walk *walk)
{
    return *walk->path ? walk->path : "the scene";
}

/* The message is in place; add where, and why if the table has a reason. */
static enum neph_status refuse(const struct walk *walk, const yaml_node_t *node)
{
    neph_document_locate(walk->document, node, walk->diag);
    const struct neph_field *field = neph_schema_field(walk->pattern);
    if (walk->diag && field && field->note && !*walk->diag->hint)
        neph_hint(walk->diag, "%s", field->note);
    return NEPH_ERR_INPUT;
}

enum neph_status neph_check_fail(struct neph_document *document, const char *path,
                                 struct neph_diag *diag, const char *format, ...)
{
    char message[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof(message), format, arguments);
    va_end(arguments);
    neph_fail(diag, NEPH_ERR_INPUT, "%s%s%s", path, *path ? ": " : "", message);
    neph_document_locate(document, neph_document_find(document, path), diag);
    return NEPH_ERR_INPUT;
}

/* --- What is allowed, in words --- */

static void describe_words(const cyaml_schema_value_t *schema, char *text, size_t size)
{
    append(text, size, "one of ");
    for (uint32_t i = 0; i < schema->enumeration.count; i++)
        append(text, size, "%s%s", i ? ", " : "", schema->enumeration.strings[i].str);
}

static void describe_count(const cyaml_schema_value_t *schema, char *text, size_t size)
{
    uint32_t minimum = schema->sequence.min, maximum = schema->sequence.max;
    if (minimum == maximum)
        append(text, size, "a list of %u numbers such as [0, 1, 0]", minimum);
    else
        append(text, size, "a list of %u to %u entries", minimum, maximum);
}

static void describe_range(const struct walk *walk, char *text, size_t size)
{
    const struct neph_field *field = neph_schema_field(walk->pattern);
    if (field)
        append(text, size, ", %g to %g%s%s", field->minimum, field->maximum,
               *field->unit ? " " : "", field->unit);
}

static void describe_keys(const cyaml_schema_value_t *schema, char *text, size_t size)
{
    for (const cyaml_schema_field_t *field = schema->mapping.fields; field->key; field++)
        append(text, size, "%s%s", field == schema->mapping.fields ? "" : ", ", field->key);
}

static void describe(const struct walk *walk, const cyaml_schema_value_t *schema, char *text,
                     size_t size)
{
    *text = '\0';
    switch (schema->type) {
    case CYAML_FLOAT:
        append(text, size, "a number");
        describe_range(walk, text, size);
        break;
    case CYAML_INT:
        append(text, size, "a whole number");
        describe_range(walk, text, size);
        break;
    case CYAML_BOOL:
        append(text, size, "true or false");
        break;
    case CYAML_ENUM:
        describe_words(schema, text, size);
        break;
    case CYAML_STRING:
        append(text, size, "a text of %u to %u bytes", schema->string.min, schema->string.max);
        break;
    case CYAML_MAPPING:
        append(text, size, "a mapping with the keys ");
        describe_keys(schema, text, size);
        break;
    default:
        describe_count(schema, text, size);
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

static enum neph_status refuse_value(const struct walk *walk, const yaml_node_t *node,
                                     const cyaml_schema_value_t *schema)
{
    char expected[512], found[128];
    describe(walk, schema, expected, sizeof(expected));
    describe_node(node, found, sizeof(found));
    neph_fail(walk->diag, NEPH_ERR_INPUT, "%s: found %s, expected %s", here(walk), found, expected);
    return refuse(walk, node);
}

/* --- Misspelled words --- */

#define WORD_MAX 40

static int minimum_of(int a, int b)
{
    return a < b ? a : b;
}

/* Edits (insert, delete, replace, swap neighbours) from one word to another. Damerau 1964,
 * "optimal string alignment" form. */
static int edit_distance(const char *a, const char *b)
{
    int size_a = (int)strlen(a), size_b = (int)strlen(b);
    if (size_a > WORD_MAX || size_b > WORD_MAX)
        return WORD_MAX;
    int table[WORD_MAX + 1][WORD_MAX + 1];
    for (int i = 0; i <= size_a; i++) {
        for (int j = 0; j <= size_b; j++) {
            if (!i || !j) {
                table[i][j] = i + j;
                continue;
            }
            int replace = table[i - 1][j - 1] + (a[i - 1] != b[j - 1]);
            int best = minimum_of(replace, 1 + minimum_of(table[i - 1][j], table[i][j - 1]));
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                best = minimum_of(best, table[i - 2][j - 2] + 1);
            table[i][j] = best;
        }
    }
    return table[size_a][size_b];
}

/* "extinction" means "extinction_per_m": a forgotten unit is no distance at all. */
static int spelling_distance(const char *word, const char *known)
{
    size_t size = strlen(word);
    if (size >= 3 && !strncasecmp(word, known, size))
        return 0;
    return edit_distance(word, known);
}

static void remember_nearest(const char *word, const char *known, const char **nearest, int *least)
{
    int distance = spelling_distance(word, known);
    if (distance >= *least || distance > 1 + (int)strlen(known) / 4)
        return;
    *least = distance;
    *nearest = known;
}

static const char *nearest_key(const cyaml_schema_value_t *schema, const char *word)
{
    const char *nearest = NULL;
    int least = WORD_MAX;
    for (const cyaml_schema_field_t *field = schema->mapping.fields; field->key; field++)
        remember_nearest(word, field->key, &nearest, &least);
    return nearest;
}

static const char *nearest_word(const cyaml_schema_value_t *schema, const char *word)
{
    const char *nearest = NULL;
    int least = WORD_MAX;
    for (uint32_t i = 0; i < schema->enumeration.count; i++)
        remember_nearest(word, schema->enumeration.strings[i].str, &nearest, &least);
    return nearest;
}

/* --- Scalars --- */

static const char *skip_digits(const char *text)
{
    while (isdigit((unsigned char)*text))
        text++;
    return text;
}

static const char *skip_sign(const char *text)
{
    return text + (*text == '-' || *text == '+');
}

/* Decimal only: no nan, no inf, no hexadecimal, nothing behind the number. */
static bool is_number(const char *text)
{
    const char *start = skip_sign(text);
    const char *end = skip_digits(start);
    bool digits = end > start;
    if (*end == '.') {
        const char *fraction = end + 1;
        end = skip_digits(fraction);
        digits |= end > fraction;
    }
    if (*end == 'e' || *end == 'E') {
        const char *exponent = skip_sign(end + 1);
        end = skip_digits(exponent);
        digits &= end > exponent;
    }
    return digits && !*end;
}

/* No leading zero: libcyaml would read 010 as eight. */
static bool is_integer(const char *text)
{
    const char *start = skip_sign(text);
    const char *end = skip_digits(start);
    return end > start && !*end && (*start != '0' || end == start + 1);
}

static bool is_plain(const yaml_node_t *node)
{
    return node->type == YAML_SCALAR_NODE && node->data.scalar.style == YAML_PLAIN_SCALAR_STYLE;
}

static enum neph_status check_range(const struct walk *walk, const yaml_node_t *node)
{
    const struct neph_field *field = neph_schema_field(walk->pattern);
    if (!field)
        return neph_fail(walk->diag, NEPH_ERR_INTERNAL, "no range is known for %s", walk->pattern);
    double value = strtod(neph_document_text(node), NULL);
    if (value >= field->minimum && value <= field->maximum)
        return NEPH_OK;
    char quote[NEPH_QUOTE_SIZE];
    neph_fail(walk->diag, NEPH_ERR_INPUT, "%s: %s is outside %g to %g%s%s", here(walk),
              neph_document_quote(neph_document_text(node), quote), field->minimum, field->maximum,
              *field->unit ? " " : "", field->unit);
    return refuse(walk, node);
}

static enum neph_status walk_number(struct walk *walk, const yaml_node_t *node,
                                    const cyaml_schema_value_t *schema)
{
    bool (*valid)(const char *) = schema->type == CYAML_INT ? is_integer : is_number;
    if (!is_plain(node) || !valid(neph_document_text(node)))
        return refuse_value(walk, node, schema);
    return check_range(walk, node);
}

static enum neph_status walk_bool(struct walk *walk, const yaml_node_t *node,
                                  const cyaml_schema_value_t *schema)
{
    if (is_plain(node) &&
        (!strcmp(neph_document_text(node), "true") || !strcmp(neph_document_text(node), "false")))
        return NEPH_OK;
    return refuse_value(walk, node, schema);
}

static enum neph_status walk_word(struct walk *walk, const yaml_node_t *node,
                                  const cyaml_schema_value_t *schema)
{
    if (node->type != YAML_SCALAR_NODE)
        return refuse_value(walk, node, schema);
    const char *word = neph_document_text(node);
    for (uint32_t i = 0; i < schema->enumeration.count; i++)
        if (!strcmp(word, schema->enumeration.strings[i].str))
            return NEPH_OK;
    enum neph_status status = refuse_value(walk, node, schema);
    const char *nearest = nearest_word(schema, word);
    if (nearest)
        neph_hint(walk->diag, "did you mean '%s'?", nearest);
    return status;
}

static enum neph_status walk_text(struct walk *walk, const yaml_node_t *node,
                                  const cyaml_schema_value_t *schema)
{
    if (node->type != YAML_SCALAR_NODE)
        return refuse_value(walk, node, schema);
    size_t size = strlen(neph_document_text(node));
    if (size < schema->string.min || size > schema->string.max)
        return refuse_value(walk, node, schema);
    return NEPH_OK;
}

/* --- Lists and mappings --- */

static enum neph_status walk_sequence(struct walk *walk, const yaml_node_t *node,
                                      const cyaml_schema_value_t *schema)
{
    if (node->type != YAML_SEQUENCE_NODE)
        return refuse_value(walk, node, schema);
    const yaml_node_item_t *start = node->data.sequence.items.start;
    size_t count = (size_t)(node->data.sequence.items.top - start);
    if (count < schema->sequence.min || count > schema->sequence.max)
        return refuse_value(walk, node, schema);
    enum neph_status status = NEPH_OK;
    for (unsigned i = 0; i < count && !status; i++) {
        struct place place = enter_item(walk, i);
        status = walk_value(walk, yaml_document_get_node(&walk->document->yaml, start[i]),
                            schema->sequence.entry);
        leave(walk, place);
    }
    return status;
}

static const cyaml_schema_field_t *field_of(const cyaml_schema_value_t *schema, const char *key)
{
    for (const cyaml_schema_field_t *field = schema->mapping.fields; field->key; field++)
        if (!strcmp(field->key, key))
            return field;
    return NULL;
}

static enum neph_status refuse_unknown(const struct walk *walk, const yaml_node_t *key,
                                       const cyaml_schema_value_t *schema)
{
    char quote[NEPH_QUOTE_SIZE], known[512] = "";
    const char *word = neph_document_text(key);
    describe_keys(schema, known, sizeof(known));
    neph_fail(walk->diag, NEPH_ERR_INPUT, "unknown key '%s' in %s; known keys: %s",
              neph_document_quote(word, quote), here(walk), known);
    const char *nearest = nearest_key(schema, word);
    if (nearest)
        neph_hint(walk->diag, "did you mean '%s'?", nearest);
    neph_document_locate(walk->document, key, walk->diag);
    return NEPH_ERR_INPUT;
}

static enum neph_status refuse_twice(const struct walk *walk, const yaml_node_t *first,
                                     const yaml_node_t *key)
{
    neph_fail(walk->diag, NEPH_ERR_INPUT, "the key '%s' stands twice in %s",
              neph_document_text(key), here(walk));
    neph_hint(walk->diag, "its first value is on line %zu", first->start_mark.line + 1);
    neph_document_locate(walk->document, key, walk->diag);
    return NEPH_ERR_INPUT;
}

static enum neph_status walk_pair(struct walk *walk, const yaml_node_t *mapping,
                                  const yaml_node_pair_t *pair, const cyaml_schema_value_t *schema)
{
    const yaml_node_t *key = yaml_document_get_node(&walk->document->yaml, pair->key);
    const yaml_node_t *value = yaml_document_get_node(&walk->document->yaml, pair->value);
    const char *name = neph_document_text(key);
    const cyaml_schema_field_t *field = field_of(schema, name);
    if (!field)
        return refuse_unknown(walk, key, schema);
    const yaml_node_t *first = neph_document_value(walk->document, mapping, name, strlen(name));
    if (first != value)
        return refuse_twice(walk, first, key);
    struct place place = enter_key(walk, name);
    enum neph_status status = walk_value(walk, value, &field->value);
    leave(walk, place);
    return status;
}

static enum neph_status check_present(struct walk *walk, const yaml_node_t *mapping,
                                      const cyaml_schema_field_t *field)
{
    if ((field->value.flags & CYAML_FLAG_OPTIONAL) ||
        neph_document_value(walk->document, mapping, field->key, strlen(field->key)))
        return NEPH_OK;
    char expected[512];
    struct place place = enter_key(walk, field->key);
    describe(walk, &field->value, expected, sizeof(expected));
    neph_fail(walk->diag, NEPH_ERR_INPUT, "missing key '%s': expected %s", walk->path, expected);
    enum neph_status status = refuse(walk, mapping);
    leave(walk, place);
    return status;
}

static enum neph_status walk_mapping(struct walk *walk, const yaml_node_t *node,
                                     const cyaml_schema_value_t *schema)
{
    if (node->type != YAML_MAPPING_NODE)
        return refuse_value(walk, node, schema);
    enum neph_status status = NEPH_OK;
    for (const yaml_node_pair_t *pair = node->data.mapping.pairs.start;
         pair < node->data.mapping.pairs.top && !status; pair++)
        status = walk_pair(walk, node, pair, schema);
    for (const cyaml_schema_field_t *field = schema->mapping.fields; field->key && !status; field++)
        status = check_present(walk, node, field);
    return status;
}

static enum neph_status walk_value(struct walk *walk, const yaml_node_t *node,
                                   const cyaml_schema_value_t *schema)
{
    switch (schema->type) {
    case CYAML_FLOAT:
    case CYAML_INT:
        return walk_number(walk, node, schema);
    case CYAML_BOOL:
        return walk_bool(walk, node, schema);
    case CYAML_ENUM:
        return walk_word(walk, node, schema);
    case CYAML_STRING:
        return walk_text(walk, node, schema);
    case CYAML_MAPPING:
        return walk_mapping(walk, node, schema);
    default:
        return walk_sequence(walk, node, schema);
    }
}

enum neph_status neph_check_document(struct neph_document *document, struct neph_diag *diag)
{
    struct walk walk = {.document = document, .diag = diag};
    return walk_value(&walk, neph_document_root(document), neph_schema_root());
}
