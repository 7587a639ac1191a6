/* SPDX-License-Identifier: MIT
 *
 * Suites: lists of scenes for studies, with a reason for each, in scenes/studies/.
 *
 *   {"format": FORMAT, "shut": {NAME: REASON},
 *    "suites": {NAME: [{"scene": ..., "reason": ..., ...}, ...], ...}}
 *
 * A scene is in one suite only, so that methods tuned on one suite are judged on another. No preset
 * is measured on a suite under "shut" before the settings are chosen: only a caller that
 * `opens_shut` gets its scenes.
 */
#ifndef NEPH_HARNESS_STUDY_SUITES_H
#define NEPH_HARNESS_STUDY_SUITES_H

#include "base/arena.h"
#include "harness/json.h"

/* The entries of a suite in a file of the project ("scenes/studies/flicker.json"), for
 * json_decref(). NEPH_ERR_USAGE: there is no such suite (the hint lists them), or it is shut.
 * NEPH_ERR_INPUT: another format, or a scene without a reason or listed twice. */
enum neph_status neph_suite_find(const char *file, const char *format, const char *name,
                                 bool opens_shut, json_t **entries, struct neph_diag *diag);

/* The scene of an entry: a name of the catalogue, or, with a slash, a file of the project. */
const char *neph_suite_scene(const json_t *entry, struct neph_arena *arena);

/* The scenes of a suite of flicker studies: "tuning", by which presets were chosen, "test", which
 * was not used for that, and others. Published statements on presets are about "test". The list and
 * its names are in `arena`. Errors as of neph_suite_find(). */
enum neph_status neph_flicker_suite_find(const char *name, bool opens_shut,
                                         struct neph_arena *arena, const char *const **scenes,
                                         int *count, struct neph_diag *diag);

#endif
