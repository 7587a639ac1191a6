/* SPDX-License-Identifier: MIT
 *
 * The list of engines, ordered by their level in the reference hierarchy. A new engine needs its
 * file and one line here.
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

/* Limit of engines for further Blenders (blender.h). */
enum { NEPH_ENGINE_PROGRAMS_MAX = 7 };

/* Upper bound of the number of engines, user engines included: the size of arrays with one entry
 * per engine. */
#define NEPH_ENGINE_COUNTED(name) +1
enum { NEPH_ENGINE_COUNT = NEPH_ENGINE_PROGRAMS_MAX NEPH_ENGINES(NEPH_ENGINE_COUNTED) };
#undef NEPH_ENGINE_COUNTED

/* All engines but user engines; `*count` receives their number. */
const struct neph_engine *const *neph_engines(int *count);

/* All engines, user engines last. */
const struct neph_engine *const *neph_engines_with_user_engines(int *count);

/* Find an engine by name, user engines included; NULL: there is none. */
const struct neph_engine *neph_engine_find(const char *name);

/* Whether frames are random samples, so that another seed gives another frame of the same mean:
 * path tracers, own and external. A real-time method with jittered rays does not count. */
bool neph_engine_is_random(const struct neph_engine *engine);

/* Choose an engine and settings from words: "PRESET+KEY=VALUE+..." for `realtime`, or
 * "command+KEY=VALUE+..." for a user engine. `shared` ("steps=8"; or NULL) is set before the
 * changes if the engine has that option. Errors as of neph_settings_parse_words(). */
enum neph_status neph_engine_parse_words(const char *words, const char *shared,
                                         const struct neph_engine **engine,
                                         struct neph_settings *settings, struct neph_diag *diag);

#endif
