/* SPDX-License-Identifier: MIT */
#include "harness/compare/maps.h"

#include "base/exr.h"
#include "base/files.h"
#include "base/png.h"
#include "metrics/display.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct neph_path neph_map_stem(const char *folder, const struct neph_map *map,
                               const struct neph_quantity *quantity, int frame)
{
    const struct neph_path name = frame < 0 ? neph_path_format("%s_%s", map->name, quantity->name)
                                            : neph_path_format("%s_%s_%04d", map->name,
                                                               quantity->name, frame);
    return neph_path_in(folder, name.text);
}

/* True for "MAP_QUANTITY" followed by an extension, or by a number and an extension. */
static bool is_map_file_name(const struct neph_map *map, const char *name)
{
    for (int q = 0; map->name && q < neph_quantity_count(); q++) {
        char stem[2 * NEPH_IMAGE_NAME_MAX];
        const int length = snprintf(stem, sizeof(stem), "%s_%s", map->name,
                                    neph_quantity_at(q)->name);
        if (strncmp(name, stem, (size_t)length) != 0)
            continue;
        const char *rest = name + length;
        rest += *rest == '_' ? 1 + strspn(rest + 1, "0123456789") : 0;
        if (strcmp(rest, ".exr") == 0 || strcmp(rest, ".png") == 0)
            return true;
    }
    return false;
}

static bool is_map_name(const struct neph_meter_choice *choices, int choice_count, const char *name)
{
    for (int c = 0; c < choice_count; c++) {
        const struct neph_extractor *extractor = choices[c].extractor;
        for (int m = 0; m < extractor->map_count; m++)
            if (is_map_file_name(&extractor->maps[m], name))
                return true;
    }
    return false;
}

static bool is_in_folder(const char *path, const char *slash, const char *folder)
{
    char *parent = slash ? strndup(path, (size_t)(slash - path) + 1) : strdup(".");
    const bool same = parent && neph_path_is_same(parent, folder);
    free(parent);
    return same;
}

enum neph_status neph_map_names_check(const struct neph_sequence *frames, const char *folder,
                                      const struct neph_meter_choice *choices, int choice_count,
                                      struct neph_diag *diag)
{
    for (int i = 0; i < frames->count; i++) {
        const char *path = frames->paths[i], *slash = strrchr(path, '/');
        if (!is_map_name(choices, choice_count, slash ? slash + 1 : path) ||
            !is_in_folder(path, slash, folder))
            continue;
        neph_fail(diag, NEPH_ERR_USAGE, "a map would be written over the frame '%s'", path);
        neph_hint(diag, "name another folder with --maps");
        return NEPH_ERR_USAGE;
    }
    return NEPH_OK;
}

/* The scale of a map in the unit of the quantity follows the exposure: see struct neph_map. */
double neph_map_scale(const struct neph_map *map, const struct neph_viewing *viewing)
{
    return map->unit ? map->scale : map->scale * exp2(-viewing->exposure_ev);
}

enum neph_status neph_map_png(const char *path, const struct neph_map *map,
                              const struct neph_viewing *viewing, const struct neph_image *image,
                              struct neph_diag *diag)
{
    const float *planes[3] = {neph_image_channel(image, "Y"), NULL, NULL};
    float *rgb[3];
    const bool is_rgb = neph_image_rgb(image, NULL, rgb);
    for (int c = 0; is_rgb && c < 3; c++)
        planes[c] = rgb[c];
    const size_t pixel_count = neph_image_pixel_count(image);
    uint8_t *shown = malloc(3 * pixel_count);
    enum neph_status status = shown ? neph_display_map(planes, is_rgb ? 3 : 1, pixel_count,
                                                       map->is_signed, neph_map_scale(map, viewing),
                                                       shown, diag)
                                    : neph_fail_memory(diag);
    if (!status)
        status = neph_png_write_rgb8(path, image->width_px, image->height_px, shown, diag);
    free(shown);
    return status;
}

enum neph_status neph_map_write(const char *exr, const char *png, const struct neph_map *map,
                                const struct neph_viewing *viewing, const struct neph_image *image,
                                struct neph_diag *diag)
{
    const enum neph_status status = neph_exr_write(exr, image, diag);
    return status ? status : neph_map_png(png, map, viewing, image, diag);
}
