/* SPDX-License-Identifier: MIT
 *
 * Experiments that are flicker studies (study/flicker_study.h): what their requests have in common,
 * and how a study is published.
 */
#ifndef NEPH_HARNESS_EXPERIMENTS_FLICKER_H
#define NEPH_HARNESS_EXPERIMENTS_FLICKER_H

#include "harness/experiment/experiment.h"
#include "harness/study/flicker_study.h"

/* A request begins with it. */
struct neph_flicker_request {
    struct neph_cli_shared shared; /* operands: the scenes, those of the suite once prepared */
    struct neph_cli_list takes;
    const char *suite;
    int first_seed, seed_count, frame_count, steps;
    struct neph_arena arena; /* of the suite's scenes */
    bool is_part;            /* for --jobs: of one scene, and of .. */
    int part_preset;         /* .. one preset */
};

/* Refuse a suite beside scenes. */
void neph_flicker_check_scenes(const void *request, const struct argp_state *state);

/* Make operands of the suite, which is `otherwise` when there are no scenes either. Takes are the
 * first `take_count` of neph_study_takes. NEPH_ERR_USAGE: there is no such take or suite, or two
 * scenes share a name. */
enum neph_status neph_flicker_prepare(struct neph_flicker_request *request, int take_count,
                                      const char *otherwise, struct neph_diag *diag);

/* The study of a prepared request or of its part; arrays are borrowed. */
struct neph_flicker_study_params neph_flicker_params(const struct neph_flicker_request *request,
                                                     const char *const *presets, int preset_count,
                                                     const struct neph_experiment_run *run);

/* As neph_experiment.part: a scene and a preset, and first all scenes with the first preset, so
 * that few references are rendered by two workers. */
bool neph_flicker_part(struct neph_flicker_request *request, int preset_count, int index);

void neph_flicker_free(struct neph_flicker_request *request);

/* Write a study that has run in all forms that are wanted. Errors: NEPH_ERR_MEMORY,
 * NEPH_ERR_INTERNAL. */
enum neph_status neph_flicker_publish(const struct neph_flicker_study *study,
                                      struct neph_publication *publication, struct neph_diag *diag);

#endif
