/* SPDX-License-Identifier: MIT
 *
 * The two phase functions that POV-Ray calls Mie's: 1 + a x^n with x = (1 + cos) / 2, normalised
 * over the sphere (POV-Ray's own factors are not; harness/engines/povray_scene.c). Private to
 * scenes/.
 */
#ifndef NEPH_SCENES_PHASE_POVRAY_H
#define NEPH_SCENES_PHASE_POVRAY_H

struct neph_haze {
    double height; /* a */
    int power;     /* n */
};

double neph_haze_per_sr(struct neph_haze haze, double cosine);
double neph_haze_within(struct neph_haze haze, double v);   /* as neph_phase_light */
double neph_haze_moment(struct neph_haze haze, int degree); /* >= 1 */

#endif
