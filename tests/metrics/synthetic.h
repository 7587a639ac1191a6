/* SPDX-License-Identifier: MIT
 *
 * Frames with every kind of layer, of any size, for tests and the benchmark of all extractors: a
 * ground with posts before a sky, a drifting cloud, sub-pixel noise. Independent of the test
 * library. The frames are not physical; they exercise each code path.
 */
#ifndef NEPH_TESTS_SYNTHETIC_H
#define NEPH_TESTS_SYNTHETIC_H

#include "metrics/extractor.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

/* The settings of an extractor: defaults, and the properties of these frames. */
static inline struct neph_settings synthetic_settings(const struct neph_extractor *extractor)
{
    static const struct {
        const char *extractor, *assignment;
    } told[] = {
        {"lag", "step_frame=1"},
        {"follow", "period_1=8"},
        {"follow", "period_3=4"},
    };
    struct neph_settings settings = neph_options_default(extractor->options);
    for (size_t i = 0; i < sizeof(told) / sizeof(told[0]); i++)
        if (strcmp(extractor->name, told[i].extractor) == 0)
            neph_options_set(extractor->options, extractor->name, told[i].assignment, &settings,
                             NULL);
    return settings;
}

struct synthetic {
    int width_px, height_px;
    int frame;     /* of the sequence; the cloud drifts, the test blinks */
    uint64_t seed; /* of the noise; 0: none */
    bool is_test;  /* slightly brighter, and blinks every other frame at the posts */
    bool all;      /* all layers; otherwise only R G B */
};

/* -0.5 .. 0.5 */
static inline float synthetic_noise(uint64_t seed, uint64_t index)
{
    uint64_t z = (seed + 1) * 0x9e3779b97f4a7c15u + index * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return seed ? (float)(z >> 40) * 0x1p-24f - 0.5f : 0.0f;
}

struct synthetic_pixel {
    float depth_m, cloud, light;
    bool is_post;
};

static inline struct synthetic_pixel synthetic_pixel(const struct synthetic *what, int x, int y)
{
    const float u = (float)x / (float)what->width_px, v = (float)y / (float)what->height_px;
    const float away_u = u - 0.5f - 0.002f * (float)what->frame, away_v = v - 0.3f;
    struct synthetic_pixel pixel = {.is_post = x % 24 == 7 && v > 0.25f, .depth_m = INFINITY};
    if (v > 0.6f)
        pixel.depth_m = 2.0f / (v - 0.55f);
    if (pixel.is_post)
        pixel.depth_m = 5.0f;
    pixel.cloud = expf(-20.0f * (away_u * away_u + away_v * away_v));
    pixel.light = pixel.is_post ? 0.05f : v > 0.6f ? 0.2f + 0.1f * u : 0.5f + 0.4f * v;
    return pixel;
}

static inline float synthetic_radiance(const struct synthetic *what,
                                       const struct synthetic_pixel *pixel, int channel,
                                       uint64_t index)
{
    const float light = pixel->light * (1.0f - pixel->cloud) + 1.5f * pixel->cloud;
    const bool blinks = what->is_test && pixel->is_post && what->frame % 4 < 2;
    const float gain = what->is_test ? 1.02f : 1.0f;
    return gain * light * (1.0f - 0.1f * (float)channel) *
               (1.0f + 0.05f * synthetic_noise(what->seed, 3 * index + (uint64_t)channel)) +
           (blinks ? 0.02f : 0.0f);
}

/* The planes next to radiance. */
struct synthetic_layers {
    float *volume[3], *transmittance[3];
    float *depth, *motion_x, *motion_y, *distance, *cloud, *fog, *sun, *thin, *card;
};

static inline enum neph_status synthetic_add_layers(struct neph_image *image,
                                                    struct synthetic_layers *layers,
                                                    struct neph_diag *diag)
{
    const struct {
        const char *name;
        float **plane;
    } planes[] = {
        {"Z", &layers->depth},           {"motion.x", &layers->motion_x},
        {"motion.y", &layers->motion_y}, {"volume.distance", &layers->distance},
        {"mask.cloud", &layers->cloud},  {"mask.fog", &layers->fog},
        {"mask.sun", &layers->sun},      {"mask.thin", &layers->thin},
        {"mask.card", &layers->card},
    };
    enum neph_status status = neph_image_add_rgb(image, "volume", layers->volume, diag);
    if (!status)
        status = neph_image_add_rgb(image, "transmittance", layers->transmittance, diag);
    for (size_t i = 0; i < sizeof(planes) / sizeof(planes[0]) && !status; i++)
        status = neph_image_add_channel(image, planes[i].name, planes[i].plane, diag);
    return status;
}

/* One row of the layers next to radiance. */
static inline void synthetic_fill_layers(const struct synthetic *what, int y,
                                         const struct synthetic_layers *layers)
{
    for (int x = 0; x < what->width_px; x++) {
        const struct synthetic_pixel pixel = synthetic_pixel(what, x, y);
        const size_t i = (size_t)y * (size_t)what->width_px + (size_t)x;
        const float noise = 1.0f + 0.02f * synthetic_noise(what->seed + 7, i);
        for (int c = 0; c < 3; c++) {
            layers->volume[c][i] = pixel.cloud * noise;
            layers->transmittance[c][i] = expf(-pixel.cloud * noise);
        }
        layers->depth[i] = pixel.depth_m;
        layers->motion_x[i] = -0.25f;
        layers->distance[i] = 10.0f;
        layers->cloud[i] = pixel.cloud > 0.1f;
        layers->fog[i] = y % 3 == 0;
        layers->sun[i] = x < 2 && y < 2;
        layers->thin[i] = pixel.is_post;
        layers->card[i] = x / 4 == what->frame % 8 && y > 0;
    }
}

static inline enum neph_status synthetic_create(const struct synthetic *what,
                                                struct neph_image **image, struct neph_diag *diag)
{
    struct neph_image *made = NULL;
    struct synthetic_layers layers;
    float *rgb[3];
    enum neph_status status = neph_image_create(what->width_px, what->height_px, &made, diag);
    if (!status)
        status = neph_image_add_rgb(made, NULL, rgb, diag);
    if (!status && what->all)
        status = synthetic_add_layers(made, &layers, diag);
    for (int y = 0; y < what->height_px && !status; y++) {
        for (int x = 0; x < what->width_px; x++) {
            const struct synthetic_pixel pixel = synthetic_pixel(what, x, y);
            const size_t i = (size_t)y * (size_t)what->width_px + (size_t)x;
            for (int c = 0; c < 3; c++)
                rgb[c][i] = synthetic_radiance(what, &pixel, c, i);
        }
        if (what->all)
            synthetic_fill_layers(what, y, &layers);
    }
    if (status)
        neph_image_destroy(made);
    else
        *image = made;
    return status;
}

#endif
