/* SPDX-License-Identifier: MIT
 *
 * Decides which renderings are non-physical models: their difference from physics is model error.
 */
#ifndef NEPH_HARNESS_NON_PHYSICAL_H
#define NEPH_HARNESS_NON_PHYSICAL_H

#include "harness/engines/engine.h"

/* The engine march_LIGHTING for a lighting; NULL: there is none. */
const struct neph_engine *neph_engine_find_by_lighting(const char *lighting);

/* Whether the engine is a non-physical model, uses the lighting of one (lighting=CHOICE, as
 * march_CHOICE), or draws a fog by one (fog=unreal, fog=filament). */
bool neph_is_non_physical(const struct neph_engine *engine, const struct neph_settings *settings);

/* A static text if the fog is drawn by a non-physical model: "fog=unreal: ..."; else NULL. */
const char *neph_fog_model_note(const struct neph_engine *engine,
                                const struct neph_settings *settings);

#endif
