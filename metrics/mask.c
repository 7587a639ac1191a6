/* SPDX-License-Identifier: MIT */
#include "metrics/mask.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What a kind works on: the planes it asked for, already found and checked. */
struct source {
    int width_px, height_px;
    const float *planes[3]; /* Z; or the three of transmittance */
    const struct neph_mask_options *options;
};

typedef enum neph_status mark_function(const struct source *source, uint8_t *inside,
                                       struct neph_diag *diag);

static size_t pixel_count_of(const struct source *source)
{
    return (size_t)source->width_px * (size_t)source->height_px;
}

/* ---- the kinds ------------------------------------------------------------------------------- */

static enum neph_status mark_all(const struct source *source, uint8_t *inside,
                                 struct neph_diag *diag)
{
    (void)diag;
    memset(inside, 1, pixel_count_of(source));
    return NEPH_OK;
}

static enum neph_status mark_sky(const struct source *source, uint8_t *inside,
                                 struct neph_diag *diag)
{
    (void)diag;
    for (size_t i = 0; i < pixel_count_of(source); i++)
        inside[i] = isinf(source->planes[0][i]) ? 1 : 0;
    return NEPH_OK;
}

static enum neph_status mark_solid(const struct source *source, uint8_t *inside,
                                   struct neph_diag *diag)
{
    (void)diag;
    for (size_t i = 0; i < pixel_count_of(source); i++)
        inside[i] = isfinite(source->planes[0][i]) ? 1 : 0;
    return NEPH_OK;
}

static enum neph_status mark_medium(const struct source *source, uint8_t *inside,
                                    struct neph_diag *diag)
{
    (void)diag;
    double clear = exp(-source->options->medium_optical_depth);
    for (size_t i = 0; i < pixel_count_of(source); i++) {
        float least = fminf(source->planes[0][i],
                            fminf(source->planes[1][i], source->planes[2][i]));
        inside[i] = (double)least < clear ? 1 : 0;
    }
    return NEPH_OK;
}

/* Written without a division, so that it holds for a depth of 0 and for the sky: infinity lies
 * beyond any ratio of a solid, and not beyond itself. */
static bool is_step(float depth_m, float other_m, double ratio)
{
    double nearer_m = fmin((double)depth_m, (double)other_m);
    double farther_m = fmax((double)depth_m, (double)other_m);
    return farther_m > ratio * nearer_m;
}

static void mark_steps(const struct source *source, uint8_t *inside)
{
    const float *depth_m = source->planes[0];
    double ratio = source->options->edge_depth_ratio;
    size_t width = (size_t)source->width_px, height = (size_t)source->height_px;
    for (size_t y = 0; y < height; y++) {
        for (size_t x = 0; x < width; x++) {
            size_t here = y * width + x, right = here + 1, down = here + width;
            if (x + 1 < width && is_step(depth_m[here], depth_m[right], ratio))
                inside[here] = inside[right] = 1;
            if (y + 1 < height && is_step(depth_m[here], depth_m[down], ratio))
                inside[here] = inside[down] = 1;
        }
    }
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
    memset(inside, 0, width * height);
    mark_steps(source, inside);
    for (size_t y = 0; y < height; y++)
        dilate_line(inside + y * width, widened + y * width, width, 1, radius);
    for (size_t x = 0; x < width; x++)
        dilate_line(widened + x, inside + x, height, width, radius);
    free(widened);
    return NEPH_OK;
}

struct kind {
    struct neph_mask_kind described;
    mark_function *mark;
};

static const struct kind kinds[] = {
    {{"all", NULL, "every pixel"}, mark_all},
    {{"sky", "Z", "no solid behind the pixel: Z = +inf"}, mark_sky},
    {{"solid", "Z", "a solid behind the pixel: Z finite"}, mark_solid},
    {{"medium", "transmittance", "optical depth above 0.001 in at least one colour channel"},
     mark_medium},
    {{"depth_edge", "Z", "within 2 px of a step in depth: 4-neighbours with a ratio above 1.1"},
     mark_depth_edge},
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
                     "the mask '%s' cannot be made: '%s' of the reference is %g at pixel (%zu, "
                     "%zu)",
                     mask, channel, (double)value, index % (size_t)width_px,
                     index / (size_t)width_px);
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
    for (size_t i = 0; i < neph_image_pixel_count(image); i++)
        if (!(depth_m[i] >= 0.0f)) /* NaN too */
            return fail_sample(kind->name, "Z", depth_m[i], i, image->width_px, diag);
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

static enum neph_status create_empty(const struct kind *kind, const struct neph_image *image,
                                     struct neph_mask **mask, struct neph_diag *diag)
{
    struct neph_mask *created = calloc(1, sizeof(*created));
    if (!created)
        return neph_fail_memory(diag);
    created->name = kind->described.name;
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

enum neph_status neph_mask_create(const struct neph_image *reference, const char *name,
                                  const struct neph_mask_options *options, struct neph_mask **mask,
                                  struct neph_diag *diag)
{
    const struct neph_mask_options defaults = NEPH_MASK_DEFAULTS;
    struct source source = {.width_px = reference->width_px,
                            .height_px = reference->height_px,
                            .options = options ? options : &defaults};
    const struct kind *kind = find_kind(name);
    if (!kind)
        return neph_fail(diag, NEPH_ERR_USAGE, "there is no mask '%s'", name);
    enum neph_status status = check_options(source.options, diag);
    if (status)
        return status;
    status = find_source(&kind->described, reference, &source, diag);
    if (status)
        return status;
    struct neph_mask *created = NULL;
    status = create_empty(kind, reference, &created, diag);
    if (status)
        return status;
    status = kind->mark(&source, created->inside, diag);
    if (status) {
        neph_mask_destroy(created);
        return status;
    }
    for (size_t i = 0; i < pixel_count_of(&source); i++)
        created->pixel_count += created->inside[i];
    *mask = created;
    return NEPH_OK;
}

void neph_mask_destroy(struct neph_mask *mask)
{
    if (!mask)
        return;
    free(mask->inside);
    free(mask);
}
