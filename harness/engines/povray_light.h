/* SPDX-License-Identifier: MIT
 *
 * The light of a frame by POV-Ray, by colour. Colours whose sources are proportional to those of
 * another colour are not rendered again.
 */
#ifndef NEPH_HARNESS_ENGINES_POVRAY_LIGHT_H
#define NEPH_HARNESS_ENGINES_POVRAY_LIGHT_H

#include "harness/engines/povray_run.h"

/* A sum of images, three planes of doubles. */
struct neph_povray_light {
    double *planes[3];
};

/* Start from {NULL}; free whatever the status. */
enum neph_status neph_povray_light_make(size_t pixel_count, struct neph_povray_light *light,
                                        struct neph_diag *diag);
void neph_povray_light_free(struct neph_povray_light *light);

/* Add what media scatter; what they emit; lit solids and the background behind absorbing media. */
enum neph_status neph_povray_add_volume(struct neph_povray_session *session,
                                        struct neph_povray_light *volume, struct neph_diag *diag);
enum neph_status neph_povray_add_emission(struct neph_povray_session *session,
                                          struct neph_povray_light *volume, struct neph_diag *diag);
enum neph_status neph_povray_add_surface(struct neph_povray_session *session,
                                         struct neph_povray_light *surface, struct neph_diag *diag);

/* Whether all media attenuate two colours alike. */
bool neph_povray_same_extinction(const struct neph_scene *scene, int a, int b);

#endif
