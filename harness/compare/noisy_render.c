/* SPDX-License-Identifier: MIT */
#include "harness/compare/noisy_render.h"

#include "base/doubt.h"
#include "base/interrupt.h"
#include "harness/compare/frame.h"
#include "metrics/metric.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

_Static_assert(NEPH_NOISE_SOURCE_COUNT == 3, "a new source of variances");

enum { CHANNELS = 3 };

static const char *const source_names[NEPH_NOISE_SOURCE_COUNT] = {
    [NEPH_NOISE_LAYER] = "variance layer",
    [NEPH_NOISE_MOMENTS] = "second moments",
    [NEPH_NOISE_REPEATS] = "repeats",
};

/* Relative error of a stored value: half of the last digit of a half; a sum of many floats. */
static const double half_rounding = 0x1p-11, float_rounding = 1e-6;

const char *neph_noise_source_name(enum neph_noise_source source)
{
    return source_names[source];
}

/* ---- channels of a file ---------------------------------------------------------------------- */

/* The channels of a file. `second`: variances or mean squares; NULL for repeats. */
struct channels {
    const float *value[CHANNELS], *second[CHANNELS];
    bool is_xyz;
};

static bool find_channels(const struct neph_image *image, const char *layer, const char *suffixes,
                          const float *found[CHANNELS])
{
    bool all = true;
    for (int c = 0; c < CHANNELS; c++) {
        char name[2 * NEPH_IMAGE_NAME_MAX];
        snprintf(name, sizeof(name), "%s.%c", layer, suffixes[c]);
        found[c] = neph_image_channel(image, name);
        all &= found[c] != NULL;
    }
    return all;
}

static bool find_layer(const struct neph_image *image, const struct neph_noisy_reading *reading,
                       struct channels *channels)
{
    char layer[2 * NEPH_IMAGE_NAME_MAX];
    snprintf(layer, sizeof(layer), "%s%s%s", reading->variance, reading->choice.layer ? "." : "",
             reading->choice.layer ? reading->choice.layer : "");
    return find_channels(image, layer, "RGB", channels->second) ||
           find_channels(image, layer, "YYY", channels->second);
}

/* The first NAME with channels m2_NAME.* and NAME.*. */
static bool find_moments(const struct neph_image *image, struct channels *channels)
{
    static const char prefix[] = "m2_";
    for (int i = 0; i < image->channel_count; i++) {
        const char *name = image->channels[i].name, *dot = strrchr(name, '.');
        char layer[NEPH_IMAGE_NAME_MAX];
        if (strncmp(name, prefix, strlen(prefix)) != 0 || !dot)
            continue;
        snprintf(layer, sizeof(layer), "%.*s", (int)(dot - name), name);
        for (int xyz = 0; xyz < 2; xyz++) {
            const char *suffixes = xyz ? "XYZ" : "RGB";
            channels->is_xyz = xyz;
            if (find_channels(image, layer, suffixes, channels->second) &&
                find_channels(image, layer + strlen(prefix), suffixes, channels->value))
                return true;
        }
    }
    return false;
}

static enum neph_status refuse_one(const char *path, const struct neph_noisy_reading *reading,
                                   struct neph_diag *diag)
{
    neph_fail(diag, NEPH_ERR_UNSUPPORTED,
              "the noise of '%s' is not known: it has no channels %s.R G B, and is one file", path,
              reading->variance);
    neph_hint(diag, "name a folder or a pattern of renders with different seeds, or the layer of "
                    "variances by --variance");
    return NEPH_ERR_UNSUPPORTED;
}

/* Decide by the first file where the variances come from. */
static enum neph_status find_source(const char *path, const struct neph_image *image,
                                    const struct neph_noisy_reading *reading, int file_count,
                                    struct neph_noisy_render *render, struct neph_diag *diag)
{
    struct channels channels = {.is_xyz = false};
    if (find_layer(image, reading, &channels)) {
        render->source = NEPH_NOISE_LAYER;
    } else if (find_moments(image, &channels)) {
        render->source = NEPH_NOISE_MOMENTS;
        if (reading->samples < 2) {
            neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                      "'%s' has second moments: the samples of a pixel are needed, at least 2",
                      path);
            neph_hint(diag, "name them by --samples N");
            return NEPH_ERR_UNSUPPORTED;
        }
    } else if (file_count >= 2) {
        render->source = NEPH_NOISE_REPEATS;
    } else {
        return refuse_one(path, reading, diag);
    }
    render->is_xyz = channels.is_xyz;
    return NEPH_OK;
}

static enum neph_status find_values(const char *path, const struct neph_image *image,
                                    const struct neph_noisy_reading *reading,
                                    const struct neph_noisy_render *render,
                                    struct channels *channels, struct neph_diag *diag)
{
    float *rgb[CHANNELS];
    bool found = neph_image_rgb(image, NULL, rgb);
    *channels = (struct channels){.is_xyz = false};
    for (int c = 0; c < CHANNELS && found; c++)
        channels->value[c] = rgb[c];
    if (render->source == NEPH_NOISE_LAYER)
        found &= find_layer(image, reading, channels);
    else if (render->source == NEPH_NOISE_MOMENTS)
        found = find_moments(image, channels) && channels->is_xyz == render->is_xyz;
    if (found)
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_INPUT, "'%s' lacks channels of the first file: R G B and its %s", path,
              neph_noise_source_name(render->source));
    neph_hint(diag, "all files of a render need the same channels");
    return NEPH_ERR_INPUT;
}

