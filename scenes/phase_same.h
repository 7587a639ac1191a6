/* SPDX-License-Identifier: MIT
 *
 * Whether two phase functions are one: kind, parameters and the rows of a table are equal.
 */
#ifndef NEPH_SCENES_PHASE_SAME_H
#define NEPH_SCENES_PHASE_SAME_H

#include "scenes/phase.h"

bool neph_phase_is_same(const struct neph_phase *a, const struct neph_phase *b);

#endif
