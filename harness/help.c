/* SPDX-License-Identifier: MIT */
#include "harness/help.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum {
    WIDTH = 79,       /* columns of a line */
    TEXT_COLUMN = 29, /* where the texts of options begin */
};

/* Print words between columns `indent` and WIDTH; `column` is where the cursor is. */
static void print_wrapped(const char *text, size_t length, int indent, int column, FILE *out)
{
    const char *const end = text + length;
    bool is_first = true;
    while (text < end) {
        text += strspn(text, " ");
        const size_t ahead = strcspn(text, " \n\v");
        const int word = text + ahead > end ? (int)(end - text) : (int)ahead;
        if (word <= 0)
            break;
        const bool wraps = !is_first && column + 1 + word > WIDTH;
        if (wraps)
            fprintf(out, "\n%*s", indent, "");
        else if (!is_first)
            fputc(' ', out);
        column = (wraps ? indent : column + !is_first) + word;
        fprintf(out, "%.*s", word, text);
        is_first = false;
        text += word;
    }
    fputc('\n', out);
}

/* A line of the source is a paragraph, or, with two blanks before it, a line. */
static void print_doc(const char *text, const char *end, FILE *out)
{
    while (text < end) {
        const char *stop = memchr(text, '\n', (size_t)(end - text));
        const size_t length = (size_t)((stop ? stop : end) - text);
        if (strncmp(text, "  ", 2) == 0)
            fprintf(out, "%.*s\n", (int)length, text);
        else
            print_wrapped(text, length, 0, 0, out);
        text += length + 1;
    }
}

static void print_option(const struct neph_help_option *option, FILE *out)
{
    char letter[5] = "    ", text[2048];
    if (option->letter)
        snprintf(letter, sizeof(letter), "-%c, ", option->letter);
    const int head = fprintf(out, "  %s--%s%s%s", letter, option->name, option->argument ? "=" : "",
                             option->argument ? option->argument : "");
    if (head + 2 > TEXT_COLUMN)
        fprintf(out, "\n%*s", TEXT_COLUMN, "");
    else
        fprintf(out, "%*s", TEXT_COLUMN - head, "");
    if (option->otherwise)
        snprintf(text, sizeof(text), "%s (default: %s)", option->text, option->otherwise);
    else
        snprintf(text, sizeof(text), "%s", option->text);
    print_wrapped(text, strlen(text), TEXT_COLUMN, TEXT_COLUMN, out);
}

/* Negative groups last. */
static long rank(const struct neph_help_option *option)
{
    return option->group < 0 ? 0x10000 + option->group : option->group;
}

static int by_group_and_name(const void *a_, const void *b_)
{
    const struct neph_help_option *a = a_, *b = b_;
    return rank(a) != rank(b) ? (rank(a) > rank(b) ? 1 : -1) : strcmp(a->name, b->name);
}

static void print_usage(const struct neph_help *help, FILE *out)
{
    const char *form = help->operands ? help->operands : "", *prefix = "Usage: ";
    for (;;) {
        const int length = (int)strcspn(form, "\n");
        fprintf(out, "%s%s [OPTION...]%s%.*s\n", prefix, help->verb, length > 0 ? " " : "", length,
                form);
        if (form[length] == '\0')
            return;
        form += length + 1;
        prefix = "  or:  ";
    }
}

void neph_help_print(const struct neph_help *help, FILE *out)
{
    const char *const end = help->doc + strlen(help->doc), *split = strchr(help->doc, '\v');
    qsort(help->options, (size_t)help->option_count, sizeof(*help->options), by_group_and_name);
    print_usage(help, out);
    print_doc(help->doc, split ? split : end, out);
    for (int i = 0; i < help->option_count; i++) {
        if (i == 0 || help->options[i].group != help->options[i - 1].group)
            fputc('\n', out);
        print_option(&help->options[i], out);
    }
    if (!split)
        return;
    fputc('\n', out);
    print_doc(split + 1, end, out);
}
