/* SPDX-License-Identifier: MIT
 *
 * A study of screens: what passes on a G-buffer make of ambient occlusion, indirect light and
 * reflections, against engine `surfaces`, which also gives the part of each that its own frame
 * shows. So the error of a method has two parts: what no screen can know, and what is its own.
 *
 * Light counts times the colour of its surface, summed over the channels, and is told relative to
 * all light of its kind in the frame; ambient occlusion in parts of the hemisphere, its mean over
 * pixels. A pixel is lost where what the screen shows of the truth is off by more than
 * NEPH_SCREEN_LOST of it.
 *
 * screen.c has the options and the results, screen_measure.c measures scenes, screen_page.c shows
 * lost pixels.
 */
#ifndef NEPH_HARNESS_EXPERIMENTS_SCREEN_H
#define NEPH_HARNESS_EXPERIMENTS_SCREEN_H

#include "base/arena.h"
#include "harness/experiment/experiment.h"
#include "harness/progress.h"
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

struct neph_screen_request {
    struct neph_cli_shared shared; /* operands: scenes */
    struct neph_cli_list models;   /* of neph_light_model_parse(), of engine screen */
    int samples;                   /* a pixel, of the truth */
    double radius_m;               /* of ambient occlusion, of truth and models */
    int rays;                      /* a pixel, to tell why it is lost */
    int cycles_samples;            /* of Cycles, a second truth; 0: there is none */
    int frame_count; /* over which flicker of models is measured, at least 16; 0: it is not */
    struct neph_scene *scenes[NEPH_SCREEN_SCENES_MAX]; /* owned */
    int scene_count;
    bool is_part; /* rendered for the store: nothing is measured of it */
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
    /* Cycles against the truth, and models against Cycles; NaN: it is not wanted, or cannot. */
    struct neph_screen_gap cycles[NEPH_SCREEN_PARTS];
    struct neph_screen_gap against_cycles[NEPH_LIGHT_MODELS_MAX][NEPH_SCREEN_PARTS];
    char cycles_cannot[200]; /* why; "": it can */
    int frame_count;         /* 0: flicker was not measured */
    /* Over surfaces in the frame: shares of the hemisphere within the radius and all the way. */
    double near[NEPH_SCREEN_LOSSES], far[NEPH_SCREEN_LOSSES];
    /* A value a pixel, of the study's arena: the truth for a display, in grey; 0 where it is known,
     * else 1 and the reason. */
    uint8_t *seen, *marks[NEPH_SCREEN_PARTS];
};

struct neph_screen_study {
    const struct neph_screen_request *request;
    const struct neph_experiment_run *run;
    struct neph_progress progress;
    struct neph_arena arena;
    struct neph_light_model truth, cycles, models[NEPH_LIGHT_MODELS_MAX];
    struct neph_open_device *device; /* of the display that flicker is seen on */
    struct neph_screen_scene scenes[NEPH_SCREEN_SCENES_MAX];
    /* What the frames of models are off by, against the truth. */
    struct neph_post_numbers flicker[NEPH_SCREEN_SCENES_MAX][NEPH_LIGHT_MODELS_MAX];
};

extern const char *const neph_screen_part_names[NEPH_SCREEN_PARTS];

/* Measure all scenes into a study that begins with its request and run; its arena is to be finished
 * in any case. NEPH_ERR_UNAVAILABLE: there is no Cycles. NEPH_ERR_INTERRUPTED: what is finished
 * stays in the store. NEPH_ERR_USAGE: a model is of another engine. NEPH_ERR_UNSUPPORTED: truth or
 * model cannot render a scene, and why. */
enum neph_status neph_screen_measure(struct neph_screen_study *study, struct neph_diag *diag);

/* Make `folder` for the page, or take one of before: neph_owned_claim(), before minutes of work. */
enum neph_status neph_screen_page_claim(const char *folder, struct neph_diag *diag);

/* What a screen cannot know, into `folder`, which is claimed: index.html, SCENE_PART.png in which
 * lost pixels have the colour of their reason, and over frames screen.svg, what models make of
 * error, flicker and milliseconds over those of the first. The page opens from disk alone. */
enum neph_status neph_screen_page_write(const struct neph_screen_study *study, const char *folder,
                                        struct neph_diag *diag);

#endif
