/* SPDX-License-Identifier: MIT */
#include "harness/study/blurred.h"

#include "base/exr.h"
#include "base/files.h"
#include "metrics/blur_fit.h"
#include "metrics/gaussian.h"
#include "metrics/metric.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FITTED_MAX = 8 };

/* ---- pairs of frames ------------------------------------------------------------------------- */

/* A frame of the reference and of the sequence. */
struct pair {
    struct neph_image *sharp, *test; /* owned */
    float *sharp_rgb[3], *test_rgb[3];
};

static void finish_pair(struct pair *pair)
{
    neph_image_destroy(pair->sharp);
    neph_image_destroy(pair->test);
}

/* Call finish_pair() in any case. */
static enum neph_status read_pair(const struct neph_sequence *reference,
                                  const struct neph_sequence *sequence, int frame,
                                  struct pair *pair, struct neph_diag *diag)
{
    const char *sharp_path = reference->paths[reference->count > 1 ? frame : 0],
               *path = sequence->paths[frame];
    *pair = (struct pair){.sharp = NULL};
    enum neph_status status = neph_exr_read(sharp_path, &pair->sharp, diag);
    if (!status)
        status = neph_exr_read(path, &pair->test, diag);
    if (!status && (!neph_image_rgb(pair->sharp, NULL, pair->sharp_rgb) ||
                    !neph_image_rgb(pair->test, NULL, pair->test_rgb) ||
                    pair->sharp->width_px != pair->test->width_px ||
                    pair->sharp->height_px != pair->test->height_px))
        status = neph_fail(diag, NEPH_ERR_INTERNAL, "'%s' is no frame of the reference '%s'", path,
                           sharp_path);
    return status;
}

/* ---- the fit --------------------------------------------------------------------------------- */

static float *make_luminance(float *const rgb[3], size_t count)
{
    const float *const constant[3] = {rgb[0], rgb[1], rgb[2]};
    float *plane = malloc(count * sizeof(*plane));
    for (size_t i = 0; plane && i < count; i++)
        plane[i] = (float)neph_luminance_at(constant, i);
    return plane;
}

/* Adds the luminances of a frame to a fit, which owns them. */
static enum neph_status add_luminances(const struct pair *pair, float **sharp, float **blurred,
                                       struct neph_blur_fit *fit, struct neph_diag *diag)
{
    const size_t count = neph_image_pixel_count(pair->sharp);
    fit->width_px = pair->sharp->width_px;
    fit->height_px = pair->sharp->height_px;
    sharp[fit->frame_count] = make_luminance(pair->sharp_rgb, count);
    blurred[fit->frame_count] = make_luminance(pair->test_rgb, count);
    return sharp[fit->frame_count] && blurred[fit->frame_count++] ? NEPH_OK
                                                                  : neph_fail_memory(diag);
}

enum neph_status neph_blurred_fit(const struct neph_sequence *reference,
                                  const struct neph_sequence *sequence, double *sigma_px,
                                  struct neph_diag *diag)
{
    const int count = sequence->count < FITTED_MAX ? sequence->count : FITTED_MAX;
    float *sharp[FITTED_MAX] = {NULL}, *blurred[FITTED_MAX] = {NULL};
    struct neph_blur_fit fit = {.sharp = (const float *const *)sharp,
                                .blurred = (const float *const *)blurred};
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < count && !status; i++) {
        struct pair pair;
        status = read_pair(reference, sequence, (2 * i + 1) * sequence->count / (2 * count), &pair,
                           diag);
        if (!status)
            status = add_luminances(&pair, sharp, blurred, &fit, diag);
        finish_pair(&pair);
    }
    if (!status)
        status = neph_blur_fit_find(&fit, sigma_px, diag);
    for (int i = 0; i < FITTED_MAX; i++) {
        free(sharp[i]);
        free(blurred[i]);
    }
    return status;
}

/* ---- the frames ------------------------------------------------------------------------------ */

/* Makes the reference's frame with the blur, and changes the frame of the sequence to the
 * reference's with its aliasing. */
static enum neph_status divide_frame(const struct pair *pair, double sigma_px,
                                     struct neph_image *blurred, struct neph_diag *diag)
{
    const size_t count = neph_image_pixel_count(pair->sharp);
    float *planes[3];
    enum neph_status status = neph_image_add_rgb(blurred, NULL, planes, diag);
    for (int c = 0; c < 3 && !status; c++) {
        memcpy(planes[c], pair->sharp_rgb[c], count * sizeof(*planes[c]));
        if (sigma_px > 0.0)
            status = neph_gaussian_blur(planes[c], pair->sharp->width_px, pair->sharp->height_px,
                                        sigma_px, diag);
        for (size_t i = 0; i < count && !status; i++)
            pair->test_rgb[c][i] = fmaxf(
                pair->test_rgb[c][i] - planes[c][i] + pair->sharp_rgb[c][i], 0.0f);
    }
    return status;
}

static enum neph_status write_pair(const struct pair *pair, double sigma_px,
                                   const char *blurred_path, const char *aliased_path,
                                   struct neph_diag *diag)
{
    struct neph_image *blurred = NULL;
    enum neph_status status = neph_image_create(pair->sharp->width_px, pair->sharp->height_px,
                                                &blurred, diag);
    if (!status)
        status = divide_frame(pair, sigma_px, blurred, diag);
    if (!status)
        status = neph_exr_write_plain(blurred_path, blurred, diag);
    if (!status)
        status = neph_exr_write_plain(aliased_path, pair->test, diag);
    neph_image_destroy(blurred);
    return status;
}

/* Adds the path of the next frame. */
static enum neph_status add_path(const char *folder, const char *name,
                                 struct neph_sequence *sequence, struct neph_diag *diag)
{
    char *path = neph_format("%s/%s_%04d.exr", folder, name, sequence->count);
    if (!path)
        return neph_fail_memory(diag);
    sequence->paths[sequence->count++] = path;
    return NEPH_OK;
}

enum neph_status neph_blurred_write(const struct neph_sequence *reference,
                                    const struct neph_sequence *sequence, double sigma_px,
                                    const char *folder, struct neph_sequence *blurred,
                                    struct neph_sequence *aliased, struct neph_diag *diag)
{
    const size_t count = (size_t)sequence->count;
    *blurred = (struct neph_sequence){.paths = calloc(count, sizeof(*blurred->paths))};
    *aliased = (struct neph_sequence){.paths = calloc(count, sizeof(*aliased->paths))};
    enum neph_status status = blurred->paths && aliased->paths ? NEPH_OK : neph_fail_memory(diag);
    for (int i = 0; i < sequence->count && !status; i++) {
        struct pair pair;
        status = read_pair(reference, sequence, i, &pair, diag);
        if (!status)
            status = add_path(folder, "blurred", blurred, diag);
        if (!status)
            status = add_path(folder, "aliased", aliased, diag);
        if (!status)
            status = write_pair(&pair, sigma_px, blurred->paths[i], aliased->paths[i], diag);
        finish_pair(&pair);
    }
    return status;
}
