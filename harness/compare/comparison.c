/* SPDX-License-Identifier: MIT */
#include "harness/compare/comparison.h"

#include "base/colour_convert.h"
#include "base/files.h"
#include "base/interrupt.h"
#include "base/threads.h"
#include "base/video.h"
#include "harness/compare/alone.h"
#include "harness/compare/frame.h"
#include "harness/compare/frame_labels.h"
#include "harness/compare/maps.h"
#include "harness/compare/read_ahead.h"
#include "harness/progress.h"
#include "metrics/extractors/cycle_frequency.h"
#include "metrics/extractors/extractors.h"
#include "metrics/validity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { OVERLOOKED_COUNT = 3 };

/* The state of one comparison while its frames are measured. */
struct work {
    const struct neph_comparison *asked;
    struct neph_viewing viewing;
    int frame_count; /* frames to measure */
    int done_count;
    bool with_draws;
    bool is_picture;                                    /* display values, not physical ones */
    const struct neph_image *reference, *second, *test; /* the current frames; borrowed */
    struct neph_mask *masks[NEPH_MASKS_MAX];            /* owned unless has_masks_of_another */
    int mask_count;
    bool has_masks_of_another; /* of this pass */
    struct neph_meter *meter;  /* owned */
    struct neph_frozen frozen;
    struct neph_frame_form forms[3];       /* of reference, second reference and test; owned */
    bool has_overlooked[OVERLOOKED_COUNT]; /* in any frame so far */
    char strangers[400];                   /* names of unknown channels */
    char declared_cycles[512];             /* of the first test frame; or "" */
    struct neph_compared *made;
};

enum { AT_HAND_MAX = 4 * NEPH_COMPARISONS_MAX }; /* largest number of files for one frame */

/* Comparisons that process the frames together. */
struct pass {
    struct work *works;
    int work_count;
    struct neph_read_ahead *ahead; /* owned; NULL: every frame is read when it is needed */
    struct at_hand {
        const char *path; /* borrowed; NULL: free slot */
        struct neph_image *image;
    } at_hand[AT_HAND_MAX];
};

static bool is_picture(const struct neph_image *image)
{
    return neph_image_attribute(image, "encoding") != NULL;
}

/* ---- frames ---------------------------------------------------------------------------------- */

static enum neph_status check_counts(const struct neph_comparison *asked, struct work *work,
                                     struct neph_diag *diag)
{
    const int test = asked->test.count, reference = asked->reference.count;
    if (reference != 1 && reference != test)
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "%d reference frames for %d test frames: one for all, or as many",
                         reference, test);
    if (asked->second.count > 0 && asked->second.count != reference)
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "%d frames of the second reference, %d of the first: as many are needed",
                         asked->second.count, reference);
    enum neph_status status = NEPH_OK;
    if (!asked->by_position)
        status = neph_sequence_check_numbers(&asked->reference, "the reference", &asked->test,
                                             "the test", diag);
    if (!status && !asked->by_position)
        status = neph_sequence_check_numbers(&asked->reference, "the reference", &asked->second,
                                             "the second reference", diag);
    if (!status && asked->warm_up_frames >= test)
        status = neph_fail(diag, NEPH_ERR_INPUT,
                           "a warm-up of %d frames leaves nothing of a sequence of %d",
                           asked->warm_up_frames, test);
    work->frame_count = test - asked->warm_up_frames;
    return status;
}

/* The file of a frame; NULL: none. A single file is used for all frames. */
static const char *find_frame_path(const struct neph_sequence *sequence, int index)
{
    return sequence->count == 0 ? NULL : sequence->paths[sequence->count == 1 ? 0 : index];
}

static const struct neph_image *test_in_memory(const struct neph_comparison *asked, int index)
{
    return asked->test_images ? asked->test_images[index] : NULL;
}

/* Find the loaded image of a file; NULL: not loaded. `path` NULL finds a free slot. */
static struct at_hand *find_at_hand(struct pass *pass, const char *path)
{
    for (int i = 0; i < AT_HAND_MAX; i++) {
        struct at_hand *held = &pass->at_hand[i];
        if (path ? held->path && strcmp(held->path, path) == 0 : !held->path)
            return held;
    }
    return NULL;
}

/* Whether a frame needs a file; the test of the frame before it is compared with its test. */
static bool needs_file(const struct neph_comparison *asked, const char *path, int index)
{
    const int before = index > asked->warm_up_frames ? index - 1 : index;
    const char *const paths[] = {
        find_frame_path(&asked->reference, index), find_frame_path(&asked->second, index),
        test_in_memory(asked, index) ? NULL : find_frame_path(&asked->test, index),
        test_in_memory(asked, before) ? NULL : find_frame_path(&asked->test, before)};
    for (int i = 0; i < 4; i++)
        if (paths[i] && strcmp(paths[i], path) == 0)
            return true;
    return false;
}

