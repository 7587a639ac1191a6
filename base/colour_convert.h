/* SPDX-License-Identifier: MIT
 *
 * Conversion of colours to linear Rec. 709.
 */
#ifndef NEPH_BASE_COLOUR_CONVERT_H
#define NEPH_BASE_COLOUR_CONVERT_H

#include "base/image.h"

/* Attribute of a converted image: the space of its file. */
#define NEPH_CONVERTED_ATTRIBUTE "neph.converted_from"

/* Colour spaces that a user's file defines (metrics/colour_config.h). Several threads call the
 * functions; a name is as in the frame's file. */
struct neph_colour_source {
    void *context;
    const char *label; /* of the user's file, for messages and attributes */
    /* Find the space of a name; `*space` belongs to the source. NEPH_ERR_INPUT: there is none; the
     * message lists similar names. */
    enum neph_status (*find)(void *context, const char *name, const char **space,
                             struct neph_diag *diag);
    /* Convert planes of a space that find() returned to linear Rec. 709, in place. NEPH_ERR_INPUT:
     * the space cannot be converted, or a result is not finite. */
    enum neph_status (*convert)(void *context, const char *space, float *const planes[3],
                                const int size_px[2], struct neph_diag *diag);
};

/* Convert R G B and volume.R G B to linear Rec. 709 with white D65, from the chromaticities of the
 * file (base/exr.h), or from the space that it names: linear, sRGB or gamma curves of the primaries
 * Rec.709, ACES AP0 and AP1, Rec.2020, P3-D65 and Adobe RGB, and linear CIE XYZ with white D65, by
 * the identifiers of the Color Interop Forum (base/colour_space.h). White becomes white (Bradford's
 * adaptation); curves continue beyond 0..1, negative values mirrored. All in double. The attributes
 * "primaries" and "colour_space" are removed. An image of linear Rec. 709 is left as it is.
 *
 * A name that `source` has is converted by the source instead, without the chromaticities beside
 * it. NULL: there is no source.
 *
 * NEPH_ERR_INPUT: another name, two names, or chromaticities beside a name of another space than
 * linear Rec. 709; the message lists the names. Errors of `source`. */
enum neph_status neph_colour_convert(struct neph_image *image,
                                     const struct neph_colour_source *source,
                                     struct neph_diag *diag);

#endif
