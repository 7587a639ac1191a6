/* SPDX-License-Identifier: MIT
 *
 * Display settings of a scene's frames. No rendered value depends on them.
 */
#ifndef NEPH_SCENES_DISPLAY_H
#define NEPH_SCENES_DISPLAY_H

#include "scenes/scene.h"

struct neph_scene_display {
    double exposure_ev; /* display = radiance * 2^ev; frozen for all frames of the scene */
    const char *chain;  /* file of the post-processing chain that displays the frames; NULL: none */
};

/* Exposure 0 and no chain for a scene that was built in memory. */
const struct neph_scene_display *neph_scene_display(const struct neph_scene *scene);

#endif
