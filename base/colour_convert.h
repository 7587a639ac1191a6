/* SPDX-License-Identifier: MIT
 *
 * Conversion of colours to linear Rec. 709.
 */
#ifndef NEPH_BASE_COLOUR_CONVERT_H
#define NEPH_BASE_COLOUR_CONVERT_H

#include "base/image.h"

/* Attribute of a converted image: the space of its file. */
#define NEPH_CONVERTED_ATTRIBUTE "neph.converted_from"

/* Convert R G B and volume.R G B to linear Rec. 709 with white D65, from the chromaticities of the
 * file (base/exr.h), or from the space that it names: linear, sRGB or gamma curves of the primaries
 * Rec.709, ACES AP0 and AP1, Rec.2020, P3-D65 and Adobe RGB, and linear CIE XYZ with white D65, by
 * the identifiers of the Color Interop Forum (base/colour_space.h). White becomes white (Bradford's
 * adaptation); curves continue beyond 0..1, negative values mirrored. All in double. The attributes
 * "primaries" and "colour_space" are removed. An image of linear Rec. 709 is left as it is.
 *
 * NEPH_ERR_INPUT: another name, two names, or chromaticities beside a name of another space than
 * linear Rec. 709; the message lists the names. */
enum neph_status neph_colour_convert(struct neph_image *image, struct neph_diag *diag);

#endif
