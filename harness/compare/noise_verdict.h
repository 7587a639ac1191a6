/* SPDX-License-Identifier: MIT
 *
 * Noise or bias between two renders by Monte Carlo: the tests of metrics/z_test.h over luminance
 * and channels, and their answer, for `neph compare --z`.
 */
#ifndef NEPH_HARNESS_COMPARE_NOISE_VERDICT_H
#define NEPH_HARNESS_COMPARE_NOISE_VERDICT_H

#include "harness/compare/noisy_render.h"
#include "harness/json.h"

#include <stdio.h>

enum { NEPH_NOISE_SEED = 1 }; /* of the random signs of the test of blobs */

struct neph_noise_verdict {
    const struct neph_noisy_render *reference, *test; /* borrowed */
    int plane_count; /* 1 for grey renders and for unlike channels: only luminance */
    const char *names[NEPH_Z_PLANES_MAX];
    struct neph_z_plane planes[NEPH_Z_PLANES_MAX];
    double p;     /* adjusted for all tests; 0: pixels without noise differ */
    bool is_bias; /* p <= NEPH_Z_LEVEL */
};

/* Compare two renders of one size. `scores`: NULL, or receives the scores of luminance.
 * NEPH_ERR_INPUT: more than half of the noisy pixels are equal bit for bit (a common seed).
 * NEPH_ERR_MEMORY. */
enum neph_status neph_noise_judge(const struct neph_noisy_render *reference,
                                  const struct neph_noisy_render *test, float *scores,
                                  struct neph_noise_verdict *verdict, struct neph_diag *diag);

/* The verdict in one sentence with its evidence, or with the least bias that would be found. */
void neph_noise_sentence(const struct neph_noise_verdict *verdict, char *text, size_t size);

/* Print the sentence, and unless `is_brief` the tests of luminance; `all`: of all channels. */
void neph_noise_print(const struct neph_noise_verdict *verdict, bool is_brief, bool all, FILE *out);

/* An object of
 *   "verdict"   "bias" or "noise"; "sentence"; "p", adjusted for all tests; "level"; "power";
 *               "seed" of the random signs of blobs
 *   "reference", "test"   {"files", "source", "doubt"}: where the variances come from, and whether
 *               they are to be trusted (base/doubt.h)
 *   "planes"    array of {"plane", "reference_mean", "bias", "low", "high" (95 % interval),
 *               "least_bias", "least_tile_bias", "least_pixel_bias", "tests", "beyond" (of 2, 3, 4
 *               standard errors: {"count", "expected"}), "noisy_pixels", "rejected_pixels",
 *               "contrary_pixels", "unjudged_pixels", "neighbour_correlation", "tile_px", "blob"};
 *               "tests": {NAME: {"statistic", "p", "adjusted_p"}}, "pixel" and "tile" with a place
 * Numbers that do not exist are null. */
json_t *neph_noise_json(const struct neph_noise_verdict *verdict);

#endif
