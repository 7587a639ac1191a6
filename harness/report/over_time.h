/* SPDX-License-Identifier: MIT
 *
 * The sequence of the report: a scene over many frames, in which presets of the real-time renderer
 * are compared with the ray marcher of the same model. The page shows the four frames of a cycle.
 */
#ifndef NEPH_HARNESS_REPORT_OVER_TIME_H
#define NEPH_HARNESS_REPORT_OVER_TIME_H

#include "base/arena.h"
#include "harness/json.h"
#include "harness/progress.h"
#include "harness/run/job.h"
#include "harness/run/speed.h"
#include "harness/study/flicker_study.h"
#include "harness/study/take.h"

/* A preset compared with the reference. Texts of this file's structs are allocated in an arena. */
struct neph_over_time_row {
    const char *preset;
    enum neph_outcome outcome;
    const char *reason, *settings;
    /* The fields below are set only for rendered rows. */
    double render_s;
    struct neph_speed speed; /* of warm frames; repeats 0: not measured */
    const char
        *floors[NEPH_STUDY_FLOOR_CANDIDATES]; /* configurations of the floor; NULL: not measured */
    const char *folder;                       /* of the captured sequence, in the store */
    json_t *measurements; /* the shown measurements, each with its value against centre rays,
                                "floor" and "times_floor"; owned, NULL: none */
    json_t *findings;     /* owned, NULL: none */
    const char *pictures[NEPH_CAPTURE_IMAGES], *map; /* paths inside the report; NULL: none, or not
                                                       yet */
};

enum { NEPH_OVER_TIME_PRESETS = 8 }; /* largest number of presets */

struct neph_over_time {
    const char *scene, *title, *physics;
    int width_px, height_px, frame_count;
    double rate_hz, exposure_ev;
    struct {
        enum neph_outcome outcome; /* rows exist only when rendered */
        const char *reason, *settings, *text;
        double cpu_s; /* NaN: unknown */
    } reference;
    int row_count;
    struct neph_over_time_row rows[NEPH_OVER_TIME_PRESETS];
};

/* Render and measure the sequence. `*made`, allocated in the arena, is set once the reference was
 * attempted; free it with neph_over_time_finish(). A preset that fails becomes a row with the
 * reason. The store keeps the last frame of each preset with its measurements and images; a later
 * run reuses them. `times` NULL: speeds are not measured. `with_floors`: the floors
 * of the presets are measured, too (harness/study/floor_plan.h), two sequences or less a preset. */
enum neph_status neph_over_time_run(struct neph_shared_device *device, struct neph_store *store,
                                    struct neph_times *times, bool with_floors,
                                    struct neph_progress *progress, struct neph_arena *arena,
                                    struct neph_over_time **made, struct neph_diag *diag);

void neph_over_time_finish(struct neph_over_time *over_time); /* NULL is allowed */

/* True when neither the reference nor a preset failed; true for NULL. */
bool neph_over_time_passes(const struct neph_over_time *over_time);

/* Copy missing images from the store into images/over_time/ of a report's folder. NULL is
 * allowed. */
enum neph_status neph_over_time_images(struct neph_over_time *over_time, const char *report_folder,
                                       struct neph_arena *arena, struct neph_diag *diag);

/* A copy of a measurement with "floor", the lower number of two documents, and "times_floor", the
 * measurement over it. Both are null where a document lacks the number; the ratio also where the
 * floor is 0. NULL: memory was short. */
json_t *neph_over_time_add_floor(const json_t *measurement,
                                 const json_t *const documents[NEPH_STUDY_FLOOR_CANDIDATES]);

/* The names of the shown metrics, NULL-terminated. */
const char *const *neph_over_time_metrics(void);

/* An element of "sequences" in scripts/report/README.md. */
json_t *neph_over_time_json(const struct neph_over_time *over_time);

/* The number of progress steps, and the typical duration of a step on two cores. */
int neph_over_time_step_count(bool with_floors);
#define NEPH_OVER_TIME_STEP_TYPICAL_S 8.0

#endif
