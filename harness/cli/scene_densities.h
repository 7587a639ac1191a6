/* SPDX-License-Identifier: MIT
 *
 * The extinction of each medium and layer in all units of scenes/density_units.h, what each unit
 * assumes, and the properties that no unit expresses: for `neph scenes NAME`.
 */
#ifndef NEPH_HARNESS_CLI_SCENE_DENSITIES_H
#define NEPH_HARNESS_CLI_SCENE_DENSITIES_H

#include "harness/json.h"
#include "scenes/scene.h"

/* Print a table on stdout; nothing without media. */
void neph_print_densities(const struct neph_scene *scene);

/* The table as an object: "media" has an object for each medium or layer, "assumptions" the texts.
 * NULL: memory is short. */
json_t *neph_densities_json(const struct neph_scene *scene);

#endif
