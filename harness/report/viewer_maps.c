/* SPDX-License-Identifier: MIT */
#include "harness/report/viewer_maps.h"

#include "harness/compare/comparison.h"
#include "metrics/extractors/extractors.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const char *const neph_viewer_overlays[3] = {"relative", "flip", "a4"};

/* A requested map and the extractor that computes it. */
struct overlay {
    const struct neph_extractor *extractor;
    const struct neph_map *map;
    json_t *sets; /* indices of the sets with this map; owned */
};

struct maps {
    const struct neph_viewer *view;
    neph_viewer_ship *ship;
    void *context;
    int set; /* index of the current set */
    struct overlay overlays[NEPH_VIEWER_OVERLAYS_MAX];
    int count;
};

/* ---- requested maps -------------------------------------------------------------------------- */

static bool find_map(const char *name, struct overlay *overlay)
{
    for (int e = 0; e < neph_extractor_count(); e++) {
        const struct neph_extractor *extractor = neph_extractor_at(e);
        for (int m = 0; m < extractor->map_count; m++)
            if (extractor->maps[m].name && strcmp(extractor->maps[m].name, name) == 0) {
                *overlay = (struct overlay){.extractor = extractor, .map = &extractor->maps[m]};
                return true;
            }
    }
    return false;
}

static enum neph_status find_radiance_map(const char *name, struct overlay *overlay,
                                          struct neph_diag *diag)
{
    if (find_map(name, overlay) && overlay->extractor->quantities & NEPH_RADIANCE)
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_USAGE, "there is no map '%s' of radiance", name);
    neph_hint(diag, "such as relative, difference, flip, ssim, a4, seen_contrast: the files that "
                    "`neph compare --metric all --maps DIR` writes");
    return NEPH_ERR_USAGE;
}

enum neph_status neph_viewer_check_overlays(const struct neph_viewer *view, struct neph_diag *diag)
{
    struct overlay overlay;
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < view->overlay_count && !status; i++)
        status = find_radiance_map(view->overlays[i], &overlay, diag);
    return status;
}

static enum neph_status find_maps(struct maps *maps, struct neph_diag *diag)
{
    for (int i = 0; i < maps->view->overlay_count; i++) {
        struct overlay *overlay = &maps->overlays[maps->count];
        const enum neph_status status = find_radiance_map(maps->view->overlays[i], overlay, diag);
        if (status)
            return status;
        overlay->sets = json_array();
        maps->count++;
    }
    return NEPH_OK;
}

/* ---- one set --------------------------------------------------------------------------------- */

static void choose(struct neph_comparison *comparison, const struct neph_extractor *extractor)
{
    for (int c = 0; c < comparison->choice_count; c++)
        if (comparison->choices[c].extractor == extractor)
            return;
    comparison->choices[comparison->choice_count++] = (struct neph_meter_choice){
        extractor, neph_options_default(extractor->options)};
}

static struct overlay *find_overlay(struct maps *maps, const struct neph_map *map)
{
    for (int i = 0; i < maps->count; i++)
        if (maps->overlays[i].map == map)
            return &maps->overlays[i];
    return NULL;
}

/* Ship a map of radiance if it was requested. */
static enum neph_status take_map(void *context, const struct neph_map *map,
                                 const struct neph_quantity *quantity, int frame,
                                 const struct neph_image *image, struct neph_diag *diag)
{
    struct maps *maps = context;
    struct overlay *overlay = find_overlay(maps, map);
    const float *planes[3] = {neph_image_channel(image, "Y"), NULL, NULL};
    char key[96], number[16] = "all";
    if (!overlay || quantity->bit != NEPH_RADIANCE)
        return NEPH_OK;
    if (!planes[0])
        neph_quantity_planes(quantity, image, planes);
    if (frame >= 0)
        snprintf(number, sizeof(number), "%d", frame);
    if (frame <= 0) /* first frame of this set */
        neph_json_add(&overlay->sets, json_integer(maps->set));
    snprintf(key, sizeof(key), "%d_%s_map_%s", maps->set, number, map->name);
    return maps->ship(maps->context, key, planes, planes[1] ? 3 : 1, diag);
}

