/* SPDX-License-Identifier: MIT
 *
 * Which number in the name of a file is the number of its frame. A path has runs of digits before
 * its extension, in names of folders too, counted 0, 1, ... from the left; one of more than 18
 * digits is no number. A hyphen is the minus of the run behind it at the start of a name and behind
 * one of . _ - / and the space: f.-0032.exr is frame -32, shot-0032.exr is frame 32. Paths that
 * differ in nothing but the numbers of their runs have one shape.
 */
#ifndef NEPH_HARNESS_COMPARE_FRAME_NUMBER_H
#define NEPH_HARNESS_COMPARE_FRAME_NUMBER_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { NEPH_FRAME_NO_RUN = -1 };

/* Where the name of the file starts in its path. */
size_t neph_frame_name_start(const char *path);

/* The last dot of the name, or its end. A name that starts with its only dot has no extension, and
 * digits behind the dot are none. */
size_t neph_frame_extension_start(const char *path);

/* How the names of a series are read, where it is not in the plain way. */
struct neph_frame_reading {
    bool hyphen_is_minus; /* behind a letter too: f-016.exr beside f0015.exr */
    uint64_t ids;         /* a bit for each word of letters and digits, from the left: an identifier
                             that each file has of its own, which orders nothing */
    bool is_guess;        /* the words may be names: only a series without a gap is one */
};

/* In these three `reading` may be NULL: the plain way. */
int neph_frame_run_count(const char *path, const struct neph_frame_reading *reading);

/* 0: of one shape. Else the order of the paths as text, runs aside. */
int neph_frame_compare_shapes(const char *a, const char *b,
                              const struct neph_frame_reading *reading);

/* Whether the numbers of that run differ as text (1 and 01 do) in paths of one shape. */
bool neph_frame_differs_at(const char *a, const char *b, int run,
                           const struct neph_frame_reading *reading);

/* Whether they have one shape, and no other run differs. */
bool neph_frame_equal_but_for(const char *a, const char *b, int run);

/* Whether paths that are sorted by neph_frame_compare_shapes() are frames of one series, and how
 * their names are read: they have one shape; or have one when identifiers of letters and digits
 * (f.0001.9e3779b1.exr) are left aside; or some have a hyphen before their number, and the numbers
 * count up by one. May change the order of the paths. */
bool neph_frame_find_series(char **paths, int count, struct neph_frame_reading *reading);

struct neph_frame_series {
    struct neph_frame_reading reading;
    int run;       /* which is the frame number, identifiers not counted, or NEPH_FRAME_NO_RUN */
    bool has_gaps; /* or a number twice */
};

/* Put paths of a series in the order of their frame numbers. These are the run that changes; when
 * several do, the one that counts up by one from file to file. `series->run` is NEPH_FRAME_NO_RUN
 * for a path by itself. NEPH_ERR_INPUT, with the way out: several change, and more or fewer than
 * one count up (the message names two); a frame is missing; a number, or a path, is there twice.
 * `by_position`: such numbers are no error. Files are in the order of the number that changes, and
 * of all numbers from the left where several do. */
enum neph_status neph_frame_arrange(char **paths, int count,
                                    const struct neph_frame_reading *reading, bool by_position,
                                    struct neph_frame_series *series, struct neph_diag *diag);

/* The frame number of a path of a series that has one. */
long long neph_frame_number(const char *path, const struct neph_frame_series *series);

#endif