/* Free the images that the current frame does not need, before more are read. */
static void release_unneeded_frames(struct pass *pass, int index)
{
    for (int i = 0; i < AT_HAND_MAX; i++) {
        struct at_hand *held = &pass->at_hand[i];
        bool is_needed = false;
        for (int w = 0; w < pass->work_count && held->path; w++)
            is_needed |= needs_file(pass->works[w].asked, held->path, index);
        if (is_needed)
            continue;
        neph_image_destroy(held->image);
        *held = (struct at_hand){.path = NULL};
    }
}

/* The image of a file, read at first use; `path` NULL gives NULL. */
static enum neph_status take_frame(struct pass *pass, const struct neph_comparison *asked,
                                   const char *path, const struct neph_image **image,
                                   struct neph_diag *diag)
{
    struct at_hand *held = path ? find_at_hand(pass, path) : NULL;
    struct neph_image *read = NULL;
    if (!path || held) {
        *image = held ? held->image : NULL;
        return NEPH_OK;
    }
    const enum neph_status status = neph_read_ahead_take(pass->ahead, asked->source, path,
                                                         &asked->frame_choice,
                                                         asked->negative_allowed, &read, diag);
    if (status)
        return status;
    *find_at_hand(pass, NULL) = (struct at_hand){path, read};
    *image = read;
    return NEPH_OK;
}

/* The number of frames to read ahead, from the size of those at hand. */
static int count_frames_ahead(const struct pass *pass)
{
    enum { FRAMES_MAX = 4 };
    static const double limit_bytes = 0x1p30;
    double bytes = 0.0;
    for (int i = 0; i < AT_HAND_MAX; i++) {
        const struct neph_image *image = pass->at_hand[i].image;
        if (image)
            bytes += (double)neph_image_pixel_count(image) * image->channel_count * sizeof(float);
    }
    return (int)fmin(fmin(FRAMES_MAX, neph_thread_count()), limit_bytes / fmax(bytes, 1.0));
}

static void start_file(struct pass *pass, const struct neph_comparison *asked, const char *path)
{
    if (path && !find_at_hand(pass, path))
        neph_read_ahead_start(pass->ahead, asked->source, path, &asked->frame_choice,
                              asked->negative_allowed);
}

/* Start to read the files of the frames after `index`. */
static void read_ahead(struct pass *pass, int index)
{
    const int last = index + (pass->ahead ? count_frames_ahead(pass) : 0);
    for (int next = index + 1; next <= last && next < pass->works[0].asked->test.count; next++)
        for (int w = 0; w < pass->work_count; w++) {
            const struct neph_comparison *asked = pass->works[w].asked;
            start_file(pass, asked, find_frame_path(&asked->reference, next));
            start_file(pass, asked, find_frame_path(&asked->second, next));
            if (!test_in_memory(asked, next))
                start_file(pass, asked, find_frame_path(&asked->test, next));
        }
}

static enum neph_status read_frames(struct pass *pass, struct work *work, int index,
                                    struct neph_diag *diag)
{
    const struct neph_comparison *asked = work->asked;
    enum neph_status status = take_frame(pass, asked, find_frame_path(&asked->reference, index),
                                         &work->reference, diag);
    if (!status)
        status = take_frame(pass, asked, find_frame_path(&asked->second, index), &work->second,
                            diag);
    work->test = test_in_memory(asked, index);
    if (!status && !work->test)
        status = take_frame(pass, asked, find_frame_path(&asked->test, index), &work->test, diag);
    return status;
}

static enum neph_status check_kinds(const struct work *work, struct neph_diag *diag)
{
    enum neph_status status = neph_frame_check_pair(work->reference, work->test, diag);
    if (!status)
        status = neph_frame_check_pair(work->reference, work->second, diag);
    if (status)
        return status;
    if (work->second && is_picture(work->second) != is_picture(work->reference))
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "one of the two references is a display image, the other is linear data");
    if (is_picture(work->reference) != is_picture(work->test))
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "%s is a display image, %s is linear data: they have no common scale",
                         is_picture(work->test) ? "the test" : "the reference",
                         is_picture(work->test) ? "the reference" : "the test");
    if (is_picture(work->test) && work->viewing.exposure_ev != 0.0)
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "an exposure of %g EV for display images, which have one already",
                         work->viewing.exposure_ev);
    return NEPH_OK;
}

