/* SPDX-License-Identifier: MIT
 *
 * The installed Blenders. NEPH_BLENDER names programs or folders of unpacked archives, separated by
 * colons; without it, Blender is taken from PATH. The first one is engine `cycles`; the others are
 * engines with a version in their name, `cycles@5.2`.
 */
#ifndef NEPH_HARNESS_ENGINES_BLENDER_H
#define NEPH_HARNESS_ENGINES_BLENDER_H

#include "harness/engines/program.h"

extern const struct neph_external_renderer neph_blender;

/* The script that Blender runs, in the data folder. */
#define NEPH_BLENDER_SCRIPT "blender_render.py"
#define NEPH_BLENDER_SCRIPT_PATH "scripts/" NEPH_BLENDER_SCRIPT

#endif
