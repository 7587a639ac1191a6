/* SPDX-License-Identifier: MIT
 *
 * Lists of scenes for flicker studies, as data with a reason for each
 * (scenes/studies/flicker.json): "tuning", which presets were chosen by, and "test", which they
 * were not. What is said of a preset is said of the second.
 */
#ifndef NEPH_HARNESS_STUDY_FLICKER_SUITES_H
#define NEPH_HARNESS_STUDY_FLICKER_SUITES_H

#include "base/status.h"

/* Names of the scenes of a suite; the list and its words are for the caller (neph_data_free_names).
 * NEPH_ERR_USAGE: there is no such suite (the hint lists them). NEPH_ERR_INPUT: the file is not
 * what it should be: a scene without a reason, or in two suites. */
enum neph_status neph_flicker_suite_find(const char *name, char ***scenes, int *count,
                                         struct neph_diag *diag);

#endif
