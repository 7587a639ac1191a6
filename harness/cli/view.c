/* SPDX-License-Identifier: MIT
 *
 * `neph view A B ...`: writes a page with a viewer for the frames.
 */
#include "harness/cli/cli.h"

#include "harness/report/report_folder.h"
#include "harness/report/viewer_maps.h"
#include "harness/report/viewer_page.h"
#include "metrics/colour_config.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { FRAMES, VIEWING, WRITING }; /* groups of the help */

struct request {
    struct neph_cli_shared shared;
    struct neph_viewer view;
    struct neph_cli_words reference;
    struct neph_cli_list quantities, overlays;
    struct neph_clips clips;
    const char *window; /* mode of differing data windows */
    double limit_mb;
};

#define AT(member) .at = offsetof(struct request, member)
static const struct neph_cli_option options[] = {
    {"reference", 0, NULL,
     "The first set, which the others are compared with (default: the first of FRAMES); may be "
     "given several times",
     NEPH_CLI_WORDS, AT(reference)},
    {"layer", 0, NULL,
     "Radiance and depth are the channels NAME.R and so on (Blender: ViewLayer.Combined)",
     NEPH_CLI_WORD, AT(view.frame_choice.layer)},
    {"part", .kind = NEPH_CLI_WORD, AT(view.frame_choice.part)},
    {"depth", .kind = NEPH_CLI_WORD, AT(view.frame_choice.depth)},
    {"convert", .kind = NEPH_CLI_FLAG, AT(view.frame_choice.convert)},
    {"window", .kind = NEPH_CLI_WORD, AT(window), "union"},
    {"quantity", 0, "NAME[,NAME]",
     "Only radiance, volume, transmittance or depth (default: all that the frames have)",
     NEPH_CLI_NAMES, AT(quantities)},
    {"warm-up", 0, "N", "Leave out the first N frames", NEPH_CLI_INTEGER, AT(view.warm_up_frames),
     "0", 0, 1000000},
    {"by-position", 0, NULL,
     "Frames belong together by their place in the sequence, whatever their numbers", NEPH_CLI_FLAG,
     AT(view.by_position)},
    {"exposure", 0, "EV", "At first: display value = 2^EV times radiance", NEPH_CLI_REAL,
     AT(view.viewing.exposure_ev), "0", -32, 32, .group = VIEWING},
    {"scale", 0, "X",
     "Where the colours of differences of radiance end (default: 0.02 as displayed)", NEPH_CLI_REAL,
     AT(view.difference_scale), .minimum = 1e-12, .maximum = 1e12, .group = VIEWING},
    {"overlay", 0, "MAP[,MAP]",
     "Maps of the metrics against the first set, by the names of their files under `neph compare "
     "--maps`; or none (default: relative, flip and, of sequences, a4)",
     NEPH_CLI_NAMES, AT(overlays), .group = VIEWING},
    {"ocio", 0, NULL,
     "An OpenColorIO config: its view is shown, and the plain curve of an sRGB display on request; "
     "--convert finds its colour spaces",
     NEPH_CLI_WORD, AT(view.display.config), .group = VIEWING},
    {"display", 0, "NAME", "Of that config (default: its own)", NEPH_CLI_WORD,
     AT(view.display.display), .group = VIEWING},
    {"view", 0, "NAME", "Of that display (default: its own)", NEPH_CLI_WORD, AT(view.display.view),
     .group = VIEWING},
    {"space", 0, NULL,
     "Name of linear Rec.709 in the config (default: by the role aces_interchange, without it the "
     "role scene_linear)",
     NEPH_CLI_WORD, AT(view.display.space), .group = VIEWING},
    {"fps", 0, NULL, "Frames a second of playback (default: the frames' attribute, else 60)",
     NEPH_CLI_REAL, AT(view.viewing.frame_rate_hz), .minimum = 0.1, .maximum = 1000,
     .group = VIEWING},
    {"ppd", 0, NULL, "Pixels per degree of the display, on which maps depend (default: 67.02)",
     NEPH_CLI_REAL, AT(view.viewing.pixels_per_degree), .minimum = 1, .maximum = 1000,
     .group = VIEWING},
    {"title", 0, "TEXT", "Of the page", NEPH_CLI_WORD, AT(view.title), .group = WRITING},
    {"page-limit", 0, NULL, "Refuse to write a page larger than this", NEPH_CLI_REAL, AT(limit_mb),
     "200", 0.001, 100000, .group = WRITING},
    {.name = "output", .help = "Folder of the page", .otherwise = "out/view", .group = WRITING},
    {.name = "json", .group = WRITING},
    {.name = "quiet", .group = WRITING},
    {.name = NULL},
};
#undef AT

