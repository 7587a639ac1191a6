/* SPDX-License-Identifier: MIT */
#include "harness/document/junit.h"

#include "base/text.h"
#include "base/written.h"

#include <stdio.h>
#include <stdlib.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_JUNIT_RESULT_COUNT == 3, "a new kind");

struct neph_junit_case {
    const char *group, *name, *message; /* owned by the arena */
    enum neph_junit_result result;
    const char *file; /* owned by the arena; NULL: none */
    int line;
};

/* Element of each result; NULL: a passed case has none. */
static const char *const elements[] = {
    [NEPH_JUNIT_PASSED] = NULL,
    [NEPH_JUNIT_FAILED] = "failure",
    [NEPH_JUNIT_SKIPPED] = "skipped",
};

/* XML 1.0 allows only UTF-8 without control characters: other bytes are written as "\xNN". */
static const char *clean_copy(struct neph_arena *arena, const char *text)
{
    char *clean = neph_text_clean_copy(text);
    const char *copy = neph_arena_copy_text(arena, clean ? clean : "");
    arena->is_short |= !clean;
    free(clean);
    return copy;
}

void neph_junit_add(struct neph_junit *junit, const char *group, const char *name,
                    enum neph_junit_result result, const char *message)
{
    struct neph_arena *arena = &junit->arena;
    struct neph_junit_case *cases = neph_arena_grow_list(arena, junit->cases, junit->count,
                                                         &junit->room, sizeof(*cases));
    if (!cases)
        return;
    junit->cases = cases;
    cases[junit->count++] = (struct neph_junit_case){.group = clean_copy(arena, group),
                                                     .name = clean_copy(arena, name),
                                                     .message = clean_copy(arena, message),
                                                     .result = result};
}

void neph_junit_set_location(struct neph_junit *junit, const char *file, int line)
{
    if (junit->count == 0 || !file || file[0] == '/')
        return;
    junit->cases[junit->count - 1].file = clean_copy(&junit->arena, file);
    junit->cases[junit->count - 1].line = line;
}

static int count_results(const struct neph_junit *junit, enum neph_junit_result result)
{
    int count = 0;
    for (int i = 0; i < junit->count; i++)
        count += junit->cases[i].result == result;
    return count;
}

/* Newlines and tabs are written as spaces: an XML parser would turn them into spaces anyway. */
static void print_attribute(const char *name, const char *text, FILE *out)
{
    static const char *const names[] = {
        ['&'] = "&amp;", ['<'] = "&lt;", ['>'] = "&gt;", ['"'] = "&quot;"};
    fprintf(out, " %s=\"", name);
    for (; *text; text++) {
        const unsigned char c = (unsigned char)*text;
        const char *escaped = c < sizeof(names) / sizeof(names[0]) ? names[c] : NULL;
        if (escaped)
            fputs(escaped, out);
        else
            fputc(c < 0x20 ? ' ' : c, out);
    }
    fputc('"', out);
}

static void print_case(const struct neph_junit_case *item, FILE *out)
{
    const char *element = elements[item->result];
    fputs("  <testcase", out);
    print_attribute("classname", item->group, out);
    print_attribute("name", item->name, out);
    if (item->file) {
        print_attribute("file", item->file, out);
        fprintf(out, " line=\"%d\"", item->line);
    }
    fputc('>', out);
    if (element) {
        fprintf(out, "<%s", element);
        print_attribute("message", item->message, out);
        fputs("/>", out);
    }
    fputs("</testcase>\n", out);
}

static void print_suite(const void *given, FILE *out)
{
    const struct neph_junit *junit = given;
    fputs("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite", out);
    print_attribute("name", junit->name, out);
    fprintf(out, " tests=\"%d\" failures=\"%d\" skipped=\"%d\" time=\"%.3f\">\n", junit->count,
            count_results(junit, NEPH_JUNIT_FAILED), count_results(junit, NEPH_JUNIT_SKIPPED),
            junit->seconds);
    for (int i = 0; i < junit->count; i++)
        print_case(&junit->cases[i], out);
    fputs("</testsuite>\n", out);
}

enum neph_status neph_junit_write(const struct neph_junit *junit, const char *path,
                                  struct neph_diag *diag)
{
    const enum neph_status status = neph_arena_check(&junit->arena, diag);
    return status ? status : neph_write_to_file(path, print_suite, junit, diag);
}

void neph_junit_finish(struct neph_junit *junit)
{
    neph_arena_finish(&junit->arena);
    *junit = (struct neph_junit){.name = NULL};
}
