/* SPDX-License-Identifier: MIT
 *
 * A scene's height fog in three worlds: as physics has it, Unreal Engine and Filament.
 */
#ifndef NEPH_HARNESS_CLI_SCENES_FOG_H
#define NEPH_HARNESS_CLI_SCENES_FOG_H

#include "harness/json.h"
#include "scenes/scene.h"

/* Their numbers side by side, what does not translate, and what it does to light. Nothing of a
 * scene without a height fog. */
void neph_cli_print_fog(const struct neph_scene *scene);

/* As much; null without a height fog. */
json_t *neph_cli_fog_json(const struct neph_scene *scene);

#endif
