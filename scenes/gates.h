/* SPDX-License-Identifier: MIT
 *
 * Gates: pass/fail limits with physical reasons, written in the scene file.
 */
#ifndef NEPH_SCENES_GATES_H
#define NEPH_SCENES_GATES_H

#include "scenes/scene.h"

enum neph_gate_quantity {
    NEPH_QUANTITY_RADIANCE,
    NEPH_QUANTITY_TRANSMITTANCE,
    NEPH_QUANTITY_DEPTH,
    NEPH_QUANTITY_COUNT,
};

struct neph_gate {
    const char *engine;
    enum neph_gate_quantity quantity;
    const char *metric; /* a name of the metrics module, such as "rel_bias" */
    const char *mask;   /* "all", "sky", "medium", "depth_edge" */
    double maximum;     /* |value| <= maximum passes */
    const char *reason;
    int line; /* in the scene file */
};

struct neph_gates {
    int count;
    struct neph_gate *list;
};

/* No gates for a scene that was built in memory. */
const struct neph_gates *neph_scene_gates(const struct neph_scene *scene);

const char *neph_gate_quantity_name(enum neph_gate_quantity quantity);

#endif
