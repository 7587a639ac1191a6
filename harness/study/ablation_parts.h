/* SPDX-License-Identifier: MIT
 *
 * The parts of the real-time renderer as data, for ablation: what each does, who claims it, and the
 * settings that take it out again. A new part is a line; a test finds the settings of a preset that
 * no part has.
 */
#ifndef NEPH_HARNESS_STUDY_ABLATION_PARTS_H
#define NEPH_HARNESS_STUDY_ABLATION_PARTS_H

#include "base/arena.h"

#include <stdbool.h>
#include <stdint.h>

enum { NEPH_ABLATION_PARTS_MAX = 60 };

struct neph_ablation_part {
    const char *name;  /* of the command line */
    const char *what;  /* one line */
    const char *claim; /* who has it, and for what */
    const char *off;   /* "key=value+key=value": the plain value of each of its settings. A preset
                          has the part when it has another value of the first */
    const char *needs; /* the part without which it does nothing; NULL: none */
    bool stays; /* only taken out of the preset, and never of the plain pipeline: that would be
                   another pipeline, or another part has its setting there */
};

/* In the order of the passes; ends with a NULL name. */
extern const struct neph_ablation_part neph_ablation_parts[];
int neph_ablation_part_count(void);

/* Settings in which presets differ and that are no part. Ends with a NULL option. */
struct neph_ablation_exception {
    const char *option, *reason;
};
extern const struct neph_ablation_exception neph_ablation_exceptions[];

/* Index of a part by name, or -1. */
int neph_ablation_part_find(const char *name);

/* A set of parts: bit i is neph_ablation_parts[i]. */
typedef uint64_t neph_ablation_set;

/* The part and all that it needs. */
neph_ablation_set neph_ablation_with_needs(int part);

/* The parts that a preset has, each with all that it needs; "NAME" or "NAME+KEY=VALUE+...".
 * NEPH_ERR_USAGE as of neph_settings_words(). */
enum neph_status neph_ablation_parts_of(const char *preset, neph_ablation_set *parts,
                                        struct neph_diag *diag);

/* The preset without some parts, in words. */
const char *neph_ablation_words(struct neph_arena *arena, const char *preset,
                                neph_ablation_set without);

/* "override=sequential": what a preset has for the settings of a part. Errors as above, and
 * NEPH_ERR_MEMORY. */
enum neph_status neph_ablation_part_values(struct neph_arena *arena, const char *preset, int part,
                                           const char **text, struct neph_diag *diag);

#endif
