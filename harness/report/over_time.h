/* SPDX-License-Identifier: MIT
 *
 * A scene over many frames, for the report: presets of the real-time renderer held against the
 * march of the same model, with the four frames of a cycle to look at.
 */
#ifndef NEPH_HARNESS_REPORT_OVER_TIME_H
#define NEPH_HARNESS_REPORT_OVER_TIME_H

#include "base/arena.h"
#include "harness/json.h"
#include "harness/progress.h"
#include "harness/run/job.h"
#include "harness/run/speed.h"
#include "harness/study/take.h"

/* A preset against the reference. Texts are of an arena, here as below. */
struct neph_over_time_row {
    const char *preset;
    enum neph_outcome outcome;
    const char *reason, *settings;
    /* The rest of rendered rows alone. */
    double render_s;
    struct neph_speed speed; /* of warm frames; repeats 0: not measured */
    const char *folder;      /* of the take, in the store */
    json_t *measurements;    /* those that are shown, as the take has them, each with what it is
                              against centre rays; owned, NULL: none */
    json_t *findings;        /* owned, NULL: none */
    const char *pictures[NEPH_TAKE_PICTURES], *map; /* inside the report; NULL: not there (yet) */
};

enum { NEPH_OVER_TIME_PRESETS = 8 }; /* at most */

struct neph_over_time {
    const char *scene, *title, *physics;
    int width_px, height_px, frame_count;
    double rate_hz, exposure_ev;
    struct {
        enum neph_outcome outcome; /* unless rendered there are no rows */
        const char *reason, *settings, *text;
        double cpu_s; /* NaN: not known */
    } reference;
    int row_count;
    struct neph_over_time_row rows[NEPH_OVER_TIME_PRESETS];
};

/* Render and measure the sequence of the report. `*made`, in the arena, is set as soon as its
 * reference is tried, and is to be given to _finish. A preset that fails is a row that says why.
 * The store keeps the last frame of each preset with its measurements and pictures, and they are
 * used again. `times` NULL: speeds are not measured. */
enum neph_status neph_over_time_run(struct neph_shared_device *device, struct neph_store *store,
                                    struct neph_times *times, struct neph_progress *progress,
                                    struct neph_arena *arena, struct neph_over_time **made,
                                    struct neph_diag *diag);

void neph_over_time_finish(struct neph_over_time *over_time); /* NULL is fine */

/* Whether nothing broke; true of NULL. */
bool neph_over_time_passes(const struct neph_over_time *over_time);

/* Copy the pictures from the store into images/over_time/ of a report's folder, those that are not
 * there yet. NULL is fine. */
enum neph_status neph_over_time_pictures(struct neph_over_time *over_time,
                                         const char *report_folder, struct neph_arena *arena,
                                         struct neph_diag *diag);

/* The names of the metrics that are shown, NULL-terminated. */
const char *const *neph_over_time_metrics(void);

/* One of "sequences" in scripts/report/README.md. */
json_t *neph_over_time_json(const struct neph_over_time *over_time);

/* How many steps of progress that takes, and about how long one is on two cores. */
int neph_over_time_step_count(void);
#define NEPH_OVER_TIME_STEP_TYPICAL_S 8.0

#endif
