/* SPDX-License-Identifier: MIT */
#include "harness/compare/frame_windows.h"

#include "base/exr_header.h"
#include "base/exr_parts.h"
#include "base/files.h"
#include "base/interrupt.h"
#include "base/png_codes.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

_Static_assert(NEPH_WINDOW_MODE_COUNT == 3, "a new kind");

static const char *const mode_names[NEPH_WINDOW_MODE_COUNT] = {
    [NEPH_WINDOW_UNION] = "union",
    [NEPH_WINDOW_INTERSECTION] = "intersection",
    [NEPH_WINDOW_STRICT] = "strict",
};

static enum neph_status parse_mode(const char *word, enum neph_window_mode *mode,
                                   struct neph_diag *diag)
{
    for (int i = 0; i < NEPH_WINDOW_MODE_COUNT; i++)
        if (strcmp(word, mode_names[i]) == 0) {
            *mode = i;
            return NEPH_OK;
        }
    return neph_fail(diag, NEPH_ERR_USAGE, "--window %s: there are union, intersection and strict",
                     word);
}

/* ---- headers --------------------------------------------------------------------------------- */

/* What the header of a file says. */
struct head {
    struct neph_window window;
    bool is_whole; /* the data window is the display window */
    bool has_part; /* the wanted one */
};

/* The first chunk of a PNG is IHDR. */
static bool read_png(const char bytes[24], struct head *head)
{
    if (memcmp(bytes, "\x89PNG", 4) != 0 || memcmp(bytes + 12, "IHDR", 4) != 0)
        return false;
    for (int axis = 0; axis < 2; axis++) {
        const uint32_t size_px = neph_png_u32(bytes + 16 + 4 * axis);
        head->window.size_px[axis] = head->window.display_px[axis] = size_px;
    }
    return true;
}

static bool find_box(const struct neph_exr_part *part, const char *name, int64_t box[4])
{
    struct neph_exr_attribute attribute;
    size_t at = 0;
    while (neph_exr_next_attribute(part->header, part->header_bytes, &at, &attribute)) {
        if (strcmp(attribute.name, name) != 0 || attribute.value_bytes != 16)
            continue;
        for (int i = 0; i < 4; i++)
            box[i] = (int32_t)neph_exr_u32(attribute.value + 4 * i);
        return true;
    }
    return false;
}

static bool read_part(const struct neph_exr_part *part, struct head *head)
{
    struct neph_window *window = &head->window;
    int64_t data[4], display[4];
    if (!find_box(part, "dataWindow", data) || !find_box(part, "displayWindow", display))
        return false;
    for (int axis = 0; axis < 2; axis++) {
        window->min_px[axis] = data[axis] - display[axis];
        window->size_px[axis] = data[axis + 2] - data[axis] + 1;
        window->display_px[axis] = display[axis + 2] - display[axis] + 1;
        if (window->display_px[axis] > INT32_MAX)
            return false; /* the reader does not keep it */
    }
    head->has_part = part->is_wanted;
    return true;
}

static bool read_exr(const char *path, int fd, uint64_t file_bytes, const char *wanted,
                     struct head *head)
{
    char *headers = NULL;
    size_t size = 0;
    struct neph_exr_part part;
    if (neph_exr_read_headers(fd, file_bytes, &headers, &size, NULL))
        return false;
    const bool is_known = !neph_exr_choose_part(path, headers, size, wanted, &part, NULL) &&
                          read_part(&part, head);
    free(headers);
    return is_known;
}

/* False: the header is not valid; reading the whole file then reports the problem. */
static bool read_head(const char *path, const char *part, struct head *head)
{
    static const unsigned char exr_magic[4] = {0x76, 0x2f, 0x31, 0x01};
    char bytes[24] = {0};
    uint64_t file_bytes = 0;
    bool is_known = false;
    int fd;
    struct neph_path file;
    int frame;
    *head = (struct head){.is_whole = false};
    if (neph_file_open(neph_clip_split(path, &file, &frame) ? file.text : path, &fd, &file_bytes,
                       NULL))
        return false;
    if (pread(fd, bytes, sizeof(bytes), 0) == (ssize_t)sizeof(bytes))
        is_known = memcmp(bytes, exr_magic, 4) == 0 ? read_exr(path, fd, file_bytes, part, head)
                                                    : read_png(bytes, head);
    close(fd);
    const struct neph_window *window = &head->window;
    head->is_whole = true;
    for (int axis = 0; axis < 2; axis++) {
        is_known &= window->size_px[axis] >= 1 && window->size_px[axis] <= NEPH_IMAGE_SIDE_MAX_PX &&
                    window->display_px[axis] >= 1;
        head->is_whole &= window->min_px[axis] == 0 &&
                          window->size_px[axis] == window->display_px[axis];
    }
    return is_known;
}

