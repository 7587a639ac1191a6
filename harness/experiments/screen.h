/* SPDX-License-Identifier: MIT
 *
 * The screen-space study compares screen-space passes on a G-buffer (ambient occlusion, indirect
 * light, reflections) with engine `surfaces`. That engine also renders the part of each that its
 * own frame shows. So the error of a method splits into two parts: information that no screen-space
 * method has, and the method's own error.
 *
 * Light is multiplied by the colour of its surface, summed over the channels, and divided by all
 * light of its kind in the frame. Ambient occlusion is a share of the hemisphere, averaged over
 * pixels. A pixel is lost when the part that the frame shows differs from the reference by more
 * than NEPH_SCREEN_LOST of the reference.
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

/* Share of a pixel's light; for occlusion half of it, as a share of the hemisphere. */
#define NEPH_SCREEN_LOST 0.1

enum neph_screen_part {
    NEPH_SCREEN_AO,
    NEPH_SCREEN_DIFFUSE, /* light of other surfaces reflected by Lambertian surfaces */
    NEPH_SCREEN_GLOSSY,  /* the same, reflected by metal */
    NEPH_SCREEN_PARTS,
};

struct neph_screen_request {
    struct neph_cli_shared shared; /* operands: scenes */
    struct neph_cli_list models;   /* as for neph_light_model_parse(), of engine screen */
    int samples;                   /* samples per pixel of the reference */
    double radius_m;               /* radius of ambient occlusion, for reference and models */
    int rays;                      /* rays per pixel for the reason of a loss */
    int cycles_samples;            /* samples of Cycles, a second reference; 0: none */
    int frame_count; /* frames for the flicker of models, at least 16; 0: not measured */
    struct neph_scene *scenes[NEPH_SCREEN_SCENES_MAX]; /* owned */
    int scene_count;
    bool is_part; /* a job: render for the store, measure nothing */
};

/* The error of a model's part against the reference. */
struct neph_screen_gap {
    double error, bias;             /* mean absolute error, mean error */
    double own;                     /* error against the part that the frame shows */
    double known_error, lost_error; /* over pixels that are not lost, and lost; NaN: none */
};

/* Reasons of a lost pixel: the reason of most of its rays. NEPH_SCREEN_LOSSES: no ray has one, so
 * the cause is noise. */
enum { NEPH_SCREEN_REASONS = NEPH_SCREEN_LOSSES + 1 };

/* Properties of a part that do not depend on a model. */
struct neph_screen_truth {
    int pixels, lost, lost_by[NEPH_SCREEN_REASONS];
    double noise;  /* of the reference: the error of a perfect model */
    double beyond; /* light that the frame does not show: no model can know it */
};

struct neph_screen_scene {
    struct neph_screen_truth truths[NEPH_SCREEN_PARTS];
    struct neph_screen_gap gaps[NEPH_LIGHT_MODELS_MAX][NEPH_SCREEN_PARTS];
    /* Cycles against the reference, and models against Cycles; NaN: not requested, or
     * unsupported. */
    struct neph_screen_gap cycles[NEPH_SCREEN_PARTS];
    struct neph_screen_gap against_cycles[NEPH_LIGHT_MODELS_MAX][NEPH_SCREEN_PARTS];
    char cycles_cannot[200]; /* reason; "": it can */
    int frame_count;         /* 0: flicker was not measured */
    /* Shares of the hemisphere over the frame's surfaces, within the radius and without a limit. */
    double near[NEPH_SCREEN_LOSSES], far[NEPH_SCREEN_LOSSES];
    /* One value for each pixel, allocated in the study's arena. `seen`: the reference as display
     * grey. `marks`: 0 for a known pixel, otherwise 1 + the reason. */
    uint8_t *seen, *marks[NEPH_SCREEN_PARTS];
};

struct neph_screen_study {
    const struct neph_screen_request *request;
    const struct neph_experiment_run *run;
    struct neph_progress progress;
    struct neph_arena arena;
    struct neph_light_model truth, cycles, models[NEPH_LIGHT_MODELS_MAX];
    struct neph_open_device *device; /* for the display model of flicker */
    struct neph_screen_scene scenes[NEPH_SCREEN_SCENES_MAX];
    /* Errors of the models' frames against the reference. */
    struct neph_post_numbers flicker[NEPH_SCREEN_SCENES_MAX][NEPH_LIGHT_MODELS_MAX];
};

extern const char *const neph_screen_part_names[NEPH_SCREEN_PARTS];

/* Measure all scenes. `study` has its request and run; always finish its arena.
 * NEPH_ERR_UNAVAILABLE: Cycles is missing. NEPH_ERR_INTERRUPTED: finished frames are in the store.
 * NEPH_ERR_USAGE: a model belongs to another engine. NEPH_ERR_UNSUPPORTED, with the reason:
 * reference or model cannot render a scene. */
enum neph_status neph_screen_measure(struct neph_screen_study *study, struct neph_diag *diag);

/* Create `folder` for the page, or reuse an earlier page (neph_owned_claim()). Called before
 * minutes of work, so that a conflict is reported early. */
enum neph_status neph_screen_page_claim(const char *folder, struct neph_diag *diag);

/* Write the page of lost pixels into the claimed `folder`: index.html; SCENE_PART.png with lost
 * pixels in the colour of their reason; for sequences screen.svg, error, flicker and milliseconds
 * of the models relative to the first one. The page opens from disk without a network. */
enum neph_status neph_screen_page_write(const struct neph_screen_study *study, const char *folder,
                                        struct neph_diag *diag);

#endif
