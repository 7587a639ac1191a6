/* SPDX-License-Identifier: MIT */
#include "base/exr_parts.h"

#include "base/colour_names.h"
#include "base/exr_header.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Bytes behind the name of a channel: type, flags and sampling. See "chlist" in
 * https://openexr.com/en/latest/OpenEXRFileLayout.html. */
enum { CHANNEL_BYTES = 16 };

/* A value in the bytes of a header. */
struct text {
    const char *start;
    size_t length;
};

static struct text find_value(const struct neph_exr_part *part, const char *name, const char *type)
{
    struct neph_exr_attribute attribute;
    for (size_t at = 0; neph_exr_next_attribute(part->header, part->header_bytes, &at, &attribute);)
        if (strcmp(attribute.name, name) == 0 && strcmp(attribute.type, type) == 0)
            return (struct text){(const char *)attribute.value, attribute.value_bytes};
    return (struct text){"", 0};
}

/* The channel at `*at`, which moves to the next one; NULL: there are no more. */
static const char *next_channel(struct text channels, size_t *at)
{
    const char *name = channels.start + *at;
    const size_t room = channels.length - *at, length = strnlen(name, room);
    if (length == 0 || length == room || room - length - 1 < CHANNEL_BYTES)
        return NULL;
    *at += length + 1 + CHANNEL_BYTES;
    return name;
}

static bool has_channel(const void *context, const char *wanted)
{
    const struct text *channels = context;
    const char *name;
    for (size_t at = 0; (name = next_channel(*channels, &at)) != NULL;)
        if (strcmp(name, wanted) == 0)
            return true;
    return false;
}

static bool has_colour(const struct neph_exr_part *part, bool is_grey)
{
    const struct text channels = find_value(part, "channels", "chlist");
    const struct neph_colour_names *names;
    if (!is_grey && has_channel(&channels, "Y") && has_channel(&channels, "RY"))
        return true;
    for (int i = 0; (names = neph_colour_names_at(i)) != NULL; i++)
        if (names->is_grey == is_grey && neph_colour_names_fit(names, has_channel, &channels))
            return true;
    return false;
}

/* The part at `*at`, which moves to the next one; false: there are no more. */
static bool next_part(const char *headers, size_t size, size_t *at, struct neph_exr_part *part)
{
    const char *header;
    size_t bytes;
    const int index = *at == 0 ? 0 : part->index + 1;
    if (!neph_exr_next_header(headers, size, at, &header, &bytes))
        return false;
    *part = (struct neph_exr_part){.index = index, .header = header, .header_bytes = bytes};
    if (find_value(part, "channels", "chlist").length == 0) /* the bytes are no header */
        return false;
    const struct text type = find_value(part, "type", "string");
    part->is_deep = type.length >= 4 && memcmp(type.start, "deep", 4) == 0;
    return true;
}

static bool has_name(const struct neph_exr_part *part, const char *wanted)
{
    const struct text name = find_value(part, "name", "string");
    return name.length == strlen(wanted) && memcmp(name.start, wanted, name.length) == 0;
}

static bool has_number(const struct neph_exr_part *part, const char *wanted)
{
    char number[16];
    snprintf(number, sizeof(number), "%d", part->index);
    return strcmp(number, wanted) == 0;
}

static bool is_flat_colour(const struct neph_exr_part *part, const char *unused)
{
    (void)unused;
    return !part->is_deep && has_colour(part, false);
}

static bool is_flat_grey(const struct neph_exr_part *part, const char *unused)
{
    (void)unused;
    return !part->is_deep && has_colour(part, true);
}

/* Find the parts of which `is_wanted` is true: returns their number, and the first one. */
static int find_parts(const char *headers, size_t size,
                      bool (*is_wanted)(const struct neph_exr_part *part, const char *wanted),
                      const char *wanted, struct neph_exr_part *found)
{
    struct neph_exr_part part;
    int count = 0;
    for (size_t at = 0; next_part(headers, size, &at, &part);)
        if (is_wanted(&part, wanted) && count++ == 0)
            *found = part;
    return count;
}

/* ---- the list of parts in a message ---------------------------------------------------------- */

struct list {
    char text[760];
    size_t used;
};

static void add_words(struct list *list, const char *words, size_t length)
{
    const size_t room = sizeof(list->text) - 1 - list->used;
    const size_t bytes = length < room ? length : room;
    memcpy(list->text + list->used, words, bytes);
    list->used += bytes;
    list->text[list->used] = '\0';
}

static void add_part(struct list *list, const struct neph_exr_part *part)
{
    const struct text name = find_value(part, "name", "string"),
                      type = find_value(part, "type", "string"),
                      channels = find_value(part, "channels", "chlist");
    char number[24];
    const char *channel;
    add_words(
        list, number,
        (size_t)snprintf(number, sizeof(number), "%s%d ", part->index ? ", " : "", part->index));
    if (name.length > 0) {
        add_words(list, name.start, name.length);
        add_words(list, " ", 1);
    }
    add_words(list, "(", 1);
    add_words(list, type.start, type.length);
    add_words(list, ":", 1);
    for (size_t at = 0; (channel = next_channel(channels, &at)) != NULL;) {
        add_words(list, " ", 1);
        add_words(list, channel, strlen(channel));
    }
    add_words(list, ")", 1);
}

static enum neph_status fail_choice(const char *path, const char *headers, size_t size,
                                    const char *wanted, int colour_count, struct neph_diag *diag)
{
    struct list list = {.used = 0};
    struct neph_exr_part part;
    for (size_t at = 0; next_part(headers, size, &at, &part);)
        add_part(&list, &part);
    if (list.used == sizeof(list.text) - 1)
        memcpy(list.text + list.used - 3, "...", 3);
    if (wanted)
        neph_fail(diag, NEPH_ERR_INPUT, "'%s' has no part '%s'; its parts are: %s", path, wanted,
                  list.text);
    else
        neph_fail(diag, NEPH_ERR_INPUT, "'%s' has %s flat part with colour: %s", path,
                  colour_count > 0 ? "more than one" : "no", list.text);
    neph_hint(diag, "choose a part by its name or its number: --part NAME");
    return NEPH_ERR_INPUT;
}

enum neph_status neph_exr_choose_part(const char *path, const char *headers, size_t size,
                                      const char *wanted, struct neph_exr_part *part,
                                      struct neph_diag *diag)
{
    struct neph_exr_part found = {.header = headers}, first = found;
    size_t at = 0, second = 0;
    next_part(headers, size, &at, &first);
    second = at;
    int count = 1;
    if (!next_part(headers, size, &second, &found)) {
        *part = first;
        part->is_wanted = wanted && (has_name(part, wanted) || has_number(part, wanted));
        return NEPH_OK;
    }
    if (!wanted) {
        count = find_parts(headers, size, is_flat_colour, NULL, &found);
        if (count == 0)
            count = find_parts(headers, size, is_flat_grey, NULL, &found);
    } else if (find_parts(headers, size, has_name, wanted, &found) == 0)
        count = find_parts(headers, size, has_number, wanted, &found);
    if (count != 1)
        return fail_choice(path, headers, size, wanted, count, diag);
    *part = found;
    part->is_wanted = wanted != NULL;
    return NEPH_OK;
}
