/* SPDX-License-Identifier: MIT
 *
 * Renders one frame with a Blender: writes its input files, runs it, and assembles the frame from
 * its images. Used by engine `cycles` and by the probe of a Blender.
 */
#ifndef NEPH_HARNESS_ENGINES_CYCLES_FRAME_H
#define NEPH_HARNESS_ENGINES_CYCLES_FRAME_H

#include "harness/engines/baked_scene.h"
#include "harness/engines/cycles_spec.h"
#include "harness/engines/program.h"

struct neph_cycles_session {
    struct neph_shot shot; /* its scene is `baked` */
    struct neph_baked_scene baked;
    const char *directory, *program; /* program: path of Blender; NULL: no Blender */
    struct neph_cycles_world world;
    struct neph_cycles_quality quality;
    double sphere_error_px;
};

/* Adapt the shot's scene. NEPH_ERR_UNSUPPORTED. Always call neph_cycles_close() afterwards. */
enum neph_status neph_cycles_open(const struct neph_shot *shot,
                                  const struct neph_cycles_quality *quality, const char *program,
                                  const char *directory, struct neph_cycles_session *session,
                                  struct neph_diag *diag);
void neph_cycles_close(struct neph_cycles_session *session);

/* Write spec.json, the script and the grids into the folder. */
enum neph_status neph_cycles_write(struct neph_cycles_session *session, struct neph_diag *diag);

/* Run the script on these files; with `blend`, save the scenes under that name instead. */
enum neph_status neph_cycles_run(const struct neph_cycles_session *session, const char *blend,
                                 struct neph_child_result *result, struct neph_diag *diag);

/* The script's report about Blender (about.json), for json_decref() by the caller. */
enum neph_status neph_cycles_about(const struct neph_cycles_session *session, json_t **about,
                                   struct neph_diag *diag);

/* Assemble the requested layers; `*render_s` is the time of the radiance images only. */
enum neph_status neph_cycles_frame(const struct neph_cycles_session *session,
                                   struct neph_image **frame, double *render_s,
                                   struct neph_diag *diag);

#endif
