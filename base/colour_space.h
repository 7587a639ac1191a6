/* SPDX-License-Identifier: MIT
 *
 * Colour spaces by the names that files give them: the identifiers of the ASWF's Color Interop
 * Forum (OpenEXR's attribute colorInteropID), and the names that OpenImageIO writes
 * (oiio:ColorSpace). Nothing is converted: names only say whether two frames are of one space.
 */
#ifndef NEPH_BASE_COLOUR_SPACE_H
#define NEPH_BASE_COLOUR_SPACE_H

#include <stddef.h>

/* What a frame is in when its file names no colour space: linear Rec.709, white D65. */
#define NEPH_COLOUR_SPACE_DEFAULT "lin_rec709_scene"

/* The identifier of a colour space into `id`, of `size` bytes: of names that mean the same it is
 * the same, whatever their case; an unknown name is its own, in small letters. "" for a name that
 * names no space: unknown, and roles of a configuration, such as scene_linear. */
void neph_colour_space_id(const char *name, char *id, size_t size);

#endif
