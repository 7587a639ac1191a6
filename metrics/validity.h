/* SPDX-License-Identifier: MIT
 *
 * Gate G0: is this a frame at all? It comes before every other number, because public tools do
 * not look: idiff (OpenImageIO 2.4.7) passes an image with NaN pixels, FLIP shows them as black.
 */
#ifndef NEPH_METRICS_VALIDITY_H
#define NEPH_METRICS_VALIDITY_H

#include "base/hash.h"
#include "base/image.h"

struct neph_validity_pixel {
    int x_px, y_px;
};

struct neph_validity_channel {
    const char *name; /* the image's own string */
    size_t nan_count;
    size_t positive_infinity_count; /* 0 for distances, where +inf is the sky */
    size_t negative_infinity_count;
    size_t non_finite_count; /* the three together */
    size_t negative_count;   /* finite and below 0, where that has no meaning; -0 is not negative */
    struct neph_validity_pixel first_non_finite, first_negative; /* in reading order, if any */
    bool has_finite;                                             /* if not, min and max are 0 */
    float min, max;                                              /* of the finite values */
};

struct neph_validity {
    int channel_count;
    struct neph_validity_channel *channels; /* in the order of the image; owned */
    size_t non_finite_count;                /* NaN and infinities over all channels */
    size_t negative_count;
};

/* Whether a channel has a meaning for us (base/image.h): others may hold anything, such as the bits
 * of an object's name. */
bool neph_validity_knows(const char *channel);

/* Count. Radiance, volume, transmittance, variance and depth must not be negative; channels of
 * other names may have any sign. Free with _finish; the names live as long as the image. */
enum neph_status neph_validity_count(const struct neph_image *image, struct neph_validity *validity,
                                     struct neph_diag *diag);

/* A zeroed validity is fine. */
void neph_validity_finish(struct neph_validity *validity);

/* The gate: NEPH_ERR_GATE with the channel, the counts and the first bad pixel when anything is
 * not finite, or when more than `negative_allowed` values are negative (SIZE_MAX: any number, for
 * estimators that go below zero and are still unbiased). */
enum neph_status neph_validity_gate(const struct neph_validity *validity, size_t negative_allowed,
                                    struct neph_diag *diag);

/* NEPH_ERR_INPUT with both sizes when they differ. */
enum neph_status neph_validity_same_size(const struct neph_image *reference,
                                         const struct neph_image *test, struct neph_diag *diag);

/* NEPH_ERR_INPUT when the sets of channels differ, with what either side lacks. For two
 * configurations of one model; two engines may well give different layers. */
enum neph_status neph_validity_same_channels(const struct neph_image *reference,
                                             const struct neph_image *test, struct neph_diag *diag);

/* Frozen frames: a renderer that hangs gives the same frame again, and the steadiest of pictures.
 * Start from {0} and add every frame of a sequence in order. */
struct neph_frozen {
    int frame_count;
    int frozen_count;              /* frames that are identical to the one before, bit by bit */
    int first_frozen;              /* index of the first of them, if any */
    char last[NEPH_HASH_HEX_SIZE]; /* of the frame before */
};

/* A hash of size, names of channels and all samples; attributes (the time of rendering) are left
 * out. */
enum neph_status neph_frozen_hash(const struct neph_image *frame, char hex[NEPH_HASH_HEX_SIZE],
                                  struct neph_diag *diag);

/* `*is_frozen` (may be NULL): whether the frame is identical to the one added before. */
enum neph_status neph_frozen_add(struct neph_frozen *frozen, const struct neph_image *frame,
                                 bool *is_frozen, struct neph_diag *diag);

#endif
