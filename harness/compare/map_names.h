/* SPDX-License-Identifier: MIT
 *
 * What maps of a comparison are called, and that none takes the place of a frame that it reads.
 */
#ifndef NEPH_HARNESS_COMPARE_MAP_NAMES_H
#define NEPH_HARNESS_COMPARE_MAP_NAMES_H

#include "harness/compare/measure.h"
#include "harness/compare/sequence.h"

/* "FOLDER/MAP_QUANTITY[_FRAME]", without the ending, for the caller to free; NULL when memory is
 * short. `frame` below 0: of the whole sequence, or the only one. */
char *neph_map_stem(const char *folder, const struct neph_map *map,
                    const struct neph_quantity *quantity, int frame);

/* NEPH_ERR_USAGE, naming the file, when one of `frames` lies where a map of the chosen extractors
 * may be written. */
enum neph_status neph_map_names_check(const struct neph_sequence *frames, const char *folder,
                                      const struct neph_meter_choice *choices, int choice_count,
                                      struct neph_diag *diag);

#endif
