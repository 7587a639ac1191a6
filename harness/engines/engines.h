/* SPDX-License-Identifier: MIT
 *
 * The list of engines, in the order of the ladder: the one line that a new one needs beside its
 * file.
 */
#ifndef NEPH_HARNESS_ENGINES_ENGINES_H
#define NEPH_HARNESS_ENGINES_ENGINES_H

#include "harness/engines/engine.h"

/* clang-format off */
#define NEPH_ENGINES(of) \
    of(exact) \
    of(oracle) \
    of(surfaces) \
    of(tracer) \
    of(march) \
    of(march_octaves) \
    of(march_horizon) \
    of(march_octaves_fitted) \
    of(march_traced) \
    of(march_diffused) \
    of(march_similarity) \
    of(march_slab) \
    of(sky) \
    of(fog_look) \
    of(screen) \
    of(realtime) \
    of(cycles) \
    of(povray) \
    of(command)
/* clang-format on */

#define NEPH_ENGINE_DECLARED(name) extern const struct neph_engine neph_engine_##name;
NEPH_ENGINES(NEPH_ENGINE_DECLARED)
#undef NEPH_ENGINE_DECLARED

/* Engines of further Blenders (blender.h), at most. */
enum { NEPH_ENGINE_PROGRAMS_MAX = 7 };

/* How many there may be, guests among them: what holds one of each has room for so many. */
#define NEPH_ENGINE_COUNTED(name) +1
enum { NEPH_ENGINE_COUNT = NEPH_ENGINE_PROGRAMS_MAX NEPH_ENGINES(NEPH_ENGINE_COUNTED) };
#undef NEPH_ENGINE_COUNTED

/* All engines but guests; `*count` receives how many. */
const struct neph_engine *const *neph_engines(int *count);

/* The same, and guests behind them. */
const struct neph_engine *const *neph_engines_and_guests(int *count);

/* By name, guests among them; NULL when there is none. */
const struct neph_engine *neph_engine_find(const char *name);

/* Whether pictures are drawn by chance, so that another seed gives another one of the same mean:
 * tracers, and witnesses that trace. A shortcut whose rays are jittered is another picture. */
bool neph_engine_draws(const struct neph_engine *engine);

/* What presets are named by where guests take part, too: "PRESET+KEY=VALUE+..." of `realtime`, or
 * "command+KEY=VALUE+...". `shared` ("steps=8"; or NULL) is set before the changes, of an engine
 * that has it. Errors as of neph_settings_words(). */
enum neph_status neph_engine_words(const char *words, const char *shared,
                                   const struct neph_engine **engine,
                                   struct neph_settings *settings, struct neph_diag *diag);

#endif
