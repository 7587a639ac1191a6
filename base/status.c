/* SPDX-License-Identifier: MIT */
#include "base/status.h"

#include "base/text.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

/* Does not compile with a new status: this file then needs a change. */
_Static_assert(NEPH_STATUS_COUNT == 13, "a new kind");

static const struct {
    const char *name;
    int exit_code;
} status_table[] = {
    [NEPH_OK] = {"ok", 0},
    [NEPH_ERR_USAGE] = {"usage", 64},
    [NEPH_ERR_INPUT] = {"input", 65},
    [NEPH_ERR_NOT_FOUND] = {"not_found", 66},
    [NEPH_ERR_IO] = {"io", 74},
    [NEPH_ERR_MEMORY] = {"memory", 71},
    [NEPH_ERR_UNAVAILABLE] = {"unavailable", 69},
    [NEPH_ERR_UNSUPPORTED] = {"unsupported", 2},
    [NEPH_ERR_ENGINE] = {"engine", 3},
    [NEPH_ERR_TIMEOUT] = {"timeout", 124},
    [NEPH_ERR_INTERRUPTED] = {"interrupted", 130},
    [NEPH_ERR_GATE] = {"gate", 1},
    [NEPH_ERR_INTERNAL] = {"internal", 70},
};

enum neph_status neph_fail(struct neph_diag *diag, enum neph_status status, const char *format, ...)
{
    if (!diag)
        return status;
    memset(diag, 0, sizeof(*diag));
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(diag->message, sizeof(diag->message), format, arguments);
    va_end(arguments);
    neph_text_clean(diag->message, sizeof(diag->message));
    return status;
}

void neph_hint(struct neph_diag *diag, const char *format, ...)
{
    if (!diag)
        return;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(diag->hint, sizeof(diag->hint), format, arguments);
    va_end(arguments);
    neph_text_clean(diag->hint, sizeof(diag->hint));
}

void neph_prefix(struct neph_diag *diag, const char *format, ...)
{
    if (!diag)
        return;
    char message[sizeof(diag->message)];
    memcpy(message, diag->message, sizeof(message));
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(diag->message, sizeof(diag->message), format, arguments);
    va_end(arguments);
    const size_t used = strlen(diag->message);
    snprintf(diag->message + used, sizeof(diag->message) - used, "%s", message);
    neph_text_clean(diag->message, sizeof(diag->message));
}

/* Replace every `from` in a text of `size` bytes by `to`. */
static void replace(char *text, size_t size, const char *from, const char *to)
{
    char *at = text;
    while (*from && (at = strstr(at, from))) {
        char rest[sizeof(((struct neph_diag *)NULL)->message)];
        snprintf(rest, sizeof(rest), "%s", at + strlen(from));
        const size_t room = size - (size_t)(at - text);
        snprintf(at, room, "%s%s", to, rest);
        at += strlen(to) < room ? strlen(to) : room - 1;
    }
    neph_text_clean(text, size);
}

void neph_move_paths(struct neph_diag *diag, const char *from, const char *to)
{
    if (!diag)
        return;
    if (to) {
        replace(diag->message, sizeof(diag->message), from, to);
        replace(diag->hint, sizeof(diag->hint), from, to);
    } else if (strstr(diag->hint, from)) {
        diag->hint[0] = '\0';
    }
}

void neph_locate(struct neph_diag *diag, const char *file, int line, int column)
{
    if (!diag)
        return;
    neph_text_format(diag->file, sizeof(diag->file), "%s", file);
    diag->line = line;
    diag->column = column;
}

int neph_diag_format(const struct neph_diag *diag, const char *who, char *text, size_t size)
{
    char place[sizeof(diag->file) + 32];
    snprintf(place, sizeof(place), "%s", who);
    if (diag->file[0] && diag->line > 0)
        snprintf(place, sizeof(place), "%s:%d:%d", diag->file, diag->line, diag->column);
    const bool has_hint = diag->hint[0] != '\0';
    return snprintf(text, size, "%s: %s\n%s%s%s", place, diag->message, has_hint ? "  hint: " : "",
                    diag->hint, has_hint ? "\n" : "");
}

enum neph_status neph_fail_memory(struct neph_diag *diag)
{
    return neph_fail(diag, NEPH_ERR_MEMORY, "out of memory");
}

const char *neph_status_name(enum neph_status status)
{
    return status_table[status].name;
}

int neph_status_exit_code(enum neph_status status)
{
    return status_table[status].exit_code;
}
