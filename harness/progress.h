/* SPDX-License-Identifier: MIT
 *
 * Progress of long work on stderr: one line with the time left on a terminal, a plain line per
 * finished step elsewhere.
 *
 * Steps are of kinds that take alike long (one engine's pictures, a chart's points). The time left
 * is the sum over the kinds of what is left of each, at the mean time of those that are over, or at
 * a guess before the first is.
 */
#ifndef NEPH_HARNESS_PROGRESS_H
#define NEPH_HARNESS_PROGRESS_H

#include <stdbool.h>

enum { NEPH_PROGRESS_KINDS = 64 };

struct neph_progress {
    bool quiet, terminal;
    int workers; /* that take steps at the same time; 0: one */
    int kind;    /* of the step at hand, 0 .. NEPH_PROGRESS_KINDS - 1; callers set it */
    struct {
        int total, done;
        double guess_s, spent_s; /* of one; of all that are done */
    } kinds[NEPH_PROGRESS_KINDS];
    double start_s, told_s; /* now; of the last line of neph_progress_tick() */
    double begun_s;         /* of the step at hand */
};

/* Steps of one kind alone; 0 when there will be more kinds than that (neph_progress_expect). */
struct neph_progress neph_progress_start(bool quiet, int total);

/* There will be `count` more steps of a kind, which take `guess_s` each; 0: nobody knows. */
void neph_progress_expect(struct neph_progress *progress, int kind, int count, double guess_s);

/* A step of progress->kind begins: shown on a terminal only. */
void neph_progress_begin(struct neph_progress *progress, const char *what);

/* It is over; `outcome` is a word or two. */
void neph_progress_step(struct neph_progress *progress, const char *what, const char *outcome,
                        double seconds);

/* It is over, after the time since it began; no other step began since. */
void neph_progress_over(struct neph_progress *progress, const char *what, const char *outcome);

/* A step of many short ones is over: elsewhere than on a terminal a line every ten seconds. */
void neph_progress_tick(struct neph_progress *progress, const char *what);

/* Others have finished so many steps of a kind, which took them `seconds` in all. */
void neph_progress_credit(struct neph_progress *progress, int kind, int steps, double seconds);

/* A line that is told in any case, also by quiet runs and in the middle of a step: "neph: ...". */
void neph_progress_warn(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Wipe the terminal's line. */
void neph_progress_end(const struct neph_progress *progress);

/* Steps that are over, and all, over all kinds. A step that was not expected raises both, so that
 * no count passes its total. */
void neph_progress_count(const struct neph_progress *progress, int *done, int *total);

/* Seconds until all steps are over, at the pace so far; negative when nothing is known yet. */
double neph_progress_left_s(const struct neph_progress *progress);

#endif