/* Append a name to a line if there is room. */
static void append(char *line, size_t size, const char *name)
{
    const size_t used = strlen(line);
    snprintf(line + used, size - used, " %s", name);
}

/* The channels of an image in one line, at most the first eight. */
static void list_channels(const struct neph_image *image, char *text, size_t size)
{
    enum { SHOWN_MAX = 8 };
    for (int c = 0; c < image->channel_count && c < SHOWN_MAX; c++)
        append(text, size, image->channels[c].name);
    if (image->channel_count > SHOWN_MAX)
        append(text, size, "...");
}

static bool has_quantity(const struct neph_image *image, const struct neph_quantity *quantity)
{
    const float *planes[3];
    return neph_quantity_planes(quantity, image, planes);
}

/* Refuse a comparison without any common quantity, and one in which only one side has radiance:
 * both would pass every gate. Other one-sided quantities are listed as not taken. */
static enum neph_status check_channels(const struct neph_image *reference,
                                       const struct neph_image *test, struct neph_diag *diag)
{
    char in_reference[160] = "", in_test[160] = "";
    const bool both_or_none = has_quantity(reference, neph_quantity_at(0)) ==
                              has_quantity(test, neph_quantity_at(0));
    for (int q = 0; q < neph_quantity_count() && both_or_none; q++)
        if (has_quantity(reference, neph_quantity_at(q)) && has_quantity(test, neph_quantity_at(q)))
            return NEPH_OK;
    list_channels(reference, in_reference, sizeof(in_reference));
    list_channels(test, in_test, sizeof(in_test));
    neph_fail(diag, NEPH_ERR_INPUT, "%s: the channels of the reference are%s, of the test%s",
              both_or_none ? "nothing can be compared" : "only one of the two has radiance",
              in_reference, in_test);
    neph_hint(diag,
              "radiance is in channels R G B (r g b, red green blue, rgba.R ...), or in Y, L or "
              "R alone; --layer NAME reads NAME.R NAME.G NAME.B");
    return NEPH_ERR_INPUT;
}

/* ---- masks ----------------------------------------------------------------------------------- */

/* Destroy the masks without a wanted number. The first mask is kept for numbers of the whole
 * frame. */
static void drop_unwanted_masks(struct work *work)
{
    int kept = 0;
    for (int i = 0; i < work->mask_count; i++)
        if (i == 0 || neph_meter_is_wanted(work->asked->wanted, NULL, work->masks[i]->name))
            work->masks[kept++] = work->masks[i];
        else
            neph_mask_destroy(work->masks[i]);
    work->mask_count = kept;
}

/* Add the file's name to an error about one of many frames. */
static enum neph_status name_file(enum neph_status status, const char *path, struct neph_diag *diag)
{
    if (status == NEPH_ERR_INPUT)
        neph_prefix(diag, "'%s': ", path);
    return status;
}

/* Check that a frame has the properties of its sequence. */
static enum neph_status check_form(struct neph_frame_form *form,
                                   const struct neph_sequence *sequence, int index,
                                   const struct neph_image *image, struct neph_diag *diag)
{
    return sequence->count > 1
               ? neph_frame_form_check(form, sequence->paths[index], image, true, diag)
               : NEPH_OK;
}

static enum neph_status add_frame_masks(struct work *work, int index, struct neph_diag *diag)
{
    struct neph_image *frame = NULL;
    const struct neph_sequence *reference = &work->asked->reference;
    const char *path = reference->paths[index];
    const struct neph_frame_source *source = work->asked->source;
    enum neph_status status = source->read(source->context, path, &work->asked->frame_choice,
                                           SIZE_MAX, &frame, diag);
    if (!status)
        status = check_form(&work->forms[0], reference, index, frame, diag);
    if (!status)
        status = name_file(neph_masks_unite(frame, work->masks, work->mask_count, diag), path,
                           diag);
    neph_image_destroy(frame);
    return status;
}

/* Make masks for the whole sequence: the union over its reference frames, so that a number covers
 * the same pixels in all frames. */
static enum neph_status unite_masks(struct work *work, struct neph_diag *diag)
{
    const struct neph_comparison *asked = work->asked;
    char *const *paths = asked->reference.paths + asked->warm_up_frames;
    enum neph_status status = NEPH_OK;
    for (int i = 1; i < work->frame_count && !status; i++) {
        if (strcmp(paths[i], paths[i - 1]) != 0) /* equal consecutive files have equal masks */
            status = add_frame_masks(work, asked->warm_up_frames + i, diag);
        if (!status && neph_interrupted())
            status = neph_fail(diag, NEPH_ERR_INTERRUPTED, "interrupted");
    }
    return status;
}