/* ---- all files ------------------------------------------------------------------------------- */

/* The files so far. */
struct search {
    struct neph_windows *windows;
    const struct neph_frame_choice *choice;
    const char *first; /* a file with a known window, and that window; NULL: none yet */
    struct head first_head;
    struct neph_window all; /* the union */
    bool has_part;
};

static void include(struct neph_window *all, const struct neph_window *window)
{
    for (int axis = 0; axis < 2; axis++) {
        const int64_t ends[2] = {all->min_px[axis] + all->size_px[axis],
                                 window->min_px[axis] + window->size_px[axis]};
        if (window->min_px[axis] < all->min_px[axis])
            all->min_px[axis] = window->min_px[axis];
        all->size_px[axis] = (ends[0] > ends[1] ? ends[0] : ends[1]) - all->min_px[axis];
    }
}

static void intersect(struct neph_window *common, const int64_t min_px[2], const int64_t size_px[2])
{
    for (int axis = 0; axis < 2; axis++) {
        const int64_t ends[2] = {common->min_px[axis] + common->size_px[axis],
                                 min_px[axis] + size_px[axis]};
        if (min_px[axis] > common->min_px[axis])
            common->min_px[axis] = min_px[axis];
        const int64_t size = (ends[0] < ends[1] ? ends[0] : ends[1]) - common->min_px[axis];
        common->size_px[axis] = size > 0 ? size : 0;
    }
}

static bool cut_to_display(struct neph_window *window)
{
    static const int64_t corner[2] = {0, 0};
    const struct neph_window before = *window;
    intersect(window, corner, window->display_px);
    return !neph_window_is_equal(&before, window);
}

/* A file with an unknown header may have the part; a file with several frames has none. */
static bool may_have_part(const char *path, bool is_known, const struct head *head)
{
    struct neph_path file;
    int frame;
    return is_known ? head->has_part : !neph_clip_split(path, &file, &frame);
}

static enum neph_status refuse_sizes(const struct search *search, const char *path,
                                     const struct head *head, struct neph_diag *diag)
{
    const bool both_whole = search->first_head.is_whole && head->is_whole;
    const int64_t *before = search->first_head.window.display_px, *now = head->window.display_px;
    neph_fail(diag, NEPH_ERR_INPUT,
              "the size %schanges: it is %lldx%lld pixels in '%s' and %lldx%lld in '%s'",
              both_whole ? "" : "of the display window ", (long long)before[0],
              (long long)before[1], search->first, (long long)now[0], (long long)now[1], path);
    neph_hint(diag, "render all frames at one size");
    return NEPH_ERR_INPUT;
}

static enum neph_status add_file(struct search *search, const char *path, struct neph_diag *diag)
{
    struct neph_windows *windows = search->windows;
    struct head head;
    const bool is_known = read_head(path, search->choice->part, &head);
    search->has_part |= may_have_part(path, is_known, &head);
    if (!is_known || (windows->mode == NEPH_WINDOW_STRICT && !head.is_whole))
        return NEPH_OK;
    struct neph_window inside = head.window;
    if (!search->first) {
        search->first = path;
        search->first_head = head;
        search->all = windows->common = head.window;
    }
    for (int axis = 0; axis < 2; axis++)
        if (head.window.display_px[axis] != search->first_head.window.display_px[axis])
            return refuse_sizes(search, path, &head, diag);
    windows->differ |= !neph_window_is_equal(&head.window, &search->first_head.window);
    windows->is_overscan |= cut_to_display(&inside);
    include(&search->all, &head.window);
    intersect(&windows->common, head.window.min_px, head.window.size_px);
    return NEPH_OK;
}

static bool is_empty(const struct neph_window *window)
{
    return window->size_px[0] < 1 || window->size_px[1] < 1;
}

