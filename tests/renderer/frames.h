/* SPDX-License-Identifier: MIT
 *
 * Frames of this folder's engines and of the reference, and numbers that compare them. A scene that
 * cannot be rendered fails the test. The caller destroys or frees all frames and arrays.
 */
#ifndef NEPH_TESTS_FRAMES_H
#define NEPH_TESTS_FRAMES_H

#include "tests/renderer/march_test.h"

#include "renderer/realtime/options.h"
#include "renderer/realtime/pipeline.h"
#include "renderer/tracer.h"
#include "scenes/motion.h"
#include "truth/oracle.h"
#include "truth/transport.h"

/* --- scenes and settings ---------------------------------------------------------------------- */

/* A scene of the project by its name, "catalog/sky_earth". For neph_scene_destroy(). */
static inline struct neph_scene *test_load(const char *name)
{
    char path[512];
    struct neph_scene *scene = NULL;
    struct neph_diag diag = {0};
    snprintf(path, sizeof(path), NEPH_SOURCE_DIR "/scenes/%s.yaml", name);
    neph_assert_ok(neph_scene_load(path, &scene, &diag), &diag);
    return scene;
}

/* The scene at one frame, without motion. */
static inline struct neph_scene *test_still(const struct neph_scene *scene, double frame)
{
    struct neph_scene *still = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_scene_at(scene, frame, &still, &diag), &diag);
    return still;
}

/* A preset of the real-time renderer (NULL: all defaults), changed by "key=value key=value". */
static inline struct neph_settings test_preset(const char *preset, const char *assignments)
{
    struct neph_settings settings = neph_options_default(neph_rt_options);
    struct neph_diag diag = {0};
    if (preset)
        neph_assert_ok(neph_options_preset(neph_rt_options, "realtime", neph_rt_presets, preset,
                                           &settings, &diag),
                       &diag);
    test_assign(neph_rt_options, assignments, &settings);
    return settings;
}

/* --- frames ----------------------------------------------------------------------------------- */

/* One frame of the ray marcher. `stats` may be NULL. */
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

/* The next frame of a ray marcher. */
static inline struct neph_image *test_march_next(struct neph_march *march,
                                                 const struct neph_scene *scene,
                                                 struct neph_march_stats *stats)
{
    struct neph_image *frame = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_march_frame(march, scene, 0.0, NULL, &frame, stats, &diag), &diag);
    return frame;
}

/* A ray marcher for several frames. */
static inline struct neph_march *test_march_open(struct neph_vulkan *vulkan,
                                                 const struct neph_scene *scene,
                                                 const struct neph_march_params *params)
{
    struct neph_march *march = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_march_create(vulkan, scene, params, &march, &diag), &diag);
    return march;
}

/* Parameters of a tracer that stops after its samples. */
static inline struct neph_tracer_params test_samples(int width_px, int height_px, uint64_t seed,
                                                     int samples)
{
    return (struct neph_tracer_params){.width_px = width_px,
                                       .height_px = height_px,
                                       .seed = seed,
                                       .samples = samples,
                                       .time_limit_s = INFINITY};
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

/* The last of `count` frames of the real-time renderer, and its statistics (may be NULL). */
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

/* The sky of a planet, computed on the CPU. */
static inline struct neph_sky *test_sky(const struct neph_scene *scene,
                                        const struct neph_sky_params *params)
{
    struct neph_sky *sky = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_sky_create(scene, params, &sky, &diag), &diag);
    return sky;
}

/* --- rays ------------------------------------------------------------------------------------- */

/* The ray of a pixel; pixels are counted along rows. */
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

/* The exact light of every pixel. */
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

/* The channels of a layer (NULL: R, G, B). */
static inline struct test_rgb test_layer(const struct neph_image *frame, const char *layer)
{
    struct test_rgb rgb;
    assert_true(neph_image_rgb(frame, layer, rgb.of));
    return rgb;
}

/* The first channel with a different name or different samples; NULL: both frames have the same
 * bits. */
static inline const char *test_other_channel(const struct neph_image *a, const struct neph_image *b)
{
    const size_t bytes = neph_image_pixel_count(a) * sizeof(float);
    assert_int_equal(a->channel_count, b->channel_count);
    for (int c = 0; c < a->channel_count; c++)
        if (strcmp(a->channels[c].name, b->channels[c].name) != 0 ||
            memcmp(a->channels[c].samples, b->channels[c].samples, bytes) != 0)
            return a->channels[c].name;
    return NULL;
}

static inline bool test_same_bits(const struct neph_image *a, const struct neph_image *b)
{
    return test_other_channel(a, b) == NULL;
}

#define assert_same_bits(a, b) assert_same_bits_at((a), (b), __FILE__, __LINE__)

static inline void assert_same_bits_at(const struct neph_image *a, const struct neph_image *b,
                                       const char *file, int line)
{
    const char *channel = test_other_channel(a, b);
    if (!channel)
        return;
    print_error("channel %s has other bits\n", channel);
    _fail(file, line);
}

static inline void assert_same_channel(const struct neph_image *a, const struct neph_image *b,
                                       const char *name)
{
    assert_memory_equal(neph_image_channel(a, name), neph_image_channel(b, name),
                        neph_image_pixel_count(a) * sizeof(float));
}

/* The largest difference in a layer (NULL: R, G, B). All values must be finite. */
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

/* RMS difference of R, G and B. */
static inline double test_rmse(const struct neph_image *image, const struct neph_image *truth)
{
    const struct test_rgb one = test_layer(image, NULL), other = test_layer(truth, NULL);
    const size_t count = neph_image_pixel_count(image);
    double sum = 0.0;
    for (int c = 0; c < 3; c++)
        for (size_t p = 0; p < count; p++)
            sum += pow((double)one.of[c][p] - (double)other.of[c][p], 2.0);
    return sqrt(sum / (3.0 * (double)count));
}

/* Mean over pixels of |a - b|, over the mean of b. */
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

/* Mean of a channel. */
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
