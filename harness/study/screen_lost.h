/* SPDX-License-Identifier: MIT
 *
 * The share of a surface's hemisphere that no screen-space method can know, by reason. Rays of the
 * exact scene are classified by the frame: a point of a ray is visible while it lies within the
 * frame and in front of all surfaces there.
 */
#ifndef NEPH_HARNESS_STUDY_SCREEN_LOST_H
#define NEPH_HARNESS_STUDY_SCREEN_LOST_H

#include "scenes/scene.h"

enum neph_screen_loss {
    NEPH_LOST_OFF,    /* the ray hits a surface, and leaves the frame before */
    NEPH_LOST_BEHIND, /* the ray hits a surface, and passes behind a visible surface before */
    NEPH_LOST_THIN,   /* the ray passes behind a visible surface and hits nothing */
    NEPH_SCREEN_LOSSES,
};

/* Number of rays that selects the mirror direction instead. */
enum { NEPH_SCREEN_MIRROR = 0 };

/* Shares of `rays` cosine-distributed rays that are lost, for the surface at the centre of a pixel,
 * up to `reach_m` (+inf: no limit). All 0 for the sky. For the mirror ray, one share is 1 or all
 * are 0. Deterministic. */
void neph_screen_compute_lost_shares(const struct neph_scene *scene,
                                     const struct neph_camera *camera, int width_px, int height_px,
                                     int column, int row, double reach_m, int rays,
                                     double shares[NEPH_SCREEN_LOSSES]);

#endif
