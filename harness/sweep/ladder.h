/* SPDX-License-Identifier: MIT
 *
 * What `neph pick` looks at: pipelines and lights as a plan of a sweep, by what a scene has.
 */
#ifndef NEPH_HARNESS_SWEEP_LADDER_H
#define NEPH_HARNESS_SWEEP_LADDER_H

#include "harness/sweep/plan.h"

/* A light that stands for all orders of scattering, or what a scene is taken for that has fewer. */
struct neph_ladder_light {
    const char *name;
    int scattering;       /* of the scene as it is rendered: enum neph_scattering */
    const char *march;    /* the engine that marches with it */
    const char *settings; /* of realtime; NULL: none */
    bool is_late;         /* looked at when nothing else is good enough */
};
extern const struct neph_ladder_light
    neph_ladder_lights[]; /* by what they have; a NULL name ends */

/* The presets of realtime that are pipelines, the cheapest, 0, first; NULL: there are no more, and
 * the engine of the light itself is the last pipeline. */
const char *neph_ladder_preset(int pipeline);

/* Engines for one kind of scene each: a series of their name where a scene is of it. */
extern const char *const neph_ladder_narrow[];

/* What moves. */
enum neph_ladder_motion {
    NEPH_LADDER_CAMERA, /* or a solid, or the size of the picture */
    NEPH_LADDER_WIND,
    NEPH_LADDER_ANY, /* of both */
    NEPH_LADDER_MOTION_COUNT,
};
bool neph_ladder_moves(const struct neph_scene *scene, enum neph_ladder_motion what);

/* Parts of realtime that only motion needs, as settings without them. */
struct neph_ladder_part {
    const char *name, *off;
    enum neph_ladder_motion needed_by;
};
extern const struct neph_ladder_part neph_ladder_motion_parts[];

/* Parts of realtime for what only some scenes have, as settings with them. */
struct neph_ladder_air {
    const char *name, *on;
    bool (*is_needed)(const struct neph_scene *scene);
    const char *absent; /* what a scene has not that does not need it */
    bool for_fitted;    /* knows lights beyond octaves */
};
extern const struct neph_ladder_air neph_ladder_air_parts[]; /* a NULL name ends */

/* Whether a scene needs a part, and the light is one that it knows. */
bool neph_ladder_takes(const struct neph_ladder_air *part, const struct neph_scene *scene,
                       const struct neph_ladder_light *light);

/* What realtime is told of a light: its settings, those without the motion that the scene has not
 * (`still`), and those of the parts that it needs (`air`). */
enum { NEPH_LADDER_HELD_SIZE = 256 };
void neph_ladder_held(const struct neph_scene *scene, const struct neph_ladder_light *light,
                      bool still, bool air, char held[NEPH_LADDER_HELD_SIZE]);

/* Whether all media have closed forms: homogeneous ones, and fogs. */
bool neph_ladder_has_closed_form(const struct neph_scene *scene);

/* A series for each: closed forms, then pipelines by lights, those that are late or those that are
 * not, and with these engines for one kind of scene where it is of that, and "yours", engine
 * command, where there is one. Without the parts for a motion that the scene has not; those of the
 * air once without, and where the scene needs any once with them: "ours+air, octaves". For
 * neph_sweep_plan_finish(). */
enum neph_status neph_ladder_plan(const struct neph_scene *scene, bool late, int width_px,
                                  int height_px, struct neph_sweep_plan *plan,
                                  struct neph_diag *diag);

/* One more series of a plan; texts are copied. `steps`: what its setting of that name is in its
 * points; NULL: it is one point. */
enum neph_status neph_ladder_add(struct neph_sweep_plan *plan,
                                 const struct neph_sweep_series *series, const char *steps,
                                 struct neph_diag *diag);

#endif
