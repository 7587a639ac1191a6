/* SPDX-License-Identifier: MIT */
#include "harness/report/compare_page.h"

#include "base/files.h"
#include "base/path.h"
#include "harness/compare/direction.h"
#include "harness/compare/headlines.h"
#include "harness/compare/maps.h"
#include "harness/report/compare_frames.h"
#include "harness/report/page.h"
#include "harness/report/vega.h"
#include "metrics/display.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct neph_page_parts parts = {
    .title = "Nephelometer comparison",
    .files = {"compare.html", "compare.js"},
    .folders = {"charts", "frames", "maps", "vendor"},
};

/* ---- maps ------------------------------------------------------------------------------------ */

/* The maps on the page, of whole sequences and of single frames. */
static const struct shown_map {
    const char *name, *title;
    bool is_of_sequence;
} shown_maps[] = {
    {"seen_contrast", "Flicker, in multiples of the threshold of the eye", true},
    {"a4", "Amplitude at the period of four frames [luma]", true},
    {"std", "Standard deviation over time [luma]", true},
    {"relative", "Absolute error over the mean of the reference", false},
    {"flip", "FLIP: the visible difference when the two alternate", false},
};

static const struct shown_map *find_shown(const struct neph_map *map, int frame)
{
    for (size_t i = 0; i < sizeof(shown_maps) / sizeof(shown_maps[0]); i++)
        if (strcmp(shown_maps[i].name, map->name) == 0 &&
            shown_maps[i].is_of_sequence == (frame < 0))
            return &shown_maps[i];
    return NULL;
}

enum { MAP_WIDTH_MAX_PX = 960 };

/* The value with the largest magnitude in a block of pixels, so that small spots remain visible;
 * NaN when all values are NaN. */
static float block_value(const float *samples, const struct neph_image *image, int left, int top,
                         int side)
{
    float most = NAN;
    for (int y = top; y < top + side && y < image->height_px; y++)
        for (int x = left; x < left + side && x < image->width_px; x++) {
            const float value = samples[(size_t)y * (size_t)image->width_px + (size_t)x];
            if (isnan(most) || fabsf(value) > fabsf(most))
                most = value;
        }
    return most;
}

/* Reduce a map that is too wide for the page, one pixel for each block of side x side pixels. */
static enum neph_status reduce(const struct neph_image *image, int side, struct neph_image **made,
                               struct neph_diag *diag)
{
    struct neph_image *small = NULL;
    enum neph_status status = neph_image_create((image->width_px + side - 1) / side,
                                                (image->height_px + side - 1) / side, &small, diag);
    for (int c = 0; c < image->channel_count && !status; c++) {
        float *samples = NULL;
        status = neph_image_add_channel(small, image->channels[c].name, &samples, diag);
        for (int y = 0; y < small->height_px && !status; y++)
            for (int x = 0; x < small->width_px; x++)
                samples[(size_t)y * (size_t)small->width_px + (size_t)x] = block_value(
                    image->channels[c].samples, image, x * side, y * side, side);
    }
    if (status)
        neph_image_destroy(small);
    else
        *made = small;
    return status;
}

static enum neph_status draw_map(const char *path, const struct neph_map *map,
                                 const struct neph_viewing *viewing, const struct neph_image *image,
                                 int side, struct neph_diag *diag)
{
    struct neph_image *small = NULL;
    enum neph_status status = side > 1 ? reduce(image, side, &small, diag) : NEPH_OK;
    if (!status)
        status = neph_map_png(path, map, viewing, small ? small : image, diag);
    neph_image_destroy(small);
    return status;
}

enum neph_status neph_compare_page_take(void *context, const struct neph_map *map,
                                        const struct neph_quantity *quantity, int frame,
                                        const struct neph_image *image, struct neph_diag *diag)
{
    const struct neph_compare_maps *maps = context;
    const struct shown_map *shown = find_shown(map, frame);
    if (!shown || quantity->bit != NEPH_RADIANCE)
        return NEPH_OK;
    const struct neph_path file = neph_path_format("maps/%s_%s.png", map->name,
                                                   maps->side == NEPH_PAGE_TEST ? "test" : "other");
    const int side = (image->width_px + MAP_WIDTH_MAX_PX - 1) / MAP_WIDTH_MAX_PX;
    const enum neph_status status = draw_map(neph_path_in(maps->folder, file.text).text, map,
                                             &maps->viewing, image, side, diag);
    return status ? status
                  : neph_json_append(
                        maps->list,
                        json_pack("{s:i, s:s, s:s, s:i, s:s, s:f, s:b, s:[i,i], s:i}", "place",
                                  (int)(shown - shown_maps), "name", map->name, "title",
                                  shown->title, "side", (int)maps->side, "src", file.text, "scale",
                                  neph_map_scale(map, &maps->viewing), "is_signed", map->is_signed,
                                  "size_px", (image->width_px + side - 1) / side,
                                  (image->height_px + side - 1) / side, "block_px", side),
                        diag);
}

