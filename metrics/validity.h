/* SPDX-License-Identifier: MIT
 *
 * Gate G0: checks that a frame contains valid values, before any other measurement. Public tools do
 * not check: idiff (OpenImageIO 2.4.7) accepts an image with NaN pixels, FLIP shows them as black.
 */
#ifndef NEPH_METRICS_VALIDITY_H
#define NEPH_METRICS_VALIDITY_H

#include "base/hash.h"
#include "base/image.h"

struct neph_validity_pixel {
    int x_px, y_px;
};

struct neph_validity_channel {
    const char *name; /* owned by the image */
    size_t nan_count;
    size_t positive_infinity_count; /* 0 for distances, where +inf is the sky */
    size_t negative_infinity_count;
    size_t non_finite_count; /* sum of the three */
    size_t negative_count;   /* finite and below 0, where that is invalid; -0 is not negative */
    struct neph_validity_pixel first_non_finite, first_negative; /* in reading order, if any */
    bool has_finite;                                             /* false: min and max are 0 */
    float min, max;                                              /* of the finite values */
};

struct neph_validity {
    int channel_count;
    struct neph_validity_channel *channels; /* in the order of the image; owned */
    size_t non_finite_count;                /* NaN and infinities over all channels */
    size_t negative_count;
};

/* Whether neph knows the meaning of a channel (base/image.h). Other channels may contain anything,
 * such as the bits of an object's name. */
bool neph_validity_has_rule(const char *channel);

/* Count invalid values. Radiance, volume, transmittance, variance and depth must not be negative;
 * other channels may have any sign. Free with neph_validity_finish(); the names live as long as the
 * image. */
enum neph_status neph_validity_count(const struct neph_image *image, struct neph_validity *validity,
                                     struct neph_diag *diag);

/* `validity` may be zeroed. */
void neph_validity_finish(struct neph_validity *validity);

/* The gate: NEPH_ERR_GATE, with the channel, the counts and the first bad pixel, if a value is not
 * finite or if more than `negative_allowed` values are negative (SIZE_MAX: any number, for unbiased
 * estimators that may be negative). */
enum neph_status neph_validity_gate(const struct neph_validity *validity, size_t negative_allowed,
                                    struct neph_diag *diag);

/* NEPH_ERR_INPUT, with both sizes, if they differ. */
enum neph_status neph_validity_same_size(const struct neph_image *reference,
                                         const struct neph_image *test, struct neph_diag *diag);

/* NEPH_ERR_INPUT, with the missing channels of both sides, if the sets of channels differ. For two
 * configurations of one model; different engines may give different layers. */
enum neph_status neph_validity_same_channels(const struct neph_image *reference,
                                             const struct neph_image *test, struct neph_diag *diag);

/* Detects frozen frames: a renderer that hangs repeats the same frame, which has no flicker at all.
 * Start from {0} and add every frame of a sequence in order. */
struct neph_frozen {
    int frame_count;
    int frozen_count; /* frames that are bitwise identical to their predecessor */
    int first_frozen; /* index of the first frozen frame, if any */
};

/* Whether two frames have the same size, channel names and samples, bit for bit. Attributes (such
 * as the render time) do not count. */
bool neph_frames_are_equal(const struct neph_image *a, const struct neph_image *b);

/* A hash of what neph_frames_are_equal() compares. */
enum neph_status neph_frozen_hash(const struct neph_image *frame, char hex[NEPH_HASH_HEX_SIZE],
                                  struct neph_diag *diag);

/* Add a frame; `previous` is the one before, NULL for the first. Returns whether both are equal. */
bool neph_frozen_add(struct neph_frozen *frozen, const struct neph_image *previous,
                     const struct neph_image *frame);

#endif
