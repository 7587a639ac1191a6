/* SPDX-License-Identifier: MIT */
#include "metrics/mask.h"

#include "metrics/depth_edge.h"
#include "metrics/vector_math.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct ring {
    bool is_near;
    uint8_t least_px, most_px;
};

struct source;

typedef enum neph_status mark_function(const struct source *source, uint8_t *inside,
                                       struct neph_diag *diag);

struct kind {
    struct neph_mask_kind described;
    mark_function *mark;
    struct ring ring; /* only of ring masks */
};

/* The input of a mask kind: its channels, found and checked. */
struct source {
    const struct kind *kind;
    int width_px, height_px;
    const float *planes[3]; /* Z; or the three channels of transmittance */
    const struct neph_mask_options *options;
};

static size_t source_pixel_count(const struct source *source)
{
    return (size_t)source->width_px * (size_t)source->height_px;
}

/* ---- the kinds ------------------------------------------------------------------------------- */

static enum neph_status mark_all(const struct source *source, uint8_t *inside,
                                 struct neph_diag *diag)
{
    (void)diag;
    memset(inside, 1, source_pixel_count(source));
    return NEPH_OK;
}

static enum neph_status mark_sky(const struct source *source, uint8_t *inside,
                                 struct neph_diag *diag)
{
    (void)diag;
    for (size_t i = 0; i < source_pixel_count(source); i++)
        inside[i] = isinf(source->planes[0][i]) ? 1 : 0;
    return NEPH_OK;
}

static enum neph_status mark_solid(const struct source *source, uint8_t *inside,
                                   struct neph_diag *diag)
{
    (void)diag;
    for (size_t i = 0; i < source_pixel_count(source); i++)
        inside[i] = isfinite(source->planes[0][i]) ? 1 : 0;
    return NEPH_OK;
}

static enum neph_status mark_medium(const struct source *source, uint8_t *inside,
                                    struct neph_diag *diag)
{
    (void)diag;
    double clear = exp(-source->options->medium_optical_depth);
    for (size_t i = 0; i < source_pixel_count(source); i++) {
        float least = fminf(source->planes[0][i],
                            fminf(source->planes[1][i], source->planes[2][i]));
        inside[i] = (double)least < clear ? 1 : 0;
    }
    return NEPH_OK;
}

/* out[i] = whether any in[i - radius .. i + radius] is set, along one row or column. */
static void dilate_line(const uint8_t *in, uint8_t *out, size_t count, size_t stride, size_t radius)
{
    size_t set_count = 0;
    for (size_t i = 0; i < radius && i < count; i++)
        set_count += in[i * stride];
    for (size_t i = 0; i < count; i++) {
        if (i + radius < count)
            set_count += in[(i + radius) * stride];
        if (i > radius)
            set_count -= in[(i - radius - 1) * stride];
        out[i * stride] = set_count > 0 ? 1 : 0;
    }
}

static enum neph_status mark_depth_edge(const struct source *source, uint8_t *inside,
                                        struct neph_diag *diag)
{
    size_t width = (size_t)source->width_px, height = (size_t)source->height_px;
    size_t radius = (size_t)source->options->edge_radius_px;
    uint8_t *widened = malloc(width * height);
    if (!widened)
        return neph_fail_memory(diag);
    neph_edge_steps(source->planes[0], source->width_px, source->height_px,
                    source->options->edge_depth_ratio, inside, widened);
    for (size_t i = 0; i < width * height; i++)
        inside[i] |= widened[i];
    for (size_t y = 0; y < height; y++)
        dilate_line(inside + y * width, widened + y * width, width, 1, radius);
    for (size_t x = 0; x < width; x++)
        dilate_line(widened + x, inside + x, height, width, radius);
    free(widened);
    return NEPH_OK;
}

static enum neph_status mark_non_edge(const struct source *source, uint8_t *inside,
                                      struct neph_diag *diag)
{
    enum neph_status status = mark_depth_edge(source, inside, diag);
    for (size_t i = 0; i < source_pixel_count(source) && !status; i++)
        inside[i] = !inside[i];
    return status;
}

static enum neph_status mark_thin(const struct source *source, uint8_t *inside,
                                  struct neph_diag *diag)
{
    return neph_mark_thin(source->planes[0], source->width_px, source->height_px,
                          source->options->edge_depth_ratio, inside, diag);
}