static enum neph_status add_file_mask(struct work *work, struct neph_diag *diag)
{
    struct neph_image *picture = NULL;
    const struct neph_frame_source *source = work->asked->source;
    enum neph_status status = source->read_mask(source->context, work->asked->mask_file,
                                                &work->asked->frame_choice, &picture, diag);
    if (!status && work->mask_count == NEPH_MASKS_MAX)
        status = neph_fail(diag, NEPH_ERR_INPUT, "more than %d masks", NEPH_MASKS_MAX);
    if (!status)
        status = neph_mask_from_image(picture, "file", &work->masks[work->mask_count], diag);
    if (!status)
        work->mask_count++;
    if (!status && work->masks[work->mask_count - 1]->pixel_count == 0)
        status = neph_fail(diag, NEPH_ERR_INPUT, "the mask '%s' is empty: no pixel is above 0.5",
                           work->asked->mask_file);
    neph_image_destroy(picture);
    return status;
}

static enum neph_status make_masks(struct work *work, struct neph_diag *diag)
{
    const struct neph_comparison *asked = work->asked;
    enum neph_status status = neph_masks_create(work->reference, asked->detail_masks, work->masks,
                                                &work->mask_count, diag);
    if (!status)
        drop_unwanted_masks(work);
    if (!status && asked->reference.count > 1 && work->mask_count > 1)
        status = unite_masks(work, diag);
    work->mask_count = neph_masks_trim(work->masks, work->mask_count);
    if (!status && asked->mask_file)
        status = add_file_mask(work, diag);
    return status;
}

/* Use the masks of another comparison of the pass if they are the same; otherwise make them. */
static enum neph_status ensure_masks(const struct pass *pass, struct work *work,
                                     struct neph_diag *diag)
{
    const struct neph_comparison *asked = work->asked;
    for (const struct work *other = pass->works; other < work; other++) {
        const struct neph_comparison *its = other->asked;
        if (its->reference.paths != asked->reference.paths || its->wanted != asked->wanted ||
            its->detail_masks != asked->detail_masks || its->mask_file != asked->mask_file)
            continue;
        memcpy(work->masks, other->masks, sizeof(work->masks));
        work->mask_count = other->mask_count;
        work->has_masks_of_another = true;
        return NEPH_OK;
    }
    return make_masks(work, diag);
}

/* Report a missing mask at the first frame, not after all frames are measured. */
static enum neph_status check_mask(const struct work *work, struct neph_diag *diag)
{
    char names[400] = "";
    for (int i = 0; i < work->mask_count; i++) {
        const char *name = work->masks[i]->name;
        if (!work->asked->mask || strcmp(name, work->asked->mask) == 0)
            return NEPH_OK;
        append(names, sizeof(names), name);
    }
    neph_fail(diag, NEPH_ERR_UNSUPPORTED,
              "nothing to measure over the mask '%s': the reference has no such pixels, or nothing "
              "else, or lacks the layer that it is made from",
              work->asked->mask);
    neph_hint(diag, "masks of this reference:%s; `neph metrics --masks` lists the needs of each",
              names);
    return NEPH_ERR_UNSUPPORTED;
}

/* ---- maps ------------------------------------------------------------------------------------ */

/* Write DIR/NAME_QUANTITY[_FRAME].exr and .png, and record their names. */
static enum neph_status write_map_files(struct work *work, const struct neph_map *map,
                                        const struct neph_quantity *quantity, int frame,
                                        const struct neph_image *image, struct neph_diag *diag)
{
    struct neph_compared *made = work->made;
    const struct neph_path stem = neph_map_stem(work->asked->maps_directory, map, quantity,
                                                work->frame_count > 1 ? frame : -1);
    const char **longer = realloc(made->maps, ((size_t)made->map_count + 2) * sizeof(*longer));
    if (!longer)
        return neph_fail_memory(diag);
    made->maps = longer;
    const char *exr = neph_arena_format(&made->arena, "%s.exr", stem.text),
               *png = neph_arena_format(&made->arena, "%s.png", stem.text);
    enum neph_status status = neph_arena_check(&made->arena, diag);
    if (!status)
        status = neph_map_write(exr, png, map, &work->viewing, image, diag);
    if (!status) {
        made->maps[made->map_count++] = exr;
        made->maps[made->map_count++] = png;
    }
    return status;
}

