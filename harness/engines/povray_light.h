/* SPDX-License-Identifier: MIT
 *
 * The radiance of a frame by POV-Ray, colour by colour. A colour with sources proportional to an
 * already rendered colour is not rendered again.
 */
#ifndef NEPH_HARNESS_ENGINES_POVRAY_LIGHT_H
#define NEPH_HARNESS_ENGINES_POVRAY_LIGHT_H

#include "harness/engines/povray_run.h"

/* A sum of images, three planes of doubles. */
struct neph_povray_light {
    double *planes[3];
};

/* Start from {NULL}; always free it. */
enum neph_status neph_povray_light_make(size_t pixel_count, struct neph_povray_light *light,
                                        struct neph_diag *diag);
void neph_povray_light_free(struct neph_povray_light *light);

/* Add the scattered light; the emission of media; lit solids and background behind absorbing
 * media. */
enum neph_status neph_povray_add_volume(struct neph_povray_session *session,
                                        struct neph_povray_light *volume, struct neph_diag *diag);
enum neph_status neph_povray_add_emission(struct neph_povray_session *session,
                                          struct neph_povray_light *volume, struct neph_diag *diag);
enum neph_status neph_povray_add_surface(struct neph_povray_session *session,
                                         struct neph_povray_light *surface, struct neph_diag *diag);

/* Whether all media have the same extinction in two colours. */
bool neph_povray_same_extinction(const struct neph_scene *scene, int a, int b);

#endif
