/* SPDX-License-Identifier: MIT
 *
 * A scene in memory under another sun, with another phase function, albedo and density of its
 * media: for measuring lighting models in many variants without a file for each.
 *
 * The sun is the only light. Its irradiance is 1 W/m2 in all channels, so that radiances of all
 * scenes have one scale; solids are black, and there is no background. All media are grey. Nothing
 * moves except a sinking sun (sun_sinks_rad).
 */
#ifndef NEPH_SCENES_RELIT_H
#define NEPH_SCENES_RELIT_H

#include "scenes/scene.h"

/* NaN in a member: the scene's own value. */
struct neph_relight {
    double sun_elevation_rad; /* above the horizon */
    double sun_azimuth_rad;   /* relative to the view of frame 0, to the right: 0 is ahead, against
                                 the light; pi is behind the camera */
    double g;                 /* mean cosine of Henyey-Greenstein, -0.999..0.999 */
    double albedo;            /* 0..1 */
    double density;           /* factor of every extinction, > 0 */
    /* Above 0: the sun sinks by this angle over NEPH_RELIT_FRAMES frames, 60 a second, and reaches
     * the elevation above in the last of them. 0: it is static. */
    double sun_sinks_rad;
};

enum { NEPH_RELIT_FRAMES = 32 };

/* Creates the scene with `scattering` as given, and a hash of its own. It borrows all large data
 * from `scene`, which must outlive it. Free with neph_scene_destroy(). NEPH_ERR_UNSUPPORTED:
 * neither the scene nor `light` has a sun, a medium emits or is coloured. NEPH_ERR_USAGE: a number
 * is out of range. */
enum neph_status neph_scene_relit(const struct neph_scene *scene, const struct neph_relight *light,
                                  enum neph_scattering scattering, struct neph_scene **made,
                                  struct neph_diag *diag);

/* The present values of a scene, with its first medium: NaN where it has no sun or medium. The
 * density is that in extinction_color. */
struct neph_relight neph_relight_from_scene(const struct neph_scene *scene);

#endif