/* ---- numbers over time ----------------------------------------------------------------------- */

enum { SERIES_MAX = 3 };

/* A number for each frame, of both tests. */
struct series {
    const char *id, *title;
    const struct neph_metric *metric; /* NULL: movement, smaller is better */
    double *values[NEPH_PAGE_SIDES];  /* owned; NULL: no second test */
    int count;
};

static bool is_headline_number(const struct neph_measurement *number,
                               const struct neph_headline *headline)
{
    return number->frame >= 0 && number->defined && strcmp(number->mask, "all") == 0 &&
           strcmp(number->metric->name, headline->metric) == 0 &&
           strcmp(number->quantity->name, headline->quantity) == 0;
}

/* One value for each frame, in order; NULL when a frame has none. */
static double *collect(const struct neph_compared *compared, const struct neph_headline *headline,
                       const struct neph_metric **metric)
{
    double *values = calloc((size_t)compared->frame_count + 1, sizeof(*values));
    int count = 0;
    for (int i = 0; i < compared->numbers.count && values; i++) {
        const struct neph_measurement *number = &compared->numbers.list[i];
        if (!is_headline_number(number, headline) || count == compared->frame_count)
            continue;
        values[count++] = number->value;
        *metric = number->metric;
    }
    if (count == compared->frame_count)
        return values;
    free(values);
    return NULL;
}

static bool find_headline(const struct neph_compare_page *page,
                          const struct neph_headline *headline, struct series *series)
{
    *series = (struct series){.id = headline->metric};
    for (int s = 0; s < NEPH_PAGE_SIDES && page->compared[s]; s++)
        series->values[s] = collect(page->compared[s], headline, &series->metric);
    series->count = page->compared[NEPH_PAGE_TEST]->frame_count;
    series->title = series->metric ? series->metric->help : "";
    return series->values[NEPH_PAGE_TEST] != NULL;
}

static double *copy(const double *values, int count)
{
    double *made = calloc((size_t)count + 1, sizeof(*made));
    if (made)
        memcpy(made, values, (size_t)count * sizeof(*made));
    return made;
}

static int find_series(const struct neph_compare_page *page, struct series series[SERIES_MAX])
{
    const struct neph_movement *movement = &page->compared[NEPH_PAGE_TEST]->movement;
    int count = 0;
    if (movement->frame_count > 0) {
        series[count] = (struct series){
            .id = "movement",
            .title = "RMS of luma less its mean over a cycle of four frames",
            .count = movement->frame_count};
        for (int s = 0; s < NEPH_PAGE_SIDES && page->compared[s]; s++)
            if (page->compared[s]->movement.frame_count == movement->frame_count)
                series[count].values[s] = copy(page->compared[s]->movement.frames,
                                               movement->frame_count);
        count += series[count].values[NEPH_PAGE_TEST] != NULL;
    }
    for (int h = 0; h < NEPH_HEADLINES && count < SERIES_MAX; h++) {
        const bool is_there = find_headline(page, &neph_headlines[h], &series[count]);
        if (!is_there)
            free(series[count].values[NEPH_PAGE_OTHER]);
        count += is_there;
    }
    return count;
}

static void finish_series(struct series *series, int count)
{
    for (int i = 0; i < count; i++)
        for (int s = 0; s < NEPH_PAGE_SIDES; s++)
            free(series[i].values[s]);
}

static const char *find_side_name(const struct neph_compare_page *page, int side)
{
    return page->names[side] ? page->names[side] : side == NEPH_PAGE_TEST ? "test" : "other";
}

static json_t *values_json(const double *values, int count)
{
    json_t *list = json_array();
    for (int i = 0; i < count; i++)
        neph_json_add(&list, neph_json_number(values[i]));
    return list;
}

