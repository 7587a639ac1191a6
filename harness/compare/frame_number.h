/* SPDX-License-Identifier: MIT
 *
 * Which number in the name of a file is that of its frame. A path has runs of digits before its
 * extension, in names of folders too, counted 0, 1, ... from the left; one of more than 18 digits
 * is no number. Paths that differ in nothing but the digits of their runs have one shape.
 */
#ifndef NEPH_HARNESS_COMPARE_FRAME_NUMBER_H
#define NEPH_HARNESS_COMPARE_FRAME_NUMBER_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>

enum { NEPH_FRAME_NO_RUN = -1 };

/* Where the name of the file starts in its path. */
size_t neph_frame_name_start(const char *path);

/* The last dot of the name, or its end. A name that starts with its only dot has no extension, and
 * digits behind the dot are none. */
size_t neph_frame_extension_start(const char *path);

int neph_frame_run_count(const char *path);

/* The value of a run; -1 when there is no such run. */
long long neph_frame_number_at(const char *path, int run);

/* 0: of one shape. Else the order of the paths as text, runs aside. */
int neph_frame_compare_shapes(const char *a, const char *b);

/* Whether the digits of that run differ (1 and 01 do) in paths of one shape. */
bool neph_frame_differs_at(const char *a, const char *b, int run);

/* Whether they have one shape, and no other run differs. */
bool neph_frame_equal_but_for(const char *a, const char *b, int run);

/* Put paths of one shape in the order of their frame numbers. These are the run that changes; when
 * several do, the one that counts up by one from file to file. `*run`: which it is, or
 * NEPH_FRAME_NO_RUN for a path alone. NEPH_ERR_INPUT, with the way out: several change, and not one
 * alone counts up (the message names two); a frame is missing; a number, or a path, is there twice.
 */
enum neph_status neph_frame_arrange(char **paths, int count, int *run, struct neph_diag *diag);

#endif
