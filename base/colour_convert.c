/* SPDX-License-Identifier: MIT */
#include "base/colour_convert.h"

#include "base/chromaticities.h"
#include "base/colour_space.h"
#include "base/exr_header.h"
#include "base/srgb.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum primaries {
    PRIMARIES_REC709,
    PRIMARIES_AP0,
    PRIMARIES_AP1,
    PRIMARIES_REC2020,
    PRIMARIES_P3D65,
    PRIMARIES_ADOBE,
    PRIMARIES_XYZ,
    PRIMARIES_COUNT,
};

/* SMPTE ST 2065-1:2021 and ACES S-2014-004 (their white is near D60), ITU-R BT.2020-2, SMPTE EG
 * 432-1 with the white D65, Adobe RGB (1998) 4.3.1. The primaries of CIE XYZ are its axes. */
static const double chromaticities[PRIMARIES_COUNT][8] = {
    [PRIMARIES_REC709] = {0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329},
    [PRIMARIES_AP0] = {0.7347, 0.2653, 0.0, 1.0, 0.0001, -0.077, 0.32168, 0.33767},
    [PRIMARIES_AP1] = {0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767},
    [PRIMARIES_REC2020] = {0.708, 0.292, 0.17, 0.797, 0.131, 0.046, 0.3127, 0.329},
    [PRIMARIES_P3D65] = {0.68, 0.32, 0.265, 0.69, 0.15, 0.06, 0.3127, 0.329},
    [PRIMARIES_ADOBE] = {0.64, 0.33, 0.21, 0.71, 0.15, 0.06, 0.3127, 0.329},
};

enum { CURVE_LINEAR, CURVE_SRGB, CURVE_GAMMA };

/* Identifiers of the Color Interop Forum,
 * https://github.com/AcademySoftwareFoundation/ColorInterop: the curve, the primaries, and the
 * state of the image. */
static const struct space {
    const char *id;
    enum primaries primaries;
    int curve;
    double gamma;
} spaces[] = {
    {"lin_rec709_scene", PRIMARIES_REC709, CURVE_LINEAR, 1.0},
    {"lin_ap0_scene", PRIMARIES_AP0, CURVE_LINEAR, 1.0},
    {"lin_ap1_scene", PRIMARIES_AP1, CURVE_LINEAR, 1.0},
    {"lin_rec2020_scene", PRIMARIES_REC2020, CURVE_LINEAR, 1.0},
    {"lin_p3d65_scene", PRIMARIES_P3D65, CURVE_LINEAR, 1.0},
    {"lin_adobergb_scene", PRIMARIES_ADOBE, CURVE_LINEAR, 1.0},
    {"lin_ciexyzd65_scene", PRIMARIES_XYZ, CURVE_LINEAR, 1.0},
    {"srgb_rec709_scene", PRIMARIES_REC709, CURVE_SRGB, 1.0},
    {"srgb_ap1_scene", PRIMARIES_AP1, CURVE_SRGB, 1.0},
    {"srgb_p3d65_scene", PRIMARIES_P3D65, CURVE_SRGB, 1.0},
    {"srgb_rec709_display", PRIMARIES_REC709, CURVE_SRGB, 1.0},
    {"srgb_p3d65_display", PRIMARIES_P3D65, CURVE_SRGB, 1.0},
    {"g18_rec709_scene", PRIMARIES_REC709, CURVE_GAMMA, 1.8},
    {"g22_rec709_scene", PRIMARIES_REC709, CURVE_GAMMA, 2.2},
    {"g22_ap1_scene", PRIMARIES_AP1, CURVE_GAMMA, 2.2},
    {"g22_adobergb_scene", PRIMARIES_ADOBE, CURVE_GAMMA, 2.2},
    {"g22_rec709_display", PRIMARIES_REC709, CURVE_GAMMA, 2.2},
    {"g24_rec709_display", PRIMARIES_REC709, CURVE_GAMMA, 2.4},
};
enum { SPACES = sizeof(spaces) / sizeof(spaces[0]) };

static enum neph_status refuse_name(const char *name, struct neph_diag *diag)
{
    char known[500] = "";
    for (size_t i = 0, used = 0; i < SPACES && used < sizeof(known); i++)
        used += (size_t)snprintf(known + used, sizeof(known) - used, " %s", spaces[i].id);
    neph_fail(diag, NEPH_ERR_INPUT, "the colour space '%s' cannot be converted", name);
    neph_hint(diag, "these can:%s; --ocio FILE adds the names of an OpenColorIO config", known);
    return NEPH_ERR_INPUT;
}

