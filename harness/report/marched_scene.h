/* SPDX-License-Identifier: MIT
 *
 * The part of a scene that the ray marcher marches in a shot: at the time of the shot's frame,
 * without media that it takes from tables (sky=tables) or from an analytic formula (non-physical
 * fog models).
 */
#ifndef NEPH_HARNESS_REPORT_MARCHED_SCENE_H
#define NEPH_HARNESS_REPORT_MARCHED_SCENE_H

#include "harness/engines/engine.h"

struct neph_marched_scene {
    const struct neph_scene *scene;
    struct neph_scene rest;   /* borrows from the shot's scene */
    struct neph_scene *still; /* owned */
};

/* Free with neph_marched_scene_finish(). False when memory is short. */
bool neph_marched_scene_init(const struct neph_shot *shot, const struct neph_engine *engine,
                             struct neph_marched_scene *marched);
void neph_marched_scene_finish(struct neph_marched_scene *marched);

/* The index of a setting's value; 0, the first value, when the engine has no such setting. */
int neph_shot_choice(const struct neph_shot *shot, const struct neph_engine *engine,
                     const char *name);

#endif
