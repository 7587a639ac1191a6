/* SPDX-License-Identifier: MIT
 *
 * Frames by the engines of this folder and by the truth, and numbers that compare them. What cannot
 * be rendered fails the test. All frames and arrays are for the caller to destroy or to free.
 */
#ifndef NEPH_TESTS_FRAMES_H
#define NEPH_TESTS_FRAMES_H

#include "tests/renderer/march_test.h"

#include "renderer/realtime/options.h"
#include "renderer/realtime/pipeline.h"
#include "renderer/tracer.h"
#include "truth/oracle.h"
#include "truth/transport.h"

/* --- scenes and settings ---------------------------------------------------------------------- */

/* A scene of the project: "catalog/sky_earth". For neph_scene_destroy(). */
static inline struct neph_scene *test_load(const char *name)
{
    char path[512];
    struct neph_scene *scene = NULL;
    struct neph_diag diag = {0};
    snprintf(path, sizeof(path), NEPH_SOURCE_DIR "/scenes/%s.yaml", name);
    neph_assert_ok(neph_scene_load(path, &scene, &diag), &diag);
    return scene;
}

/* A preset of the real-time renderer (NULL: all defaults) with "key=value key=value". */
static inline struct neph_settings test_preset(const char *preset, const char *assignments)
{
    struct neph_settings settings = neph_options_default(neph_rt_options);
    struct neph_diag diag = {0};
    char word[64];
    if (preset)
        neph_assert_ok(neph_options_preset(neph_rt_options, "realtime", neph_rt_presets, preset,
                                           &settings, &diag),
                       &diag);
    for (int length; sscanf(assignments, " %63s%n", word, &length) == 1; assignments += length)
        neph_assert_ok(neph_options_set(neph_rt_options, "realtime", word, &settings, &diag),
                       &diag);
    return settings;
}

/* --- frames ----------------------------------------------------------------------------------- */

/* One frame of the march by itself. `stats` may be NULL. */
static inline struct neph_image *test_march(struct neph_vulkan *vulkan,
                                            const struct neph_scene *scene,
                                            const struct neph_march_params *params,
                                            struct neph_march_stats *stats)
{
    struct neph_image *frame = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(test_march_frame(vulkan, scene, params, &frame, stats, &diag), &diag);
    return frame;
}

/* Another frame of a march. */
static inline struct neph_image *test_march_next(struct neph_march *march,
                                                 const struct neph_scene *scene,
                                                 struct neph_march_stats *stats)
{
    struct neph_image *frame = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_march_frame(march, scene, 0.0, NULL, &frame, stats, &diag), &diag);
    return frame;
}

static inline struct neph_image *test_trace(struct neph_vulkan *vulkan,
                                            const struct neph_scene *scene,
                                            const struct neph_tracer_params *params,
                                            struct neph_tracer_stats *stats)
{
    struct neph_image *frame = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_tracer_render(vulkan, scene, params, &frame, stats, &diag), &diag);
    return frame;
}

static inline struct neph_image *test_oracle(const struct neph_scene *scene, int width_px,
                                             int height_px, uint64_t seed, int samples)
{
    const struct neph_oracle_params params = {.width_px = width_px,
                                              .height_px = height_px,
                                              .seed = seed,
                                              .samples = samples,
                                              .time_limit_s = INFINITY};
    struct neph_image *frame = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_oracle_render(scene, &params, &frame, NULL, &diag), &diag);
    return frame;
}

/* The last of `count` frames in real time, and what it has cost (may be NULL). */
static inline struct neph_image *test_film(struct neph_vulkan *vulkan,
                                           const struct neph_scene *scene,
                                           const struct neph_realtime_params *params, int count,
                                           struct neph_realtime_stats *stats)
{
    struct neph_realtime *realtime = NULL;
    struct neph_image *image = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_realtime_create(vulkan, scene, params, &realtime, &diag), &diag);
    for (int i = 0; i < count; i++) {
        const struct neph_realtime_frame frame = {scene, i, NULL};
        neph_image_destroy(image);
        neph_assert_ok(neph_realtime_render(realtime, &frame, &image, stats, &diag), &diag);
    }
    neph_realtime_destroy(realtime);
    return image;
}

/* --- rays ------------------------------------------------------------------------------------- */

/* The ray of a pixel, counted along rows. */
static inline struct neph_pixel_ray test_ray(const struct neph_scene *scene, int width_px,
                                             int height_px, int pixel)
{
    const struct neph_camera camera = neph_scene_camera(scene, 0.0);
    return neph_camera_ray(&camera, width_px, height_px, pixel % width_px, pixel / width_px);
}

static inline struct neph_ray_light test_exact_ray(const struct neph_scene *scene, int width_px,
                                                   int height_px, int pixel)
{
    const struct neph_pixel_ray ray = test_ray(scene, width_px, height_px, pixel);
    return neph_transport_ray(scene, ray.origin_m, ray.direction);
}

/* The exact light of each pixel. */
static inline struct neph_ray_light *test_exact(const struct neph_scene *scene, int width_px,
                                                int height_px)
{
    char reason[256];
    if (!neph_transport_is_exact(scene, reason, sizeof(reason)))
        fail_msg("no truth: %s", reason);
    struct neph_ray_light *light = calloc((size_t)width_px * (size_t)height_px, sizeof(*light));
    assert_non_null(light);
    for (int p = 0; p < width_px * height_px; p++)
        light[p] = test_exact_ray(scene, width_px, height_px, p);
    return light;
}

/* --- comparisons ------------------------------------------------------------------------------ */

/* Three channels. */
struct test_rgb {
    float *of[3];
};

/* Of a layer (NULL: R, G, B). */
static inline struct test_rgb test_layer(const struct neph_image *frame, const char *layer)
{
    struct test_rgb rgb;
    assert_true(neph_image_rgb(frame, layer, rgb.of));
    return rgb;
}

static inline bool test_same_bits(const struct neph_image *a, const struct neph_image *b)
{
    bool same = a->channel_count == b->channel_count;
    for (int c = 0; c < a->channel_count && same; c++)
        same = memcmp(a->channels[c].samples, b->channels[c].samples,
                      neph_image_pixel_count(a) * sizeof(float)) == 0;
    return same;
}

/* Of a layer (NULL: R, G, B). */
static inline double test_largest_difference(const struct neph_image *a, const struct neph_image *b,
                                             const char *layer)
{
    const struct test_rgb one = test_layer(a, layer), other = test_layer(b, layer);
    double largest = 0.0;
    for (int c = 0; c < 3; c++)
        for (size_t p = 0; p < neph_image_pixel_count(a); p++)
            largest = fmax(largest, fabs((double)one.of[c][p] - (double)other.of[c][p]));
    return largest;
}

/* The mean over pixels of |a - b|, over the mean of b. */
static inline double test_distance(const struct neph_image *a, const struct neph_image *b,
                                   const char *channel)
{
    const float *x = neph_image_channel(a, channel), *y = neph_image_channel(b, channel);
    double off = 0.0, sum = 0.0;
    for (size_t i = 0; i < neph_image_pixel_count(a); i++) {
        off += fabs((double)x[i] - (double)y[i]);
        sum += (double)y[i];
    }
    return off / sum;
}

/* The mean of a channel. */
static inline double test_mean(const struct neph_image *frame, const char *channel)
{
    const float *values = neph_image_channel(frame, channel);
    double sum = 0.0;
    assert_non_null(values);
    for (size_t i = 0; i < neph_image_pixel_count(frame); i++)
        sum += (double)values[i];
    return sum / (double)neph_image_pixel_count(frame);
}

#endif
