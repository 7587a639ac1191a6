/* SPDX-License-Identifier: MIT */
#include "metrics/validity.h"

#include "metrics/vector_math.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The allowed values of a channel. A name that ends in '.' covers all channels of that layer. */
struct rule {
    const char *name;
    bool may_be_far; /* +inf is valid */
    bool may_be_negative;
};

static const struct rule rules[] = {
    {"R", false, false},           {"G", false, false},
    {"B", false, false},           {"volume.distance", true, false},
    {"volume.", false, false},     {"transmittance.", false, false},
    {"variance.", false, false},   {"Z", true, false},
    {"Y", false, false},           {"mask.", false, true},
    {"motion.depth", true, false}, {"motion.", false, true},
    {"normal.", false, true},
};

static const struct rule unknown = {"", false, true};

static const struct rule *find_channel_rule(const char *channel)
{
    for (size_t i = 0; i < sizeof(rules) / sizeof(rules[0]); i++) {
        size_t length = strlen(rules[i].name);
        bool is_layer = rules[i].name[length - 1] == '.';
        if (is_layer ? strncmp(channel, rules[i].name, length) == 0
                     : strcmp(channel, rules[i].name) == 0)
            return &rules[i];
    }
    return &unknown;
}

bool neph_validity_has_rule(const char *channel)
{
    return find_channel_rule(channel) != &unknown;
}

static void count_finite(struct neph_validity_channel *counts, float value)
{
    counts->min = counts->has_finite ? fminf(counts->min, value) : value;
    counts->max = counts->has_finite ? fmaxf(counts->max, value) : value;
    counts->has_finite = true;
}

static void count_sample(struct neph_validity_channel *counts, const struct rule *rule, float value,
                         struct neph_validity_pixel pixel)
{
    if (isfinite(value)) {
        count_finite(counts, value);
        if (value < 0.0f && !rule->may_be_negative && counts->negative_count++ == 0)
            counts->first_negative = pixel;
        return;
    }
    if (isinf(value) && value > 0.0f && rule->may_be_far)
        return;
    if (isnan(value))
        counts->nan_count++;
    else if (value > 0.0f)
        counts->positive_infinity_count++;
    else
        counts->negative_infinity_count++;
    if (counts->non_finite_count++ == 0)
        counts->first_non_finite = pixel;
}

/* Whether all values of a run are finite and not negative; if so, their minimum and maximum.
 * Compared as integers, which have vector minimum and maximum: the bits of such floats have the
 * same order. */
NEPH_VECTOR static bool is_plain_run(int count, const float *restrict values, float *restrict min,
                                     float *restrict max)
{
    uint32_t least = UINT32_MAX, largest = 0;
    for (int i = 0; i < count; i++) {
        uint32_t bits;
        memcpy(&bits, &values[i], sizeof(bits));
        least = bits < least ? bits : least;
        largest = bits > largest ? bits : largest;
    }
    memcpy(min, &least, sizeof(*min));
    memcpy(max, &largest, sizeof(*max));
    return largest < 0x7f800000u; /* +inf; values with the sign bit, including -0, are larger */
}

/* Count a row. Nearly all rows are plain and are checked in vectors. */
static void count_row(struct neph_validity_channel *counts, const struct rule *rule, int width_px,
                      const float *samples, int y)
{
    float min, max;
    if (width_px > 0 && is_plain_run(width_px, samples, &min, &max)) {
        count_finite(counts, min);
        count_finite(counts, max);
        return;
    }
    for (int x = 0; x < width_px; x++)
        count_sample(counts, rule, samples[x], (struct neph_validity_pixel){x, y});
}

enum neph_status neph_validity_count(const struct neph_image *image, struct neph_validity *validity,
                                     struct neph_diag *diag)
{
    struct neph_validity counted = {.channel_count = image->channel_count};
    if (image->channel_count > 0) {
        counted.channels = calloc((size_t)image->channel_count, sizeof(*counted.channels));
        if (!counted.channels)
            return neph_fail_memory(diag);
    }
    for (int i = 0; i < image->channel_count; i++) {
        const struct neph_channel *channel = &image->channels[i];
        const struct rule *rule = find_channel_rule(channel->name);
        struct neph_validity_channel *counts = &counted.channels[i];
        counts->name = channel->name;
        for (int y = 0; y < image->height_px; y++)
            count_row(counts, rule, image->width_px,
                      channel->samples + (size_t)y * (size_t)image->width_px, y);
        counted.non_finite_count += counts->non_finite_count;
        counted.negative_count += counts->negative_count;
    }
    *validity = counted;
    return NEPH_OK;
}

void neph_validity_finish(struct neph_validity *validity)
{
    free(validity->channels);
    *validity = (struct neph_validity){0};
}

static enum neph_status fail_non_finite(const struct neph_validity *validity,
                                        struct neph_diag *diag)
{
    const struct neph_validity_channel *first = NULL;
    int bad_channel_count = 0;
    for (int i = 0; i < validity->channel_count; i++) {
        const struct neph_validity_channel *channel = &validity->channels[i];
        if (channel->non_finite_count > 0 && bad_channel_count++ == 0)
            first = channel;
    }
    return neph_fail(diag, NEPH_ERR_GATE,
                     "%zu values in %d of %d channels are not finite; first '%s' at pixel (%d, "
                     "%d), which has %zu NaN, %zu +inf and %zu -inf",
                     validity->non_finite_count, bad_channel_count, validity->channel_count,
                     first->name, first->first_non_finite.x_px, first->first_non_finite.y_px,
                     first->nan_count, first->positive_infinity_count,
                     first->negative_infinity_count);
}