/* ---- one file -------------------------------------------------------------------------------- */

static bool is_half(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof(bits));
    return (bits & 0x1fff) == 0;
}

static double get_luminance(const struct channels *channels, size_t i)
{
    const float *const *v = channels->value;
    return channels->is_xyz ? (double)v[1][i]
                            : neph_luminance((double)v[0][i], (double)v[1][i], (double)v[2][i]);
}

static double get_variance(const struct neph_noisy_render *render,
                           const struct neph_noisy_reading *reading,
                           const struct channels *channels, int c, size_t i)
{
    const double value = (double)channels->value[c][i], second = (double)channels->second[c][i];
    if (render->source == NEPH_NOISE_LAYER)
        return second;
    return fmax(0.0, (second - value * value) / (reading->samples - 1.0));
}

/* Add a file's share of means and of variances: of N files, 1/N and 1/N^2. */
static void add_variances(struct neph_noisy_render *render,
                          const struct neph_noisy_reading *reading, const struct channels *channels,
                          double *mean[], double *variance[])
{
    const size_t pixels = (size_t)render->width_px * (size_t)render->height_px;
    const double share = 1.0 / render->file_count, square = share * share;
    for (size_t i = 0; i < pixels; i++) {
        double errors[CHANNELS];
        mean[0][i] += share * get_luminance(channels, i);
        for (int c = 0; c < CHANNELS; c++) {
            /* Planes of XYZ are Y, X, Z. */
            const int plane = !render->is_xyz ? c + 1 : c == 1 ? 0 : c == 0 ? 1 : 2;
            const double v = get_variance(render, reading, channels, c, i);
            errors[c] = sqrt(v);
            variance[plane][i] += square * v;
            mean[plane][i] += plane > 0 ? share * (double)channels->value[c][i] : 0.0;
        }
        const double error = neph_luminance(errors[0], errors[1], errors[2]);
        variance[0][i] += render->is_xyz ? 0.0 : square * error * error;
    }
}

static void keep_repeat(const struct neph_noisy_render *render, const struct channels *channels,
                        float *kept[NEPH_Z_PLANES_MAX])
{
    const size_t pixels = (size_t)render->width_px * (size_t)render->height_px;
    for (size_t i = 0; i < pixels; i++)
        kept[0][i] = (float)get_luminance(channels, i);
    for (int c = 0; c < CHANNELS; c++)
        memcpy(kept[c + 1], channels->value[c], pixels * sizeof(*kept[0]));
}

static enum neph_status check_values(const char *path, const struct neph_noisy_render *render,
                                     const struct channels *channels, bool *is_grey, bool *is_halfs,
                                     struct neph_diag *diag)
{
    const size_t pixels = (size_t)render->width_px * (size_t)render->height_px;
    const float *const *v = channels->value;
    for (size_t i = 0; i < pixels; i++) {
        *is_grey &= v[0][i] == v[1][i] && v[1][i] == v[2][i];
        for (int c = 0; c < CHANNELS; c++) {
            *is_halfs &= is_half(v[c][i]);
            const float second = channels->second[c] ? channels->second[c][i] : 0.0f;
            if (!(second >= 0.0f) || isinf(second))
                return neph_fail(diag, NEPH_ERR_GATE,
                                 "'%s': the %s at pixel (%d, %d) is %g; it is finite and at least "
                                 "0 in a valid file",
                                 path, neph_noise_source_name(render->source),
                                 (int)(i % (size_t)render->width_px),
                                 (int)(i / (size_t)render->width_px), (double)second);
        }
    }
    return NEPH_OK;
}

/* ---- all files ------------------------------------------------------------------------------- */

struct reader {
    const struct neph_sequence *files;
    const struct neph_noisy_reading *reading;
    struct neph_noisy_render *render;
    double *mean[NEPH_Z_PLANES_MAX], *variance[NEPH_Z_PLANES_MAX];
    float **repeats[NEPH_Z_PLANES_MAX]; /* [plane][file] */
    bool is_half;
};

static enum neph_status allocate(struct reader *reader, struct neph_diag *diag)
{
    struct neph_noisy_render *render = reader->render;
    const size_t pixels = (size_t)render->width_px * (size_t)render->height_px;
    const size_t files = (size_t)render->file_count;
    render->plane_count = render->is_xyz ? CHANNELS : CHANNELS + 1;
    for (int p = 0; p < render->plane_count; p++) {
        reader->mean[p] = neph_arena_allocate(&render->arena, pixels, sizeof(double));
        reader->variance[p] = neph_arena_allocate(&render->arena, pixels, sizeof(double));
        if (render->source != NEPH_NOISE_REPEATS)
            continue;
        reader->repeats[p] = neph_arena_allocate(&render->arena, files, sizeof(float *));
        for (size_t f = 0; f < files && reader->repeats[p]; f++)
            reader->repeats[p][f] = neph_arena_allocate(&render->arena, pixels, sizeof(float));
    }
    return neph_arena_check(&render->arena, diag);
}