NEPH_VECTOR static void pick_ring(struct ring ring, const uint8_t *restrict near_px,
                                  const uint8_t *restrict far_px, size_t count,
                                  uint8_t *restrict inside)
{
    const uint8_t least_px = ring.least_px, most_px = ring.most_px, is_near = ring.is_near;
    for (size_t i = 0; i < count; i++) {
        uint8_t distance_px = near_px[i] < far_px[i] ? near_px[i] : far_px[i];
        uint8_t is_nearer = near_px[i] <= far_px[i];
        inside[i] = (is_nearer == is_near) & (distance_px >= least_px) & (distance_px <= most_px);
    }
}

static enum neph_status mark_ring(const struct source *source, uint8_t *inside,
                                  struct neph_diag *diag)
{
    struct neph_edge_field field;
    enum neph_status status = neph_edge_field_create(
        source->planes[0], source->width_px, source->height_px, source->options->edge_depth_ratio,
        &field, diag);
    if (status)
        return status;
    pick_ring(source->kind->ring, field.near_px, field.far_px, source_pixel_count(source), inside);
    neph_edge_field_finish(&field);
    return NEPH_OK;
}

#define RING(side, is_near, words, distance, least_px, most_px)                                    \
    {                                                                                              \
        {"edge_" side "_" #distance, "Z", words, true}, mark_ring,                                 \
        {                                                                                          \
            is_near, least_px, most_px                                                             \
        }                                                                                          \
    }

static const struct kind kinds[] = {
    {{"all", NULL, "every pixel", false}, mark_all, {0}},
    {{"sky", "Z", "no solid behind the pixel: Z = +inf", false}, mark_sky, {0}},
    {{"solid", "Z", "a solid behind the pixel: Z finite", false}, mark_solid, {0}},
    {{"medium", "transmittance", "optical depth above 0.001 in at least one colour channel", false},
     mark_medium,
     {0}},
    {{"depth_edge", "Z", "within 2 px of a step in depth: 4-neighbours with a ratio above 1.1",
      false},
     mark_depth_edge,
     {0}},
    {{"non_edge", "Z", "farther than 2 px from any step in depth, in all frames", false},
     mark_non_edge,
     {0}},
    {{"thin", "Z", "up to 3 px wide: no square of 4x4 px around it without something behind",
      false},
     mark_thin,
     {0}},
    RING("near", true, "the nearer pixel of a step in depth", 0, 0, 0),
    RING("near", true, "1 px from a step in depth, before it", 1, 1, 1),
    RING("near", true, "2 px from a step in depth, before it", 2, 2, 2),
    RING("near", true, "3 or 4 px from a step in depth, before it", 3_4, 3, 4),
    RING("near", true, "5 to 8 px from a step in depth, before it", 5_8, 5, 8),
    RING("far", false, "the farther pixel of a step in depth", 0, 0, 0),
    RING("far", false, "1 px from a step in depth, behind it", 1, 1, 1),
    RING("far", false, "2 px from a step in depth, behind it", 2, 2, 2),
    RING("far", false, "3 or 4 px from a step in depth, behind it", 3_4, 3, 4),
    RING("far", false, "5 to 8 px from a step in depth, behind it", 5_8, 5, 8),
};

enum { KIND_COUNT = sizeof(kinds) / sizeof(kinds[0]) };

int neph_mask_kind_count(void)
{
    return KIND_COUNT;
}

const struct neph_mask_kind *neph_mask_kind_at(int index)
{
    return index >= 0 && index < KIND_COUNT ? &kinds[index].described : NULL;
}

static const struct kind *find_kind(const char *name)
{
    for (int i = 0; i < KIND_COUNT; i++)
        if (strcmp(kinds[i].described.name, name) == 0)
            return &kinds[i];
    return NULL;
}

const struct neph_mask_kind *neph_mask_kind_find(const char *name)
{
    const struct kind *kind = find_kind(name);
    return kind ? &kind->described : NULL;
}

/* ---- making one ------------------------------------------------------------------------------ */

static enum neph_status check_options(const struct neph_mask_options *options,
                                      struct neph_diag *diag)
{
    if (!(options->medium_optical_depth > 0.0) || !isfinite(options->medium_optical_depth))
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "the optical depth of a medium mask must be above 0, not %g",
                         options->medium_optical_depth);
    if (!(options->edge_depth_ratio >= 1.0) || !isfinite(options->edge_depth_ratio))
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "the depth ratio of an edge must be at least 1, not %g",
                         options->edge_depth_ratio);
    if (options->edge_radius_px < 0 || options->edge_radius_px > NEPH_IMAGE_SIDE_MAX_PX)
        return neph_fail(diag, NEPH_ERR_INPUT, "the radius of an edge mask must be 0..%d, not %d",
                         NEPH_IMAGE_SIDE_MAX_PX, options->edge_radius_px);
    return NEPH_OK;
}

