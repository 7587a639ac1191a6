/* SPDX-License-Identifier: MIT
 *
 * The registry's list of engines, one table per file of this folder.
 */
#ifndef NEPH_HARNESS_ENGINES_ENGINES_H
#define NEPH_HARNESS_ENGINES_ENGINES_H

#include "harness/engines/engine.h"

extern const struct neph_engine neph_engine_exact;
extern const struct neph_engine neph_engine_oracle;
extern const struct neph_engine neph_engine_tracer;
extern const struct neph_engine neph_engine_march;
extern const struct neph_engine neph_engine_march_octaves;
extern const struct neph_engine neph_engine_march_horizon;
extern const struct neph_engine neph_engine_realtime;
extern const struct neph_engine neph_engine_cycles;
extern const struct neph_engine neph_engine_povray;

#endif
