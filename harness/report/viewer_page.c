/* SPDX-License-Identifier: MIT */
#include "harness/report/viewer_page.h"

#include "base/clock.h"
#include "base/files.h"
#include "base/interrupt.h"
#include "base/packed.h"
#include "base/path.h"
#include "harness/compare/frame.h"
#include "harness/compare/frame_labels.h"
#include "harness/progress.h"
#include "harness/report/page.h"
#include "harness/report/viewer_maps.h"
#include "metrics/display.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Ends of the colour scales of differences; radiance in display values, transmittance as a
 * share. */
static const double display_scale = 0.02, share_scale = 0.02, depth_scale_m = 1.0;

static const struct neph_page_parts parts = {
    .title = "Frames",
    .files = {"view.html", "view.css", "view_planes.js", "view_paint.js", "view.js"},
    .folders = {"frames"},
};

/* ---- common properties of the frames --------------------------------------------------------- */

/* The state of a page while it is written. */
struct page_state {
    const struct neph_viewer *view;
    const char *folder;
    struct neph_viewer_made made;
    const char *first_path;      /* first frame, which sets size and kind; NULL: none yet */
    struct neph_frame_form form; /* of the first frame; owned */
    bool is_picture;             /* display values, not linear data */
    double frame_rate_hz;
    bool has_frame_rate;                                /* a frame states it */
    int ahead_count;                                    /* number of frames left to read */
    size_t frame_bytes;                                 /* size of the last frame */
    json_t *sets, *overlays, *not_taken, *codes, *cube; /* members of the document; owned */
    struct neph_progress progress;
};

static enum neph_status check_counts(const struct neph_viewer *view, int *frame_count,
                                     struct neph_diag *diag)
{
    const struct neph_sequence *longest = &view->sets[0].frames;
    for (int s = 1; s < view->set_count; s++)
        if (view->sets[s].frames.count > longest->count)
            longest = &view->sets[s].frames;
    for (int s = 0; s < view->set_count; s++) {
        const struct neph_sequence *frames = &view->sets[s].frames;
        if (frames->count != 1 && frames->count != longest->count)
            return neph_fail(diag, NEPH_ERR_INPUT,
                             "%d frames of '%s', %d of '%s': one for all, or as many",
                             frames->count, frames->paths[0], longest->count, longest->paths[0]);
        const enum neph_status status = view->by_position
                                            ? NEPH_OK
                                            : neph_sequence_check_numbers(longest,
                                                                          longest->paths[0], frames,
                                                                          frames->paths[0], diag);
        if (status)
            return status;
    }
    if (longest->count > 1 && view->warm_up_frames >= longest->count)
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "a warm-up of %d frames leaves nothing of a sequence of %d",
                         view->warm_up_frames, longest->count);
    *frame_count = longest->count > 1 ? longest->count - view->warm_up_frames : 1;
    return NEPH_OK;
}

static void take_first(struct page_state *page_state, const char *path,
                       const struct neph_image *image)
{
    page_state->first_path = path;
    page_state->made.width_px = image->width_px;
    page_state->made.height_px = image->height_px;
    page_state->is_picture = neph_image_attribute(image, "encoding") != NULL;
    page_state->frame_rate_hz = page_state->view->viewing.frame_rate_hz;
}

static enum neph_status check_radiance(const char *path, const struct neph_image *image,
                                       struct neph_diag *diag)
{
    const float *planes[3];
    if (neph_quantity_planes(neph_quantity_at(0), image, planes))
        return NEPH_OK;
    char names[200] = "";
    for (int c = 0; c < image->channel_count && strlen(names) < 100; c++)
        snprintf(names + strlen(names), sizeof(names) - strlen(names), " %s",
                 image->channels[c].name);
    neph_fail(diag, NEPH_ERR_INPUT, "'%s' has no radiance: its channels are%s", path, names);
    neph_hint(diag,
              "radiance is in channels R G B (r g b, red green blue, rgba.R ...), or in Y, L or "
              "R alone; --layer NAME reads NAME.R NAME.G NAME.B");
    return NEPH_ERR_INPUT;
}