static enum neph_status send_map(struct work *work, const struct neph_quantity *quantity,
                                 const struct neph_extractor *extractor, int index, int frame,
                                 struct neph_diag *diag)
{
    const struct neph_comparison *asked = work->asked;
    const struct neph_map *map = &extractor->maps[index];
    struct neph_image *image = NULL;
    enum neph_status status = neph_meter_map(work->meter, quantity, extractor, index, &image, diag);
    if (!status && asked->take_map)
        status = asked->take_map(asked->map_context, map, quantity, frame, image, diag);
    if (!status && asked->maps_directory)
        status = write_map_files(work, map, quantity, frame, image, diag);
    neph_image_destroy(image);
    return status;
}

/* Output the maps of the current frame, or of the sequence (frame < 0). */
static enum neph_status send_maps(struct work *work, int frame, struct neph_diag *diag)
{
    const bool is_wanted = work->asked->maps_directory || work->asked->take_map;
    enum neph_status status = NEPH_OK;
    for (int c = 0; is_wanted && c < work->asked->choice_count; c++) {
        const struct neph_extractor *extractor = work->asked->choices[c].extractor;
        if (extractor->temporal != (frame < 0))
            continue;
        for (int q = 0; q < neph_quantity_count(); q++) {
            const struct neph_quantity *quantity = neph_quantity_at(q);
            if (neph_meter_obstacle(work->meter, quantity, extractor))
                continue;
            for (int m = 0; m < extractor->map_count && !status; m++) {
                const unsigned shown = extractor->maps[m].quantities;
                if (extractor->maps[m].name && (shown == 0 || shown & (unsigned)quantity->bit))
                    status = send_map(work, quantity, extractor, m, frame, diag);
            }
        }
    }
    return status;
}

/* ---- the run --------------------------------------------------------------------------------- */

/* Take the frame rate that the test states, else the reference's, unless the user set one. */
static void take_frame_rate(struct work *work)
{
    double rate_hz = neph_frame_rate_hz(work->test);
    if (isnan(rate_hz))
        rate_hz = neph_frame_rate_hz(work->reference);
    if (work->asked->own_frame_rate && !isnan(rate_hz))
        work->viewing.frame_rate_hz = rate_hz;
}

/* Parts of a frame that no metric uses. */
static const struct overlooked {
    const char *channel, *attribute; /* one of the two */
    const char *what, *because;
} overlooked[OVERLOOKED_COUNT] = {
    {"A", NULL, "alpha", "R G B are compared as they are, and no metric reads A"},
    {"vector.Z", NULL, "channel Z", "beside X and Y it is no depth"},
    {NULL, "pixel_aspect", "the pixel aspect ratio", "pixels are taken for square"},
};

static void record_ignored_data(struct work *work, const struct neph_image *image)
{
    for (int i = 0; i < OVERLOOKED_COUNT; i++)
        work->has_overlooked[i] |= overlooked[i].channel
                                       ? neph_image_channel(image, overlooked[i].channel) != NULL
                                       : neph_image_attribute(image, overlooked[i].attribute) !=
                                             NULL;
}

static bool is_unknown_channel(const char *channel)
{
    return !neph_validity_has_rule(channel) && strcmp(channel, "A") != 0 &&
           strncmp(channel, "vector.", strlen("vector.")) != 0;
}

/* Record the unknown channels of the first test frame, at most six. */
static void record_unknown_channels(struct work *work, const struct neph_image *image)
{
    enum { SHOWN_MAX = 6 };
    char more[32];
    int count = 0;
    for (int c = 0; c < image->channel_count; c++)
        if (is_unknown_channel(image->channels[c].name) && ++count <= SHOWN_MAX)
            append(work->strangers, sizeof(work->strangers), image->channels[c].name);
    snprintf(more, sizeof(more), "and %d more", count - SHOWN_MAX);
    if (count > SHOWN_MAX)
        append(work->strangers, sizeof(work->strangers), more);
}

static enum neph_status check_forms(struct work *work, int index, struct neph_diag *diag)
{
    const struct neph_comparison *asked = work->asked;
    enum neph_status status = check_form(&work->forms[0], &asked->reference, index, work->reference,
                                         diag);
    if (!status)
        status = check_form(&work->forms[1], &asked->second, index, work->second, diag);
    if (!status)
        status = check_form(&work->forms[2], &asked->test, index, work->test, diag);
    return status;
}

static const char *copy_attribute(struct neph_compared *made, const struct neph_image *image,
                                  const char *name)
{
    const char *text = neph_image_attribute(image, name);
    return text ? neph_arena_copy_text(&made->arena, text) : NULL;
}

