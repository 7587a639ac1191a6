/* SPDX-License-Identifier: MIT */
#include "scenes/errors.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_STATUS_COUNT == 13, "a new kind");

void neph_errors_attribute(struct neph_errors *errors, const char *path)
{
    snprintf(errors->path, sizeof(errors->path), "%s", path);
}

void neph_errors_keep(struct neph_errors *errors, enum neph_status status, const char *path)
{
    if (!errors->now.message[0] || neph_errors_are_full(errors))
        return;
    const struct neph_diag *now = &errors->now;
    struct neph_error *error = &errors->list[errors->count];
    *error = (struct neph_error){
        .status = status, .order = errors->count, .line = now->line, .column = now->column};
    snprintf(error->path, sizeof(error->path), "%s", errors->path[0] ? errors->path : path);
    strcpy(error->message, now->message);
    strcpy(error->hint, now->hint);
    errors->count++;
    errors->now.message[0] = errors->path[0] = '\0';
}

bool neph_errors_are_full(const struct neph_errors *errors)
{
    return errors->count == NEPH_ERRORS_MAX;
}

static bool is_in_list(const char *key, size_t length, const char *keys)
{
    for (const char *at = keys; *at; at += strcspn(at, " "), at += *at == ' ')
        if (strcspn(at, " ") == length && memcmp(at, key, length) == 0)
            return true;
    return false;
}

bool neph_errors_concern(const struct neph_errors *errors, const char *path, const char *keys)
{
    const size_t length = strlen(path);
    for (int i = 0; i < errors->count; i++) {
        const char *key = errors->list[i].path;
        if (strncmp(key, path, length) != 0)
            continue;
        key += length;
        if (!*key)
            return true;
        key += *key == '.';
        if (is_in_list(key, strcspn(key, ".["), keys))
            return true;
    }
    return false;
}

/* By line and column; errors at one place stay in the order in which they were found. */
static int compare(const void *a_, const void *b_)
{
    const struct neph_error *a = a_, *b = b_;
    if (a->line != b->line)
        return a->line < b->line ? -1 : 1;
    if (a->column != b->column)
        return a->column < b->column ? -1 : 1;
    return a->order < b->order ? -1 : a->order > b->order;
}

static bool is_file_error(enum neph_status status)
{
    return status != NEPH_ERR_MEMORY && status != NEPH_ERR_INTERRUPTED &&
           status != NEPH_ERR_INTERNAL;
}

static void fill(const struct neph_error *error, const char *file, struct neph_diag *diag)
{
    *diag = (struct neph_diag){.line = error->line, .column = error->column};
    strcpy(diag->message, error->message);
    strcpy(diag->hint, error->hint);
    neph_locate(diag, file, error->line, error->column);
}

/* Lists whole entries; the last line gives the number of the others, or states that reading
 * ended. */
static void list_others(const struct neph_errors *errors, struct neph_diag *diag)
{
    enum { TAIL_SIZE = 120 };
    struct neph_diag other;
    size_t used = 0;
    int left = errors->count - 1;
    for (int i = 1; i < errors->count; i++, left--) {
        const size_t room = sizeof(diag->more) - TAIL_SIZE - used;
        fill(&errors->list[i], errors->file, &other);
        const int length = neph_diag_format(&other, errors->file, diag->more + used, room);
        if ((size_t)length >= room)
            break;
        used += (size_t)length;
    }
    diag->more[used] = '\0';
    if (neph_errors_are_full(errors))
        snprintf(diag->more + used, TAIL_SIZE,
                 "reading ended after %d errors, of which %d are shown; correct these first\n",
                 errors->count, errors->count - left);
    else if (left > 0)
        snprintf(diag->more + used, TAIL_SIZE,
                 "%d more errors are not shown; correct these first\n", left);
}

enum neph_status neph_errors_report(struct neph_errors *errors, struct neph_diag *diag)
{
    if (errors->count == 0)
        return NEPH_OK;
    qsort(errors->list, (size_t)errors->count, sizeof(errors->list[0]), compare);
    enum neph_status status = errors->list[0].status;
    for (int i = 0; i < errors->count; i++) {
        if (!is_file_error(errors->list[i].status)) {
            if (diag)
                fill(&errors->list[i], errors->file, diag);
            return errors->list[i].status;
        }
        if (errors->list[i].status == NEPH_ERR_INPUT)
            status = NEPH_ERR_INPUT;
    }
    if (diag) {
        fill(&errors->list[0], errors->file, diag);
        list_others(errors, diag);
    }
    return status;
}
