/* SPDX-License-Identifier: MIT
 *
 * Lists of scenes for studies, as data with a reason for each: {"format": FORMAT, "suites": {NAME:
 * [{"scene": ..., "reason": ..., ...}, ...], ...}} in scenes/studies/. What is chosen by one suite
 * is judged by another: a scene is in one of them, and once.
 */
#ifndef NEPH_HARNESS_STUDY_SUITES_H
#define NEPH_HARNESS_STUDY_SUITES_H

#include "base/arena.h"
#include "harness/json.h"

/* The entries of a suite in a file of the project ("scenes/studies/flicker.json"), for the caller
 * to json_decref. NEPH_ERR_USAGE: there is no such suite (the hint lists them). NEPH_ERR_INPUT: the
 * file is not what it should be: of another format, a scene without a reason, or twice. */
enum neph_status neph_suite_find(const char *file, const char *format, const char *name,
                                 json_t **entries, struct neph_diag *diag);

/* Where an entry's scene is: a name of the catalogue, or, with a slash, a file of the project. */
const char *neph_suite_scene(const json_t *entry, struct neph_arena *arena);

/* Names of the scenes of a suite of flicker studies: "tuning", which presets were chosen by,
 * "test", which they were not, and others. What is said of a preset is said of "test". The list and
 * its words are in `arena`. Errors as above. */
enum neph_status neph_flicker_suite_find(const char *name, struct neph_arena *arena,
                                         const char *const **scenes, int *count,
                                         struct neph_diag *diag);

#endif
