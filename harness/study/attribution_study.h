/* SPDX-License-Identifier: MIT
 *
 * Causes of flicker: the flicker study of an attribution's sequences (attribution_plan.h), divided
 * into shares of the parts (attribution_value.h), scene by scene and over the scenes.
 */
#ifndef NEPH_HARNESS_STUDY_ATTRIBUTION_STUDY_H
#define NEPH_HARNESS_STUDY_ATTRIBUTION_STUDY_H

#include "harness/study/attribution_plan.h"
#include "harness/study/flicker_study.h"

#include <stdio.h>

struct neph_attribution_scene {
    const char *why;                       /* the reason why it has no values; NULL: it has */
    struct neph_attribution_values values; /* squared thresholds, means over seeds */
    double blur_px; /* of the sequence with all parts ideal but blur and aliasing, mean over seeds
                     */
};

/* A part, or the interaction of all, over the scenes with values. */
struct neph_attribution_row {
    double percent; /* mean share of the squared flicker of a scene; NaN: no scene */
    bool has_interval;
    double low, high; /* 95 %, Student's t over scenes */
    int worst_scene;  /* with the largest share in squared thresholds; -1: none */
    double falls;     /* mean fall of the flicker seen with only this part ideal [%]; NaN: none */
};

enum { NEPH_ATTRIBUTION_INTERACTION = NEPH_PARTS, NEPH_ATTRIBUTION_WORST = 3 };

struct neph_attribution_study {
    const struct neph_attribution_plan *plan;
    const struct neph_flicker_study *study; /* params->presets: the words of the plan */
    struct neph_attribution_scene *scenes;
    int scene_count;     /* scenes with values */
    int explained_count; /* of them, scenes with neph_attribution_explains() */
    struct neph_attribution_row rows[NEPH_PARTS + 1]; /* the last is the interaction */
    int order[NEPH_PARTS];                            /* parts, the largest mean share first */
};

/* Flicker seen in a scene with a seed and with these parts real, in thresholds; NaN: none. */
double neph_attribution_seen(const struct neph_attribution_plan *plan,
                             const struct neph_flicker_study *study, int scene, int seed,
                             neph_part_set state);

/* Divides the flicker of a finished study; the arena owns the scenes. NEPH_ERR_UNSUPPORTED: all
 * scenes were left out; NEPH_ERR_MEMORY. */
enum neph_status neph_attribution_judge(const struct neph_attribution_plan *plan,
                                        const struct neph_flicker_study *study,
                                        struct neph_arena *arena,
                                        struct neph_attribution_study *attribution,
                                        struct neph_diag *diag);

/* The share of a part, or the interaction, in percent of the scene's squared flicker. */
double neph_attribution_percent(const struct neph_attribution_scene *scene, int row);

/* Writes an SVG with a stacked bar of shares for each scene. */
void neph_attribution_plot(const struct neph_attribution_study *attribution, FILE *out);

/* Writes FOLDER/SCENE_PART.png for each of the worst parts in each scene: the last frame of the
 * preset, and beside it the flicker that the part adds in each pixel,
 * (max(0, all^2 - without^2))^(1/2), means over seeds. NEPH_ERR_IO, NEPH_ERR_MEMORY. */
enum neph_status neph_attribution_draw_maps(const struct neph_attribution_study *attribution,
                                            const char *folder, struct neph_diag *diag);

/* End of the colour scale of these maps, in thresholds. */
#define NEPH_ATTRIBUTION_MAP_SCALE 10.0

#endif
