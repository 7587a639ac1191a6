/* SPDX-License-Identifier: MIT
 *
 * The phase function of each medium, its mean cosine and its albedo: for `neph scenes NAME`.
 */
#ifndef NEPH_HARNESS_CLI_SCENE_PHASES_H
#define NEPH_HARNESS_CLI_SCENE_PHASES_H

#include "harness/json.h"
#include "scenes/scene.h"

/* Print a line for each medium on stdout. */
void neph_print_phases(const struct neph_scene *scene);

/* An array with a member for each medium. NULL: memory is short. */
json_t *neph_phases_json(const struct neph_scene *scene);

#endif
