/* SPDX-License-Identifier: MIT
 *
 * Which pictures claim no physics: what they are off by is the gap of a model, nobody's fault.
 */
#ifndef NEPH_HARNESS_LOOK_H
#define NEPH_HARNESS_LOOK_H

#include "harness/engines/engine.h"

/* The engine that marches with a lighting, march_LIGHTING, or NULL. */
const struct neph_engine *neph_engine_lit_like(const char *lighting);

/* An engine that is a look, one with the light of a look (lighting=CHOICE, as march_CHOICE), or a
 * fog's look (fog=unreal, fog=filament). */
bool neph_is_look(const struct neph_engine *engine, const struct neph_settings *settings);

/* In words, where the fog is left to its look: "fog=unreal: ...". Else NULL. Static. */
const char *neph_look_of_fog(const struct neph_engine *engine,
                             const struct neph_settings *settings);

#endif
