/* SPDX-License-Identifier: MIT
 *
 * Images by POV-Ray for a frame in the making: its files, its runs, and the values that are read
 * from several exposures of one image.
 */
#ifndef NEPH_HARNESS_ENGINES_POVRAY_RUN_H
#define NEPH_HARNESS_ENGINES_POVRAY_RUN_H

#include "harness/engines/baked_scene.h"
#include "harness/engines/povray_exposure.h"
#include "harness/engines/povray_scene.h"
#include "harness/engines/program.h"

#include <stdint.h>

extern const struct neph_external_renderer neph_povray;

/* One frame in the making. */
struct neph_povray_session {
    struct neph_shot shot; /* its scene is `baked` */
    struct neph_baked_scene baked;
    struct neph_povray_world world;
    size_t pixel_count;
    const char *program; /* the path of POV-Ray; NULL: there is none to run */
    int threads;
    int renders[NEPH_POVRAY_DEPTH + 1]; /* by enum neph_povray_kind */
    struct neph_cost cost;
};

/* Write what decides an image and stands on no command line. */
enum neph_status neph_povray_write_ini(const char *directory, struct neph_diag *diag);

enum neph_status neph_povray_write(const struct neph_povray_session *session,
                                   const struct neph_povray_pass *pass, const char *path,
                                   struct neph_diag *diag);

/* Render one image; `*codes` (three per pixel) is for the caller to free. */
enum neph_status neph_povray_image(struct neph_povray_session *session, const char *name,
                                   const struct neph_povray_pass *pass, uint16_t **codes,
                                   double *wall_s, struct neph_diag *diag);

/* Render a bracketed image at as many gains as the target needs. No value is above `bound`, as far
 * as is known; the gain falls when one is. `*readings` (one per pixel) is for the caller to free;
 * `*wall_s` is the time of the last render. */
enum neph_status neph_povray_expose(struct neph_povray_session *session, const char *name,
                                    struct neph_povray_pass pass, double bound,
                                    const struct neph_povray_target *target,
                                    struct neph_povray_reading **readings, double *wall_s,
                                    struct neph_diag *diag);

#endif