/* The chromaticities of the file's header. */
static bool find_chromaticities(const struct neph_image *image, double found[8])
{
    struct neph_exr_attribute attribute;
    const struct neph_file_header *header = image->header;
    for (size_t at = 0;
         header &&
         neph_exr_next_attribute(header->attributes, header->attribute_bytes, &at, &attribute);)
        if (strcmp(attribute.name, "chromaticities") == 0 && attribute.value_bytes == 32) {
            for (int i = 0; i < 8; i++)
                found[i] = (double)neph_exr_f32(attribute.value + 4 * i);
            return true;
        }
    return false;
}

/* From XYZ with white D65, by the inverse: the matrix to Rec. 709 of primaries that are the axes.
 * Their white is scaled to that of D65. */
static void find_xyz_matrix(double matrix[3][3])
{
    static const double axes[8] = {1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.3127, 0.329};
    double white[3];
    neph_matrix_to_rec709(axes, matrix);
    neph_xyz_from_xy(neph_rec709_chromaticities + 6, white);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            matrix[i][j] /= white[j];
}

static const struct space *find_name(const char *name)
{
    for (size_t i = 0; i < SPACES; i++)
        if (strcmp(spaces[i].id, name) == 0)
            return &spaces[i];
    return NULL;
}

static enum neph_status refuse_both(const char *primaries, const char *name, struct neph_diag *diag)
{
    neph_fail(diag, NEPH_ERR_INPUT,
              "the file has the chromaticities %s, which are not those of its colour space %s",
              primaries, name);
    neph_hint(diag, "write one of the two");
    return NEPH_ERR_INPUT;
}

/* Whether chromaticities are those of a named space. Writers round them to three digits. */
static bool is_same(const double found[8], const struct space *space)
{
    bool is_equal = space->primaries != PRIMARIES_XYZ;
    for (int i = 0; i < 8 && is_equal; i++)
        is_equal = fabs(found[i] - chromaticities[space->primaries][i]) <= 1e-3;
    return is_equal;
}

/* The space of the image, and its matrix to linear Rec. 709. */
static enum neph_status find_space(const struct neph_image *image, const struct space **space,
                                   double matrix[3][3], struct neph_diag *diag)
{
    const char *name = neph_image_attribute(image, "colour_space"),
               *primaries = neph_image_attribute(image, "primaries");
    double found[8];
    *space = name ? find_name(name) : &spaces[0];
    if (!*space)
        return refuse_name(name, diag);
    if (primaries && (!find_chromaticities(image, found) || !neph_matrix_to_rec709(found, matrix)))
        return neph_fail(diag, NEPH_ERR_INPUT, "the chromaticities %s are those of no RGB",
                         primaries);
    if (primaries && name && !is_same(found, *space))
        return refuse_both(primaries, name, diag);
    if (name && (*space)->primaries == PRIMARIES_XYZ)
        find_xyz_matrix(matrix);
    else if (name)
        neph_matrix_to_rec709(chromaticities[(*space)->primaries], matrix);
    return NEPH_OK;
}

static double decode(const struct space *space, double code)
{
    const double size = fabs(code);
    const double linear = space->curve == CURVE_SRGB    ? neph_srgb_to_linear(size)
                          : space->curve == CURVE_GAMMA ? pow(size, space->gamma)
                                                        : size;
    return copysign(linear, code);
}

static void convert_layer(const struct neph_image *image, const char *layer,
                          const struct space *space, double matrix[3][3])
{
    float *planes[3];
    if (!neph_image_rgb(image, layer, planes))
        return;
    for (size_t i = 0; i < neph_image_pixel_count(image); i++) {
        double rgb[3];
        for (int c = 0; c < 3; c++)
            rgb[c] = decode(space, (double)planes[c][i]);
        for (int c = 0; c < 3; c++)
            planes[c][i] = (float)(matrix[c][0] * rgb[0] + matrix[c][1] * rgb[1] +
                                   matrix[c][2] * rgb[2]);
    }
}

