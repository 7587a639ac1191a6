/* SPDX-License-Identifier: MIT */
#include "base/colour_space.h"

#include "base/text.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

/* Synonyms of the identifiers: from OpenImageIO's documentation of oiio:ColorSpace, from the ACES
 * configurations of OpenColorIO, and from Blender. An empty identifier: the name identifies no
 * space. */
static const struct {
    const char *name, *id;
} names[] = {
    {"unknown", ""},
    {"scene_linear", ""},
    {"default", ""},
    {"linear", "lin_rec709_scene"},
    {"lin_rec709", "lin_rec709_scene"},
    {"lin_srgb", "lin_rec709_scene"},
    {"Linear Rec.709", "lin_rec709_scene"},
    {"Linear Rec.709 (sRGB)", "lin_rec709_scene"},
    {"Linear sRGB", "lin_rec709_scene"},
    {"Utility - Linear - sRGB", "lin_rec709_scene"},
    {"Utility - Linear - Rec.709", "lin_rec709_scene"},
    {"lin_ap1", "lin_ap1_scene"},
    {"ACEScg", "lin_ap1_scene"},
    {"ACES - ACEScg", "lin_ap1_scene"},
    {"lin_ap0", "lin_ap0_scene"},
    {"ACES2065-1", "lin_ap0_scene"},
    {"ACES - ACES2065-1", "lin_ap0_scene"},
    {"lin_rec2020", "lin_rec2020_scene"},
    {"Linear Rec.2020", "lin_rec2020_scene"},
    {"lin_p3d65", "lin_p3d65_scene"},
    {"lin_displayp3", "lin_p3d65_scene"},
    {"Linear P3-D65", "lin_p3d65_scene"},
    {"lin_adobergb", "lin_adobergb_scene"},
    {"Linear AdobeRGB", "lin_adobergb_scene"},
    {"sRGB", "srgb_rec709_scene"},
    {"srgb_texture", "srgb_rec709_scene"},
    {"raw", "data"},
    {"Non-Color", "data"},
};

void neph_colour_space_id(const char *name, char *id, size_t size)
{
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++)
        if (strcasecmp(names[i].name, name) == 0) {
            snprintf(id, size, "%s", names[i].id);
            return;
        }
    neph_text_format(id, size, "%s", name);
    for (char *c = id; *c; c++)
        *c = (char)tolower((unsigned char)*c);
}
