/* SPDX-License-Identifier: MIT
 *
 * One frame by a Blender: the files that it is given, its run, and the frame from the images that
 * it leaves. For engine `cycles` and for the probe of a Blender.
 */
#ifndef NEPH_HARNESS_ENGINES_CYCLES_FRAME_H
#define NEPH_HARNESS_ENGINES_CYCLES_FRAME_H

#include "harness/engines/baked_scene.h"
#include "harness/engines/cycles_spec.h"
#include "harness/engines/program.h"

struct neph_cycles_session {
    struct neph_shot shot; /* its scene is `baked` */
    struct neph_baked_scene baked;
    const char *directory, *program; /* program: the path of Blender; NULL: there is none to run */
    struct neph_cycles_world world;
    struct neph_cycles_quality quality;
    double sphere_error_px;
};

/* Adapt the shot's scene. NEPH_ERR_UNSUPPORTED. The caller calls neph_cycles_close(), whatever the
 * status. */
enum neph_status neph_cycles_open(const struct neph_shot *shot,
                                  const struct neph_cycles_quality *quality, const char *program,
                                  const char *directory, struct neph_cycles_session *session,
                                  struct neph_diag *diag);
void neph_cycles_close(struct neph_cycles_session *session);

/* Write spec.json, the script and the grids into the folder. */
enum neph_status neph_cycles_write(struct neph_cycles_session *session, struct neph_diag *diag);

/* Run the script on them, or, with `blend` not NULL, save the scenes under that name. */
enum neph_status neph_cycles_run(const struct neph_cycles_session *session, const char *blend,
                                 struct neph_child_result *result, struct neph_diag *diag);

/* What the script said of its Blender (about.json), for the caller to json_decref(). */
enum neph_status neph_cycles_about(const struct neph_cycles_session *session, json_t **about,
                                   struct neph_diag *diag);

/* The layers that the shot wants; `*render_s` is the time of the radiance images alone. */
enum neph_status neph_cycles_frame(const struct neph_cycles_session *session,
                                   struct neph_image **frame, double *render_s,
                                   struct neph_diag *diag);

#endif
