/* SPDX-License-Identifier: MIT
 *
 * What of the hemisphere over a pixel's surface no method on a screen can know, and why. Rays of
 * the truth are told apart by what the picture shows: along each, the space before it is seen as
 * long as it is within the picture and before everything there.
 */
#ifndef NEPH_HARNESS_STUDY_SCREEN_LOST_H
#define NEPH_HARNESS_STUDY_SCREEN_LOST_H

#include "scenes/scene.h"

enum neph_screen_loss {
    NEPH_LOST_OFF,    /* it meets a surface, and has left the picture before */
    NEPH_LOST_BEHIND, /* it meets a surface, and has gone behind something that is seen before */
    NEPH_LOST_THIN,   /* it goes behind something that is seen, and meets nothing */
    NEPH_SCREEN_LOSSES,
};

/* In place of a number of rays: the one that a mirror would send. */
enum { NEPH_SCREEN_MIRROR = 0 };

/* Shares of `rays` by the cosine, for the surface in the centre of a pixel, as far as `reach_m`
 * (+inf: all the way); all 0 for the sky. Of a mirror's ray one of the shares is 1, or none. The
 * same numbers each time. */
void neph_screen_lost(const struct neph_scene *scene, const struct neph_camera *camera,
                      int width_px, int height_px, int column, int row, double reach_m, int rays,
                      double shares[NEPH_SCREEN_LOSSES]);

#endif
