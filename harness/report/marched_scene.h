/* SPDX-License-Identifier: MIT
 *
 * The scene that a ray marcher sees in a shot: as it is at the shot's frame, without what comes
 * from tables (sky=tables) or is drawn by a formula (the look of a fog).
 */
#ifndef NEPH_HARNESS_REPORT_MARCHED_SCENE_H
#define NEPH_HARNESS_REPORT_MARCHED_SCENE_H

#include "harness/engines/engine.h"

struct neph_marched_scene {
    const struct neph_scene *scene;
    struct neph_scene rest;   /* borrows from the shot's scene */
    struct neph_scene *still; /* owned */
};

/* For neph_marched_scene_finish(). False without memory. */
bool neph_marched_scene_init(const struct neph_shot *shot, const struct neph_engine *engine,
                             struct neph_marched_scene *marched);
void neph_marched_scene_finish(struct neph_marched_scene *marched);

/* The index of a setting's choice; 0, the first, where an engine has no such setting. */
int neph_shot_choice(const struct neph_shot *shot, const struct neph_engine *engine,
                     const char *name);

#endif
