/* SPDX-License-Identifier: MIT */
#include "scenes/box_shadow.h"

#include "scenes/bounds.h"

#include <math.h>

bool neph_clip_less_equal(struct neph_affine f, struct neph_affine g, double *u0, double *u1)
{
    const double constant = f.constant - g.constant;
    const double slope = f.slope - g.slope;
    if (slope == 0.0)
        return constant <= 0.0;
    const double root = -constant / slope;
    if (slope > 0.0)
        *u1 = fmin(*u1, root);
    else
        *u0 = fmax(*u0, root);
    return *u0 < *u1;
}

/* Shadow of a box: all u for which some t >= 0 puts o + u d + t s inside. On each axis t is bounded
 * below and above by affine functions of u; a t exists when every lower bound is below every upper
 * bound (Fourier-Motzkin elimination of t). */
bool neph_box_shadow(const struct neph_bounds *box, struct neph_vec3 sun, struct neph_vec3 o,
                     struct neph_vec3 d, double *u0, double *u1)
{
    const double low[3] = {box->min_m.x, box->min_m.y, box->min_m.z};
    const double high[3] = {box->max_m.x, box->max_m.y, box->max_m.z};
    const double origin[3] = {o.x, o.y, o.z};
    const double direction[3] = {d.x, d.y, d.z};
    const double s[3] = {sun.x, sun.y, sun.z};
    struct neph_affine lower[4] = {{0.0, 0.0}}; /* t >= 0 */
    struct neph_affine upper[3];
    int lower_count = 1, upper_count = 0;
    for (int axis = 0; axis < 3; axis++) {
        if (s[axis] == 0.0) {
            if (!neph_clip_axis(low[axis], high[axis], origin[axis], direction[axis], u0, u1))
                return false;
            continue;
        }
        const double entry = s[axis] > 0.0 ? low[axis] : high[axis];
        const double exit = s[axis] > 0.0 ? high[axis] : low[axis];
        const double slope = -direction[axis] / s[axis];
        lower[lower_count++] = (struct neph_affine){(entry - origin[axis]) / s[axis], slope};
        upper[upper_count++] = (struct neph_affine){(exit - origin[axis]) / s[axis], slope};
    }
    for (int i = 0; i < lower_count; i++)
        for (int j = 0; j < upper_count; j++)
            if (!neph_clip_less_equal(lower[i], upper[j], u0, u1))
                return false;
    return *u0 < *u1;
}

/* All u for which some factor f >= 1 puts o + u d at L + f (k - L) with k in the box. On each axis
 * o + u d - L lies between f (low - L) and f (high - L), which bound f by affine functions of u, as
 * in neph_box_shadow(). */
bool neph_box_point_shadow(const struct neph_bounds *box, struct neph_vec3 light_m,
                           struct neph_vec3 o, struct neph_vec3 d, double *u0, double *u1)
{
    const double light[3] = {light_m.x, light_m.y, light_m.z};
    const double low[3] = {box->min_m.x, box->min_m.y, box->min_m.z};
    const double high[3] = {box->max_m.x, box->max_m.y, box->max_m.z};
    const double origin[3] = {o.x, o.y, o.z}, direction[3] = {d.x, d.y, d.z};
    struct neph_affine lower[7] = {{1.0, 0.0}}, upper[6];
    int lower_count = 1, upper_count = 0;
    for (int axis = 0; axis < 3; axis++) {
        const struct neph_affine way = {origin[axis] - light[axis], direction[axis]};
        const struct neph_affine zero = {0.0, 0.0};
        const double faces[2] = {low[axis] - light[axis], high[axis] - light[axis]};
        for (int side = 0; side < 2; side++) { /* faces[0] f <= way <= faces[1] f */
            const struct neph_affine bound = {way.constant / faces[side], way.slope / faces[side]};
            const bool is_below = (faces[side] < 0.0) == (side == 0);
            if (faces[side] != 0.0 && is_below)
                lower[lower_count++] = bound;
            else if (faces[side] != 0.0)
                upper[upper_count++] = bound;
            else if (!neph_clip_less_equal(side ? way : zero, side ? zero : way, u0, u1))
                return false;
        }
    }
    for (int i = 0; i < lower_count; i++)
        for (int j = 0; j < upper_count; j++)
            if (!neph_clip_less_equal(lower[i], upper[j], u0, u1))
                return false;
    return *u0 < *u1;
}
