/* SPDX-License-Identifier: MIT
 *
 * From what a step has printed to series. A series has a name of parts,
 *
 *   SUITE/SCENE@HASH/ENGINE/METRIC[/TRUTH]
 *
 * in which everything is that makes it another number, so that a scene or a truth that was changed
 * begins new series and does not alarm. Settings are no part of it: a default that was changed is a
 * change of the program. What makes two numbers incomparable is their environment: the versions and
 * devices behind them, the samples that a budget took, of durations the machine.
 */
#ifndef NEPH_HARNESS_NIGHT_READERS_H
#define NEPH_HARNESS_NIGHT_READERS_H

#include "base/arena.h"
#include "harness/json.h"
#include "harness/night/judge.h"
#include "harness/night/plan.h"
#include "harness/run/history.h"

/* The kind of a picture: the range of its radiance over the mean; 0 is a blank one, and
 * NEPH_NIGHT_BROKEN_PICTURE one with pixels that are no numbers. */
#define NEPH_NIGHT_PICTURE "picture"
#define NEPH_NIGHT_BROKEN_PICTURE -1.0

/* Texts are of the arena. */
struct neph_night_numbers {
    struct neph_measurement *list;
    int count;
    const char *size; /* of the frames, "" when the document does not tell */
};

/* `calibration_s` is that of the step; NaN: its durations are not to be used. `host` is the class
 * of this machine. NEPH_ERR_ENGINE: the document is none of the suite, or has more than
 * 4096 numbers. */
enum neph_status neph_night_read(enum neph_night_suite suite, const json_t *document,
                                 double calibration_s, const char *host, struct neph_arena *arena,
                                 struct neph_night_numbers *numbers, struct neph_diag *diag);

/* The JSON document in what a program has printed, warnings before and after it left out. NULL:
 * there is none. */
json_t *neph_night_find_document(const char *text);

/* What a metric is in terms of judge.h. */
struct neph_night_metric {
    const char *name; /* the end of METRIC */
    double unit;
    bool is_signed;
};

const struct neph_night_metric *neph_night_metric(const char *metric);

/* Parts of a name, "" where there is none. Texts are of the arena. */
struct neph_night_name {
    const char *suite, *scene, *engine, *metric, *truth;
};

struct neph_night_name neph_night_split(struct neph_arena *arena, const char *series);

#endif
