/* SPDX-License-Identifier: MIT
 *
 * The history of nightly runs in the store's database (index.h): series of measurements, the steps
 * that measured them, and the accepted baselines.
 *
 * Each finished run and each acceptance is also a document in STORE/history/, which is written
 * completely before its rows and never changed. The database can be rebuilt from the documents.
 *
 *   STORE/history/night-000012.json    {"format": "neph-night-1", "night": 12, "steps": [...], ...}
 *   STORE/history/accept-000003.json   {"format": "neph-accept-1", "series": "*", "night": 12, ...}
 *   STORE/history/copy-of-accept-000003.json   a copy, from which `neph store check --repair`
 *                                              restores a damaged acceptance
 */
#ifndef NEPH_HARNESS_RUN_HISTORY_H
#define NEPH_HARNESS_RUN_HISTORY_H

#include "harness/json.h"
#include "harness/run/record.h"

/* One number that a nightly run measured. */
struct neph_measurement {
    const char *series;      /* unique name: scene, engine, metric and all else that distinguishes
                                the number */
    const char *kind;        /* harness/night/judge.h */
    double value;            /* NaN: planned, but not measured */
    double standard_error;   /* NaN: not known */
    const char *environment; /* only measurements with an equal environment are comparable */
    const char *frame;       /* store key of the frame that was measured (store.h); "": none */
};

/* One step of a nightly run. */
struct neph_history_step {
    const char *name;
    const char *outcome; /* "done", "failed", "timeout"; "not run" in a finished run */
    const char *reason;  /* "" when done */
    const char *size;    /* of its frames, for example "96x54" */
    double wall_s;
    double calibration_s; /* NaN: no times were measured */
};

/* The scene that a step has measured. `terms` is a digest of the scene's settings that decide about
 * its measurements and change no rendered value: gates, exposure, measures over time
 * (night/scene_copy.h). */
struct neph_history_scene {
    const char *step, *scene, *hash, *terms;
};

extern const struct neph_record_form neph_history_step_form, neph_history_scene_form;

/* Identity of a nightly run: an unfinished run is resumed only when all four are equal. */
struct neph_history_night {
    const char *plan;     /* description of its steps, distinct for each plan */
    const char *revision; /* of the sources, from the caller */
    const char *program;  /* digest of neph itself */
    const char *host;
};

/* Inserts the rows of documents that the database does not have yet. A damaged document is reported
 * on stderr and skipped. */
enum neph_status neph_history_refresh(struct neph_database *index, const char *store_folder,
                                      struct neph_diag *diag);

/* Begins a nightly run, or resumes the last unfinished one when it has the same identity;
 * `*resumed` is true then. Other unfinished runs are deleted. A new run gets a number that no run,
 * no document (damaged ones included) and no acceptance has. */
enum neph_status neph_history_begin(struct neph_database *index, const char *store_folder,
                                    const struct neph_history_night *night, int64_t *id,
                                    bool *resumed, struct neph_diag *diag);

/* Begins a nightly run with the number and start time that it has in another database of the store.
 * Other unfinished runs are deleted. NEPH_ERR_IO also when the run is finished: its document
 * exists. */
enum neph_status neph_history_adopt(struct neph_database *index, const char *store_folder,
                                    const struct neph_history_night *night, int64_t id,
                                    const char *started_utc, struct neph_diag *diag);

/* Adds a finished step with all its measurements, or nothing. */
enum neph_status neph_history_add(struct neph_database *index, int64_t night,
                                  const struct neph_history_step *step,
                                  const struct neph_measurement *measurements, int count,
                                  struct neph_diag *diag);

/* Adds the scene that a step of the run has measured. */
enum neph_status neph_history_add_scene(struct neph_database *index, int64_t night,
                                        const struct neph_history_scene *scene,
                                        struct neph_diag *diag);

/* Stores the judgement of one measurement of the run. */
enum neph_status neph_history_judge(struct neph_database *index, int64_t night, const char *series,
                                    const char *judgement, struct neph_diag *diag);

/* Finishes a nightly run: writes its document, then its rows. `frames` is a JSON array of the keys
 * of the frames that it used. NEPH_ERR_IO also when the document exists. */
enum neph_status neph_history_end(struct neph_database *index, const char *store_folder,
                                  int64_t night, const char *verdict, const json_t *frames,
                                  struct neph_diag *diag);

/* NEPH_ERR_NOT_FOUND when neph_history_accept() would return that. */
enum neph_status neph_history_check_acceptable(struct neph_database *index, const char *series,
                                               int64_t night, struct neph_diag *diag);

/* The last finished run; 0: none. */
enum neph_status neph_history_last(struct neph_database *index, int64_t *night,
                                   struct neph_diag *diag);

/* Accepts a finished run as the baseline of `series`, or of all series ("*"). A series that only an
 * earlier accepted run has measured is accepted as lost: later runs do not report it as missing.
 * The document is written with a copy, and contains a digest of the run's document.
 * NEPH_ERR_NOT_FOUND: no such run, or neither it nor an accepted run has measured the series. */
enum neph_status neph_history_accept(struct neph_database *index, const char *store_folder,
                                     const char *series, int64_t night, const char *who,
                                     const char *why, struct neph_diag *diag);

/* Whether the database has this run, finished. */
enum neph_status neph_history_has(struct neph_database *index, int64_t night, bool *has,
                                  struct neph_diag *diag);

/* Whether the run is finished: its document, which is written last, exists. */
bool neph_history_is_over(const char *store_folder, int64_t night);

/* The document of a run, from its current rows. For json_decref(). */
enum neph_status neph_history_document(struct neph_database *index, int64_t night,
                                       json_t **document, struct neph_diag *diag);

/* The documents of all acceptances, oldest first. For json_decref(). */
enum neph_status neph_history_acceptances(struct neph_database *index, json_t **list,
                                          struct neph_diag *diag);

#endif