static enum neph_status place(struct search *search, struct neph_diag *diag)
{
    struct neph_windows *windows = search->windows;
    const bool is_union = windows->mode == NEPH_WINDOW_UNION;
    cut_to_display(&windows->common);
    if (windows->mode == NEPH_WINDOW_STRICT || (!windows->differ && !windows->is_overscan))
        return NEPH_OK;
    windows->placed = is_union ? search->all : windows->common;
    cut_to_display(&windows->placed);
    if (is_empty(&windows->placed)) {
        neph_fail(diag, NEPH_ERR_INPUT, "no pixel of the display window is in %s data window",
                  is_union ? "any" : "every");
        neph_hint(diag, is_union ? "write data windows inside the display window"
                                 : "--window union compares the pixels that one file has");
        return NEPH_ERR_INPUT;
    }
    for (int axis = 0; axis < 2; axis++)
        if (windows->placed.size_px[axis] > NEPH_IMAGE_SIDE_MAX_PX) {
            neph_fail(diag, NEPH_ERR_INPUT,
                      "the data windows together have %lldx%lld pixels; allowed are 1 to %d per "
                      "side",
                      (long long)windows->placed.size_px[0], (long long)windows->placed.size_px[1],
                      NEPH_IMAGE_SIDE_MAX_PX);
            neph_hint(diag, "--window intersection compares the pixels that all files have");
            return NEPH_ERR_INPUT;
        }
    return NEPH_OK;
}

static enum neph_status refuse_part(const char *part, struct neph_diag *diag)
{
    neph_fail(diag, NEPH_ERR_INPUT, "no file has the part '%s': none has more than one part", part);
    neph_hint(diag, "leave out --part; --layer chooses channels by their prefix");
    return NEPH_ERR_INPUT;
}

enum neph_status neph_windows_find(const struct neph_sequence *const *sequences, int count,
                                   const char *mode, struct neph_frame_choice *choice,
                                   struct neph_windows *windows, struct neph_diag *diag)
{
    *windows = (struct neph_windows){.differ = false};
    struct search search = {.windows = windows, .choice = choice};
    enum neph_status status = parse_mode(mode, &windows->mode, diag);
    for (int s = 0; s < count && !status; s++)
        for (int i = 0; i < sequences[s]->count && !status; i++)
            status = neph_interrupted() ? neph_fail(diag, NEPH_ERR_INTERRUPTED, "interrupted")
                                        : add_file(&search, sequences[s]->paths[i], diag);
    if (!status && choice->part && !search.has_part)
        status = refuse_part(choice->part, diag);
    if (!status)
        status = place(&search, diag);
    if (!status)
        choice->window = windows->placed;
    return status;
}

enum neph_status neph_part_check(const struct neph_sequence *sequence, const char *part,
                                 struct neph_diag *diag)
{
    bool has_part = part == NULL;
    for (int i = 0; i < sequence->count && !has_part; i++) {
        struct head head;
        has_part = may_have_part(sequence->paths[i], read_head(sequence->paths[i], part, &head),
                                 &head);
    }
    return has_part ? NEPH_OK : refuse_part(part, diag);
}

/* ---- the answer ------------------------------------------------------------------------------ */

void neph_windows_sentence(const struct neph_windows *windows, char *text, size_t size)
{
    const struct neph_window *placed = &windows->placed, *common = &windows->common;
    char part[64] = "none is";
    *text = '\0';
    if (is_empty(placed))
        return;
    if (!is_empty(common))
        snprintf(part, sizeof(part), "%lldx%lld are", (long long)common->size_px[0],
                 (long long)common->size_px[1]);
    if (!windows->differ)
        snprintf(text, size,
                 "the data windows reach beyond the display window: %lldx%lld pixels inside it are "
                 "measured (--window)",
                 (long long)placed->size_px[0], (long long)placed->size_px[1]);
    else if (windows->mode == NEPH_WINDOW_UNION)
        snprintf(text, size,
                 "the data windows differ: of %lldx%lld measured pixels %s in all files; outside a "
                 "window is 0 and transparent (--window)",
                 (long long)placed->size_px[0], (long long)placed->size_px[1], part);
    else
        snprintf(text, size,
                 "the data windows differ: only the %lldx%lld pixels at (%lld, %lld) that all "
                 "files have are measured (--window)",
                 (long long)placed->size_px[0], (long long)placed->size_px[1],
                 (long long)placed->min_px[0], (long long)placed->min_px[1]);
}

static json_t *pair_json(const int64_t px[2])
{
    return json_pack("[I, I]", (json_int_t)px[0], (json_int_t)px[1]);
}

json_t *neph_windows_json(const struct neph_windows *windows)
{
    const struct neph_window *placed = &windows->placed;
    json_t *where = is_empty(placed)
                        ? json_null()
                        : json_pack("{s:o, s:o, s:o}", "corner_px", pair_json(placed->min_px),
                                    "size_px", pair_json(placed->size_px), "display_px",
                                    pair_json(placed->display_px));
    return json_pack("{s:s, s:b, s:o}", "mode", mode_names[windows->mode], "differ",
                     windows->differ, "measured", where);
}
