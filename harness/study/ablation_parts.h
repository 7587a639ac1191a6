/* SPDX-License-Identifier: MIT
 *
 * The parts of the real-time renderer as a table for ablations: effect, origin, and the settings
 * that switch a part off. A new part is one row. A test finds settings of presets that belong to no
 * part.
 */
#ifndef NEPH_HARNESS_STUDY_ABLATION_PARTS_H
#define NEPH_HARNESS_STUDY_ABLATION_PARTS_H

#include "base/arena.h"

#include <stdbool.h>
#include <stdint.h>

enum { NEPH_ABLATION_PARTS_MAX = 60 };

struct neph_ablation_part {
    const char *name;  /* on the command line */
    const char *what;  /* effect, in one line */
    const char *claim; /* origin and purpose */
    const char *off;   /* "key=value+key=value": the plain value of each of its settings. A preset
                          has the part when its value of the first key differs from the plain one */
    const char *needs; /* the part without which it has no effect; NULL: none */
    bool stays; /* switched off in the preset only, and present in the plain pipeline: without it
                   that would be a different pipeline, or another part has its setting there */
};

/* In the order of the passes; ends with a NULL name. */
extern const struct neph_ablation_part neph_ablation_parts[];
int neph_ablation_part_count(void);

/* Settings in which presets differ that are not parts. Ends with a NULL option. */
struct neph_ablation_exception {
    const char *option, *reason;
};
extern const struct neph_ablation_exception neph_ablation_exceptions[];

/* Index of a part by name; -1: none. */
int neph_ablation_part_find(const char *name);

/* A set of parts: bit i is neph_ablation_parts[i]. */
typedef uint64_t neph_ablation_set;

/* The part and, recursively, the parts it needs. */
neph_ablation_set neph_ablation_with_needs(int part);

/* The parts of a preset ("NAME" or "NAME+KEY=VALUE+...") whose needs the preset has as well.
 * NEPH_ERR_USAGE as of neph_settings_parse_words(). */
enum neph_status neph_ablation_find_parts(const char *preset, neph_ablation_set *parts,
                                          struct neph_diag *diag);

/* The preset without some parts, as preset words. */
const char *neph_ablation_words(struct neph_arena *arena, const char *preset,
                                neph_ablation_set without);

/* The settings of a part as a preset has them, for example "override=sequential". Errors as of
 * neph_ablation_find_parts(), and NEPH_ERR_MEMORY. */
enum neph_status neph_ablation_part_values(struct neph_arena *arena, const char *preset, int part,
                                           const char **text, struct neph_diag *diag);

#endif