/* Take the frame rate of the first frame that states one, unless the user set another. */
static void take_frame_rate(struct page_state *page_state, const struct neph_image *image)
{
    const double rate_hz = neph_frame_rate_hz(image);
    if (page_state->view->own_frame_rate && !page_state->has_frame_rate && !isnan(rate_hz)) {
        page_state->frame_rate_hz = rate_hz;
        page_state->has_frame_rate = true;
    }
}

/* Check that a frame has the size and the kind of the first frame. */
static enum neph_status check_frame(struct page_state *page_state, const char *path,
                                    const struct neph_image *image, struct neph_diag *diag)
{
    if (!page_state->first_path)
        take_first(page_state, path, image);
    take_frame_rate(page_state, image);
    const bool is_picture = neph_image_attribute(image, "encoding") != NULL;
    if (image->width_px != page_state->made.width_px ||
        image->height_px != page_state->made.height_px)
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "'%s' has %dx%d pixels, '%s' %dx%d: frames of a page are laid over each "
                         "other",
                         path, image->width_px, image->height_px, page_state->first_path,
                         page_state->made.width_px, page_state->made.height_px);
    if (is_picture != page_state->is_picture)
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "'%s' is a display image, '%s' is linear data: they have no common scale",
                         is_picture ? path : page_state->first_path,
                         is_picture ? page_state->first_path : path);
    const enum neph_status status = neph_frame_form_check(&page_state->form, path, image, false,
                                                          diag);
    return status ? status : check_radiance(path, image, diag);
}

/* Hint for reducing the size of a page. */
static const char take_less[] = "take fewer frames (a pattern, --warm-up), --quantity radiance, "
                                "--overlay none, or a higher --limit";

/* ---- floats ---------------------------------------------------------------------------------- */

static enum neph_status write_text(struct page_state *page_state, const char *key, const char *text,
                                   struct neph_diag *diag)
{
    char *script = neph_format("NEPH_VIEW_PLANES(\"%s\", \"%s\");\n", key, text);
    const size_t length = script ? strlen(script) : 0;
    enum neph_status status = script ? NEPH_OK : neph_fail_memory(diag);
    page_state->made.bytes += length;
    if (!status && (double)page_state->made.bytes > page_state->view->limit_bytes) {
        status = neph_fail(diag, NEPH_ERR_INPUT, "the page would be larger than %.3g MB",
                           page_state->view->limit_bytes / 1e6);
        neph_hint(diag, "take fewer frames (a pattern, --warm-up), only --quantity radiance, "
                        "--overlay none, or a higher --page-limit");
    }
    if (!status)
        status = neph_file_write_unsynced(
            neph_path_format("%s/frames/%s.js", page_state->folder, key).text, script, length,
            diag);
    free(script);
    return status;
}

/* Write a script that passes planes to the page under a key. */
static enum neph_status ship_planes(struct page_state *page_state, const char *key,
                                    const float *const *planes, int plane_count, size_t count,
                                    struct neph_diag *diag)
{
    char *text = NULL;
    size_t length = 0;
    enum neph_status status = neph_packed_floats(planes, plane_count, count, &text, &length, diag);
    if (!status)
        status = write_text(page_state, key, text, diag);
    free(text);
    return status;
}

/* Write planes of the frames' size. */
static enum neph_status ship(void *shop_, const char *key, const float *const *planes,
                             int plane_count, struct neph_diag *diag)
{
    struct page_state *page_state = shop_;
    return ship_planes(page_state, key, planes, plane_count,
                       (size_t)page_state->made.width_px * (size_t)page_state->made.height_px,
                       diag);
}

/* Write the requested quantities of a frame. `found` is the set of quantities in the first frame of
 * its set; later frames must have them as well. */
