/* SPDX-License-Identifier: MIT
 *
 * The frequencies that repeat: m / P cycles a frame in lowest terms belongs to the primitive period
 * of P frames and to no other, so that 2, 4, 8 and 16 share no power (the subspaces of S.
 * Ramanujan's sums: P. P. Vaidyanathan, IEEE Trans. Signal Processing 62, 2014).
 */
#ifndef NEPH_METRICS_EXTRACTORS_CYCLE_FREQUENCY_H
#define NEPH_METRICS_EXTRACTORS_CYCLE_FREQUENCY_H

#include "base/arena.h"

#include <stddef.h>

/* A frame's attribute: the periods that its maker has put in; neph_cycle_parse(). */
#define NEPH_CYCLE_ATTRIBUTE "neph.cycles"

enum {
    NEPH_CYCLE_PERIOD_MIN = 2,
    NEPH_CYCLE_PERIOD_MAX = 32, /* that is looked for without being declared */
    NEPH_CYCLE_LONG_COUNT = 4,  /* longer ones that have a number, cycle_long_1 .. */
    NEPH_CYCLE_DECLARED_MAX = 16,
    NEPH_CYCLE_NAME_MAX = 32,
};

/* A frequency [cycles per frame]. */
struct neph_cycle_frequency {
    int m;
    int period; /* frames; m and it have no common divisor, and 2 m <= period */
};

struct neph_cycle_frequencies {
    struct neph_cycle_frequency *items;
    int count;
};

/* Periods that whoever made the frames says are in them. */
struct neph_cycle_declared {
    int periods[NEPH_CYCLE_DECLARED_MAX];                     /* frames, each >= 2 */
    char names[NEPH_CYCLE_DECLARED_MAX][NEPH_CYCLE_NAME_MAX]; /* cut off if need be */
    int count;
};

static inline double neph_cycle_per_frame(struct neph_cycle_frequency frequency)
{
    return (double)frequency.m / (double)frequency.period;
}

/* Why a period has no number that explains the frames as well as one that was found. */
extern const char neph_cycle_not_apart[];

/* The longest period that `frame_count` frames show often enough to be told from its neighbours
 * without being declared: an eighth of them, and at most NEPH_CYCLE_PERIOD_MAX. Declared ones and
 * their beats need four times their length. */
int neph_cycle_longest(int frame_count);

/* Names and periods of "slot 4, TAA jitter 7, ray dither 64". What is no list of words and numbers
 * 2..65536, or has more than NEPH_CYCLE_DECLARED_MAX: NEPH_ERR_INPUT. */
enum neph_status neph_cycle_parse(const char *text, struct neph_cycle_declared *declared,
                                  struct neph_diag *diag);

/* Who may have made a period: the name of a declared one that it divides, the shortest such; else
 * "beat of A and B" of two; else an empty text. `text` has `size` > 0 bytes. */
void neph_cycle_explain(const struct neph_cycle_declared *declared, int period, char *text,
                        size_t size);

/* The frequencies to look for, ascending: of all periods up to neph_cycle_longest(), of those that
 * are declared, and of the beats of pairs of these (least common multiples), as far as they are in
 * the frames four times. The arena has them. */
enum neph_status neph_cycle_candidates(int frame_count, const struct neph_cycle_declared *declared,
                                       struct neph_arena *memory,
                                       struct neph_cycle_frequencies *frequencies,
                                       struct neph_diag *diag);

#endif