static enum neph_status finish(struct neph_image *image, const char *label, const char *origin,
                               struct neph_diag *diag)
{
    const enum neph_status status = neph_image_set_attribute(image, NEPH_CONVERTED_ATTRIBUTE, diag,
                                                             "%s%s%s", origin, label ? " of " : "",
                                                             label ? label : "");
    neph_image_remove_attribute(image, "colour_space");
    neph_image_remove_attribute(image, "primaries");
    return status;
}

static enum neph_status convert_known(struct neph_image *image, struct neph_diag *diag)
{
    const char *name = neph_image_attribute(image, "colour_space"),
               *primaries = neph_image_attribute(image, "primaries");
    const struct space *space = NULL;
    double matrix[3][3];
    if (!name && !primaries)
        return NEPH_OK;
    const enum neph_status status = find_space(image, &space, matrix, diag);
    if (status)
        return status;
    convert_layer(image, NULL, space, matrix);
    convert_layer(image, "volume", space, matrix);
    return finish(image, NULL, name ? name : primaries, diag);
}

/* ---- spaces of a source ---------------------------------------------------------------------- */

/* A name in the file, its identifier, and its space in the source; NULL: the source lacks it. */
struct name {
    const char *written, *space;
    char id[256];
};

/* The names of the file that identify a space, at most two. `lacking`: the source's message about
 * the first that it lacks. */
static enum neph_status list_names(const struct neph_image *image,
                                   const struct neph_colour_source *source, struct name names[2],
                                   int *count, struct neph_diag *lacking)
{
    static const char *const attributes[] = {"colorInteropID", "oiio:ColorSpace"};
    *count = 0;
    for (size_t i = 0; i < sizeof(attributes) / sizeof(attributes[0]); i++) {
        struct name *name = &names[*count];
        struct neph_diag later = {.line = 0};
        *name = (struct name){.written = neph_image_attribute(image, attributes[i])};
        if (!name->written)
            continue;
        neph_colour_space_id(name->written, name->id, sizeof(name->id));
        const enum neph_status status = source->find(source->context, name->written, &name->space,
                                                     lacking->message[0] ? &later : lacking);
        if (status && status != NEPH_ERR_INPUT)
            return status;
        *count += name->space || name->id[0];
    }
    return NEPH_OK;
}

static bool are_one_space(const struct name names[2])
{
    return names[0].space && names[1].space ? strcmp(names[0].space, names[1].space) == 0
                                            : strcmp(names[0].id, names[1].id) == 0;
}

/* The space of the file's names in the source. NULL: neph_colour_convert() itself has it, or the
 * file has no name. */
static enum neph_status find_in_source(const struct neph_image *image,
                                       const struct neph_colour_source *source, const char **space,
                                       struct neph_diag *diag)
{
    struct name names[2];
    struct neph_diag lacking = {.line = 0};
    int count;
    const enum neph_status status = list_names(image, source, names, &count, &lacking);
    if (status) {
        if (diag)
            *diag = lacking;
        return status;
    }
    *space = NULL;
    if (count == 2 && !are_one_space(names)) {
        neph_fail(diag, NEPH_ERR_INPUT, "the file names two colour spaces: '%s' and '%s'",
                  names[0].written, names[1].written);
        neph_hint(diag, "write one of the two");
        return NEPH_ERR_INPUT;
    }
    for (int i = 0; i < count && !*space; i++)
        *space = names[i].space;
    if (count == 0 || *space || find_name(names[0].id))
        return NEPH_OK;
    if (diag)
        *diag = lacking;
    return NEPH_ERR_INPUT;
}

static enum neph_status convert_by_source(struct neph_image *image,
                                          const struct neph_colour_source *source,
                                          const char *space, struct neph_diag *diag)
{
    static const char *const layers[] = {NULL, "volume"};
    const int size_px[2] = {image->width_px, image->height_px};
    enum neph_status status = NEPH_OK;
    for (size_t i = 0; i < sizeof(layers) / sizeof(layers[0]) && !status; i++) {
        float *planes[3];
        if (neph_image_rgb(image, layers[i], planes))
            status = source->convert(source->context, space, planes, size_px, diag);
    }
    return status ? status : finish(image, source->label, space, diag);
}

enum neph_status neph_colour_convert(struct neph_image *image,
                                     const struct neph_colour_source *source,
                                     struct neph_diag *diag)
{
    const char *space = NULL;
    const enum neph_status status = source ? find_in_source(image, source, &space, diag) : NEPH_OK;
    if (status)
        return status;
    return space ? convert_by_source(image, source, space, diag) : convert_known(image, diag);
}