static enum neph_status begin(struct reader *reader, const struct neph_image *image,
                              struct neph_diag *diag)
{
    struct neph_noisy_render *render = reader->render;
    render->width_px = image->width_px;
    render->height_px = image->height_px;
    const enum neph_status status = find_source(reader->files->paths[0], image, reader->reading,
                                                render->file_count, render, diag);
    return status ? status : allocate(reader, diag);
}

static enum neph_status add_image(struct reader *reader, int file, const struct neph_image *image,
                                  struct neph_diag *diag)
{
    struct neph_noisy_render *render = reader->render;
    const char *path = reader->files->paths[file];
    struct channels channels;
    if (neph_image_attribute(image, "encoding"))
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "'%s' is an image for a display: its rounding and clipping are no noise; "
                         "--z needs linear EXR frames",
                         path);
    enum neph_status status = neph_frame_form_check(reader->reading->form, path, image, false,
                                                    diag);
    if (!status && file == 0)
        status = begin(reader, image, diag);
    if (!status)
        status = find_values(path, image, reader->reading, render, &channels, diag);
    if (!status)
        status = check_values(path, render, &channels, &render->is_grey, &reader->is_half, diag);
    if (status)
        return status;
    if (render->source == NEPH_NOISE_REPEATS) {
        float *kept[NEPH_Z_PLANES_MAX];
        for (int p = 0; p < render->plane_count; p++)
            kept[p] = reader->repeats[p][file];
        keep_repeat(render, &channels, kept);
    } else {
        add_variances(render, reader->reading, &channels, reader->mean, reader->variance);
        render->doubt = fmax(render->doubt, neph_doubt_read(image));
    }
    return NEPH_OK;
}

/* Two repeats with a common seed would have no noise between them. */
static enum neph_status check_seeds(const struct reader *reader, struct neph_diag *diag)
{
    const struct neph_noisy_render *render = reader->render;
    const size_t bytes = (size_t)render->width_px * (size_t)render->height_px * sizeof(float);
    for (int a = 0; a < render->file_count && render->source == NEPH_NOISE_REPEATS; a++)
        for (int b = 0; b < a; b++)
            if (memcmp(reader->repeats[0][a], reader->repeats[0][b], bytes) == 0) {
                neph_fail(diag, NEPH_ERR_INPUT,
                          "'%s' and '%s' are equal: repeats need different "
                          "seeds",
                          reader->files->paths[b], reader->files->paths[a]);
                neph_hint(diag, "render each repeat with a seed of its own");
                return NEPH_ERR_INPUT;
            }
    return NEPH_OK;
}

static enum neph_status finish_planes(struct reader *reader, struct neph_diag *diag)
{
    static const char *const rgb[] = {"luminance", "R", "G", "B"};
    static const char *const xyz[] = {"luminance", "X", "Z"};
    struct neph_noisy_render *render = reader->render;
    enum neph_status status = check_seeds(reader, diag);
    for (int p = 0; p < render->plane_count && !status; p++) {
        struct neph_z_side *side = &render->planes[p];
        render->names[p] = render->is_xyz ? xyz[p] : rgb[p];
        *side = (struct neph_z_side){.mean = reader->mean[p],
                                     .variance = reader->variance[p],
                                     .correlation = 1.0,
                                     .rounding = reader->is_half ? half_rounding : float_rounding};
        if (render->source == NEPH_NOISE_REPEATS)
            status = neph_z_from_repeats((const float *const *)reader->repeats[p],
                                         render->file_count, render->width_px, render->height_px,
                                         reader->mean[p], reader->variance[p], side, diag);
    }
    return status;
}

enum neph_status neph_noisy_render_read(const struct neph_sequence *files,
                                        const struct neph_noisy_reading *reading,
                                        struct neph_noisy_render *render, struct neph_diag *diag)
{
    struct reader reader = {.files = files, .reading = reading, .render = render, .is_half = true};
    enum neph_status status = NEPH_OK;
    render->file_count = files->count;
    render->is_grey = true;
    render->doubt = NAN;
    if (files->count > NEPH_Z_REPEATS_MAX)
        return neph_fail(diag, NEPH_ERR_INPUT, "%d files of one render: at most %d are read",
                         files->count, NEPH_Z_REPEATS_MAX);
    for (int f = 0; f < files->count && !status; f++) {
        struct neph_image *image = NULL;
        status = neph_interrupted() ? neph_fail(diag, NEPH_ERR_INTERRUPTED, "interrupted")
                                    : NEPH_OK;
        if (!status)
            status = neph_frame_read(files->paths[f], &reading->choice, reading->negative_allowed,
                                     &image, diag);
        if (!status)
            status = add_image(&reader, f, image, diag);
        neph_image_destroy(image);
    }
    return status ? status : finish_planes(&reader, diag);
}

void neph_noisy_render_finish(struct neph_noisy_render *render)
{
    neph_arena_finish(&render->arena);
}
