/* SPDX-License-Identifier: MIT
 *
 * The series that the accepted night has and a later night has not: lost with their step, missing
 * from a step that was done, replaced because their scene was edited, or not run for want of time.
 */
#ifndef NEPH_HARNESS_NIGHT_LOST_H
#define NEPH_HARNESS_NIGHT_LOST_H

#include "base/arena.h"
#include "harness/run/database.h"

#include <stdbool.h>
#include <stdint.h>

/* An accepted series that was not compared for more nights than this is lost, whatever the reason:
 * NEPH_JUDGE_WINDOW, the nights that a baseline is made of. */
extern const int neph_lost_after_nights;

/* The end of a step's name under which the accepted version of its edited scene is rendered. */
extern const char neph_as_accepted[];

/* A scene that was edited since a night was accepted. Texts are of the arena. */
struct neph_night_edit {
    const char *step;           /* "catalog fog" */
    const char *before, *after; /* "catalog/fog@15da7c6d" and what tonight has in its place */
    int64_t accepted;           /* the night */
    int count;                  /* series that are replaced */
    const char *words;          /* what became of the accepted version; NULL: nothing */
};

/* What a comparison is told of its night. */
struct neph_night_scope {
    const char *const *planned; /* names of tonight's steps; NULL: no step was left out */
    int planned_count;
    const char *const *only; /* of a comparison with a chosen night: a step with none of these in */
    int only_count;          /* its name was left out on purpose; 0: none was */
    const struct neph_night_edit *edits;
    int edit_count;
};

enum neph_loss {
    NEPH_LOSS_STEP,    /* tonight's plan does not have its step */
    NEPH_LOSS_SERIES,  /* its step was done */
    NEPH_LOSS_EDITED,  /* tonight has the same series of an edited scene in its place */
    NEPH_LOSS_OVERDUE, /* its step is in the plan, and it was not measured for too many nights */
};

/* Texts are of the arena. */
struct neph_lost_series {
    const char *name, *step; /* that measured it in the accepted night */
    enum neph_loss loss;
    int64_t accepted; /* the night */
    int64_t nights;   /* since it was last measured */
    const char
        *other; /* of an edited scene the series in its place; else a series of tonight of the
                          same scene under another name or in another suite; NULL: none */
};

struct neph_lost_list {
    struct neph_lost_series *list; /* of the arena */
    int count;
    int left_out; /* of NEPH_LOSS_STEP, those of the accepted night of all */
};

/* The night whose acceptance counts for a series, its own or that of all; `against` > 0: that. An
 * acceptance of all does not count for the numbers of a step that its night has not done: the one
 * before it does. 0: none. */
enum neph_status neph_accepted_night(struct neph_database *index, int64_t night, int64_t against,
                                     const char *series, int64_t *accepted, struct neph_diag *diag);

enum neph_status neph_lost_find(struct neph_database *index, int64_t night, int64_t against,
                                const struct neph_night_scope *scope, struct neph_arena *arena,
                                struct neph_lost_list *lost, struct neph_diag *diag);

/* The scenes that were edited, each once, with no words yet; of the arena. */
enum neph_status neph_lost_edits(struct neph_database *index, int64_t night, int64_t against,
                                 struct neph_arena *arena, struct neph_night_edit **edits,
                                 int *count, struct neph_diag *diag);

#endif
