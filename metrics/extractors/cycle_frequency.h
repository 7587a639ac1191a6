/* SPDX-License-Identifier: MIT
 *
 * Frequencies of periodic signals. The frequency m / P cycles per frame, in lowest terms, belongs
 * to the primitive period of P frames and to no other period; so the periods 2, 4, 8 and 16 share
 * no power (the subspaces of Ramanujan sums: P. P. Vaidyanathan, IEEE Trans. Signal Processing 62,
 * 2014).
 */
#ifndef NEPH_METRICS_EXTRACTORS_CYCLE_FREQUENCY_H
#define NEPH_METRICS_EXTRACTORS_CYCLE_FREQUENCY_H

#include "base/arena.h"

#include <stddef.h>

/* A frame's attribute with the periods that its renderer declares; see neph_cycle_parse(). */
#define NEPH_CYCLE_ATTRIBUTE "neph.cycles"

enum {
    NEPH_CYCLE_PERIOD_MIN = 2,
    NEPH_CYCLE_PERIOD_MAX = 32, /* longest period that is searched without being declared */
    NEPH_CYCLE_LONG_COUNT = 4,  /* number of longer periods with a metric, cycle_long_1 .. */
    NEPH_CYCLE_DECLARED_MAX = 16,
    NEPH_CYCLE_NAME_MAX = 32,
};

/* A frequency [cycles per frame]. */
struct neph_cycle_frequency {
    int m;
    int period; /* frames; m and period are coprime, and 2 m <= period */
};

struct neph_cycle_frequencies {
    struct neph_cycle_frequency *items;
    int count;
};

/* Periods that the renderer declares. */
struct neph_cycle_declared {
    int periods[NEPH_CYCLE_DECLARED_MAX];                     /* frames, each >= 2 */
    char names[NEPH_CYCLE_DECLARED_MAX][NEPH_CYCLE_NAME_MAX]; /* cut if too long */
    int count;
};

static inline double neph_cycle_per_frame(struct neph_cycle_frequency frequency)
{
    return (double)frequency.m / (double)frequency.period;
}

/* The reason why a period has no number: another period explains the frames equally well. */
extern const char neph_cycle_not_apart[];

/* The longest period that `frame_count` frames can separate from its neighbours without a
 * declaration: an eighth of the frames, at most NEPH_CYCLE_PERIOD_MAX. Declared periods and their
 * beats need four times their length. */
int neph_cycle_longest(int frame_count);

/* Parse names and periods such as "slot 4, TAA jitter 7, ray dither 64". NEPH_ERR_INPUT: not a list
 * of names and numbers 2..65536, or more than NEPH_CYCLE_DECLARED_MAX. */
enum neph_status neph_cycle_parse(const char *text, struct neph_cycle_declared *declared,
                                  struct neph_diag *diag);

/* A likely cause of a period: the name of the shortest declared period that it divides; else "beat
 * of A and B" for two of them; else an empty text. `text` has `size` > 0 bytes. */
void neph_cycle_explain(const struct neph_cycle_declared *declared, int period, char *text,
                        size_t size);

/* The candidate frequencies, ascending: of all periods up to neph_cycle_longest(), of the declared
 * periods, and of the beats of pairs of them (least common multiples), if the frames contain the
 * period four times. Allocated in the arena. */
enum neph_status neph_cycle_candidates(int frame_count, const struct neph_cycle_declared *declared,
                                       struct neph_arena *memory,
                                       struct neph_cycle_frequencies *frequencies,
                                       struct neph_diag *diag);

#endif
