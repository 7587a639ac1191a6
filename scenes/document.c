/* SPDX-License-Identifier: MIT */
#include "scenes/document.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* State of the scan of events. */
struct scan {
    const char *file;
    const char *text;
    size_t size;
    int depth, depth_max;
    int documents;
};

static void locate_mark(const char *file, yaml_mark_t mark, struct neph_diag *diag)
{
    if (diag)
        neph_locate(diag, file, (int)mark.line + 1, (int)mark.column + 1);
}

/* libyaml gives a byte offset, but no mark, for text that it cannot decode. */
static yaml_mark_t mark_of_offset(const struct scan *scan, size_t offset)
{
    yaml_mark_t mark = {0};
    for (size_t i = 0; i < offset && i < scan->size; i++) {
        bool new_line = scan->text[i] == '\n';
        mark.line += new_line;
        mark.column = new_line ? 0 : mark.column + 1;
    }
    return mark;
}

static enum neph_status fail_parser(const struct scan *scan, const yaml_parser_t *parser,
                                    struct neph_diag *diag)
{
    if (parser->error == YAML_MEMORY_ERROR)
        return neph_fail_memory(diag);
    const char *problem = parser->problem ? parser->problem : "unreadable text";
    if (parser->error == YAML_READER_ERROR) {
        neph_fail(diag, NEPH_ERR_INPUT, "not a YAML text file: %s (value 0x%x)", problem,
                  (unsigned)parser->problem_value);
        locate_mark(scan->file, mark_of_offset(scan, parser->problem_offset), diag);
        return NEPH_ERR_INPUT;
    }
    neph_fail(diag, NEPH_ERR_INPUT, "not valid YAML: %s%s%s", problem, parser->context ? ", " : "",
              parser->context ? parser->context : "");
    locate_mark(scan->file, parser->problem_mark, diag);
    return NEPH_ERR_INPUT;
}

static enum neph_status refuse(const struct scan *scan, const yaml_event_t *event,
                               struct neph_diag *diag, const char *message, const char *hint)
{
    neph_fail(diag, NEPH_ERR_INPUT, "%s", message);
    neph_hint(diag, "%s", hint);
    locate_mark(scan->file, event->start_mark, diag);
    return NEPH_ERR_INPUT;
}

static enum neph_status check_plain(const struct scan *scan, const yaml_event_t *event,
                                    const yaml_char_t *anchor, const yaml_char_t *tag,
                                    struct neph_diag *diag)
{
    if (anchor)
        return refuse(scan, event, diag, "anchors (&name) are not allowed in a scene",
                      "write the value out where it is used");
    if (tag)
        return refuse(scan, event, diag, "tags (!name) are not allowed in a scene",
                      "only its key defines the type of a value");
    return NEPH_OK;
}

static enum neph_status check_open(struct scan *scan, const yaml_event_t *event,
                                   struct neph_diag *diag)
{
    if (++scan->depth > scan->depth_max)
        return refuse(scan, event, diag, "lists or mappings are nested too deeply",
                      "no scene needs more than 6 levels; is a bracket missing?");
    return NEPH_OK;
}

static enum neph_status check_event(struct scan *scan, const yaml_event_t *event,
                                    struct neph_diag *diag)
{
    enum neph_status status;
    switch (event->type) {
    case YAML_DOCUMENT_START_EVENT:
        if (++scan->documents > 1)
            return refuse(scan, event, diag, "a second document ('---') in one file",
                          "a file has one scene");
        return NEPH_OK;
    case YAML_ALIAS_EVENT:
        return refuse(scan, event, diag, "aliases (*name) are not allowed in a scene",
                      "write the value out where it is used");
    case YAML_SCALAR_EVENT:
        if (memchr(event->data.scalar.value, 0, event->data.scalar.length))
            return refuse(scan, event, diag, "a NUL character inside a text", "remove the \\0");
        return check_plain(scan, event, event->data.scalar.anchor, event->data.scalar.tag, diag);
    case YAML_SEQUENCE_START_EVENT:
        status = check_open(scan, event, diag);
        return status ? status
                      : check_plain(scan, event, event->data.sequence_start.anchor,
                                    event->data.sequence_start.tag, diag);
    case YAML_MAPPING_START_EVENT:
        status = check_open(scan, event, diag);
        return status ? status
                      : check_plain(scan, event, event->data.mapping_start.anchor,
                                    event->data.mapping_start.tag, diag);
    case YAML_SEQUENCE_END_EVENT:
    case YAML_MAPPING_END_EVENT:
        scan->depth--;
        return NEPH_OK;
    case YAML_NO_EVENT:
    case YAML_STREAM_START_EVENT:
    case YAML_STREAM_END_EVENT:
    case YAML_DOCUMENT_END_EVENT:
        break;
    }
    return NEPH_OK;
}

/* One pass over the events before the tree is built. It stops at the first refused event, so a
 * hostile file costs no more than the part that was read. */
static enum neph_status scan_events(struct scan *scan, struct neph_diag *diag)
{
    yaml_parser_t parser;
    if (!yaml_parser_initialize(&parser))
        return neph_fail_memory(diag);
    yaml_parser_set_input_string(&parser, (const unsigned char *)scan->text, scan->size);
    enum neph_status status = NEPH_OK;
    for (bool end = false; !end && !status;) {
        yaml_event_t event;
        if (!yaml_parser_parse(&parser, &event)) {
            status = fail_parser(scan, &parser, diag);
            break;
        }
        status = check_event(scan, &event, diag);
        end = event.type == YAML_STREAM_END_EVENT;
        yaml_event_delete(&event);
    }
    yaml_parser_delete(&parser);
    if (!status && !scan->documents) {
        status = neph_fail(diag, NEPH_ERR_INPUT, "the file has no scene: it is empty");
        neph_hint(diag, "see scenes/README.md for the format, scenes/catalog/ for examples");
        neph_locate(diag, scan->file, 1, 1);
    }
    return status;
}

