/* SPDX-License-Identifier: MIT
 *
 * Common parts of the experiments that are flicker studies (study/flicker_study.h): their requests,
 * and the output of a study.
 */
#ifndef NEPH_HARNESS_EXPERIMENTS_FLICKER_H
#define NEPH_HARNESS_EXPERIMENTS_FLICKER_H

#include "harness/experiment/experiment.h"
#include "harness/study/flicker_study.h"

/* The first member of each request of such an experiment. */
struct neph_flicker_request {
    struct neph_cli_shared shared; /* operands: the scenes; after preparation the suite's */
    struct neph_cli_list takes;
    const char *suite;
    bool opens_shut_suite;
    int first_seed, seed_count, steps;
    int frame_count;         /* at 30 Hz where all scenes get one rate */
    double frame_rate_hz;    /* 0 or NaN: each scene has its own */
    struct neph_arena arena; /* for the suite's scenes */
    bool is_part;            /* a job of --jobs: one scene and */
    int part_preset;         /* one preset */
};

/* Reject a suite together with scenes. */
void neph_flicker_check_scenes(const void *request, const struct argp_state *state);

/* Replace missing operands by the scenes of the suite, by default `otherwise`. Takes must be among
 * the first `take_count` of neph_study_captures. NEPH_ERR_USAGE: an unknown take or suite, or two
 * scenes of the same name. */
enum neph_status neph_flicker_prepare(struct neph_flicker_request *request, int take_count,
                                      const char *otherwise, struct neph_diag *diag);

/* The study of a prepared request or of its part; arrays are borrowed. */
struct neph_flicker_study_params neph_flicker_params(const struct neph_flicker_request *request,
                                                     const char *const *presets, int preset_count,
                                                     const struct neph_experiment_run *run);

/* As neph_experiment.part: a job for each scene and preset. All scenes with the first preset come
 * first, so that two workers seldom render the same reference. */
bool neph_flicker_part(struct neph_flicker_request *request, int preset_count, int index);

void neph_flicker_free(struct neph_flicker_request *request);

/* Write a finished study in all requested forms. NEPH_ERR_MEMORY, NEPH_ERR_INTERNAL. */
enum neph_status neph_flicker_publish(const struct neph_flicker_study *study,
                                      struct neph_publication *publication, struct neph_diag *diag);

#endif
