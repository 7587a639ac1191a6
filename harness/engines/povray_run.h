/* SPDX-License-Identifier: MIT
 *
 * Runs POV-Ray for the images of a frame: writes its files, starts it, and reads values from
 * several exposures of an image.
 */
#ifndef NEPH_HARNESS_ENGINES_POVRAY_RUN_H
#define NEPH_HARNESS_ENGINES_POVRAY_RUN_H

#include "harness/engines/baked_scene.h"
#include "harness/engines/povray_exposure.h"
#include "harness/engines/povray_scene.h"
#include "harness/engines/program.h"

#include <stdint.h>

extern const struct neph_external_renderer neph_povray;

/* The state of a frame while its images are rendered. */
struct neph_povray_session {
    struct neph_shot shot; /* its scene is `baked` */
    struct neph_baked_scene baked;
    struct neph_povray_world world;
    size_t pixel_count;
    const char *program; /* path of POV-Ray; NULL: not installed */
    int threads;
    int renders[NEPH_POVRAY_DEPTH + 1]; /* by enum neph_povray_kind */
    struct neph_cost cost;
};

/* Write the ini file: the settings that change an image and are not on the command line. */
enum neph_status neph_povray_write_ini(const char *directory, struct neph_diag *diag);

enum neph_status neph_povray_write(const struct neph_povray_session *session,
                                   const struct neph_povray_pass *pass, const char *path,
                                   struct neph_diag *diag);

/* Render one image; `*codes` (three per pixel) is for the caller to free. */
enum neph_status neph_povray_image(struct neph_povray_session *session, const char *name,
                                   const struct neph_povray_pass *pass, uint16_t **codes,
                                   double *wall_s, struct neph_diag *diag);

/* Render a bracketed image at as many gains as the target needs. `bound`: expected upper bound of
 * the values; the gain falls if a value exceeds it. `*readings` (one per pixel) is for the caller
 * to free; `*wall_s`: time of the last render. */
enum neph_status neph_povray_expose(struct neph_povray_session *session, const char *name,
                                    struct neph_povray_pass pass, double bound,
                                    const struct neph_povray_target *target,
                                    struct neph_povray_reading **readings, double *wall_s,
                                    struct neph_diag *diag);

#endif
