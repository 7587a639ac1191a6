/* SPDX-License-Identifier: MIT
 *
 * Readers that turn the JSON document of a step into measurements, each of a named series. The name
 * of a series has the parts
 *
 *   SUITE/SCENE@HASH/ENGINE/METRIC[/REFERENCE]
 *
 * The name contains everything that makes two numbers different quantities. A changed scene or
 * reference therefore starts a new series and raises no alarm. Settings are not part of the name: a
 * changed default is a change of the program. Two numbers of a series are comparable when their
 * environments agree: versions, devices, the number of samples within a time budget, and for
 * durations the class of the host.
 */
#ifndef NEPH_HARNESS_NIGHT_READERS_H
#define NEPH_HARNESS_NIGHT_READERS_H

#include "base/arena.h"
#include "harness/json.h"
#include "harness/night/judge.h"
#include "harness/night/plan.h"
#include "harness/run/history.h"

/* The kind of the series "contrast": (maximum - minimum) / mean of a frame's radiance. 0 is a blank
 * frame; NEPH_NIGHT_BROKEN_PICTURE marks a frame with NaN or infinite values. */
#define NEPH_NIGHT_PICTURE "picture"
#define NEPH_NIGHT_BROKEN_PICTURE -1.0

/* The end of the metric of a floor's series: "error over all floor" is the floor of a preset's
 * "error over all" in a stress scene that moves (harness/stress/floors.h). Documents of earlier
 * versions have no floors. */
#define NEPH_NIGHT_FLOOR " floor"

/* Texts are allocated in the arena. */
struct neph_night_numbers {
    struct neph_measurement *list;
    int count;
    const char *size; /* of the frames; "" when the document has no size */
};

/* Read the numbers of a suite's document. `calibration_s` is the step's calibration time; NaN:
 * durations are not used. `host` is the class of this host. NEPH_ERR_ENGINE: the document is not
 * one of the suite, or has more than 4096 numbers. */
enum neph_status neph_night_read(enum neph_night_suite suite, const json_t *document,
                                 double calibration_s, const char *host, struct neph_arena *arena,
                                 struct neph_night_numbers *numbers, struct neph_diag *diag);

/* Parse the JSON document in the output of a program; warnings before and after it are skipped.
 * NULL: there is none. The caller owns the result. */
json_t *neph_night_find_document(const char *text);

/* A metric as judge.h needs it. */
struct neph_night_metric {
    const char *name; /* the end of METRIC */
    double unit;
    bool is_signed;
};

const struct neph_night_metric *neph_night_metric(const char *metric);

/* The parts of a series name; "" for a missing part. Texts are allocated in the arena. */
struct neph_night_name {
    const char *suite, *scene, *engine, *metric, *truth;
};

struct neph_night_name neph_night_split(struct neph_arena *arena, const char *series);

#endif
