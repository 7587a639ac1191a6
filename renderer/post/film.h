/* SPDX-License-Identifier: MIT
 *
 * Unreal Engine 4.26's film curve: toe, straight part and shoulder over log10 of a channel in AP1
 * (shaders/tone.glsl). Where they meet follows from 0.18 being shown as 0.18.
 */
#ifndef NEPH_RENDERER_POST_FILM_H
#define NEPH_RENDERER_POST_FILM_H

struct neph_film {
    double slope, toe, shoulder, black_clip, white_clip;
};

/* log10 of where the straight part begins and ends, and its offset: there y = slope (log10 x +
 * straight_match). */
struct neph_film_joints {
    double toe_match, straight_match, shoulder_match;
};

/* For slope > 0, toe and shoulder in 0..0.99, clips >= 0. */
struct neph_film_joints neph_film_joints(const struct neph_film *film);

#endif