/* Record how the files were read. */
static void record_reading(struct neph_compared *made, const struct neph_image *reference,
                           const struct neph_image *test)
{
    made->reference_video = copy_attribute(made, reference, NEPH_VIDEO_ATTRIBUTE);
    made->test_video = copy_attribute(made, test, NEPH_VIDEO_ATTRIBUTE);
    made->reference_space = copy_attribute(made, reference, NEPH_CONVERTED_ATTRIBUTE);
    made->test_space = copy_attribute(made, test, NEPH_CONVERTED_ATTRIBUTE);
}

/* Set up a comparison with its first frame. */
static enum neph_status begin_work(const struct pass *pass, struct work *work,
                                   struct neph_diag *diag)
{
    const char *declared = neph_image_attribute(work->test, NEPH_CYCLE_ATTRIBUTE);
    snprintf(work->declared_cycles, sizeof(work->declared_cycles), "%s", declared ? declared : "");
    record_unknown_channels(work, work->test);
    record_reading(work->made, work->reference, work->test);
    work->is_picture = is_picture(work->reference);
    take_frame_rate(work);
    work->made->movement.gain = exp2(work->viewing.exposure_ev);
    enum neph_status status = check_channels(work->reference, work->test, diag);
    if (!status)
        status = ensure_masks(pass, work, diag);
    if (!status)
        status = check_mask(work, diag);
    if (status)
        return status;
    const struct neph_meter_params params = {
        .choices = work->asked->choices,
        .choice_count = work->asked->choice_count,
        .viewing = work->viewing,
        .masks = (const struct neph_mask *const *)work->masks,
        .mask_count = work->mask_count,
        .wanted = work->asked->wanted,
        .frame_count = work->frame_count,
        .intervals = !work->asked->plain,
        .draws = work->with_draws,
    };
    return neph_meter_create(&params, &work->meter, diag);
}

static enum neph_status add_movement(struct work *work, struct neph_diag *diag)
{
    const double *luma[2];
    const bool is_known = neph_meter_display_luma(work->meter, neph_quantity_find("radiance"),
                                                  &luma[0], &luma[1]);
    return neph_movement_add(&work->made->movement, work->reference, work->test,
                             is_known ? luma : NULL, diag);
}

static bool measures_error(const struct neph_comparison *asked)
{
    for (int c = 0; c < asked->choice_count; c++)
        if (asked->choices[c].extractor == &neph_extractor_error)
            return true;
    return false;
}

/* Measure a frame. The histogram and the meter stop at Ctrl-C: the histogram is counted first and
 * kept last, so that both end with the same frame. */
static enum neph_status measure_frame(struct pass *pass, struct work *work, int frame,
                                      struct neph_diag *diag)
{
    const int index = work->asked->warm_up_frames + frame;
    const char *path = work->asked->test.paths[index];
    const struct neph_image *before = frame > 0 ? work->test : NULL;
    enum neph_status status = read_frames(pass, work, index, diag);
    if (!status && work == &pass->works[pass->work_count - 1])
        read_ahead(pass, index);
    if (!status)
        status = check_forms(work, index, diag);
    if (!status)
        status = name_file(check_kinds(work, diag), path, diag);
    if (!status && frame == 0)
        status = begin_work(pass, work, diag);
    if (!status) {
        record_ignored_data(work, work->reference);
        record_ignored_data(work, work->test);
    }
    if (!status && work == pass->works) /* all comparisons have the same test frames */
        neph_frozen_add(&work->frozen, before, work->test);
    work->frozen = pass->works[0].frozen;
    work->made->has_largest_error = measures_error(work->asked);
    struct neph_error_histogram histogram = work->made->histogram;
    if (!status && work->made->has_largest_error && work->asked->with_histogram)
        status = neph_histogram_add(&histogram, work->reference, work->test, diag);
    if (!status)
        status = name_file(
            neph_meter_frame(work->meter, work->reference, work->second, work->test, diag), path,
            diag);
    if (!status && work->asked->with_movement)
        status = add_movement(work, diag);
    if (!status && work->made->has_largest_error)
        neph_largest_error_add(&work->made->largest_error, work->reference, work->test, frame);
    if (!status)
        status = send_maps(work, frame, diag);
    if (!status)
        work->made->histogram = histogram;
    work->done_count += !status;
    return status;
}

