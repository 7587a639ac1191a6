/* SPDX-License-Identifier: MIT
 *
 * Compares engines `exact`, `oracle`, `tracer` and `march` on one scene, pixel by pixel.
 *
 * Noise: `oracle` and `tracer` render COMPARE_BATCHES times, each time with another seed. The
 * variance of a pixel's mean is the mean of the variances that the batches report, divided by their
 * number. The scatter of the reported variances gives the relative standard error of this variance,
 * `unsure`; its square is 2 over the degrees of freedom of Student's t. A pixel with few degrees of
 * freedom (a light close to a path) must differ by as much as t then requires, and is counted
 * separately from the pixels whose z-scores must have variance 1.
 *
 * A scene with an unlikely pixel, or an unlikely sum over pixels, is rendered again with other
 * seeds and more samples. Only a difference that is unlikely again is a disagreement.
 *
 * `march` has no noise but a step bias. It agrees when its deviation from the reference is
 * rounding, or falls with finer steps like the deviation of a first-order method, or faster.
 */
#ifndef NEPH_TESTS_RANDOM_SCENES_COMPARE_H
#define NEPH_TESTS_RANDOM_SCENES_COMPARE_H

#include "renderer/vulkan.h"
#include "scenes/scene.h"

#include <stdbool.h>
#include <stdint.h>

enum compare_engine {
    COMPARE_EXACT,
    COMPARE_ORACLE,
    COMPARE_TRACER,
    COMPARE_MARCH,
    COMPARE_ENGINES
};
extern const char *const compare_engine_names[COMPARE_ENGINES];

/* Pairs of engines with noise, and pairs without. */
enum compare_pair {
    PAIR_ORACLE_EXACT,
    PAIR_TRACER_EXACT,
    PAIR_TRACER_ORACLE,
    PAIR_MARCH_EXACT,
    PAIR_MARCH_ORACLE, /* where there is no exact result */
    PAIR_COUNT,
};

enum { COMPARE_BATCHES = 4, COMPARE_PIXELS = 24, COMPARE_STAGES = 3 };

/* z-scores of all scenes, each with the largest number of samples that it was rendered with. */
struct compare_scores {
    long count;
    double sum, square_sum;
    double expected_sum; /* of dof / (dof - 2): the expected square sum */
    long unsure;         /* pixels with uncertain variance, excluded from the above */
    double unsure_square_sum;
    long rare;          /* pixels with light that their paths may have missed, excluded, too */
    long without_noise; /* pixels that are compared within rounding */
};

struct compare_march {
    long count, rounding; /* scenes; scenes that agree within rounding at the first step count */
    long left_out;        /* pixels next to a light */
    double largest_bias;  /* relative, explained by steps */
};

struct compare_request {
    /* At one moment (neph_scene_at()). `written` has wind; `still` has its media at their displaced
     * positions, computed independently, and is rendered by exact and oracle. */
    const struct neph_scene *written, *still;
    struct neph_vulkan *vulkan; /* NULL: without tracer and march */
    uint64_t seed;
    unsigned engines; /* participating engines, as bits of enum compare_engine */
};

struct compare_finding {
    bool disagrees;
    enum compare_engine test, truth;
    char what[400]; /* a sentence with pixel, channel, values and their probability */
};

struct compare_result {
    struct compare_finding findings[PAIR_COUNT + COMPARE_ENGINES];
    int finding_count;
    char refusals[COMPARE_ENGINES][200]; /* why an engine is skipped; empty: it takes part */
    double seconds[COMPARE_ENGINES];
    int stages; /* rendered stages */
};

void compare_add_scores(struct compare_scores *sum, const struct compare_scores *part);

/* Scores may be NULL. Interruption and lack of memory are errors; an engine that fails is a
 * finding. */
enum neph_status compare_scene(const struct compare_request *request,
                               struct compare_scores scores[PAIR_COUNT],
                               struct compare_march *marched, struct compare_result *result,
                               struct neph_diag *diag);

#endif
