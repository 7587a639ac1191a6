/* SPDX-License-Identifier: MIT
 *
 * Finds the series of the baseline that a later run lacks: their step is gone, the step ran without
 * measuring them, an edited scene replaced them, or their step was not run for lack of time.
 */
#ifndef NEPH_HARNESS_NIGHT_LOST_H
#define NEPH_HARNESS_NIGHT_LOST_H

#include "base/arena.h"
#include "harness/run/database.h"

#include <stdbool.h>
#include <stdint.h>

/* A series of the baseline that no run has compared for more than this number of runs counts as
 * lost, whatever the reason. Equals NEPH_JUDGE_WINDOW, the number of runs in a baseline. */
extern const int neph_lost_after_nights;

/* Suffix of the name of the step that renders the accepted version of an edited scene. */
extern const char neph_as_accepted[];

/* A scene that was edited after the baseline run. Texts are allocated in the arena. */
struct neph_night_edit {
    const char *step;           /* "catalog fog" */
    const char *before, *after; /* "catalog/fog@15da7c6d" and the version of this run */
    int64_t accepted;           /* number of the baseline run */
    int count;                  /* series that are replaced */
    const char *words;          /* result of rendering the accepted version; NULL: not tried */
};

/* The part of the plan that a run covers, for its comparison. */
struct neph_night_scope {
    const char *const *planned; /* names of this run's steps; NULL: no step was left out */
    int planned_count;
    const char *const *only; /* for a comparison with a chosen run: steps that contain none of */
    int only_count;          /* these texts were left out on purpose; 0: all steps count */
    const struct neph_night_edit *edits;
    int edit_count;
};

enum neph_loss {
    NEPH_LOSS_STEP,    /* this run's plan has no such step */
    NEPH_LOSS_SERIES,  /* its step is done, without this series */
    NEPH_LOSS_EDITED,  /* this run has the same series of an edited scene instead */
    NEPH_LOSS_OVERDUE, /* its step is planned, but has not measured it for too many runs */
};

/* Texts are allocated in the arena. */
struct neph_lost_series {
    const char *name, *step; /* the step that measured it in the baseline */
    enum neph_loss loss;
    int64_t accepted; /* number of the baseline run */
    int64_t nights;   /* number of runs since its last measurement */
    /* the edited scene's series; else a series of this run with the same scene version under
     * another name or suite; NULL: none */
    const char *other;
};

struct neph_lost_list {
    struct neph_lost_series *list; /* allocated in the arena */
    int count;
    int left_out; /* number of NEPH_LOSS_STEP entries of the overall baseline */
};

/* The number of the baseline run of a series: the later one of its own acceptance and the last
 * acceptance of all series ("*"); `against` > 0 overrides both. An acceptance of all skips the
 * numbers of steps that its run had not finished; for these the acceptance before it counts. 0:
 * none. */
enum neph_status neph_accepted_night(struct neph_database *index, int64_t night, int64_t against,
                                     const char *series, int64_t *accepted, struct neph_diag *diag);

/* The number of the baseline run of a series for a measurement in `environment` (environment.h): of
 * the accepted runs as above, the last that measured the series in this environment; where none
 * did, the last of all. An acceptance without the series, which accepted it as lost, ends the
 * search. */
enum neph_status neph_accepted_night_in(struct neph_database *index, int64_t night,
                                        const char *series, const char *environment,
                                        int64_t *accepted, struct neph_diag *diag);

enum neph_status neph_lost_find(struct neph_database *index, int64_t night, int64_t against,
                                const struct neph_night_scope *scope, struct neph_arena *arena,
                                struct neph_lost_list *lost, struct neph_diag *diag);

/* The edited scenes, each once, without `words`; allocated in the arena. */
enum neph_status neph_lost_edits(struct neph_database *index, int64_t night, int64_t against,
                                 struct neph_arena *arena, struct neph_night_edit **edits,
                                 int *count, struct neph_diag *diag);

#endif