static json_t *series_json(const struct series *series, int count)
{
    json_t *list = json_array();
    for (int i = 0; i < count; i++)
        neph_json_add(
            &list,
            json_pack("{s:s, s:s, s:o, s:o}", "id", series[i].id, "title", series[i].title, "test",
                      values_json(series[i].values[NEPH_PAGE_TEST], series[i].count), "other",
                      series[i].values[NEPH_PAGE_OTHER]
                          ? values_json(series[i].values[NEPH_PAGE_OTHER], series[i].count)
                          : json_null()));
    return list;
}

/* ---- charts ---------------------------------------------------------------------------------- */

static json_t *points_json(const struct neph_compare_page *page, const struct series *series)
{
    json_t *list = json_array();
    for (int s = 0; s < NEPH_PAGE_SIDES; s++)
        for (int f = 0; f < series->count && series->values[s]; f++)
            neph_json_add(&list, json_pack("{s:i, s:f, s:s}", "frame", f, "value",
                                           series->values[s][f], "test", find_side_name(page, s)));
    return list;
}

static enum neph_status draw_charts(const struct neph_compare_page *page, const char *folder,
                                    const struct series *series, int count, json_t **charts,
                                    char told[512], struct neph_diag *diag)
{
    char *stems[SERIES_MAX] = {NULL};
    struct neph_diag why = {.line = 0};
    enum neph_status status = NEPH_OK;
    bool drawn = false;
    for (int i = 0; i < count && !status; i++) {
        json_t *spec = NULL;
        status = neph_vega_template("compare.vl.json", &spec, diag);
        if (!status)
            status = neph_json_put(json_object_get(spec, "datasets"), "points",
                                   points_json(page, &series[i]), diag);
        if (!status)
            status = neph_json_put(spec, "title", json_string(series[i].id), diag);
        stems[i] = neph_format("%s/charts/%s", folder, series[i].id);
        if (!status)
            status = stems[i] ? neph_vega_write(spec, stems[i], diag) : neph_fail_memory(diag);
        if (!status)
            status = neph_json_append(*charts, spec, diag);
        else
            json_decref(spec);
    }
    if (!status && count > 0)
        status = neph_vega_draw(stems, count, &drawn, &why, diag);
    if (!status && count > 0 && !drawn)
        snprintf(told, 512,
                 "charts are not drawn: %.300s (apt-get install nodejs npm; npm ci --omit=dev in "
                 "scripts/report)",
                 why.message);
    for (int i = 0; i < count; i++)
        free(stems[i]);
    return status;
}

/* ---- frames with the largest errors ---------------------------------------------------------- */

static bool is_worse(const struct series *series, double a, double b)
{
    const bool is_reversed = series->metric &&
                             neph_metric_direction(series->metric) == NEPH_LARGER_IS_BETTER;
    return is_reversed ? a < b : fabs(a) > fabs(b);
}

/* The frame with the largest error that is not in `before`; -1: none is left. */
static int find_worst(const struct series *series, const int *before, int count)
{
    const double *values = series->values[NEPH_PAGE_TEST];
    int worst = -1;
    for (int f = 0; f < series->count; f++) {
        bool is_taken = false;
        for (int i = 0; i < count; i++)
            is_taken |= before[i] == f;
        if (!is_taken && (worst < 0 || is_worse(series, values[f], values[worst])))
            worst = f;
    }
    return worst;
}

/* Draw the maps of single frames for the frame with the largest error. */
static enum neph_status draw_maps(const struct neph_compare_page *page, const char *folder,
                                  int index, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    const struct neph_comparison *asked = page->compared[NEPH_PAGE_TEST]->asked;
    for (int s = 0; s < NEPH_PAGE_SIDES && page->tests[s] && !status; s++) {
        struct neph_comparison one = *asked;
        struct neph_compared compared = {.asked = NULL};
        struct neph_compare_maps maps = {folder, (enum neph_page_side)s, page->compared[s]->viewing,
                                         page->maps};
        const int at = asked->warm_up_frames + index;
        one.reference.paths += asked->reference.count == 1 ? 0 : at;
        one.test = *page->tests[s];
        one.test.paths += at;
        one.reference.count = one.test.count = 1;
        one.reference.numbers = one.test.numbers = NULL;
        one.second = (struct neph_sequence){.count = 0};
        one.warm_up_frames = 0;
        one.by_position = one.plain = one.quiet = one.allow_frozen_frames = true;
        one.with_movement = false;
        one.maps_directory = NULL;
        one.take_map = neph_compare_page_take;
        one.map_context = &maps;
        status = neph_comparison_run(&one, false, &compared, diag);
        neph_compared_finish(&compared);
    }
    return status;
}

