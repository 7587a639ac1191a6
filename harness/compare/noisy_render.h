/* SPDX-License-Identifier: MIT
 *
 * A render by Monte Carlo with its noise, from one file or several, for `neph compare --z`.
 */
#ifndef NEPH_HARNESS_COMPARE_NOISY_RENDER_H
#define NEPH_HARNESS_COMPARE_NOISY_RENDER_H

#include "base/arena.h"
#include "harness/compare/frame.h"
#include "harness/compare/frame_labels.h"
#include "harness/compare/sequence.h"
#include "metrics/z_test.h"

/* Where the variance comes from. */
enum neph_noise_source {
    NEPH_NOISE_LAYER,   /* channels LAYER.R G B or LAYER.Y: the variance of the mean of R G B */
    NEPH_NOISE_MOMENTS, /* m2_NAME.R G B or .X Y Z: the mean square of the samples of NAME.*, as the
                           integrator `moment` of Mitsuba 3 writes them */
    NEPH_NOISE_REPEATS, /* several files with different seeds */
    NEPH_NOISE_SOURCE_COUNT,
};

const char *neph_noise_source_name(enum neph_noise_source source);

struct neph_noisy_reading {
    struct neph_frame_choice choice; /* its layer is also behind the variance's name */
    const char *variance;            /* name of the layer of variances: "variance" */
    int samples;                     /* of a pixel, for NEPH_NOISE_MOMENTS; below 2: not known */
    size_t negative_allowed;
    struct neph_frame_form *form; /* that all files of both renders share; borrowed */
};

/* Start from {0}; free with neph_noisy_render_finish(). */
struct neph_noisy_render {
    enum neph_noise_source source;
    int width_px, height_px, file_count;
    bool is_grey; /* R = G = B in all files */
    bool is_xyz;
    double doubt; /* the largest of its files (base/doubt.h); NaN: they do not say */
    /* Luminance (Y) first, then R G B (or X, Z). The variance of the luminance of a layer or of
     * moments is that of fully correlated channels, the largest possible one. */
    int plane_count;
    const char *names[NEPH_Z_PLANES_MAX];
    struct neph_z_side planes[NEPH_Z_PLANES_MAX];
    struct neph_arena arena; /* of the samples */
};

/* Read a render. Several files with variances are averaged; several files without are repeats.
 * NEPH_ERR_UNSUPPORTED: one file without variances, or moments without `samples`.
 * NEPH_ERR_INPUT: an image for a display; files of different forms, or with equal values (a common
 * seed). NEPH_ERR_GATE: a variance is NaN or negative. Errors of neph_frame_read(). */
enum neph_status neph_noisy_render_read(const struct neph_sequence *files,
                                        const struct neph_noisy_reading *reading,
                                        struct neph_noisy_render *render, struct neph_diag *diag);

void neph_noisy_render_finish(struct neph_noisy_render *render);

#endif
