/* SPDX-License-Identifier: MIT
 *
 * Finds the frame number in the names of files. A path is divided into runs of digits before its
 * extension, folder names included, counted 0, 1, ... from the left; a run of more than 18 digits
 * is not a number. A hyphen before a run is a minus sign at the start of a name and after one of .
 * _ - / and the space: f.-0032.exr is frame -32, shot-0032.exr is frame 32. Two paths have the same
 * shape when they differ only in the numbers of their runs.
 */
#ifndef NEPH_HARNESS_COMPARE_FRAME_NUMBER_H
#define NEPH_HARNESS_COMPARE_FRAME_NUMBER_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { NEPH_FRAME_NO_RUN = -1 };

/* Index of the first character of the file name in a path. */
size_t neph_frame_name_start(const char *path);

/* Index of the last dot of the name, or of its end when it has no extension. A name that starts
 * with its only dot has no extension; digits after a dot are no extension. */
size_t neph_frame_extension_start(const char *path);

/* Interpretation of the names of a series, for series that need other rules than the plain ones. */
struct neph_frame_reading {
    bool hyphen_is_minus; /* also after a letter: f-016.exr beside f0015.exr */
    uint64_t ids;         /* a bit for each word of letters and digits, from the left: set for a
                             unique identifier of each file, which does not affect the order */
    bool is_guess;        /* the words might be names, so a series must have no gaps */
};

/* In the next three functions `reading` NULL stands for the plain rules. */
int neph_frame_run_count(const char *path, const struct neph_frame_reading *reading);

/* 0: the same shape. Otherwise the order of the paths as text without their runs. */
int neph_frame_compare_shapes(const char *a, const char *b,
                              const struct neph_frame_reading *reading);

/* True when this run differs as text (1 and 01 do) between two paths of the same shape. */
bool neph_frame_differs_at(const char *a, const char *b, int run,
                           const struct neph_frame_reading *reading);

/* True when the paths have the same shape and differ in no other run. */
bool neph_frame_equal_but_for(const char *a, const char *b, int run);

/* True when paths, sorted by neph_frame_compare_shapes(), are frames of one series; `*reading` gets
 * the interpretation of their names. They must have the same shape; or the same shape without
 * identifiers of letters and digits (f.0001.9e3779b1.exr); or some have a hyphen before their
 * number, and the numbers increase by one. May change the order of the paths. */
bool neph_frame_find_series(char **paths, int count, struct neph_frame_reading *reading);

struct neph_frame_series {
    struct neph_frame_reading reading;
    int run;       /* index of the frame number, identifiers not counted, or NEPH_FRAME_NO_RUN */
    bool has_gaps; /* a number is missing or occurs twice */
};

/* Sort the paths of a series by frame number. The frame number is the run that changes; when
 * several runs change, the one that increases by one from file to file. `series->run` is
 * NEPH_FRAME_NO_RUN for a single path.
 *
 * NEPH_ERR_INPUT, with a remedy: several runs change, and none or more than one of them increases
 * by one (the message names two); a frame is missing; a number or a path occurs twice. With
 * `by_position` these are not errors: files are sorted by the run that changes, or by all runs from
 * the left when several change. */
enum neph_status neph_frame_arrange(char **paths, int count,
                                    const struct neph_frame_reading *reading, bool by_position,
                                    struct neph_frame_series *series, struct neph_diag *diag);

/* The frame number of a path; the series must have one. */
long long neph_frame_number(const char *path, const struct neph_frame_series *series);

#endif
