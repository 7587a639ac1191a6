/* SPDX-License-Identifier: MIT
 *
 * The files of the maps of a comparison: their names, none of which takes the place of a frame that
 * is read, and what is in them.
 */
#ifndef NEPH_HARNESS_COMPARE_MAPS_H
#define NEPH_HARNESS_COMPARE_MAPS_H

#include "base/path.h"
#include "harness/compare/measure.h"
#include "harness/compare/sequence.h"

/* "FOLDER/MAP_QUANTITY[_FRAME]", without the ending. `frame` below 0: of the whole sequence, or the
 * only one. */
struct neph_path neph_map_stem(const char *folder, const struct neph_map *map,
                               const struct neph_quantity *quantity, int frame);

/* NEPH_ERR_USAGE, naming the file, when one of `frames` lies where a map of the chosen extractors
 * may be written. */
enum neph_status neph_map_names_check(const struct neph_sequence *frames, const char *folder,
                                      const struct neph_meter_choice *choices, int choice_count,
                                      struct neph_diag *diag);

/* Write the values of a map, and a picture of them on its fixed scale. */
enum neph_status neph_map_write(const char *exr, const char *png, const struct neph_map *map,
                                const struct neph_viewing *viewing, const struct neph_image *image,
                                struct neph_diag *diag);

/* Where the colours of a map's picture end, in its own unit. */
double neph_map_scale(const struct neph_map *map, const struct neph_viewing *viewing);

/* Write the picture alone. */
enum neph_status neph_map_png(const char *path, const struct neph_map *map,
                              const struct neph_viewing *viewing, const struct neph_image *image,
                              struct neph_diag *diag);

#endif