static enum neph_status fail_sample(const char *mask, const char *channel, float value,
                                    size_t index, int width_px, struct neph_diag *diag)
{
    return neph_fail(diag, NEPH_ERR_GATE,
                     "the mask '%s' cannot be made: '%s' is %g at pixel (%zu, %zu)", mask, channel,
                     (double)value, index % (size_t)width_px, index / (size_t)width_px);
}

/* The index of the first invalid depth, or `count`. */
NEPH_VECTOR static size_t find_bad_depth(const float *depth_m, size_t count)
{
    uint32_t bad_count = 0;
    for (size_t i = 0; i < count; i++)
        bad_count += depth_m[i] >= 0.0f ? 0u : 1u; /* also true for NaN */
    if (bad_count == 0)
        return count;
    size_t first = 0;
    while (depth_m[first] >= 0.0f)
        first++;
    return first;
}

static enum neph_status find_depth(const struct neph_mask_kind *kind,
                                   const struct neph_image *image, struct source *source,
                                   struct neph_diag *diag)
{
    const float *depth_m = neph_image_channel(image, "Z");
    if (!depth_m)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "the mask '%s' needs the channel 'Z', which the reference has not",
                         kind->name);
    size_t bad = find_bad_depth(depth_m, neph_image_pixel_count(image));
    if (bad < neph_image_pixel_count(image))
        return fail_sample(kind->name, "Z", depth_m[bad], bad, image->width_px, diag);
    source->planes[0] = depth_m;
    return NEPH_OK;
}

static enum neph_status find_transmittance(const struct neph_mask_kind *kind,
                                           const struct neph_image *image, struct source *source,
                                           struct neph_diag *diag)
{
    float *planes[3];
    if (!neph_image_rgb(image, "transmittance", planes))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "the mask '%s' needs the layer 'transmittance', which the reference has "
                         "not",
                         kind->name);
    for (int c = 0; c < 3; c++) {
        for (size_t i = 0; i < neph_image_pixel_count(image); i++)
            if (!isfinite(planes[c][i]))
                return fail_sample(kind->name, "transmittance", planes[c][i], i, image->width_px,
                                   diag);
        source->planes[c] = planes[c];
    }
    return NEPH_OK;
}

static enum neph_status find_source(const struct neph_mask_kind *kind,
                                    const struct neph_image *image, struct source *source,
                                    struct neph_diag *diag)
{
    if (!kind->needs)
        return NEPH_OK;
    return strcmp(kind->needs, "Z") == 0 ? find_depth(kind, image, source, diag)
                                         : find_transmittance(kind, image, source, diag);
}

static enum neph_status create_empty(const char *name, const struct neph_image *image,
                                     struct neph_mask **mask, struct neph_diag *diag)
{
    struct neph_mask *created = calloc(1, sizeof(*created));
    if (!created)
        return neph_fail_memory(diag);
    snprintf(created->name, sizeof(created->name), "%s", name);
    created->width_px = image->width_px;
    created->height_px = image->height_px;
    created->inside = calloc(neph_image_pixel_count(image), sizeof(*created->inside));
    if (!created->inside) {
        neph_mask_destroy(created);
        return neph_fail_memory(diag);
    }
    *mask = created;
    return NEPH_OK;
}

NEPH_VECTOR static void count_inside(struct neph_mask *mask)
{
    const size_t all = (size_t)mask->width_px * (size_t)mask->height_px;
    const uint8_t *inside = mask->inside;
    size_t count = 0;
    for (size_t i = 0; i < all; i++)
        count += inside[i];
    mask->pixel_count = count;
}

/* ---- from channels --------------------------------------------------------------------------- */

static const char channel_prefix[] = "mask.";

static const char *name_of_channel(const char *channel)
{
    size_t length = sizeof(channel_prefix) - 1;
    return strncmp(channel, channel_prefix, length) == 0 && channel[length] ? channel + length
                                                                            : NULL;
}

const char *neph_mask_channel_at(const struct neph_image *image, int index)
{
    for (int i = 0; i < image->channel_count; i++) {
        const char *name = name_of_channel(image->channels[i].name);
        if (name && index-- == 0)
            return name;
    }
    return NULL;
}

static const struct neph_channel *find_channel(const struct neph_image *image, const char *mask)
{
    for (int i = 0; i < image->channel_count; i++) {
        const char *name = name_of_channel(image->channels[i].name);
        if (name && strcmp(name, mask) == 0)
            return &image->channels[i];
    }
    return NULL;
}

