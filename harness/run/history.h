/* SPDX-License-Identifier: MIT
 *
 * What nights have measured, in the store's database (index.h): series of numbers, the steps that
 * made them, and which nights were accepted as the baseline. A night that is over and an acceptance
 * are each a document in STORE/history/ as well, written whole before its rows are, and never
 * changed: of these the database can be made again.
 *
 *   STORE/history/night-000012.json    {"format": "neph-night-1", "night": 12, "steps": [...], ...}
 *   STORE/history/accept-000003.json   {"format": "neph-accept-1", "series": "*", "night": 12, ...}
 *   STORE/history/copy-of-accept-000003.json   the same once more: `neph store check --repair`
 *                                              restores a torn acceptance from this file
 */
#ifndef NEPH_HARNESS_RUN_HISTORY_H
#define NEPH_HARNESS_RUN_HISTORY_H

#include "harness/json.h"
#include "harness/run/record.h"

/* One number of a night. */
struct neph_measurement {
    const char *series;      /* scene, engine, metric, ...: what makes it another number is in it */
    const char *kind;        /* harness/night/judge.h */
    double value;            /* NaN: it was to be measured and is not there */
    double standard_error;   /* NaN: none is known */
    const char *environment; /* what it may be compared with */
    const char *frame;       /* key of the picture that it is of (store.h); "": of none */
};

/* One part of a night. */
struct neph_history_step {
    const char *name;
    const char *outcome; /* "done", "failed", "timeout"; "not run" of a night that is over */
    const char *reason;  /* "" when done */
    const char *size;    /* of its frames, such as "96x54" */
    double wall_s;
    double calibration_s; /* NaN: nothing was timed */
};

/* The scene that a step has measured. `terms` is a digest of what decides about its numbers and
 * changes none: gates, exposure, what is measured over time (night/scene_copy.h). */
struct neph_history_scene {
    const char *step, *scene, *hash, *terms;
};

extern const struct neph_record_form neph_history_step_form, neph_history_scene_form;

/* Who a night is. */
struct neph_history_night {
    const char *plan;     /* what belongs to it, in words that tell nights apart */
    const char *revision; /* of the sources, as the caller names it */
    const char *program;  /* digest of neph itself */
    const char *host;
};

/* Documents that have no rows yet become rows; one that is damaged is named on stderr and left
 * alone. */
enum neph_status neph_history_refresh(struct neph_database *index, const char *store_folder,
                                      struct neph_diag *diag);

/* Begin a night, or go on with the last when it did not end and is the same in all four; `*resumed`
 * tells. Other nights that did not end are forgotten. A new one has a number that no night, no
 * document, not even a torn one, and no acceptance has. */
enum neph_status neph_history_begin(struct neph_database *index, const char *store_folder,
                                    const struct neph_history_night *night, int64_t *id,
                                    bool *resumed, struct neph_diag *diag);

/* Begin a night under the number and the time that it has from another database of the store. Other
 * nights that did not end are forgotten. NEPH_ERR_IO also when a document of its number is there:
 * it is over. */
enum neph_status neph_history_adopt(struct neph_database *index, const char *store_folder,
                                    const struct neph_history_night *night, int64_t id,
                                    const char *started_utc, struct neph_diag *diag);

/* A step is over, with all its numbers or not at all. */
enum neph_status neph_history_add(struct neph_database *index, int64_t night,
                                  const struct neph_history_step *step,
                                  const struct neph_measurement *measurements, int count,
                                  struct neph_diag *diag);

/* Keep which scene a step of the night has measured. */
enum neph_status neph_history_add_scene(struct neph_database *index, int64_t night,
                                        const struct neph_history_scene *scene,
                                        struct neph_diag *diag);

/* What was found of one number of the night. */
enum neph_status neph_history_judge(struct neph_database *index, int64_t night, const char *series,
                                    const char *judgement, struct neph_diag *diag);

/* A night is over: its document, and then its rows. `frames` are the keys of the frames that it
 * used, an array of texts. NEPH_ERR_IO also when a document of its number is there. */
enum neph_status neph_history_end(struct neph_database *index, const char *store_folder,
                                  int64_t night, const char *verdict, const json_t *frames,
                                  struct neph_diag *diag);

/* Accept a night that is over as the baseline of `series`, or of all ("*"). A series that only an
 * earlier accepted night has measured is accepted as lost: later nights do not miss it. The
 * document is written twice, and holds a digest of the night's document. NEPH_ERR_NOT_FOUND: there
 * is no such night, or neither it nor an accepted night has measured the series. */
enum neph_status neph_history_accept(struct neph_database *index, const char *store_folder,
                                     const char *series, int64_t night, const char *who,
                                     const char *why, struct neph_diag *diag);

/* Whether the database has a night that is over. */
enum neph_status neph_history_has(struct neph_database *index, int64_t night, bool *has,
                                  struct neph_diag *diag);

/* Whether the night has its document, which is written last. */
bool neph_history_is_over(const char *store_folder, int64_t night);

/* The document of a night, as it is now. To json_decref. */
enum neph_status neph_history_document(struct neph_database *index, int64_t night,
                                       json_t **document, struct neph_diag *diag);

/* Acceptances, oldest first, as their documents. To json_decref. */
enum neph_status neph_history_acceptances(struct neph_database *index, json_t **list,
                                          struct neph_diag *diag);

#endif
