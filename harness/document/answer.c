/* SPDX-License-Identifier: MIT */
#include "harness/document/answer.h"

#include "base/files.h"
#include "base/path.h"
#include "base/text.h"

#include <math.h>
#include <stdarg.h>

enum { LINE_SIZE = 1024 };

void neph_answer_add(struct neph_answer *answer, const char *format, ...)
{
    char line[LINE_SIZE];
    va_list arguments;
    if (answer->count == NEPH_ANSWER_LINES_MAX - 1)
        return;
    va_start(arguments, format);
    vsnprintf(line, sizeof(line), format, arguments);
    va_end(arguments);
    neph_text_clean(line, sizeof(line));
    answer->lines[answer->count++] = neph_arena_copy_text(&answer->arena, line);
}

static void print_files(const struct neph_answer_rest *rest, FILE *out)
{
    const char *before = rest->flags ? "; files in " : "files in ";
    for (int i = 0; rest->folder && rest->files && rest->files[i]; i++) {
        if (!neph_path_exists(neph_path_in(rest->folder, rest->files[i]).text))
            continue;
        if (before[0] != ',')
            fprintf(out, "%s%s: %s", before, rest->folder, rest->files[i]);
        else
            fprintf(out, "%s%s", before, rest->files[i]);
        before = ", ";
    }
}

void neph_answer_print(const struct neph_answer *answer, const struct neph_answer_rest *rest,
                       bool is_brief, FILE *out)
{
    for (int i = 0; i < (is_brief ? 1 : answer->count); i++)
        fprintf(out, "%s\n", answer->lines[i]);
    if (is_brief)
        return;
    if (rest->flags)
        fprintf(out, "all numbers: %s", rest->flags);
    print_files(rest, out);
    fputc('\n', out);
}

void neph_answer_finish(struct neph_answer *answer)
{
    neph_arena_finish(&answer->arena);
    *answer = (struct neph_answer){.count = 0};
}

const char *neph_answer_difference_word(double low, double high)
{
    if (low == 0.0 && high == 0.0)
        return "equal";
    if (!(low > 0.0) && !(high < 0.0))
        return "not told apart";
    return high < 0.0 ? "better" : "worse";
}

const char *neph_answer_interval(double low, double high, char text[NEPH_ANSWER_INTERVAL_SIZE])
{
    text[0] = '\0';
    if (isfinite(low) && isfinite(high))
        snprintf(text, NEPH_ANSWER_INTERVAL_SIZE, " (%.3g to %.3g)", low, high);
    return text;
}
