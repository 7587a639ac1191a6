/* SPDX-License-Identifier: MIT
 *
 * A study of screens: what passes on a G-buffer make of ambient occlusion, indirect light and
 * reflections, against engine `surfaces`, which also gives the part of each that its own picture
 * shows. So the error of a method has two parts: what no screen can know, and what is its own.
 *
 * Light counts times the colour of its surface, summed over the channels, and is told relative to
 * all light of its kind in the picture; ambient occlusion in parts of the hemisphere, its mean over
 * pixels. A pixel is lost where what the screen shows of the truth is off by more than
 * NEPH_SCREEN_LOST of it.
 */
#ifndef NEPH_HARNESS_STUDY_SCREEN_STUDY_H
#define NEPH_HARNESS_STUDY_SCREEN_STUDY_H

#include "harness/json.h"
#include "harness/run/job.h"
#include "harness/study/light_models.h"
#include "harness/study/post_measure.h"
#include "harness/study/screen_lost.h"

#include <stdint.h>

enum { NEPH_SCREEN_SCENES_MAX = 16 };

#define NEPH_SCREEN_LOST 0.1 /* of a pixel's light; of the hemisphere half of it */

enum neph_screen_part {
    NEPH_SCREEN_AO,
    NEPH_SCREEN_DIFFUSE, /* light of other surfaces off Lambertian ones */
    NEPH_SCREEN_GLOSSY,  /* and off metal */
    NEPH_SCREEN_PARTS,
};

struct neph_screen_study_params {
    struct neph_scene *const *scenes;
    int scene_count;           /* 1 .. NEPH_SCREEN_SCENES_MAX */
    const char *const *models; /* of neph_light_model_parse(), of engine screen */
    int model_count;           /* 1 .. NEPH_LIGHT_MODELS_MAX */
    int width_px, height_px;
    int samples;         /* a pixel, of the truth */
    double radius_m;     /* of ambient occlusion, of truth and models */
    int rays;            /* a pixel, to tell why it is lost */
    int witness_samples; /* of Cycles, which is then held against, too; 0: it is not */
    int frame_count;     /* over which models flicker, at least 16; 0: nobody looks */
    struct neph_shared_device *device; /* as neph_shot.device */
    bool quiet;
};

/* One model's part against the truth. */
struct neph_screen_gap {
    double error, bias;             /* mean absolute, and mean */
    double own;                     /* error against what the screen shows of the truth */
    double known_error, lost_error; /* over pixels that are not lost, that are; NaN: none */
};

/* What a pixel is lost by: that of most of its rays; NEPH_SCREEN_LOSSES: none of them is, which is
 * noise. */
enum { NEPH_SCREEN_REASONS = NEPH_SCREEN_LOSSES + 1 };

/* What is known of a part before any model. */
struct neph_screen_truth {
    int pixels, lost, lost_by[NEPH_SCREEN_REASONS];
    double noise;  /* of the truth: what a perfect model would be off by */
    double beyond; /* what the screen does not show of the truth: no model can know it */
};

struct neph_screen_scene {
    struct neph_screen_truth truths[NEPH_SCREEN_PARTS];
    struct neph_screen_gap gaps[NEPH_LIGHT_MODELS_MAX][NEPH_SCREEN_PARTS];
    /* Cycles against the truth, and models against Cycles; NaN: it was not asked, or cannot. */
    struct neph_screen_gap witness[NEPH_SCREEN_PARTS];
    struct neph_screen_gap against_witness[NEPH_LIGHT_MODELS_MAX][NEPH_SCREEN_PARTS];
    char witness_cannot[200];                                /* why; "": it can */
    int frame_count;                                         /* 0: flicker was not measured */
    struct neph_post_numbers flicker[NEPH_LIGHT_MODELS_MAX]; /* of pictures, against the truth */
    /* Over surfaces in the picture: shares of the hemisphere within the radius and all the way. */
    double near[NEPH_SCREEN_LOSSES], far[NEPH_SCREEN_LOSSES];
    /* A value a pixel, owned: the truth for a display, in grey; 0 where it is known, else 1 and the
     * reason. */
    uint8_t *seen, *marks[NEPH_SCREEN_PARTS];
};

struct neph_screen_study {
    const struct neph_screen_study_params *params;           /* borrowed */
    struct neph_screen_scene scenes[NEPH_SCREEN_SCENES_MAX]; /* neph_screen_study_finish() */
};

extern const char *const neph_screen_part_names[NEPH_SCREEN_PARTS];

/* NEPH_ERR_UNAVAILABLE: there is no Cycles. NEPH_ERR_INTERRUPTED: what is finished stays in the
 * store. NEPH_ERR_USAGE: a model is of another engine. NEPH_ERR_UNSUPPORTED: truth or model cannot
 * render a scene, and why. */
enum neph_status neph_screen_study_run(const struct neph_screen_study_params *params,
                                       struct neph_store *store, struct neph_screen_study *study,
                                       struct neph_diag *diag);

/* Nothing but the study's own memory stays. */
void neph_screen_study_finish(struct neph_screen_study *study);

/* As Markdown, for the caller to free; and as JSON, NULL when memory is short. */
enum neph_status neph_screen_study_text(const struct neph_screen_study *study, char **text,
                                        struct neph_diag *diag);
json_t *neph_screen_study_json(const struct neph_screen_study *study);

#endif
