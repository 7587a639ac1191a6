/* SPDX-License-Identifier: MIT
 *
 * Comparisons of two frames, of the same size.
 */
#ifndef NEPH_TESTS_IMAGE_TEST_H
#define NEPH_TESTS_IMAGE_TEST_H

#include "tests/neph_test.h"

#include "base/image.h"

/* The first channel whose name or samples differ; NULL: both frames have the same bits. */
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

static inline bool test_has_same_bits(const struct neph_image *a, const struct neph_image *b)
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

/* Of three colours of a layer; NULL: the frame itself. Not for values that are no numbers. */
static inline double test_largest_difference(const struct neph_image *a, const struct neph_image *b,
                                             const char *layer)
{
    float *one[3], *other[3];
    double largest = 0.0;
    assert_true(neph_image_rgb(a, layer, one) && neph_image_rgb(b, layer, other));
    for (int c = 0; c < 3; c++)
        for (size_t p = 0; p < neph_image_pixel_count(a); p++)
            largest = fmax(largest, fabs((double)one[c][p] - (double)other[c][p]));
    return largest;
}

/* Of all three colours. */
static inline double test_rmse(const struct neph_image *image, const struct neph_image *truth)
{
    float *one[3], *other[3];
    double sum = 0.0;
    const size_t count = neph_image_pixel_count(image);
    assert_true(neph_image_rgb(image, NULL, one) && neph_image_rgb(truth, NULL, other));
    for (int c = 0; c < 3; c++)
        for (size_t p = 0; p < count; p++)
            sum += ((double)one[c][p] - other[c][p]) * ((double)one[c][p] - other[c][p]);
    return sqrt(sum / (3.0 * (double)count));
}

#endif
