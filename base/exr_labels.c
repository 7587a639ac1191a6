/* SPDX-License-Identifier: MIT */
#include "base/exr_labels.h"

#include "base/colour_space.h"
#include "base/exr_header.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Names with a meaning defined by the format. */
bool neph_exr_is_reserved(const char *name)
{
    static const char *const reserved[] = {
        "channels",          "compression", "dataWindow",
        "displayWindow",     "lineOrder",   "pixelAspectRatio",
        "chunkCount",        "name",        "screenWindowCenter",
        "screenWindowWidth", "type",        "tiles",
        "version",           "view",        "preview",
    };
    for (size_t i = 0; i < sizeof(reserved) / sizeof(reserved[0]); i++)
        if (strcmp(name, reserved[i]) == 0)
            return true;
    return false;
}

/* Names of derived attributes: a text of the file must not replace them. */
bool neph_exr_is_derived(const char *name)
{
    static const char *const ours[] = {
        "crop",         "primaries",       "pixel_aspect",     "encoding",
        "colour_space", "white_luminance", "frames_per_second"};
    for (size_t i = 0; i < sizeof(ours) / sizeof(ours[0]); i++)
        if (strcmp(name, ours[i]) == 0)
            return true;
    return false;
}

/* Copy the text of an attribute; false: it is not a text, or is too long. */
static bool read_text_attribute(const struct neph_exr_attribute *attribute, char *text, size_t size)
{
    if (strcmp(attribute->type, "string") != 0 || attribute->value_bytes >= size)
        return false;
    memcpy(text, attribute->value, attribute->value_bytes);
    text[attribute->value_bytes] = '\0';
    return true;
}

static double read_float_value(const unsigned char *value)
{
    return (double)neph_exr_f32(value);
}

static double read_int_value(const unsigned char *value)
{
    return (int32_t)neph_exr_u32(value);
}

static double read_rational_value(const unsigned char *value)
{
    return read_int_value(value) / neph_exr_u32(value + 4);
}

/* Parse "24", "23.976", "24000/1001"; NaN: not a number. */
static double parse_number_text(const char *text)
{
    char *end;
    const double number = strtod(text, &end);
    if (end == text || (*end && *end != '/'))
        return NAN;
    if (!*end)
        return number;
    const char *divisor_text = end + 1;
    const double divisor = strtod(divisor_text, &end);
    return end == divisor_text || *end ? NAN : number / divisor;
}

/* The numeric value of an attribute, in any of the types that writers use; NaN: not a number. */
static double read_number_attribute(const struct neph_exr_attribute *attribute)
{
    static const struct {
        const char *type;
        uint32_t bytes;
        double (*of)(const unsigned char *value);
    } types[] = {
        {"float", 4, read_float_value},
        {"double", 8, neph_exr_f64},
        {"int", 4, read_int_value},
        {"rational", 8, read_rational_value},
    };
    char text[64];
    for (size_t i = 0; i < sizeof(types) / sizeof(types[0]); i++)
        if (strcmp(attribute->type, types[i].type) == 0 && attribute->value_bytes == types[i].bytes)
            return types[i].of(attribute->value);
    return read_text_attribute(attribute, text, sizeof(text)) ? parse_number_text(text) : NAN;
}

/* Set colour_space if the name means another space than linear Rec.709. If the file names two
 * spaces, the attribute lists both. */
static enum neph_status add_colour_space(struct neph_image *image,
                                         const struct neph_exr_attribute *attribute,
                                         struct neph_diag *diag)
{
    char name[256], id[256];
    if (!read_text_attribute(attribute, name, sizeof(name)))
        return NEPH_OK;
    neph_colour_space_id(name, id, sizeof(id));
    const char *other = neph_image_attribute(image, "colour_space");
    if (!id[0] || strcmp(id, NEPH_COLOUR_SPACE_DEFAULT) == 0 || (other && strcmp(other, id) == 0))
        return NEPH_OK;
    return neph_image_set_attribute(image, "colour_space", diag, "%s%s%s", other ? other : "",
                                    other ? " and " : "", id);
}

static enum neph_status add_number(struct neph_image *image, const char *name, double number,
                                   struct neph_diag *diag)
{
    return isfinite(number) && number > 0.0
               ? neph_image_set_attribute(image, name, diag, "%.15g", number)
               : NEPH_OK;
}

/* Interpret the standard attributes that have another type or name than ours. */
static enum neph_status interpret_attribute(struct neph_image *image,
                                            const struct neph_exr_attribute *attribute,
                                            struct neph_diag *diag)
{
    const char *name = attribute->name;
    if (strcmp(name, "framesPerSecond") == 0)
        return add_number(image, "frames_per_second", read_number_attribute(attribute), diag);
    if (strcmp(name, "whiteLuminance") == 0)
        return add_number(image, "white_luminance", read_number_attribute(attribute), diag);
    if (strcmp(name, "colorInteropID") == 0 || strcmp(name, "oiio:ColorSpace") == 0)
        return add_colour_space(image, attribute, diag);
    return NEPH_OK;
}

enum neph_status neph_exr_interpret_attributes(const char *header, size_t size,
                                               struct neph_image *image, struct neph_diag *diag)
{
    struct neph_exr_attribute attribute;
    enum neph_status status = NEPH_OK;
    for (size_t at = 0; !status && neph_exr_next_attribute(header, size, &at, &attribute);)
        status = interpret_attribute(image, &attribute, diag);
    return status;
}

/* Whether an attribute is preserved as raw bytes: the image stores texts itself, and the writer
 * makes the reserved attributes. */
static bool is_preserved(const struct neph_exr_attribute *attribute)
{
    const bool is_text = strcmp(attribute->type, "string") == 0;
    if (neph_exr_is_reserved(attribute->name)) /* the view (left or right eye) is reserved, but a
                                                  text */
        return is_text && strcmp(attribute->name, "view") == 0;
    return !is_text;
}

size_t neph_exr_copy_preserved(const char *header, size_t size, char *kept)
{
    struct neph_exr_attribute attribute;
    size_t bytes = 0;
    for (size_t at = 0; neph_exr_next_attribute(header, size, &at, &attribute);) {
        if (!is_preserved(&attribute))
            continue;
        memcpy(kept + bytes, attribute.start, attribute.bytes);
        bytes += attribute.bytes;
    }
    return bytes;
}
