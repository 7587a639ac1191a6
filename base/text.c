/* SPDX-License-Identifier: MIT */
#include "base/text.h"

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    ESCAPE_SIZE = 12, /* "\U000e0001" and its NUL, rounded up */
    GROWTH = 4,       /* upper bound: one byte becomes "\xNN" */
};

static const struct {
    uint32_t first, last;
} control_characters[] = {
    {0x00, 0x08},     {0x0b, 0x1f},     {0x7f, 0x9f},     {0x61c, 0x61c},   {0x200e, 0x200f},
    {0x2028, 0x202e}, {0x2066, 0x206f}, {0xfeff, 0xfeff}, {0xfff9, 0xfffb}, {0xe0000, 0xe007f},
};

static bool is_control_character(uint32_t code)
{
    for (size_t i = 0; i < sizeof(control_characters) / sizeof(control_characters[0]); i++)
        if (code >= control_characters[i].first && code <= control_characters[i].last)
            return true;
    return false;
}

/* Length in bytes of the UTF-8 character that starts with `first`; 0: not a start byte. */
static size_t get_character_length(unsigned char first)
{
    if (first < 0x80)
        return 1;
    if (first >= 0xc2 && first < 0xe0)
        return 2;
    if (first >= 0xe0 && first < 0xf0)
        return 3;
    return first >= 0xf0 && first < 0xf5 ? 4 : 0;
}

/* Decode the character at the start of `left` > 0 bytes. Returns its length in bytes; 0: not UTF-8.
 * `*cut`: the bytes are the beginning of a character that continues after them. */
static size_t decode(const char *text, size_t left, uint32_t *code, bool *cut)
{
    static const uint32_t smallest[] = {0, 0, 0x80, 0x800, 0x10000};
    const size_t length = get_character_length((unsigned char)text[0]);
    *cut = false;
    *code = (unsigned char)text[0] & (length > 1 ? 0x7fu >> length : 0x7fu);
    for (size_t i = 1; i < length; i++) {
        if (i == left) {
            *cut = true;
            return 0;
        }
        if (((unsigned char)text[i] & 0xc0) != 0x80)
            return 0;
        *code = *code << 6 | ((unsigned char)text[i] & 0x3f);
    }
    const bool is_surrogate = *code >= 0xd800 && *code < 0xe000;
    return length == 0 || *code < smallest[length] || is_surrogate || *code > 0x10ffff ? 0 : length;
}

bool neph_text_is_utf8(const char *text, size_t length)
{
    uint32_t code;
    bool cut;
    for (size_t at = 0, step; at < length; at += step)
        if (text[at] == '\0' || !(step = decode(text + at, length - at, &code, &cut)))
            return false;
    return true;
}

size_t neph_text_first_unfit(const char *text, size_t length)
{
    uint32_t code;
    bool cut;
    size_t at = 0, step;
    while (at < length && (step = decode(text + at, length - at, &code, &cut)) &&
           !is_control_character(code))
        at += step;
    return at;
}

/* Write the escape of the first character of `left` bytes, such as "\x1b" or "\u202e". Returns the
 * length of the character in bytes. */
static size_t escape(const char *text, size_t left, char shown[ESCAPE_SIZE])
{
    uint32_t code;
    bool cut;
    const size_t length = decode(text, left, &code, &cut);
    if (length <= 1)
        snprintf(shown, ESCAPE_SIZE, "\\x%02x", (unsigned)(unsigned char)text[0]);
    else
        snprintf(shown, ESCAPE_SIZE, code > 0xffff ? "\\U%08x" : "\\u%04x", (unsigned)code);
    return length ? length : 1;
}

/* Drop an incomplete character at the end of a full buffer: it was probably filled by a function
 * that truncates at any byte. */
static void drop_truncated_character(char *text, size_t size)
{
    const size_t length = strlen(text);
    uint32_t code;
    bool cut = false;
    if (length + 1 < size)
        return;
    for (size_t back = length < 3 ? length : 3; back > 0 && !cut; back--)
        if (!decode(text + length - back, back, &code, &cut) && cut)
            text[length - back] = '\0';
}

void neph_text_clean(char *text, size_t size)
{
    drop_truncated_character(text, size);
    size_t length = strlen(text);
    for (size_t at = 0; (at += neph_text_first_unfit(text + at, length - at)) < length;) {
        char shown[ESCAPE_SIZE];
        const size_t old = escape(text + at, length - at, shown), new = strlen(shown);
        if (at + new >= size) {
            text[at] = '\0';
            return;
        }
        size_t rest = length - at - old;
        const bool is_full = rest > size - 1 - at - new;
        if (is_full)
            rest = size - 1 - at - new;
        memmove(text + at + new, text + at + old, rest);
        memcpy(text + at, shown, new);
        text[at + new + rest] = '\0';
        if (is_full)
            drop_truncated_character(text, size);
        length = strlen(text);
        at += new;
    }
}

void neph_text_format(char *text, size_t size, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, size, format, arguments);
    va_end(arguments);
    neph_text_clean(text, size);
}

char *neph_text_clean_copy(const char *text)
{
    const size_t size = GROWTH * strlen(text) + 2; /* never full */
    char *copy = malloc(size);
    if (!copy)
        return NULL;
    strcpy(copy, text);
    neph_text_clean(copy, size);
    return copy;
}
