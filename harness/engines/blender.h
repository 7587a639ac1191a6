/* SPDX-License-Identifier: MIT
 *
 * Which Blenders there are. NEPH_BLENDER names programs or folders of unpacked archives, separated
 * by colons; without it there is the Blender in PATH. The first is engine `cycles`; the others are
 * engines named by their versions, `cycles@5.2`.
 */
#ifndef NEPH_HARNESS_ENGINES_BLENDER_H
#define NEPH_HARNESS_ENGINES_BLENDER_H

#include "harness/engines/program.h"

extern const struct neph_external_renderer neph_blender;

/* What is run with a Blender, in the data folder. */
#define NEPH_BLENDER_SCRIPT "blender_render.py"
#define NEPH_BLENDER_SCRIPT_PATH "scripts/" NEPH_BLENDER_SCRIPT

#endif
