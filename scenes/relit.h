/* SPDX-License-Identifier: MIT
 *
 * A scene in memory under another sun, its media with another phase function, albedo and density:
 * what a lighting model is measured with, many times over, without a file for each.
 *
 * Nothing but the sun lights it: it is 1 W/m2 in all channels, so that radiances of all scenes are
 * of one scale; solids are black, and there is no background. All media are grey. Nothing moves but
 * a sun that is told to.
 */
#ifndef NEPH_SCENES_RELIT_H
#define NEPH_SCENES_RELIT_H

#include "scenes/scene.h"

/* NaN in a member: as the scene has it. */
struct neph_relight {
    double sun_elevation_rad; /* above the horizon */
    double sun_azimuth_rad;   /* from where the camera of frame 0 looks, to the right: 0 is ahead,
                                 against the light; pi is behind the camera */
    double g;                 /* mean cosine of Henyey-Greenstein, -0.999..0.999 */
    double albedo;            /* 0..1 */
    double density;           /* factor of every extinction, > 0 */
    /* Above 0: the sun sinks by so much over NEPH_RELIT_FRAMES, 60 a second, and is in the last of
     * them where it stands above; it is 0 where nothing is said. */
    double sun_sinks_rad;
};

enum { NEPH_RELIT_FRAMES = 32 };

/* With `scattering` as given, and a hash of its own. It borrows all large data from `scene`, which
 * must outlive it. Free with neph_scene_destroy(). NEPH_ERR_UNSUPPORTED: the scene has no sun and
 * `light` none, a medium emits or is coloured. NEPH_ERR_USAGE: a number is out of range. */
enum neph_status neph_scene_relit(const struct neph_scene *scene, const struct neph_relight *light,
                                  enum neph_scattering scattering, struct neph_scene **made,
                                  struct neph_diag *diag);

/* What a scene is lit with, of its first medium: NaN where it has no sun or medium. The density is
 * that of extinction_color. */
struct neph_relight neph_relight_of(const struct neph_scene *scene);

#endif