/* Borrows the sequences of the view. */
static struct neph_comparison make_set_comparison(struct maps *maps, int set, bool is_picture,
                                                  double frame_rate_hz)
{
    static const struct neph_meter_number none[] = {{NULL, NULL}};
    const struct neph_viewer *view = maps->view;
    const bool is_sequence = view->sets[set].frames.count > 1;
    struct neph_comparison comparison = {
        .source = &neph_frame_files,
        .reference = view->sets[0].frames,
        .test = view->sets[set].frames,
        .viewing = view->viewing,
        .wanted = none,
        .frame_choice = view->frame_choice,
        .windows = view->windows,
        .take_map = take_map,
        .map_context = maps,
        .warm_up_frames = is_sequence ? view->warm_up_frames : 0,
        .negative_allowed = SIZE_MAX,
        .by_position = view->by_position,
        .allow_frozen_frames = true,
        .plain = true,
        .quiet = view->quiet,
    };
    comparison.viewing.frame_rate_hz = frame_rate_hz;
    if (is_picture) /* already contains the exposure */
        comparison.viewing.exposure_ev = 0.0;
    for (int i = 0; i < maps->count; i++)
        choose(&comparison, maps->overlays[i].extractor);
    return comparison;
}

static void add_obstacle(json_t **not_taken, int set, const char *name, const char *because)
{
    neph_json_add(not_taken,
                  json_pack("{s:i, s:s, s:s}", "set", set, "overlay", name, "because", because));
}

/* List the reasons for missing maps, as the comparison gives them. */
static void add_missing_maps(const struct maps *maps, const struct neph_compared *compared, int set,
                             json_t **not_taken)
{
    for (int i = 0; i < maps->count; i++)
        for (int n = 0; n < compared->not_taken_count; n++) {
            const struct neph_not_taken *row = &compared->not_taken[n];
            if (strcmp(row->extractor, maps->overlays[i].extractor->name) == 0 &&
                strcmp(row->quantity, neph_quantity_at(0)->name) == 0)
                add_obstacle(not_taken, set, maps->overlays[i].map->name, row->because);
        }
}

static enum neph_status compare(struct maps *maps, int set, bool is_picture, double frame_rate_hz,
                                json_t **not_taken, struct neph_diag *diag)
{
    const struct neph_comparison comparison = make_set_comparison(maps, set, is_picture,
                                                                  frame_rate_hz);
    struct neph_compared compared = {.asked = NULL};
    maps->set = set;
    const enum neph_status status = neph_comparison_run(&comparison, false, &compared, diag);
    if (!status)
        add_missing_maps(maps, &compared, set, not_taken);
    neph_compared_finish(&compared);
    return status;
}

/* ---- all sets -------------------------------------------------------------------------------- */

static void add_overlays(const struct maps *maps, bool is_picture, json_t **overlays)
{
    const double exposure_ev = is_picture ? 0.0 : maps->view->viewing.exposure_ev;
    for (int i = 0; i < maps->count; i++) {
        const struct overlay *overlay = &maps->overlays[i];
        const struct neph_map *map = overlay->map;
        neph_json_add(
            overlays,
            json_pack("{s:s, s:s, s:s, s:i, s:b, s:f, s:b, s:O}", "name", map->name, "help",
                      overlay->extractor->help, "unit",
                      map->unit ? map->unit : neph_quantity_at(0)->unit, "planes",
                      map->plane_count ? map->plane_count : neph_quantity_at(0)->plane_count,
                      "is_signed", map->is_signed, "scale",
                      map->unit ? map->scale : map->scale * exp2(-exposure_ev), "temporal",
                      overlay->extractor->temporal, "sets", overlay->sets));
    }
}

enum neph_status neph_viewer_maps(const struct neph_viewer *view, bool is_picture,
                                  double frame_rate_hz, neph_viewer_ship *ship, void *context,
                                  json_t **overlays, json_t **not_taken, struct neph_diag *diag)
{
    struct maps maps = {.view = view, .ship = ship, .context = context};
    enum neph_status status = find_maps(&maps, diag);
    for (int s = 1; s < view->set_count && maps.count > 0 && !status; s++) {
        if (view->sets[0].frames.count > 1 && view->sets[s].frames.count == 1)
            add_obstacle(not_taken, s, "all", "a single frame is not compared with a sequence");
        else
            status = compare(&maps, s, is_picture, frame_rate_hz, not_taken, diag);
    }
    if (!status)
        add_overlays(&maps, is_picture, overlays);
    for (int i = 0; i < maps.count; i++)
        json_decref(maps.overlays[i].sets);
    return status;
}
