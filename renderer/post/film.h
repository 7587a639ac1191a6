/* SPDX-License-Identifier: MIT
 *
 * The joints of Unreal Engine 4.26's film curve: toe, straight part and shoulder over log10 of a
 * channel in AP1 (shaders/tone.glsl). The condition that 0.18 is shown as 0.18 determines them.
 */
#ifndef NEPH_RENDERER_POST_FILM_H
#define NEPH_RENDERER_POST_FILM_H

struct neph_film {
    double slope, toe, shoulder, black_clip, white_clip;
};

/* log10 of the start and the end of the straight part, and its offset: y = slope (log10 x +
 * straight_match). */
struct neph_film_joints {
    double toe_match, straight_match, shoulder_match;
};

/* For slope > 0, toe and shoulder in 0..0.99, clips >= 0. */
struct neph_film_joints neph_film_joints(const struct neph_film *film);

#endif