static enum neph_status draw_worst(const struct neph_compare_page *page, const char *folder,
                                   const struct series *series, json_t *frames,
                                   struct neph_diag *diag)
{
    int worst[NEPH_WORST_FRAMES];
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < NEPH_WORST_FRAMES && !status; i++) {
        json_t *frame = NULL;
        worst[i] = find_worst(series, worst, i);
        if (worst[i] < 0)
            break;
        status = neph_compare_frame_draw(page, folder, worst[i],
                                         series->values[NEPH_PAGE_TEST][worst[i]], &frame, diag);
        if (!status)
            status = neph_json_append(frames, frame, diag);
        if (!status && i == 0 && series->metric) /* movement has no maps of single frames */
            status = draw_maps(page, folder, worst[0], diag);
    }
    return status;
}

/* ---- the document ---------------------------------------------------------------------------- */

static json_t *colour_json(const uint8_t rgb[3])
{
    return json_sprintf("#%02x%02x%02x", rgb[0], rgb[1], rgb[2]);
}

static json_t *colours_json(const struct neph_display_legend *legend)
{
    json_t *colours = json_array();
    for (int i = 0; i < legend->stop_count; i++)
        neph_json_add(&colours, colour_json(legend->stops[i].rgb));
    return json_pack("{s:o, s:o, s:o, s:o}", "stops", colours, "below", colour_json(legend->below),
                     "above", colour_json(legend->above), "none",
                     colour_json(legend->not_a_number));
}

static json_t *lines_json(const char *text)
{
    json_t *list = json_array();
    for (const char *end; (end = strchr(text, '\n')); text = end + 1)
        neph_json_add(&list, json_stringn(text, (size_t)(end - text)));
    return list;
}

/* Numbers of single frames are left out of a sequence's page, where they would dominate its size;
 * --csv and --json contain them. */
static json_t *compared_json(const struct neph_compared *compared)
{
    json_t *json = neph_compared_json(compared), *kept = json_array(), *number;
    size_t i;
    json_array_foreach(json_object_get(json, "measurements"), i, number)
    {
        if (compared->frame_count == 1 || !json_object_get(number, "frame"))
            neph_json_add(&kept, json_incref(number));
    }
    neph_json_set(&json, "measurements", kept);
    return json;
}

struct drawn {
    json_t *charts, *frames; /* owned */
    bool is_interactive;
};

static json_t *document_json(const struct neph_compare_page *page, const struct series *series,
                             int series_count, const struct drawn *drawn)
{
    const struct neph_compared *compared = page->compared[NEPH_PAGE_TEST];
    json_t *names = json_array();
    for (int s = 0; s < NEPH_PAGE_SIDES && page->tests[s]; s++)
        neph_json_add(&names, json_string(find_side_name(page, s)));
    return json_pack(
        "{s:s, s:s, s:o, s:o, s:o, s:O, s:O, s:O, s:b, s:o, s:o, s:o}", "format", "neph-compare-1",
        "verb", page->verb, "names", names, "verdict", lines_json(page->verdict), "series",
        series_json(series, series_count), "charts", drawn->charts, "frames", drawn->frames, "maps",
        page->maps, "interactive", drawn->is_interactive, "differences",
        colours_json(neph_display_difference_legend()), "amounts",
        colours_json(neph_display_amount_legend()), "compared", compared_json(compared));
}

enum neph_status neph_compare_page_write(const struct neph_compare_page *page,
                                         const struct neph_report_folder *folder, char told[512],
                                         struct neph_diag *diag)
{
    const char *work = neph_report_folder_work(folder);
    struct series series[SERIES_MAX];
    struct drawn drawn = {json_array(), json_array(), false};
    json_t *document = NULL;
    const int count = find_series(page, series);
    told[0] = '\0';
    enum neph_status status = neph_page_start(work, &parts, &drawn.is_interactive, diag);
    if (!status && count > 0 && series[0].count > 1)
        status = draw_charts(page, work, series, count, &drawn.charts, told, diag);
    if (!status && count > 0)
        status = draw_worst(page, work, &series[0], drawn.frames, diag);
    if (!status) {
        document = document_json(page, series, count, &drawn);
        status = neph_json_check(document, diag);
    }
    if (!status)
        status = neph_page_publish(folder, "NEPH_COMPARE", document, diag);
    json_decref(document);
    json_decref(drawn.charts);
    json_decref(drawn.frames);
    finish_series(series, count);
    return status;
}