static enum neph_status ship_frame(struct page_state *page_state, int set, int frame,
                                   const char *path, const struct neph_image *image,
                                   unsigned *found, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int q = 0; q < neph_quantity_count() && !status; q++) {
        const struct neph_quantity *quantity = neph_quantity_at(q);
        const float *planes[3];
        char key[64];
        const unsigned wanted = page_state->view->quantities;
        const bool has = (wanted == 0 || (wanted & (unsigned)quantity->bit)) &&
                         neph_quantity_planes(quantity, image, planes);
        if (frame == 0 && has)
            *found |= (unsigned)quantity->bit;
        if (!(*found & (unsigned)quantity->bit))
            continue;
        if (!has)
            return neph_fail(diag, NEPH_ERR_INPUT,
                             "'%s' has no %s, and the first frame of its sequence has", path,
                             quantity->name);
        snprintf(key, sizeof(key), "%d_%d_%s", set, frame, quantity->name);
        status = ship(page_state, key, planes, quantity->plane_count, diag);
    }
    return status;
}

static enum neph_status ship_file(struct page_state *page_state, int set, int frame,
                                  const char *path, unsigned *found, struct neph_diag *diag)
{
    struct neph_image *image = NULL;
    enum neph_status status = neph_interrupted()
                                  ? neph_fail(diag, NEPH_ERR_INTERRUPTED, "interrupted")
                                  : neph_frame_read(path, &page_state->view->frame_choice, SIZE_MAX,
                                                    &image, diag);
    if (!status)
        status = check_frame(page_state, path, image, diag);
    if (!status)
        status = ship_frame(page_state, set, frame, path, image, found, diag);
    neph_image_destroy(image);
    return status;
}

/* Refuse a page that will exceed its limit after its first frames. The frames of a sequence have
 * similar sizes, so the estimate multiplies the last frame's size by the number of frames left; 0.8
 * allows for their noise. */
static enum neph_status check_ahead(struct page_state *page_state, struct neph_diag *diag)
{
    static const double sure = 0.8;
    const double ahead = sure * (double)page_state->frame_bytes * page_state->ahead_count;
    if ((double)page_state->made.bytes + ahead <= page_state->view->limit_bytes)
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_INPUT,
              "the page would be larger than %.3g MB: about %.3g MB, by its first frames",
              page_state->view->limit_bytes / 1e6,
              ((double)page_state->made.bytes +
               (double)page_state->frame_bytes * page_state->ahead_count) /
                  1e6);
    neph_hint(diag, "%s", take_less);
    return NEPH_ERR_INPUT;
}

static int count_set_frames(const struct page_state *page_state, int set)
{
    return page_state->view->sets[set].frames.count > 1 ? page_state->made.frame_count : 1;
}

/* ---- sets ------------------------------------------------------------------------------------ */

static json_t *quantities_json(unsigned found)
{
    json_t *list = json_array();
    for (int q = 0; q < neph_quantity_count(); q++)
        if (found & (unsigned)neph_quantity_at(q)->bit)
            neph_json_add(&list, json_string(neph_quantity_at(q)->name));
    return list;
}

static json_t *set_json(const struct neph_viewer_set *set, int first, int count, unsigned found)
{
    json_t *files = json_array();
    for (int i = 0; i < count; i++)
        neph_json_add(&files, neph_json_cleaned(set->frames.paths[first + i]));
    return json_pack("{s:o, s:o, s:o}", "label", neph_json_cleaned(set->label), "files", files,
                     "quantities", quantities_json(found));
}

static enum neph_status ship_sets(struct page_state *page_state, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    page_state->sets = json_array();
    for (int s = 0; s < page_state->view->set_count && !status; s++) {
        const struct neph_viewer_set *set = &page_state->view->sets[s];
        const int count = count_set_frames(page_state, s);
        const int first = count > 1 ? page_state->view->warm_up_frames : 0;
        unsigned found = 0;
        for (int i = 0; i < count && !status; i++) {
            const char *path = set->frames.paths[first + i];
            const size_t before = page_state->made.bytes;
            neph_progress_begin(&page_state->progress, path);
            status = ship_file(page_state, s, i, path, &found, diag);
            neph_progress_tick(&page_state->progress, path);
            page_state->frame_bytes = page_state->made.bytes - before;
            page_state->ahead_count--;
            if (!status)
                status = check_ahead(page_state, diag);
        }
        if (!status)
            neph_json_add(&page_state->sets, set_json(set, first, count, found));
    }
    return status;
}

