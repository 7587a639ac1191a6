/* SPDX-License-Identifier: MIT */
#include "metrics/clipping.h"

#include "metrics/vector_math.h"

#include <math.h>
#include <string.h>

static const double pu21_most_cd_per_m2 = 1e4; /* see extractors/code_value.h */

enum image { REFERENCE, TEST, IMAGE_COUNT };

/* Number of a mask's pixels beyond each bound, for each image. */
struct tally {
    size_t beyond[NEPH_BOUND_COUNT][IMAGE_COUNT];
    bool differs;
};

struct neph_clipping {
    int mask_count, frame_count;
    struct tally *last, *all; /* one for each mask */
};

struct neph_clipping *neph_clipping_create(int mask_count, struct neph_arena *memory)
{
    const struct neph_clipping clipping = {
        .mask_count = mask_count,
        .last = neph_arena_allocate(memory, (size_t)mask_count, sizeof(struct tally)),
        .all = neph_arena_allocate(memory, (size_t)mask_count, sizeof(struct tally)),
    };
    return clipping.last && clipping.all ? neph_arena_copy(memory, &clipping, sizeof(clipping))
                                         : NULL;
}

/* Values above these limits are beyond a bound. */
struct limits {
    double channel, luminance;
};

static struct limits compute_clipping_limits(const struct neph_viewing *viewing)
{
    const double gain = exp2(viewing->exposure_ev);
    return (struct limits){1.0 / gain, pu21_most_cd_per_m2 / (viewing->white_cd_per_m2 * gain)};
}

/* Whether any channel is above the limit. Luminance can be above it only where a channel is. */
NEPH_VECTOR static bool any_above(const float *restrict r, const float *restrict g,
                                  const float *restrict b, size_t count, float limit)
{
    uint32_t above = 0;
    for (size_t i = 0; i < count; i++)
        above |= (r[i] > limit ? 1u : 0u) | (g[i] > limit ? 1u : 0u) | (b[i] > limit ? 1u : 0u);
    return above != 0;
}

/* Pixels per step. */
enum { CHUNK_PX = 256 };

/* For each bound, 1 for pixels beyond it, else 0. */
struct marks {
    uint8_t beyond[NEPH_BOUND_COUNT][CHUNK_PX];
};

NEPH_VECTOR static void mark(const float *restrict r, const float *restrict g,
                             const float *restrict b, size_t count, struct limits limits,
                             uint8_t *restrict white, uint8_t *restrict pu21)
{
    for (size_t i = 0; i < count; i++) {
        const double red = (double)r[i], green = (double)g[i], blue = (double)b[i];
        white[i] = (red > limits.channel) | (green > limits.channel) | (blue > limits.channel);
        pu21[i] = neph_luminance(red, green, blue) > limits.luminance;
    }
}

NEPH_VECTOR static size_t count_marks(const uint8_t *restrict beyond,
                                      const uint8_t *restrict inside, size_t count)
{
    uint32_t sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += (uint32_t)(beyond[i] & inside[i]);
    return sum;
}

static void count_chunk(struct neph_clipping *clipping, const struct marks *marks, size_t first,
                        size_t count, const struct neph_mask *const *masks, enum image image)
{
    for (int m = 0; m < clipping->mask_count; m++)
        for (int bound = NEPH_BOUND_WHITE; bound <= NEPH_BOUND_PU21; bound++)
            clipping->last[m].beyond[bound][image] += count_marks(marks->beyond[bound],
                                                                  masks[m]->inside + first, count);
}

static void count_row(struct neph_clipping *clipping, const float *const planes[3], size_t first,
                      size_t width, struct limits limits, const struct neph_mask *const *masks,
                      enum image image)
{
    const float *r = planes[0] + first, *g = planes[1] + first, *b = planes[2] + first;
    const double least = fmin(limits.channel, limits.luminance);
    if (!any_above(r, g, b, width, (float)(least * (1.0 - 1e-6)))) /* lowered, to be safe against
                                                                    * rounding */
        return;
    for (size_t x = 0; x < width; x += CHUNK_PX) {
        const size_t count = width - x < CHUNK_PX ? width - x : CHUNK_PX;
        struct marks marks;
        mark(r + x, g + x, b + x, count, limits, marks.beyond[NEPH_BOUND_WHITE],
             marks.beyond[NEPH_BOUND_PU21]);
        count_chunk(clipping, &marks, first + x, count, masks, image);
    }
}

static bool differs_at(const struct neph_frame_pair *pair, size_t pixel)
{
    for (int p = 0; p < pair->plane_count; p++)
        if (pair->reference[p][pixel] != pair->test[p][pixel])
            return true;
    return false;
}

static bool row_differs(const struct neph_frame_pair *pair, size_t first, size_t width)
{
    for (int p = 0; p < pair->plane_count; p++)
        if (memcmp(pair->reference[p] + first, pair->test[p] + first, width * sizeof(float)) != 0)
            return true;
    return false;
}

static bool differs_in(const struct neph_frame_pair *pair, const struct neph_mask *mask,
                       size_t first, size_t width)
{
    for (size_t i = first; i < first + width; i++)
        if (mask->inside[i] && differs_at(pair, i))
            return true;
    return false;
}

static void compare_row(struct neph_clipping *clipping, const struct neph_frame_pair *pair,
                        size_t first, size_t width, const struct neph_mask *const *masks)
{
    if (!row_differs(pair, first, width))
        return;
    for (int m = 0; m < clipping->mask_count; m++)
        if (!clipping->last[m].differs)
            clipping->last[m].differs = differs_in(pair, masks[m], first, width);
}

static void add_to_all(struct neph_clipping *clipping)
{
    for (int m = 0; m < clipping->mask_count; m++) {
        for (int b = 0; b < NEPH_BOUND_COUNT; b++)
            for (int i = 0; i < IMAGE_COUNT; i++)
                clipping->all[m].beyond[b][i] += clipping->last[m].beyond[b][i];
        clipping->all[m].differs |= clipping->last[m].differs;
    }
    clipping->frame_count++;
}

void neph_clipping_add_frame(struct neph_clipping *clipping, const struct neph_frame_pair *pair,
                             const struct neph_mask *const *masks)
{
    const struct limits limits = compute_clipping_limits(pair->viewing);
    const size_t width = (size_t)pair->width_px, count = width * (size_t)pair->height_px;
    memset(clipping->last, 0, (size_t)clipping->mask_count * sizeof(*clipping->last));
    for (size_t first = 0; first < count; first += width) {
        count_row(clipping, pair->reference, first, width, limits, masks, REFERENCE);
        count_row(clipping, pair->test, first, width, limits, masks, TEST);
        compare_row(clipping, pair, first, width, masks);
    }
    add_to_all(clipping);
}

struct neph_clipped neph_clipping_shares(const struct neph_clipping *clipping,
                                         enum neph_display_bound bound,
                                         const struct neph_mask *mask, int index, bool of_all)
{
    const struct tally *tally = of_all ? &clipping->all[index] : &clipping->last[index];
    const double pixels = (double)mask->pixel_count * (of_all ? clipping->frame_count : 1);
    if (bound == NEPH_BOUND_NONE || pixels <= 0.0)
        return (struct neph_clipped){.bound = bound};
    return (struct neph_clipped){.bound = bound,
                                 .reference = (double)tally->beyond[bound][REFERENCE] / pixels,
                                 .test = (double)tally->beyond[bound][TEST] / pixels};
}

bool neph_clipping_differs(const struct neph_clipping *clipping, int index, bool of_all)
{
    return of_all ? clipping->all[index].differs : clipping->last[index].differs;
}
