/* SPDX-License-Identifier: MIT */
#include "harness/fly/script.h"

#include <ctype.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum { FRAMES_MAX = 100000 };

static const struct {
    const char *name;
    int key;
} names[] = {
    {"space", NEPH_FLY_KEY_SPACE}, {"tab", NEPH_FLY_KEY_TAB}, {"esc", NEPH_FLY_KEY_ESCAPE},
    {"home", NEPH_FLY_KEY_HOME},   {".", NEPH_FLY_KEY_NONE},
};

struct word {
    int key, frame_count;
};

/* The key that a word starts with; `*size`: bytes of its name. */
static int parse_key_name(const char *text, size_t *size)
{
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
        *size = strlen(names[i].name);
        if (strncmp(text, names[i].name, *size) == 0)
            return names[i].key;
    }
    *size = 1;
    return tolower((unsigned char)*text);
}

static const char *skip_spaces(const char *text)
{
    return text + strspn(text, " \t\n");
}

/* The number from a '*' up to `end`; 0: not a number. */
static int parse_repeat_count(const char *text, const char *end)
{
    char *rest;
    const long count = isdigit((unsigned char)*text) ? strtol(text, &rest, 10) : 0;
    return count >= 1 && count <= FRAMES_MAX && rest == end ? (int)count : 0;
}

/* Read a word and advance to the next one; false: not a valid word. */
static bool read_word(const char **text, struct word *word)
{
    const char *end = *text + strcspn(*text, " \t\n");
    size_t size;
    word->key = parse_key_name(*text, &size);
    const char *behind = *text + size;
    if (behind != end && *behind != '*')
        return false;
    word->frame_count = behind == end ? 1 : parse_repeat_count(behind + 1, end);
    *text = skip_spaces(end);
    return word->frame_count > 0;
}

enum neph_status neph_fly_script_check(const char *script, struct neph_diag *diag)
{
    struct word word;
    for (const char *text = skip_spaces(script); *text;) {
        const char *start = text;
        if (read_word(&text, &word))
            continue;
        neph_fail(diag, NEPH_ERR_USAGE, "'%.*s' is neither a key nor a key*frames",
                  (int)strcspn(start, " \t\n"), start);
        neph_hint(diag, "such as --keys \"w*60 x .*8 p\"; . is no key, a wait");
        return NEPH_ERR_USAGE;
    }
    return NEPH_OK;
}

struct neph_fly_strokes neph_fly_script_at(const char *script, int frame)
{
    struct neph_fly_strokes strokes = {NEPH_FLY_KEY_NONE, NEPH_FLY_KEY_NONE};
    struct word word;
    int first = 0;
    for (const char *text = skip_spaces(script); *text && first <= frame;
         first += word.frame_count) {
        if (!read_word(&text, &word))
            break;
        if (first == frame)
            strokes.down = word.key;
        if (first + word.frame_count == frame)
            strokes.up = word.key;
    }
    return strokes;
}