/* ---- parts that do not depend on the frames -------------------------------------------------- */

static json_t *colour_json(const uint8_t rgb[3])
{
    return json_pack("[i, i, i]", rgb[0], rgb[1], rgb[2]);
}

static json_t *colours_json(const struct neph_display_legend *legend)
{
    json_t *stops = json_array();
    for (int i = 0; i < legend->stop_count; i++)
        neph_json_add(&stops, json_pack("{s:f, s:o}", "position", legend->stops[i].position, "rgb",
                                        colour_json(legend->stops[i].rgb)));
    return json_pack("{s:o, s:o, s:o, s:o}", "stops", stops, "below", colour_json(legend->below),
                     "above", colour_json(legend->above), "not_a_number",
                     colour_json(legend->not_a_number));
}

static double choose_difference_scale(const struct neph_viewer *view,
                                      const struct neph_quantity *quantity)
{
    if (quantity->bit == NEPH_TRANSMITTANCE)
        return share_scale;
    if (quantity->bit == NEPH_DEPTH)
        return depth_scale_m;
    return isnan(view->difference_scale) ? display_scale * exp2(-view->viewing.exposure_ev)
                                         : view->difference_scale;
}

static json_t *quantity_list_json(const struct neph_viewer *view)
{
    json_t *list = json_array();
    for (int q = 0; q < neph_quantity_count(); q++) {
        const struct neph_quantity *quantity = neph_quantity_at(q);
        neph_json_add(&list,
                      json_pack("{s:s, s:s, s:i, s:f}", "name", quantity->name, "unit",
                                quantity->unit, "planes", quantity->plane_count, "difference_scale",
                                choose_difference_scale(view, quantity)));
    }
    return list;
}

/* The thresholds of OpenColorIO's view of linear values, from display code 1: see
 * neph_display_bake(). */
static enum neph_status bake_display(json_t **codes, struct neph_diag *diag)
{
    float thresholds[256];
    const enum neph_status status = neph_display_bake(thresholds, diag);
    *codes = json_array();
    for (int k = 1; k < 256 && !status; k++)
        neph_json_add(codes, json_real((double)thresholds[k]));
    return status;
}

/* Bake a view of the user's OpenColorIO config. Runs before frames are read, because the config may
 * be missing. */
static enum neph_status bake_cube(const struct neph_viewer *view, struct neph_display_cube *cube,
                                  struct neph_diag *diag)
{
    if (!view->display.config)
        return NEPH_OK;
    const enum neph_status status = neph_display_cube_bake(&view->display, cube, diag);
    if (!status && cube->not_numbers > 0)
        neph_progress_warn(
            "view '%s' has %d colours that are no numbers (NaN), in the tables of its "
            "config or by its formulas; they are shown as 0",
            cube->name, cube->not_numbers);
    return status;
}

/* Write the baked view; null when there is none. */
static enum neph_status ship_cube(struct page_state *page_state,
                                  const struct neph_display_cube *cube, struct neph_diag *diag)
{
    page_state->cube = json_null();
    if (!cube->nodes[0])
        return NEPH_OK;
    if (page_state->is_picture)
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "these are display images: --ocio shows linear data");
    const size_t node_count = (size_t)NEPH_DISPLAY_CUBE_SIDE * NEPH_DISPLAY_CUBE_SIDE *
                              NEPH_DISPLAY_CUBE_SIDE;
    const enum neph_status status = ship_planes(
        page_state, "cube", (const float *const *)cube->nodes, 3, node_count, diag);
    page_state->cube = json_pack(
        "{s:o, s:i, s:f, s:f, s:f, s:f, s:i}", "name", neph_json_cleaned(cube->name), "side",
        NEPH_DISPLAY_CUBE_SIDE, "knee", cube->knee, "top", cube->top, "error_mean",
        cube->error_mean, "error_max", cube->error_max, "not_numbers", cube->not_numbers);
    return status;
}

