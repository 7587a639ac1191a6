/* SPDX-License-Identifier: MIT
 *
 * A study of the picture chain: what each stage, on and off, makes of the error and the flicker of
 * a real-time renderer. Its frames and their reference (reference.h) go through the same chain;
 * they are compared before the tone curve, as light, and behind the chain, on the display.
 */
#ifndef NEPH_HARNESS_STUDY_POST_STUDY_H
#define NEPH_HARNESS_STUDY_POST_STUDY_H

#include "harness/json.h"
#include "harness/run/store.h"
#include "metrics/extractor.h"
#include "renderer/post/chain.h"

#include <stdint.h>

enum { NEPH_POST_ROWS_MAX = 40, NEPH_POST_SCENES_MAX = 32 };

struct neph_vulkan;

/* Frames as light, and what is true of them: as many, or one for all. All borrowed. */
struct neph_post_film {
    const struct neph_image *const *tests, *const *references;
    int count, reference_count;
    int warm_up; /* frames at the start that the chain sees and nobody measures */
    double frame_rate_hz;
    uint64_t seed; /* of the grain */
};

struct neph_post_numbers {
    /* Light before the tone curve, over the reference's mean: rms of the error, and of what it
     * changes by from frame to frame. */
    double scene_error, scene_change;
    /* On the display, an SDR one of 100 cd/m^2 or an HDR one of its peak: FLIP (NaN: it is not for
     * HDR displays), flicker seen over threshold, the share of pixels where most people see
     * it, and the rms of what luma's error changes by. */
    double flip, seen, seen_share, luma_change;
    double ms; /* of all its stages on the device, the median of the frames; NaN: no clock */
};

/* The reference goes through the chain without grain: that is noise, and counts as such. */
enum neph_status neph_post_measure(struct neph_vulkan *vulkan, const struct neph_post_film *film,
                                   const struct neph_settings *settings,
                                   struct neph_post_numbers *numbers, struct neph_diag *diag);

/* The exposure at which an eye that looks at a frame shows it: for chains without one. */
enum neph_status neph_post_meter(struct neph_vulkan *vulkan, const struct neph_image *frame,
                                 double *exposure_ev, struct neph_diag *diag);

/* A chain of the study; the table ends with a NULL name. */
struct neph_post_row {
    const char *name;
    const char *settings; /* on top of what all have: tone=on, and neph_post_meter()'s exposure of
                             the reference, unless the eye of the chain finds one */
    bool is_of_whole;     /* a part is taken out of the whole, not put onto the curve alone */
};
extern const struct neph_post_row neph_post_rows[];

/* The row that others are over. */
#define NEPH_POST_BASE "Unreal's curve"

struct neph_post_study_params {
    const char *const *scenes; /* names or paths */
    int scene_count;           /* 1 .. NEPH_POST_SCENES_MAX */
    const char *preset;        /* of realtime: "NAME" or "NAME+KEY=VALUE+..." */
    int frame_count;           /* that are measured, a multiple of 4 */
    int warm_up;               /* before them, too */
    int width_px, height_px, steps;
    int seed; /* 1 .. */
    double frame_rate_hz;
    const char *const *chains; /* those with one of these words in their names, and the curve */
    int chain_count;           /* 0: all */
    struct neph_shared_device *device; /* as neph_shot.device */
    bool quiet;
};

struct neph_post_study {
    const struct neph_post_study_params *params; /* borrowed */
    char device[128];
    char *names[NEPH_POST_SCENES_MAX];                 /* of the scenes; owned */
    struct neph_post_row rows[NEPH_POST_ROWS_MAX + 1]; /* that were chosen; ends with a NULL name */
    struct neph_post_numbers numbers[NEPH_POST_SCENES_MAX][NEPH_POST_ROWS_MAX];
};

/* For _finish in any case. Errors: of loading and rendering; NEPH_ERR_INTERRUPTED; NEPH_ERR_USAGE:
 * no chain has such a word. */
enum neph_status neph_post_study_run(const struct neph_post_study_params *params,
                                     struct neph_store *store, struct neph_post_study *study,
                                     struct neph_diag *diag);
void neph_post_study_finish(struct neph_post_study *study);

/* A table a scene, in Markdown; a line for each chain and scene; all numbers. Texts are for the
 * caller to free. */
enum neph_status neph_post_study_text(const struct neph_post_study *study, char **text,
                                      struct neph_diag *diag);
enum neph_status neph_post_study_csv(const struct neph_post_study *study, char **text,
                                     struct neph_diag *diag);
/* Error and flicker on the display, over those of the curve alone, as SVG. */
enum neph_status neph_post_study_plot(const struct neph_post_study *study, char **svg,
                                      struct neph_diag *diag);
json_t *neph_post_study_json(const struct neph_post_study *study);

#endif
