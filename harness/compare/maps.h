/* SPDX-License-Identifier: MIT
 *
 * The files of a comparison's maps: their names, a check that no map overwrites an input frame, and
 * their contents.
 */
#ifndef NEPH_HARNESS_COMPARE_MAPS_H
#define NEPH_HARNESS_COMPARE_MAPS_H

#include "base/path.h"
#include "harness/compare/measure.h"
#include "harness/compare/sequence.h"

/* The path "FOLDER/MAP_QUANTITY[_FRAME]" without extension. `frame` below 0: the map of the whole
 * sequence, or of the only frame. */
struct neph_path neph_map_stem(const char *folder, const struct neph_map *map,
                               const struct neph_quantity *quantity, int frame);

/* NEPH_ERR_USAGE with the file's name when a map of the chosen extractors could overwrite one of
 * `frames`. */
enum neph_status neph_map_names_check(const struct neph_sequence *frames, const char *folder,
                                      const struct neph_meter_choice *choices, int choice_count,
                                      struct neph_diag *diag);

/* Write the values of a map as EXR, and an image of them on its fixed scale as PNG. */
enum neph_status neph_map_write(const char *exr, const char *png, const struct neph_map *map,
                                const struct neph_viewing *viewing, const struct neph_image *image,
                                struct neph_diag *diag);

/* End of the colour scale of a map's image, in the map's unit. */
double neph_map_scale(const struct neph_map *map, const struct neph_viewing *viewing);

/* Write only the image. */
enum neph_status neph_map_png(const char *path, const struct neph_map *map,
                              const struct neph_viewing *viewing, const struct neph_image *image,
                              struct neph_diag *diag);

#endif
