/* SPDX-License-Identifier: MIT
 *
 * The registry of phase functions: number, name and file. Each is a file scenes/phase_FILE.c and
 * one line here; shaders include this list and have a file renderer/shaders/phase_FILE.glsl. The
 * number is part of the hashes of scenes, and the file's name is the word in scene files.
 */
#ifndef NEPH_SCENES_PHASE_KINDS_H
#define NEPH_SCENES_PHASE_KINDS_H

/* clang-format off */
#define NEPH_PHASE_KINDS(of) \
    of(0, ISOTROPIC, isotropic) \
    of(1, HENYEY_GREENSTEIN, henyey_greenstein) \
    of(2, RAYLEIGH, rayleigh)
/* clang-format on */

/* The kinds that need the key asymmetry_g: for the reference of keys and for messages. */
#define NEPH_PHASES_WITH_ASYMMETRY "henyey_greenstein"

#endif
