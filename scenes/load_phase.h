/* SPDX-License-Identifier: MIT
 *
 * The phase function of a medium in a scene file. Private to scenes/.
 */
#ifndef NEPH_SCENES_LOAD_PHASE_H
#define NEPH_SCENES_LOAD_PHASE_H

#include "scenes/fields.h"
#include "scenes/medium_kind.h"

/* Checks that the medium has the parameters of its phase function and no others, as far as its keys
 * were read, and reads its table. */
enum neph_status neph_finish_phase(struct neph_reader *reader, const yaml_node_t *node,
                                   struct neph_written_medium *written);

#endif