/* Add the pixels of a mask channel. */
static enum neph_status mark_channel(const struct neph_channel *channel, struct neph_mask *mask,
                                     struct neph_diag *diag)
{
    size_t all = (size_t)mask->width_px * (size_t)mask->height_px;
    for (size_t i = 0; i < all; i++) {
        if (isnan(channel->samples[i]))
            return fail_sample(mask->name, channel->name, channel->samples[i], i, mask->width_px,
                               diag);
        mask->inside[i] |= channel->samples[i] > 0.5f;
    }
    return NEPH_OK;
}

static enum neph_status create_from_channel(const struct neph_image *reference, const char *name,
                                            const struct neph_channel *channel,
                                            struct neph_mask **mask, struct neph_diag *diag)
{
    struct neph_mask *created = NULL;
    enum neph_status status = create_empty(name, reference, &created, diag);
    if (status)
        return status;
    status = mark_channel(channel, created, diag);
    if (status) {
        neph_mask_destroy(created);
        return status;
    }
    count_inside(created);
    *mask = created;
    return NEPH_OK;
}

enum neph_status neph_mask_from_image(const struct neph_image *image, const char *name,
                                      struct neph_mask **mask, struct neph_diag *diag)
{
    if (image->channel_count == 0)
        return neph_fail(diag, NEPH_ERR_INPUT, "the mask '%s' has no channel", name);
    struct neph_mask *created = NULL;
    enum neph_status status = create_empty(name, image, &created, diag);
    if (status)
        return status;
    for (int i = 0; i < image->channel_count && !status; i++)
        if (image->channel_count == 1 || strcmp(image->channels[i].name, "A") != 0)
            status = mark_channel(&image->channels[i], created, diag);
    if (status) {
        neph_mask_destroy(created);
        return status;
    }
    count_inside(created);
    *mask = created;
    return NEPH_OK;
}

enum neph_status neph_mask_unite(struct neph_mask *mask, const struct neph_mask *other,
                                 struct neph_diag *diag)
{
    if (mask->width_px != other->width_px || mask->height_px != other->height_px)
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "the mask '%s' is %dx%d pixels in one frame, %dx%d "
                         "in another",
                         mask->name, mask->width_px, mask->height_px, other->width_px,
                         other->height_px);
    const struct kind *kind = find_kind(mask->name);
    const bool never_an_edge = kind && kind->mark == mark_non_edge;
    size_t all = (size_t)mask->width_px * (size_t)mask->height_px;
    for (size_t i = 0; i < all; i++)
        mask->inside[i] = never_an_edge ? mask->inside[i] & other->inside[i]
                                        : mask->inside[i] | other->inside[i];
    count_inside(mask);
    return NEPH_OK;
}

/* ---- by name --------------------------------------------------------------------------------- */

static enum neph_status create_from_kind(const struct neph_image *reference,
                                         const struct kind *kind,
                                         const struct neph_mask_options *options,
                                         struct neph_mask **mask, struct neph_diag *diag)
{
    struct source source = {.kind = kind,
                            .width_px = reference->width_px,
                            .height_px = reference->height_px,
                            .options = options};
    enum neph_status status = find_source(&kind->described, reference, &source, diag);
    if (status)
        return status;
    struct neph_mask *created = NULL;
    status = create_empty(kind->described.name, reference, &created, diag);
    if (status)
        return status;
    status = kind->mark(&source, created->inside, diag);
    if (status) {
        neph_mask_destroy(created);
        return status;
    }
    count_inside(created);
    *mask = created;
    return NEPH_OK;
}

enum neph_status neph_mask_create(const struct neph_image *reference, const char *name,
                                  const struct neph_mask_options *options, struct neph_mask **mask,
                                  struct neph_diag *diag)
{
    const struct neph_mask_options defaults = NEPH_MASK_DEFAULTS;
    const struct neph_channel *channel = find_channel(reference, name);
    const struct kind *kind = find_kind(name);
    if (!channel && !kind) {
        neph_fail(diag, NEPH_ERR_USAGE, "there is no mask '%s'", name);
        neph_hint(diag, "a channel 'mask.%s' of the reference would make one", name);
        return NEPH_ERR_USAGE;
    }
    enum neph_status status = check_options(options ? options : &defaults, diag);
    if (status)
        return status;
    return channel ? create_from_channel(reference, name, channel, mask, diag)
                   : create_from_kind(reference, kind, options ? options : &defaults, mask, diag);
}

void neph_mask_destroy(struct neph_mask *mask)
{
    if (!mask)
        return;
    free(mask->inside);
    free(mask);
}
