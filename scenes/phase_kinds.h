/* SPDX-License-Identifier: MIT
 *
 * The registry of phase functions: number, name and file. Each is a file scenes/phase_FILE.c and
 * one line here. The number is part of the hashes of scenes, and the file's name is the word in
 * scene files.
 *
 * Shaders include this list. The first kinds have a file renderer/shaders/phase_FILE.glsl; the
 * others reach the device as tables (renderer/phase_tables.h) and need nothing there.
 */
#ifndef NEPH_SCENES_PHASE_KINDS_H
#define NEPH_SCENES_PHASE_KINDS_H

/* clang-format off */
#define NEPH_PHASES_IN_SHADERS(of) \
    of(0, ISOTROPIC, isotropic) \
    of(1, HENYEY_GREENSTEIN, henyey_greenstein) \
    of(2, RAYLEIGH, rayleigh)

#define NEPH_PHASES_BY_TABLE(of) \
    of(3, TABLE, table) \
    of(4, DOUBLE_HENYEY_GREENSTEIN, double_henyey_greenstein) \
    of(5, CORNETTE_SHANKS, cornette_shanks) \
    of(6, DRAINE, draine) \
    of(7, JENDERSIE_DEON, jendersie_deon) \
    of(8, POVRAY_MIE_HAZY, povray_mie_hazy) \
    of(9, POVRAY_MIE_MURKY, povray_mie_murky)
/* clang-format on */

#define NEPH_PHASE_KINDS(of) NEPH_PHASES_IN_SHADERS(of) NEPH_PHASES_BY_TABLE(of)

#endif
