/* SPDX-License-Identifier: MIT
 *
 * The candidate configurations of `neph pick` for a scene: pipelines combined with lighting models,
 * as a sweep plan.
 */
#ifndef NEPH_HARNESS_SWEEP_LADDER_H
#define NEPH_HARNESS_SWEEP_LADDER_H

#include "harness/sweep/plan.h"

/* A lighting model: for all orders of scattering, or for a scene rendered with fewer orders. */
struct neph_ladder_light {
    const char *name;
    int scattering;       /* scattering of the rendered scene: enum neph_scattering */
    const char *march;    /* the marcher with this lighting */
    const char *settings; /* for realtime; NULL: none */
    bool is_late;         /* tried only when no other lighting model is good enough */
};
extern const struct neph_ladder_light
    neph_ladder_lights[]; /* ascending by the modelled light; ends with a NULL name */

/* The presets of realtime that are pipelines, from the cheapest (0) on; NULL: no more. The lighting
 * model's marcher is the last pipeline. */
const char *neph_ladder_preset(int pipeline);

/* Engines for one kind of scene, NULL-terminated; each is a series where it can render the scene.
 */
extern const char *const neph_ladder_narrow[];

/* Motion of a scene. */
enum neph_ladder_motion {
    NEPH_LADDER_CAMERA, /* camera, solids, or the frame size */
    NEPH_LADDER_WIND,
    NEPH_LADDER_ANY, /* camera or wind */
    NEPH_LADDER_MOTION_COUNT,
};

/* Whether the scene has this motion. */
bool neph_ladder_moves(const struct neph_scene *scene, enum neph_ladder_motion what);

/* Parts of realtime that only motion needs, with the settings that switch them off. */
struct neph_ladder_part {
    const char *name, *off;
    enum neph_ladder_motion needed_by;
};
extern const struct neph_ladder_part neph_ladder_motion_parts[];

/* Parts of realtime that only some scenes need, with the settings that switch them on. */
struct neph_ladder_air {
    const char *name, *on;
    bool (*is_needed)(const struct neph_scene *scene);
    const char *absent; /* reason why a scene does not need it */
    bool for_fitted;    /* works with lighting models other than octaves */
};
extern const struct neph_ladder_air neph_ladder_air_parts[]; /* ends with a NULL name */

/* Whether a scene needs a part and the part works with the lighting model. */
bool neph_ladder_takes(const struct neph_ladder_air *part, const struct neph_scene *scene,
                       const struct neph_ladder_light *light);

/* Writes the settings of realtime for a lighting model: its own, settings that switch off parts for
 * motion the scene does not have (`still`), and settings of parts that the scene needs (`air`). */
enum { NEPH_LADDER_HELD_SIZE = 256 };
void neph_ladder_held(const struct neph_scene *scene, const struct neph_ladder_light *light,
                      bool still, bool air, char held[NEPH_LADDER_HELD_SIZE]);

/* Whether all media have closed forms: homogeneous media and fogs. */
bool neph_ladder_has_closed_form(const struct neph_scene *scene);

/* Plans a series for each candidate:
 *
 * - closed forms;
 * - pipelines combined with lighting models, late ones (`late`) or the others;
 * - engines for one kind of scene, and the user engine as "yours" (not with `late`).
 *
 * Parts for motion that the scene does not have are off. Parts of the air are off, and a second
 * series has them on where the scene needs any: "ours+air, octaves". Free with
 * neph_sweep_plan_finish(). */
enum neph_status neph_ladder_plan(const struct neph_scene *scene, bool late, int width_px,
                                  int height_px, struct neph_sweep_plan *plan,
                                  struct neph_diag *diag);

/* Adds a series to a plan; texts are copied. `steps`: values of the setting `steps` for its points;
 * NULL: a single point. */
enum neph_status neph_ladder_add(struct neph_sweep_plan *plan,
                                 const struct neph_sweep_series *series, const char *steps,
                                 struct neph_diag *diag);

#endif