static enum neph_status load_tree(struct neph_document *document, const struct scan *scan,
                                  struct neph_diag *diag)
{
    yaml_parser_t parser;
    if (!yaml_parser_initialize(&parser))
        return neph_fail_memory(diag);
    yaml_parser_set_input_string(&parser, (const unsigned char *)scan->text, scan->size);
    enum neph_status status = NEPH_OK;
    if (!yaml_parser_load(&parser, &document->yaml))
        status = fail_parser(scan, &parser, diag);
    yaml_parser_delete(&parser);
    return status;
}

/* Refuses lists and mappings as keys by their kind; the scan refuses them only by depth. */
static enum neph_status check_keys(struct neph_document *document, struct neph_diag *diag)
{
    yaml_document_t *yaml = &document->yaml;
    for (yaml_node_t *node = yaml->nodes.start; node < yaml->nodes.top; node++) {
        if (node->type != YAML_MAPPING_NODE)
            continue;
        for (yaml_node_pair_t *pair = node->data.mapping.pairs.start;
             pair < node->data.mapping.pairs.top; pair++) {
            yaml_node_t *key = yaml_document_get_node(yaml, pair->key);
            if (key->type == YAML_SCALAR_NODE)
                continue;
            neph_fail(diag, NEPH_ERR_INPUT, "a key must be a word, not a list or a mapping");
            neph_document_locate(document, key, diag);
            return NEPH_ERR_INPUT;
        }
    }
    return NEPH_OK;
}

enum neph_status neph_document_init(struct neph_document *document, const char *file,
                                    const char *text, size_t size, int depth_max,
                                    struct neph_diag *diag)
{
    struct scan scan = {.file = file, .text = text, .size = size, .depth_max = depth_max};
    enum neph_status status = scan_events(&scan, diag);
    if (status)
        return status;
    struct neph_document made = {.file = file};
    status = load_tree(&made, &scan, diag);
    if (status)
        return status;
    status = check_keys(&made, diag);
    if (status) {
        neph_document_finish(&made);
        return status;
    }
    *document = made;
    return NEPH_OK;
}

void neph_document_finish(struct neph_document *document)
{
    yaml_document_delete(&document->yaml);
}

yaml_node_t *neph_document_root(struct neph_document *document)
{
    return yaml_document_get_root_node(&document->yaml);
}

const char *neph_document_text(const yaml_node_t *scalar)
{
    return (const char *)scalar->data.scalar.value;
}

yaml_node_t *neph_document_value(struct neph_document *document, const yaml_node_t *mapping,
                                 const char *key, size_t key_size)
{
    for (yaml_node_pair_t *pair = mapping->data.mapping.pairs.start;
         pair < mapping->data.mapping.pairs.top; pair++) {
        const char *name = neph_document_text(yaml_document_get_node(&document->yaml, pair->key));
        if (strlen(name) == key_size && !memcmp(name, key, key_size))
            return yaml_document_get_node(&document->yaml, pair->value);
    }
    return NULL;
}

static yaml_node_t *item_of(struct neph_document *document, const yaml_node_t *sequence, long index)
{
    long count = sequence->data.sequence.items.top - sequence->data.sequence.items.start;
    if (index < 0 || index >= count)
        return NULL;
    return yaml_document_get_node(&document->yaml, sequence->data.sequence.items.start[index]);
}

/* Follows the path as far as the file has it; `*rest` receives the remaining part. */
static yaml_node_t *walk(struct neph_document *document, const char *path, const char **rest)
{
    yaml_node_t *node = neph_document_root(document);
    for (*rest = path; *path; *rest = path) {
        yaml_node_t *next = NULL;
        if (*path == '[') {
            char *end;
            long index = strtol(path + 1, &end, 10);
            path = *end ? end + 1 : end;
            if (node->type == YAML_SEQUENCE_NODE)
                next = item_of(document, node, index);
        } else {
            path += *path == '.';
            size_t size = strcspn(path, ".[");
            if (node->type == YAML_MAPPING_NODE)
                next = neph_document_value(document, node, path, size);
            path += size;
        }
        if (!next)
            break;
        node = next;
    }
    return node;
}

yaml_node_t *neph_document_find(struct neph_document *document, const char *path)
{
    const char *rest;
    return walk(document, path, &rest);
}

yaml_node_t *neph_document_exactly(struct neph_document *document, const char *path)
{
    const char *rest;
    yaml_node_t *node = walk(document, path, &rest);
    return *rest ? NULL : node;
}

enum neph_status neph_document_put_number(yaml_node_t *scalar, double number,
                                          struct neph_diag *diag)
{
    char text[32];
    const int length = snprintf(text, sizeof(text), "%.17g", number);
    yaml_char_t *copy = (yaml_char_t *)strdup(text);
    if (!copy)
        return neph_fail_memory(diag);
    free(scalar->data.scalar.value);
    scalar->data.scalar.value = copy;
    scalar->data.scalar.length = (size_t)length;
    return NEPH_OK;
}

void neph_document_locate(const struct neph_document *document, const yaml_node_t *node,
                          struct neph_diag *diag)
{
    locate_mark(document->file, node->start_mark, diag);
}

const char *neph_document_quote(const char *text, char buffer[NEPH_QUOTE_SIZE])
{
    const size_t limit = 60;
    size_t size = 0;
    for (; text[size] && size < limit; size++) {
        unsigned char byte = (unsigned char)text[size];
        buffer[size] = byte >= 0x20 && byte < 0x7f ? (char)byte : '?';
    }
    strcpy(buffer + size, text[size] ? "..." : "");
    return buffer;
}
