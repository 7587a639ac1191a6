/* SPDX-License-Identifier: MIT
 *
 * A planet's scene in memory with any sun and camera: for measuring models of the sky in many
 * variants without a file for each.
 */
#ifndef NEPH_SCENES_SKYWARD_H
#define NEPH_SCENES_SKYWARD_H

#include "scenes/scene.h"

struct neph_skyward {
    double sun_elevation_rad;
    double altitude_m;  /* of the camera, vertically above the centre of the first solid */
    double azimuth_rad; /* of the view relative to the sun: 0 is towards it, pi away from it */
    double pitch_rad;   /* of the view, above -pi/2 and below pi/2 */
    double vertical_fov_rad;
};

/* The scene gets a hash of its own. It borrows all large data from `scene`, which must outlive it.
 * Free with neph_scene_destroy(). NEPH_ERR_UNSUPPORTED: the first solid is no ball, or there is no
 * sun. NEPH_ERR_USAGE: a number is out of range. */
enum neph_status neph_scene_skyward(const struct neph_scene *scene, const struct neph_skyward *view,
                                    struct neph_scene **made, struct neph_diag *diag);

#endif
