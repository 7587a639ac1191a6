/* SPDX-License-Identifier: MIT */
#include "renderer/post/film.h"

#include <math.h>

static const double grey = 0.18;

/* Above this toe value grey is on the straight part. */
static const double straight_toe = 0.8;

/* The toe is a logistic curve minus black_clip: solved for the position that maps grey to grey. */
static double toe_match(const struct neph_film *film)
{
    if (film->toe > straight_toe)
        return (1.0 - film->toe - grey) / film->slope + log10(grey);
    const double scale = 1.0 + film->black_clip - film->toe;
    const double part = (grey + film->black_clip) / scale - 1.0; /* tanh of the position */
    return log10(grey) - atanh(part) * scale / film->slope;
}

struct neph_film_joints neph_film_joints(const struct neph_film *film)
{
    const double least_width = 1e-4; /* the shader divides by the difference */
    struct neph_film_joints joints;
    joints.toe_match = toe_match(film);
    joints.straight_match = (1.0 - film->toe) / film->slope - joints.toe_match;
    joints.shoulder_match = film->shoulder / film->slope - joints.straight_match;
    if (fabs(joints.shoulder_match - joints.toe_match) < least_width)
        joints.shoulder_match = joints.toe_match + least_width;
    return joints;
}