static json_t *document_json(const struct page_state *page_state)
{
    const struct neph_viewer *view = page_state->view;
    const struct neph_sequence *numbered = NULL;
    char now[32];
    neph_utc_now(now);
    for (int s = 0; s < view->set_count && !numbered; s++)
        if (view->sets[s].frames.numbers)
            numbered = &view->sets[s].frames;
    json_t *document = json_pack(
        "{s:s, s:s, s:s, s:s, s:[i, i], s:i, s:f, s:f, s:b, s:o, s:O, s:O, s:O, s:O, s:o, s:o}",
        "format", "neph-view-1", "title", view->title, "created_utc", now, "neph_version",
        NEPH_VERSION, "size_px", page_state->made.width_px, page_state->made.height_px, "frames",
        page_state->made.frame_count, "rate_hz", page_state->frame_rate_hz, "exposure_ev",
        view->viewing.exposure_ev, "is_picture", page_state->is_picture, "quantities",
        quantity_list_json(view), "sets", page_state->sets, "overlays", page_state->overlays,
        "not_taken", page_state->not_taken, "display_codes", page_state->codes, "differences",
        colours_json(neph_display_difference_legend()), "amounts",
        colours_json(neph_display_amount_legend()));
    neph_json_set(&document, "first_number",
                  numbered ? json_integer(numbered->numbers[0] + view->warm_up_frames)
                           : json_integer(view->warm_up_frames));
    neph_json_set(&document, "bytes", json_integer((json_int_t)page_state->made.bytes));
    neph_json_set(&document, "cube", json_incref(page_state->cube));
    return document;
}

enum neph_status neph_viewer_write(const struct neph_viewer *view, const char *folder,
                                   struct neph_viewer_made *made, struct neph_diag *diag)
{
    struct page_state page_state = {
        .view = view, .folder = folder, .overlays = json_array(), .not_taken = json_array()};
    struct neph_display_cube baked = {.nodes = {NULL}};
    enum neph_status status = check_counts(view, &page_state.made.frame_count, diag);
    if (!status)
        status = neph_viewer_check_overlays(view, diag);
    if (!status)
        status = bake_cube(view, &baked, diag);
    int total = 0;
    for (int s = 0; s < view->set_count; s++)
        total += count_set_frames(&page_state, s);
    page_state.ahead_count = total;
    page_state.progress = neph_progress_start(view->quiet || total < 4, total);
    if (!status)
        status = neph_page_start(folder, &parts, NULL, diag);
    if (!status)
        status = ship_sets(&page_state, diag);
    neph_progress_end(&page_state.progress);
    if (!status)
        status = neph_viewer_maps(view, page_state.is_picture, page_state.frame_rate_hz, ship,
                                  &page_state, &page_state.overlays, &page_state.not_taken, diag);
    if (!status)
        status = bake_display(&page_state.codes, diag);
    if (!status)
        status = ship_cube(&page_state, &baked, diag);
    json_t *document = status ? NULL : document_json(&page_state);
    if (!status)
        status = neph_json_check(document, diag);
    if (!status)
        status = neph_page_write_data(folder, "NEPH_VIEW", document, diag);
    if (!status)
        status = neph_file_system_sync(folder, diag);
    if (!status)
        *made = page_state.made;
    json_decref(document);
    json_t *const parts_made[] = {page_state.sets, page_state.overlays, page_state.not_taken,
                                  page_state.codes, page_state.cube};
    for (size_t i = 0; i < sizeof(parts_made) / sizeof(parts_made[0]); i++)
        json_decref(parts_made[i]);
    neph_display_cube_finish(&baked);
    neph_frame_form_finish(&page_state.form);
    return status;
}

void neph_viewer_finish(struct neph_viewer *view)
{
    for (int s = 0; s < view->set_count; s++)
        neph_sequence_finish(&view->sets[s].frames);
}