static const struct neph_cli_operands operands = {
    .shown = "FRAMES...",
    .minimum = 1,
    .maximum = NEPH_VIEWER_SETS_MAX,
    .missing = "which frames?",
    .surplus = "24 sets of frames (quote patterns: one is one set)",
};

static void check(const void *request_, const struct argp_state *state)
{
    const struct neph_display_choice *display = &((const struct request *)request_)->view.display;
    if (!display->config && (display->display || display->view || display->space))
        argp_error(state, "--display, --view and --space are of a config: --ocio FILE");
}

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &operands,
    .check = check,
    .doc = "Make a page that opens from disk and overlays frames of any renderer: EXR frames or "
           "PNG images, of one size.\v"
           "Each operand is a set: " NEPH_SEQUENCE_HELP
           ". Differences and maps are against the reference, else the first. In the page: zoom "
           "and pan down to pixels, values as they are in the files, wipe, flip, differences on a "
           "fixed scale, exposure, maps of the metrics, and time; ? lists the keys. Its address "
           "contains the current view: copy it to share the view.\n\n"
           "Examples:\n"
           "  neph view exact.exr march.exr -o page\n"
           "  neph view -r reference.exr 'a/frame.*.exr' 'b/frame.*.exr' --quantity radiance\n"
           "  neph view old.png new.png --overlay flip\n"
           "  neph view a.exr b.exr --ocio config.ocio --view Filmic",
};

/* ---- the inputs ------------------------------------------------------------------------------ */

/* A label for one of the words: without the leading folders that all words have in common. */
static const char *make_set_label(const char *const *words, int count, int which)
{
    size_t common = 0;
    for (size_t i = 0; words[0][i]; i++) {
        for (int w = 1; w < count; w++)
            if (words[w][i] != words[0][i])
                return words[which] + common;
        if (words[0][i] == '/' && words[0][i + 1])
            common = i + 1;
    }
    return words[which] + common;
}

/* Find the frame sets: the reference (if given; it may consist of several words), then one set for
 * each operand. */
static enum neph_status find_sets(struct request *request, struct neph_diag *diag)
{
    const struct neph_cli_words *reference = &request->reference;
    const char *words[NEPH_VIEWER_SETS_MAX + 1];
    const int first = reference->count > 0, count = first + request->shared.operand_count;
    struct neph_viewer *view = &request->view;
    enum neph_status status = NEPH_OK;
    if (count > NEPH_VIEWER_SETS_MAX)
        return neph_fail(diag, NEPH_ERR_USAGE,
                         "%d sets of frames with the reference; a page has "
                         "%d at most",
                         count, NEPH_VIEWER_SETS_MAX);
    if (first)
        words[0] = reference->list[0];
    for (int i = first; i < count; i++)
        words[i] = request->shared.operands[i - first];
    for (int i = 0; i < count && !status; i++) {
        const bool is_reference = first && i == 0;
        view->sets[i].label = make_set_label(words, count, i);
        status = neph_sequence_find(is_reference ? reference->count : 1,
                                    is_reference ? reference->list : &words[i], view->by_position,
                                    &view->sets[i].frames, diag);
        view->set_count += !status;
    }
    return status;
}

static enum neph_status find_windows(struct request *request, struct neph_diag *diag)
{
    struct neph_viewer *view = &request->view;
    const struct neph_sequence *sequences[NEPH_VIEWER_SETS_MAX];
    for (int i = 0; i < view->set_count; i++)
        sequences[i] = &view->sets[i].frames;
    return neph_windows_find(sequences, view->set_count, request->window, &view->frame_choice,
                             &view->windows, diag);
}

static enum neph_status find_quantities(struct request *request, struct neph_diag *diag)
{
    for (int i = 0; i < request->quantities.count; i++) {
        const char *name = request->quantities.words[i];
        const struct neph_quantity *quantity = neph_quantity_find(name);
        if (!quantity)
            return neph_fail(diag, NEPH_ERR_USAGE,
                             "there is no quantity '%s'; there are radiance, volume, "
                             "transmittance and depth",
                             name);
        request->view.quantities |= (unsigned)quantity->bit;
    }
    return NEPH_OK;
}

static bool has_sequence(const struct neph_viewer *view)
{
    for (int s = 0; s < view->set_count; s++)
        if (view->sets[s].frames.count > 1)
            return true;
    return false;
}

