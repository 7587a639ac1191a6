/* SPDX-License-Identifier: MIT */
#include "harness/compare/frame_labels.h"

#include "base/colour_space.h"
#include "metrics/validity.h"

#include <stdlib.h>
#include <string.h>

#define PLACE_HINT                                                                                 \
    "--window union or intersection compares them; or write data windows equal to the display "    \
    "window; the pixels outside are 0"
#define SPACE_HINT                                                                                 \
    "--convert converts both to linear Rec.709; if both are in one space, write both with the "    \
    "same colorInteropID and oiio:ColorSpace, or with neither"

static const struct label {
    const char *attribute; /* of an image, base/exr.h */
    const char *what, *usual, *hint;
    const char *same;   /* word for the message about a pair; NULL: pairs are checked elsewhere */
    bool is_of_colours; /* irrelevant without colours */
} labels[NEPH_FRAME_LABELS] = {
    {"crop", "the data window", "the whole image", PLACE_HINT, "place", false},
    {"pixel_aspect", "the pixel aspect ratio", "1", "render both with the same pixels", "place",
     false},
    {"colour_space", "the colour space", NEPH_COLOUR_SPACE_DEFAULT, SPACE_HINT, "light", true},
    {"white_luminance", "the luminance of white (whiteLuminance)", "not said",
     "write both with the same whiteLuminance, or with none", "light", true},
    {"encoding", "the encoding", "linear", "give display images, or linear data", NULL, false},
};

static const char *read_label_value(const struct label *label, const struct neph_image *image)
{
    const char *value = neph_image_attribute(image, label->attribute);
    float *rgb[3];
    const bool counts = !label->is_of_colours || neph_image_rgb(image, NULL, rgb);
    return value && counts ? value : label->usual;
}

enum neph_status neph_frame_check_pair(const struct neph_image *reference,
                                       const struct neph_image *other, struct neph_diag *diag)
{
    for (int i = 0; other && i < NEPH_FRAME_LABELS; i++) {
        const struct label *label = &labels[i];
        const char *first = read_label_value(label, reference),
                   *second = read_label_value(label, other);
        if (!label->same || strcmp(first, second) == 0)
            continue;
        neph_fail(diag, NEPH_ERR_INPUT,
                  "the images differ in the %s: %s of the reference is %s, of the other image %s",
                  label->same, label->what, first, second);
        neph_hint(diag, "%s", label->hint);
        return NEPH_ERR_INPUT;
    }
    return NEPH_OK;
}

/* ---- channels -------------------------------------------------------------------------------- */

static int by_text(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* Mask channels may be absent: a frame without one has no pixel in that mask, for example when the
 * sun is not visible. So may the distance of the medium, which is infinite without a medium. */
static bool must_be_in_all_frames(const char *name)
{
    return neph_validity_has_rule(name) && strncmp(name, "mask.", strlen("mask.")) != 0 &&
           strcmp(name, "volume.distance") != 0;
}

/* Sorted names of the channels that all frames must have, one on each line. */
static const char *list_channels(const struct neph_image *image, struct neph_arena *arena)
{
    const size_t count = (size_t)image->channel_count;
    const char **names = neph_arena_allocate(arena, count + 1, sizeof(*names));
    char *list = neph_arena_allocate(arena, count * NEPH_IMAGE_NAME_MAX + 1, 1), *end = list;
    size_t known = 0;
    if (!names || !list)
        return "";
    for (size_t i = 0; i < count; i++) {
        const char *name = image->channels[i].name;
        if (must_be_in_all_frames(name))
            names[known++] = name;
    }
    qsort(names, known, sizeof(*names), by_text);
    for (size_t i = 0; i < known; i++) {
        end = stpcpy(end, names[i]);
        *end++ = '\n';
    }
    return list;
}

/* Find the first line of `list` that `other` lacks; returns its length, or 0. */
static size_t first_missing(const char *list, const char *other, const char **line)
{
    while (*list) {
        const size_t length = strcspn(list, "\n");
        const char *at = other;
        while (*at && (strncmp(at, list, length) != 0 || at[length] != '\n'))
            at += strcspn(at, "\n") + 1;
        *line = list;
        if (!*at)
            return length;
        list += length + 1;
    }
    return 0;
}

static enum neph_status compare_channels(const struct neph_frame_form *form, const char *path,
                                         const char *channels, struct neph_diag *diag)
{
    const char *name = "", *with = form->path, *without = path;
    size_t length = first_missing(form->channels, channels, &name);
    if (length == 0) {
        with = path;
        without = form->path;
        length = first_missing(channels, form->channels, &name);
    }
    neph_fail(diag, NEPH_ERR_INPUT,
              "the channels change within the sequence: '%s' has %.*s, '%s' has not", with,
              (int)length, name, without);
    neph_hint(diag, "write all frames of a sequence with the same channels");
    return NEPH_ERR_INPUT;
}

static enum neph_status check_channels(struct neph_frame_form *form, const char *path,
                                       const struct neph_image *image, struct neph_diag *diag)
{
    struct neph_arena arena = {0};
    const char *channels = list_channels(image, form->channels ? &arena : &form->arena);
    enum neph_status status = neph_arena_check(form->channels ? &arena : &form->arena, diag);
    if (!form->channels)
        form->channels = channels;
    else if (!status && strcmp(form->channels, channels) != 0)
        status = compare_channels(form, path, channels, diag);
    neph_arena_finish(&arena);
    return status;
}

/* ---- the form -------------------------------------------------------------------------------- */

void neph_frame_form_finish(struct neph_frame_form *form)
{
    neph_arena_finish(&form->arena);
    *form = (struct neph_frame_form){.path = NULL};
}

static enum neph_status keep(struct neph_frame_form *form, const char *path,
                             const struct neph_image *image, struct neph_diag *diag)
{
    form->path = neph_arena_copy_text(&form->arena, path);
    form->width_px = image->width_px;
    form->height_px = image->height_px;
    for (int i = 0; i < NEPH_FRAME_LABELS; i++)
        form->labels[i] = neph_arena_copy_text(&form->arena, read_label_value(&labels[i], image));
    return neph_arena_check(&form->arena, diag);
}

static enum neph_status compare_labels(const struct neph_frame_form *form, const char *path,
                                       const struct neph_image *image, struct neph_diag *diag)
{
    for (int i = 0; i < NEPH_FRAME_LABELS; i++) {
        const char *value = read_label_value(&labels[i], image);
        if (strcmp(form->labels[i], value) == 0)
            continue;
        neph_fail(diag, NEPH_ERR_INPUT, "%s changes: it is %s in '%s' and %s in '%s'",
                  labels[i].what, form->labels[i], form->path, value, path);
        neph_hint(diag, "%s", labels[i].hint);
        return NEPH_ERR_INPUT;
    }
    if (form->width_px == image->width_px && form->height_px == image->height_px)
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_INPUT,
              "the size changes: it is %dx%d pixels in '%s' and %dx%d in '%s'", form->width_px,
              form->height_px, form->path, image->width_px, image->height_px, path);
    neph_hint(diag,
              neph_image_attribute(image, "crop") ? PLACE_HINT : "render all frames at one size");
    return NEPH_ERR_INPUT;
}

enum neph_status neph_frame_form_check(struct neph_frame_form *form, const char *path,
                                       const struct neph_image *image, bool with_channels,
                                       struct neph_diag *diag)
{
    const enum neph_status status = form->path ? compare_labels(form, path, image, diag)
                                               : keep(form, path, image, diag);
    return status || !with_channels ? status : check_channels(form, path, image, diag);
}
