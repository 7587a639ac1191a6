/* SPDX-License-Identifier: MIT */
#include "harness/progress.h"

#include "base/clock.h"
#include "base/text.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <unistd.h>

struct neph_progress neph_progress_start(bool quiet, int total)
{
    struct neph_progress progress = {
        .quiet = quiet, .terminal = isatty(STDERR_FILENO) == 1, .start_s = neph_wall_s()};
    progress.kinds[0].total = total;
    progress.begun_s = progress.start_s;
    return progress;
}

void neph_progress_expect(struct neph_progress *progress, int kind, int count, double guess_s)
{
    progress->kinds[kind].total += count;
    if (count > 0)
        progress->kinds[kind].guess_s = guess_s;
}

double neph_progress_left_s(const struct neph_progress *progress)
{
    double left_s = 0.0;
    bool is_known = false;
    for (int k = 0; k < NEPH_PROGRESS_KINDS; k++) {
        const int done = progress->kinds[k].done, left = progress->kinds[k].total - done;
        const double each_s = done > 0 ? progress->kinds[k].spent_s / done
                                       : progress->kinds[k].guess_s;
        is_known = is_known || done > 0 || each_s > 0.0;
        left_s += each_s * fmax(left, 0);
    }
    return is_known ? left_s / (progress->workers > 1 ? progress->workers : 1) : -1.0;
}

void neph_progress_count(const struct neph_progress *progress, int *done, int *total)
{
    *done = *total = 0;
    for (int k = 0; k < NEPH_PROGRESS_KINDS; k++) {
        const int done_of_kind = progress->kinds[k].done, total_of_kind = progress->kinds[k].total;
        *done += done_of_kind;
        *total += done_of_kind > total_of_kind ? done_of_kind : total_of_kind;
    }
}

/* "[3/26] " */
static void print_place(const struct neph_progress *progress, int ahead)
{
    int done, total;
    neph_progress_count(progress, &done, &total);
    const int place = done + ahead;
    fprintf(stderr, "[%d/%d] ", place, place > total ? place : total);
}

/* What is being done may be named by a file. */
static void print_name(const char *what)
{
    char name[512];
    neph_text_format(name, sizeof(name), "%s", what);
    fputs(name, stderr);
}

/* " (about 4 min left)". */
static void print_left(const struct neph_progress *progress)
{
    const double left_s = neph_progress_left_s(progress);
    if (left_s >= 90.0)
        fprintf(stderr, " (about %.0f min left)", ceil(left_s / 60.0));
    else if (left_s > 0.5)
        fprintf(stderr, " (about %.0f s left)", left_s);
}

void neph_progress_begin(struct neph_progress *progress, const char *what)
{
    progress->begun_s = neph_wall_s();
    if (progress->quiet || !progress->terminal)
        return;
    fprintf(stderr, "\r\033[K");
    print_place(progress, 1);
    print_name(what);
    print_left(progress);
    fflush(stderr);
}

static void count_step(struct neph_progress *progress, double seconds)
{
    neph_progress_credit(progress, progress->kind, 1, seconds);
}

void neph_progress_step(struct neph_progress *progress, const char *what, const char *outcome,
                        double seconds)
{
    count_step(progress, seconds);
    if (progress->quiet || progress->terminal)
        return;
    print_place(progress, 0);
    print_name(what);
    fprintf(stderr, ": %s, %.1f s", outcome, seconds);
    print_left(progress);
    fprintf(stderr, "\n");
}

void neph_progress_over(struct neph_progress *progress, const char *what, const char *outcome)
{
    neph_progress_step(progress, what, outcome, neph_wall_s() - progress->begun_s);
}

void neph_progress_tick(struct neph_progress *progress, const char *what)
{
    static const double every_s = 10.0;
    const double now_s = neph_wall_s(), elapsed_s = now_s - progress->start_s;
    count_step(progress, now_s - progress->begun_s);
    progress->begun_s = now_s;
    if (progress->quiet || progress->terminal || elapsed_s - progress->told_s < every_s)
        return;
    progress->told_s = elapsed_s;
    print_place(progress, 0);
    print_name(what);
    print_left(progress);
    fprintf(stderr, "\n");
}

void neph_progress_credit(struct neph_progress *progress, int kind, int steps, double seconds)
{
    progress->kinds[kind].done += steps;
    progress->kinds[kind].spent_s += seconds;
    if (progress->kinds[kind].done > progress->kinds[kind].total)
        progress->kinds[kind].total = progress->kinds[kind].done;
}

void neph_progress_warn(const char *format, ...)
{
    char text[2048]; /* one write, so that lines of several runs do not mix */
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof(text), format, arguments);
    va_end(arguments);
    neph_text_clean(text, sizeof(text));
    fprintf(stderr, "%sneph: %s\n", isatty(STDERR_FILENO) == 1 ? "\r\033[K" : "", text);
}

void neph_progress_end(const struct neph_progress *progress)
{
    if (!progress->quiet && progress->terminal)
        fprintf(stderr, "\r\033[K");
}
