/* SPDX-License-Identifier: MIT
 *
 * Names of colour spaces in image files: the identifiers of the ASWF's Color Interop Forum
 * (OpenEXR's attribute colorInteropID), and the names that OpenImageIO writes (oiio:ColorSpace). No
 * colour is converted; names only decide whether two frames have the same colour space.
 */
#ifndef NEPH_BASE_COLOUR_SPACE_H
#define NEPH_BASE_COLOUR_SPACE_H

#include <stddef.h>

/* The colour space of a file that names none: linear Rec.709, white D65. */
#define NEPH_COLOUR_SPACE_DEFAULT "lin_rec709_scene"

/* Write the identifier of a colour space to `id`, of `size` bytes. Synonyms have the same
 * identifier, in any case of letters. An unknown name is its own identifier, in lower case. "" for
 * names that identify no space: "unknown", and roles of a configuration, such as scene_linear. */
void neph_colour_space_id(const char *name, char *id, size_t size);

#endif