static enum neph_status find_overlays(struct request *request, struct neph_diag *diag)
{
    const struct neph_cli_list *asked = &request->overlays;
    struct neph_viewer *view = &request->view;
    view->overlays = asked->count > 0 ? asked->words : neph_viewer_overlays;
    view->overlay_count = asked->count > 0 ? asked->count : 2 + has_sequence(view);
    if (asked->count == 1 && strcmp(asked->words[0], "none") == 0)
        view->overlay_count = 0;
    if (view->overlay_count > NEPH_VIEWER_OVERLAYS_MAX)
        return neph_fail(diag, NEPH_ERR_USAGE, "%d overlays; a page has %d at most",
                         view->overlay_count, NEPH_VIEWER_OVERLAYS_MAX);
    return NEPH_OK;
}

static void choose_viewing(struct neph_viewer *view)
{
    const struct neph_viewing asked = view->viewing;
    view->viewing = NEPH_VIEWING_DEFAULTS;
    view->viewing.exposure_ev = asked.exposure_ev;
    if (!isnan(asked.frame_rate_hz))
        view->viewing.frame_rate_hz = asked.frame_rate_hz;
    if (!isnan(asked.pixels_per_degree))
        view->viewing.pixels_per_degree = asked.pixels_per_degree;
    view->own_frame_rate = isnan(asked.frame_rate_hz);
}

static enum neph_status prepare(struct request *request, struct neph_diag *diag)
{
    struct neph_viewer *view = &request->view;
    view->title = view->title ? view->title : "Frames side by side";
    view->limit_bytes = 1e6 * request->limit_mb;
    view->quiet = request->shared.quiet;
    choose_viewing(view);
    enum neph_status status = find_sets(request, diag);
    if (!status)
        status = find_windows(request, diag);
    if (!status)
        status = find_quantities(request, diag);
    return status ? status : find_overlays(request, diag);
}

/* ---- the page -------------------------------------------------------------------------------- */

static enum neph_status tell(const struct request *request, const struct neph_viewer_made *made,
                             struct neph_diag *diag)
{
    const struct neph_viewer *view = &request->view;
    const char *folder = request->shared.output;
    char text[256];
    if (request->shared.json)
        return neph_json_print(json_pack("{s:o, s:i, s:i, s:i, s:i, s:I, s:o}", "page",
                                         json_sprintf("%s/index.html", folder), "sets",
                                         view->set_count, "frames", made->frame_count, "width_px",
                                         made->width_px, "height_px", made->height_px, "bytes",
                                         (json_int_t)made->bytes, "window",
                                         neph_windows_json(&view->windows)),
                               diag);
    printf("%s/index.html: %d set%s, %d frame%s of %dx%d, %.1f MB\n", folder, view->set_count,
           view->set_count == 1 ? "" : "s", made->frame_count, made->frame_count == 1 ? "" : "s",
           made->width_px, made->height_px, (double)made->bytes / 1e6);
    neph_windows_sentence(&view->windows, text, sizeof(text));
    if (text[0])
        printf("%s\n", text);
    return NEPH_OK;
}

static enum neph_status write_page(const struct request *request, struct neph_diag *diag)
{
    struct neph_report_folder *folder = NULL;
    struct neph_scratch *fresh = NULL;
    struct neph_viewer_made made;
    enum neph_status status = neph_report_folder_open(request->shared.output, &folder, diag);
    if (!status)
        status = neph_viewer_write(&request->view, neph_report_folder_work(folder), &made, diag);
    if (!status)
        status = neph_report_folder_begin(folder, &fresh, diag);
    if (!status)
        status = neph_report_folder_exchange(folder, fresh, diag);
    neph_scratch_destroy(fresh);
    neph_report_folder_close(folder);
    return status ? status : tell(request, &made, diag);
}

enum neph_status neph_cli_view(int argc, char **argv, struct neph_diag *diag)
{
    struct request request = {.limit_mb = 0.0};
    neph_cli_parse(&syntax, argc, argv, &request);
    const struct neph_display_choice *display = &request.view.display;
    request.view.frame_choice.clips = &request.clips;
    struct neph_colour_source *colours = NULL;
    enum neph_status status = neph_oiio_server_create(&request.view.frame_choice.server, diag);
    if (!status && display->config && request.view.frame_choice.convert)
        status = neph_colour_config_open(display->config, display->space, &colours, diag);
    request.view.frame_choice.colours = colours;
    if (!status)
        status = prepare(&request, diag);
    if (!status)
        status = write_page(&request, diag);
    neph_oiio_server_destroy(request.view.frame_choice.server);
    neph_viewer_finish(&request.view);
    neph_colour_config_close(colours);
    neph_clips_close(&request.clips);
    return status;
}