static enum neph_status measure_all(struct pass *pass, struct neph_diag *diag)
{
    const struct neph_comparison *asked = pass->works[0].asked;
    const int frame_count = pass->works[0].frame_count;
    struct neph_progress progress = neph_progress_start(asked->quiet || frame_count == 1,
                                                        frame_count);
    enum neph_status status = NEPH_OK;
    for (int frame = 0; frame < frame_count && !status; frame++) {
        const char *path = asked->test.paths[asked->warm_up_frames + frame];
        neph_progress_begin(&progress, path);
        if (neph_interrupted())
            status = neph_fail(diag, NEPH_ERR_INTERRUPTED, "interrupted");
        else
            release_unneeded_frames(pass, asked->warm_up_frames + frame);
        for (int w = 0; w < pass->work_count && !status; w++)
            status = measure_frame(pass, &pass->works[w], frame, diag);
        if (!status)
            neph_progress_tick(&progress, path);
    }
    neph_progress_end(&progress);
    return status;
}

/* ---- results --------------------------------------------------------------------------------- */

static void add_not_measured(struct neph_compared *made, const char *extractor,
                             const char *quantity, const char *because)
{
    made->not_taken[made->not_taken_count++] = (struct neph_not_taken){extractor, quantity,
                                                                       because};
}

/* List the quantities that only one of the two images has. */
static void add_one_sided(const struct work *work)
{
    for (int q = 0; q < neph_quantity_count() && work->reference && work->test; q++) {
        const struct neph_quantity *quantity = neph_quantity_at(q);
        if (has_quantity(work->reference, quantity) != has_quantity(work->test, quantity))
            add_not_measured(work->made, "everything", quantity->name,
                             work->asked->without_reference ? "only one of the two sequences has it"
                             : has_quantity(work->test, quantity) ? "the reference does not have it"
                                                                  : "the test does not have it");
    }
}

static void report_ignored_data(const struct work *work)
{
    for (int i = 0; i < OVERLOOKED_COUNT; i++)
        if (work->has_overlooked[i])
            add_not_measured(work->made, "everything", overlooked[i].what, overlooked[i].because);
    if (work->strangers[0])
        add_not_measured(
            work->made, "everything",
            neph_arena_format(&work->made->arena, "channels%s", work->strangers),
            "they have no meaning here; --layer NAME reads NAME.R, NAME.Z, ... as R, Z, ...");
}

static enum neph_status list_not_taken(const struct work *work, struct neph_diag *diag)
{
    struct neph_compared *made = work->made;
    const size_t most = (size_t)(neph_quantity_count() * (1 + work->asked->choice_count) +
                                 OVERLOOKED_COUNT + 1);
    made->not_taken = neph_arena_allocate(&made->arena, most, sizeof(*made->not_taken));
    if (!made->not_taken)
        return neph_fail_memory(diag);
    add_one_sided(work);
    report_ignored_data(work);
    for (int c = 0; c < work->asked->choice_count; c++) {
        const struct neph_extractor *extractor = work->asked->choices[c].extractor;
        for (int q = 0; q < neph_quantity_count(); q++) {
            const struct neph_quantity *quantity = neph_quantity_at(q);
            const char *because = neph_meter_obstacle(work->meter, quantity, extractor);
            if (because && neph_meter_has_extractor(work->meter, quantity, extractor))
                add_not_measured(made, extractor->name, quantity->name, because);
        }
    }
    return neph_arena_check(&made->arena, diag);
}

/* Take the numbers from the meter. Those of display images have display values as their unit. */
static void take_numbers(const struct work *work)
{
    struct neph_measurements *numbers = &work->made->numbers;
    numbers->list = neph_meter_release(work->meter, &numbers->count);
    if (work->asked->without_reference)
        neph_measurements_select(numbers, neph_needs_no_reference, NULL);
    for (int i = 0; i < numbers->count && work->is_picture; i++)
        if (strcmp(numbers->list[i].unit, numbers->list[i].quantity->unit) == 0)
            numbers->list[i].unit = "display value";
}

static enum neph_status judge_frozen(const struct work *work, struct neph_diag *diag)
{
    if (work->frozen.frozen_count == 0 || work->asked->allow_frozen_frames)
        return NEPH_OK;
    neph_fail(
        diag, NEPH_ERR_GATE,
        "%d of %d test frames are bit for bit the frame before, first '%s': that says nothing "
        "about stability",
        work->frozen.frozen_count, work->done_count,
        work->asked->test.paths[work->asked->warm_up_frames + work->frozen.first_frozen]);
    neph_hint(diag, "if they are meant to be (a deterministic renderer of a still scene), say "
                    "--frozen-ok");
    return NEPH_ERR_GATE;
}

