/* SPDX-License-Identifier: MIT
 *
 * Maps of an attribution: where the flicker of a part is, beside the frame.
 */
#include "harness/study/attribution_study.h"

#include "base/exr.h"
#include "base/files.h"
#include "base/path.h"
#include "base/png.h"
#include "harness/data.h"
#include "metrics/display.h"
#include "scenes/display.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { GAP_PX = 4 };

/* Adds `weight` times the squares of a map to `sum`. */
static enum neph_status add_squares(const char *path, double weight, const struct neph_image *frame,
                                    double *sum, struct neph_diag *diag)
{
    struct neph_image *map = NULL;
    enum neph_status status = neph_exr_read(path, &map, diag);
    const float *values = status ? NULL : neph_image_channel(map, "Y");
    const size_t count = neph_image_pixel_count(frame);
    if (!status && (!values || neph_image_pixel_count(map) != count))
        status = neph_fail(diag, NEPH_ERR_INTERNAL, "the map '%s' is of another frame", path);
    for (size_t i = 0; i < count && !status; i++)
        sum[i] += weight * values[i] * values[i];
    neph_image_destroy(map);
    return status;
}

/* The flicker of a part in each pixel; `sum` is zero. */
static enum neph_status make_map(const struct neph_attribution_study *attribution, int scene,
                                 int part, const struct neph_image *frame, double *sum,
                                 struct neph_diag *diag)
{
    const struct neph_flicker_study *study = attribution->study;
    const int seed_count = study->params->seed_count;
    const neph_part_set state = neph_part_set_without(NEPH_PARTS_ALL,
                                                      (enum neph_attribution_part_id)part);
    const int without = neph_attribution_find_sequence(attribution->plan, state);
    const enum neph_ideal_kind against = neph_attribution_find_reference(state);
    enum neph_status status = NEPH_OK;
    for (int seed = 0; seed < seed_count && !status; seed++) {
        const char *all = neph_study_cost_at(study, scene, 0, seed)->folder,
                   *ideal = neph_study_cost_at(study, scene, without, seed)->folder;
        status = add_squares(neph_study_map_path(all, NEPH_IDEALS).text, 1.0 / seed_count, frame,
                             sum, diag);
        if (!status)
            status = add_squares(neph_study_map_path(ideal, against).text, -1.0 / seed_count, frame,
                                 sum, diag);
    }
    return status;
}

/* Copies an image of `width_px` columns into a wider one, from a column on. */
static void copy_columns(const uint8_t *from, int width_px, int height_px, int to_width_px,
                         int first_px, uint8_t *to)
{
    for (int y = 0; y < height_px; y++)
        memcpy(to + 3 * ((size_t)y * (size_t)to_width_px + (size_t)first_px),
               from + 3 * (size_t)y * (size_t)width_px, 3 * (size_t)width_px);
}

/* Writes the frame and a map beside it. `rgb` has room for one of them, `both` for the image. */
static enum neph_status write_pair(const struct neph_image *frame, const float *map,
                                   double exposure_ev, uint8_t *rgb, uint8_t *both,
                                   const char *path, struct neph_diag *diag)
{
    const int width_px = frame->width_px, height_px = frame->height_px;
    const int both_px = 2 * width_px + GAP_PX;
    const size_t count = neph_image_pixel_count(frame);
    float *planes[3];
    if (!neph_image_rgb(frame, NULL, planes))
        return neph_fail(diag, NEPH_ERR_INTERNAL, "the frame of '%s' has no radiance", path);
    const float *const constant[3] = {planes[0], planes[1], planes[2]};
    enum neph_status status = neph_display_encode(constant, count, exposure_ev, rgb, diag);
    memset(both, 255, 3 * (size_t)both_px * (size_t)height_px);
    copy_columns(rgb, width_px, height_px, both_px, 0, both);
    if (!status)
        status = neph_display_map(&map, 1, count, false, NEPH_ATTRIBUTION_MAP_SCALE, rgb, diag);
    copy_columns(rgb, width_px, height_px, both_px, width_px + GAP_PX, both);
    return status ? status : neph_png_write_rgb8(path, both_px, height_px, both, diag);
}

static enum neph_status draw_part(const struct neph_attribution_study *attribution, int scene,
                                  int part, const struct neph_image *frame, double exposure_ev,
                                  const char *folder, struct neph_diag *diag)
{
    const size_t count = neph_image_pixel_count(frame);
    const struct neph_path path = neph_path_format("%s/%s_%s.png", folder,
                                                   attribution->study->scenes[scene].name,
                                                   neph_attribution_parts[part].name);
    double *sum = calloc(count, sizeof(*sum));
    float *map = malloc(count * sizeof(*map));
    uint8_t *rgb = malloc(3 * count),
            *both = malloc(3 * (2 * count + GAP_PX * (size_t)frame->height_px));
    enum neph_status status = sum && map && rgb && both ? NEPH_OK : neph_fail_memory(diag);
    if (!status)
        status = make_map(attribution, scene, part, frame, sum, diag);
    for (size_t i = 0; i < count && !status; i++)
        map[i] = (float)sqrt(fmax(sum[i], 0.0));
    if (!status)
        status = write_pair(frame, map, exposure_ev, rgb, both, path.text, diag);
    free(sum);
    free(map);
    free(rgb);
    free(both);
    return status;
}

static enum neph_status draw_scene(const struct neph_attribution_study *attribution, int index,
                                   const char *folder, struct neph_diag *diag)
{
    const struct neph_flicker_study *study = attribution->study;
    const char *entry = neph_study_cost_at(study, index, 0, 0)->folder;
    struct neph_scene *scene = NULL;
    struct neph_image *frame = NULL;
    enum neph_status status = neph_data_load_scene(study->params->scenes[index], &scene, diag);
    if (!status)
        status = neph_exr_read(neph_path_in(entry, "frame.exr").text, &frame, diag);
    for (int i = 0; i < NEPH_ATTRIBUTION_WORST && !status; i++)
        status = draw_part(attribution, index, attribution->order[i], frame,
                           neph_scene_display(scene)->exposure_ev, folder, diag);
    neph_image_destroy(frame);
    neph_scene_destroy(scene);
    return status;
}

enum neph_status neph_attribution_draw_maps(const struct neph_attribution_study *attribution,
                                            const char *folder, struct neph_diag *diag)
{
    enum neph_status status = neph_dir_create(folder, diag);
    for (int i = 0; i < attribution->study->params->scene_count && !status; i++)
        if (!attribution->scenes[i].why)
            status = draw_scene(attribution, i, folder, diag);
    return status;
}
