/* SPDX-License-Identifier: MIT
 *
 * Helpers for tests of metrics: small images from numbers, and a measurement by its name.
 */
#ifndef NEPH_TESTS_METRICS_TEST_H
#define NEPH_TESTS_METRICS_TEST_H

#include "tests/neph_test.h"

#include "base/image.h"
#include "metrics/extractors/extractors.h"
#include "metrics/meter.h"

static inline struct neph_image *create_image(int width_px, int height_px)
{
    struct neph_image *image = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_image_create(width_px, height_px, &image, &diag), &diag);
    return image;
}

/* Adds a channel; NULL values: all zero. */
static inline float *add_channel(struct neph_image *image, const char *name, const float *values)
{
    float *samples = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_image_add_channel(image, name, &samples, &diag), &diag);
    if (values)
        memcpy(samples, values, neph_image_pixel_count(image) * sizeof(*samples));
    return samples;
}

/* Adds R G B of a layer from interleaved values; NULL layer: radiance. */
static inline void add_rgb(struct neph_image *image, const char *layer, const float *interleaved)
{
    float *planes[3];
    struct neph_diag diag = {0};
    neph_assert_ok(neph_image_add_rgb(image, layer, planes, &diag), &diag);
    for (size_t i = 0; i < neph_image_pixel_count(image); i++)
        for (int c = 0; c < 3; c++)
            planes[c][i] = interleaved[3 * i + (size_t)c];
}

static inline struct neph_mask *create_mask(const struct neph_image *image, const char *name)
{
    struct neph_mask *mask = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_mask_create(image, name, NULL, &mask, &diag), &diag);
    return mask;
}

enum { MEASURED_MAX = 256 };

struct measured {
    struct neph_measurement all[MEASURED_MAX];
    int count;
};

/* The measurements of one extractor with default settings, for a pair of images over one mask. */
static inline struct measured measure_with(const struct neph_extractor *extractor,
                                           const struct neph_image *reference,
                                           const struct neph_image *test, const char *quantity,
                                           const struct neph_mask *mask)
{
    const struct neph_meter_choice choice = {extractor, neph_options_default(extractor->options)};
    const struct neph_meter_params params = {.choices = &choice,
                                             .choice_count = 1,
                                             .viewing = NEPH_VIEWING_DEFAULTS,
                                             .masks = &mask,
                                             .mask_count = 1,
                                             .intervals = true};
    struct neph_meter *meter = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_meter_create(&params, &meter, &diag), &diag);
    neph_assert_ok(neph_meter_frame(meter, reference, NULL, test, &diag), &diag);
    int count = 0;
    const struct neph_measurement *all = neph_meter_measurements(meter, &count);
    struct measured measured = {.count = 0};
    for (int i = 0; i < count; i++)
        if (strcmp(all[i].quantity->name, quantity) == 0 && measured.count < MEASURED_MAX)
            measured.all[measured.count++] = all[i];
    neph_meter_destroy(meter);
    return measured;
}

static inline struct measured measure(const struct neph_image *reference,
                                      const struct neph_image *test, const char *quantity,
                                      const struct neph_mask *mask)
{
    return measure_with(neph_extractor_find("error"), reference, test, quantity, mask);
}

static inline const struct neph_measurement *find(const struct measured *measured, const char *name)
{
    for (int i = 0; i < measured->count; i++)
        if (strcmp(measured->all[i].metric->name, name) == 0)
            return &measured->all[i];
    fail_msg("no measurement '%s'", name);
    return NULL;
}

static inline double value_of(const struct measured *measured, const char *name)
{
    const struct neph_measurement *found = find(measured, name);
    if (!found->defined)
        fail_msg("'%s' is undefined: %s", name, found->undefined_because);
    return found->value;
}

/* NEPH_TEST_SEED, or the given seed; printed, so that a failure can be reproduced. */
static inline uint64_t test_seed(uint64_t usual)
{
    const char *wanted = getenv("NEPH_TEST_SEED");
    uint64_t seed = wanted ? strtoull(wanted, NULL, 0) : usual;
    print_message("NEPH_TEST_SEED=%llu\n", (unsigned long long)seed);
    return seed;
}

#endif