/* Compute the numbers of the frames so far, and their findings. */
static enum neph_status conclude(struct work *work, bool interrupted, struct neph_diag *diag)
{
    struct neph_diag *words = interrupted ? NULL : diag; /* keep the message about the
                                                            interruption */
    struct neph_compared *made = work->made;
    neph_movement_end(&made->movement);
    const int frozen_count = work->frozen.frozen_count;
    enum neph_status status = neph_meter_finish(work->meter, words);
    if (!status)
        status = send_maps(work, -1, words);
    if (!status)
        status = list_not_taken(work, words);
    take_numbers(work);
    if (!status)
        status = neph_findings_make(&made->numbers, work->viewing.frame_rate_hz,
                                    frozen_count > 0 && !work->asked->allow_frozen_frames,
                                    work->declared_cycles, &made->findings, words);
    if (status)
        return status;
    made->asked = work->asked;
    made->viewing = work->viewing;
    made->frame_count = work->done_count;
    made->frozen_count = frozen_count;
    made->interrupted = interrupted;
    return interrupted ? NEPH_OK : judge_frozen(work, diag);
}

/* Checks before any file is read: enough frames, a folder for maps, and no map that overwrites a
 * frame. */
static enum neph_status prepare(const struct neph_comparison *asked, struct work *work,
                                struct neph_diag *diag)
{
    const struct neph_sequence *const sequences[] = {&asked->reference, &asked->second,
                                                     &asked->test};
    enum neph_status status = check_counts(asked, work, diag);
    if (status || !asked->maps_directory)
        return status;
    for (int s = 0; s < 3 && !status; s++)
        status = neph_map_names_check(sequences[s], asked->maps_directory, asked->choices,
                                      asked->choice_count, diag);
    return status ? status : neph_dir_create(asked->maps_directory, diag);
}

static void finish_pass(struct pass *pass)
{
    neph_read_ahead_destroy(pass->ahead);
    for (struct work *work = pass->works; work < pass->works + pass->work_count; work++) {
        neph_meter_destroy(work->meter);
        for (int i = 0; i < 3; i++)
            neph_frame_form_finish(&work->forms[i]);
        if (!work->has_masks_of_another)
            neph_masks_destroy(work->masks, work->mask_count);
    }
    for (int i = 0; i < AT_HAND_MAX; i++)
        neph_image_destroy(pass->at_hand[i].image);
}

/* Finish all comparisons. After Ctrl-C the frames measured so far give a result as well. */
static enum neph_status conclude_all(struct pass *pass, enum neph_status status,
                                     struct neph_diag *diag)
{
    const struct work *last = &pass->works[pass->work_count - 1];
    const bool interrupted = status == NEPH_ERR_INTERRUPTED && last->done_count > 0;
    if (interrupted)
        neph_interrupt_acknowledge();
    for (int w = 0; w < pass->work_count && (!status || interrupted); w++) {
        const enum neph_status finished = conclude(&pass->works[w], interrupted, diag);
        if (finished)
            return finished;
    }
    return status;
}

enum neph_status neph_comparisons_run(const struct neph_comparison *comparisons, int count,
                                      bool with_draws, struct neph_compared *compared,
                                      struct neph_diag *diag)
{
    struct work works[NEPH_COMPARISONS_MAX] = {{.asked = NULL}};
    struct pass pass = {.works = works, .work_count = count};
    enum neph_status status = NEPH_OK;
    for (int w = 0; w < count; w++)
        works[w] = (struct work){.asked = &comparisons[w],
                                 .viewing = comparisons[w].viewing,
                                 .with_draws = with_draws,
                                 .made = &compared[w]};
    for (int w = 0; w < count && !status; w++)
        status = prepare(&comparisons[w], &works[w], diag);
    if (!status && neph_thread_count() > 1 && works[0].frame_count > 1)
        status = neph_read_ahead_create(neph_thread_count(), &pass.ahead, diag);
    if (!status)
        status = conclude_all(&pass, measure_all(&pass, diag), diag);
    finish_pass(&pass);
    return status;
}

enum neph_status neph_comparison_run(const struct neph_comparison *comparison, bool with_draws,
                                     struct neph_compared *compared, struct neph_diag *diag)
{
    return neph_comparisons_run(comparison, 1, with_draws, compared, diag);
}

void neph_compared_finish(struct neph_compared *compared)
{
    neph_measurements_finish(&compared->numbers);
    neph_findings_finish(&compared->findings);
    neph_movement_finish(&compared->movement);
    neph_differences_finish(&compared->versus);
    neph_partner_finish(&compared->partner);
    free(compared->maps);
    neph_arena_finish(&compared->arena);
    *compared = (struct neph_compared){.asked = NULL};
}

void neph_comparison_finish(struct neph_comparison *comparison)
{
    neph_sequence_finish(&comparison->reference);
    neph_sequence_finish(&comparison->second);
    neph_sequence_finish(&comparison->test);
}