static enum neph_status fail_negative(const struct neph_validity *validity, size_t negative_allowed,
                                      struct neph_diag *diag)
{
    const struct neph_validity_channel *first = NULL;
    int bad_channel_count = 0;
    for (int i = 0; i < validity->channel_count; i++) {
        const struct neph_validity_channel *channel = &validity->channels[i];
        if (channel->negative_count > 0 && bad_channel_count++ == 0)
            first = channel;
    }
    return neph_fail(diag, NEPH_ERR_GATE,
                     "%zu values in %d of %d channels are negative, %zu allowed; first '%s' at "
                     "pixel (%d, %d); minimum of that channel: %g",
                     validity->negative_count, bad_channel_count, validity->channel_count,
                     negative_allowed, first->name, first->first_negative.x_px,
                     first->first_negative.y_px, (double)first->min);
}

enum neph_status neph_validity_gate(const struct neph_validity *validity, size_t negative_allowed,
                                    struct neph_diag *diag)
{
    if (validity->non_finite_count > 0)
        return fail_non_finite(validity, diag);
    if (validity->negative_count > negative_allowed)
        return fail_negative(validity, negative_allowed, diag);
    return NEPH_OK;
}

enum neph_status neph_validity_same_size(const struct neph_image *reference,
                                         const struct neph_image *test, struct neph_diag *diag)
{
    if (reference->width_px == test->width_px && reference->height_px == test->height_px)
        return NEPH_OK;
    return neph_fail(diag, NEPH_ERR_INPUT, "the reference is %dx%d pixels, the test %dx%d",
                     reference->width_px, reference->height_px, test->width_px, test->height_px);
}

/* List the channels of `image` that `other` lacks, as " 'A' 'B'"; returns their number. */
static int list_missing(const struct neph_image *image, const struct neph_image *other,
                        char list[256])
{
    int count = 0;
    size_t length = 0;
    list[0] = '\0';
    for (int i = 0; i < image->channel_count; i++) {
        const char *name = image->channels[i].name;
        if (neph_image_channel(other, name))
            continue;
        count++;
        int written = snprintf(list + length, 256 - length, " '%s'", name);
        if (written > 0)
            length += (size_t)written;
        if (length > 255)
            length = 255;
    }
    return count;
}

enum neph_status neph_validity_same_channels(const struct neph_image *reference,
                                             const struct neph_image *test, struct neph_diag *diag)
{
    char only_reference[256], only_test[256];
    int reference_count = list_missing(reference, test, only_reference);
    int test_count = list_missing(test, reference, only_test);
    if (reference_count == 0 && test_count == 0)
        return NEPH_OK;
    return neph_fail(diag, NEPH_ERR_INPUT,
                     "the channels differ: %d only in the reference%s%s; %d only in the test%s%s",
                     reference_count, reference_count > 0 ? ":" : "", only_reference, test_count,
                     test_count > 0 ? ":" : "", only_test);
}

/* ---- frozen frames --------------------------------------------------------------------------- */

enum neph_status neph_frozen_hash(const struct neph_image *frame, char hex[NEPH_HASH_HEX_SIZE],
                                  struct neph_diag *diag)
{
    /* Hash a text with a line for the size and one for each channel. */
    enum { LINE_MAX = NEPH_IMAGE_NAME_MAX + NEPH_HASH_HEX_SIZE + 32 };
    size_t size = (size_t)(frame->channel_count + 1) * LINE_MAX;
    char *text = malloc(size);
    if (!text)
        return neph_fail_memory(diag);
    size_t length = (size_t)snprintf(text, size, "%dx%d", frame->width_px, frame->height_px);
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < frame->channel_count && !status; i++) {
        const struct neph_channel *channel = &frame->channels[i];
        char samples[NEPH_HASH_HEX_SIZE];
        status = neph_hash(channel->samples, neph_image_pixel_count(frame) * sizeof(float), samples,
                           diag);
        if (!status)
            length += (size_t)snprintf(text + length, size - length, "\n%s %s", channel->name,
                                       samples);
    }
    if (!status)
        status = neph_hash(text, length, hex, diag);
    free(text);
    return status;
}

bool neph_frames_are_equal(const struct neph_image *a, const struct neph_image *b)
{
    bool same = a->width_px == b->width_px && a->height_px == b->height_px &&
                a->channel_count == b->channel_count;
    for (int i = 0; i < a->channel_count && same; i++)
        same = strcmp(a->channels[i].name, b->channels[i].name) == 0;
    for (int i = 0; i < a->channel_count && same; i++)
        same = memcmp(a->channels[i].samples, b->channels[i].samples,
                      neph_image_pixel_count(a) * sizeof(float)) == 0;
    return same;
}

bool neph_frozen_add(struct neph_frozen *frozen, const struct neph_image *previous,
                     const struct neph_image *frame)
{
    const bool same = previous && neph_frames_are_equal(previous, frame);
    if (same && frozen->frozen_count++ == 0)
        frozen->first_frozen = frozen->frame_count;
    frozen->frame_count++;
    return same;
}
