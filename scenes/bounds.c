/* SPDX-License-Identifier: MIT */
#include "scenes/bounds.h"

#include <math.h>

bool neph_bounds_contain(const struct neph_bounds *bounds, struct neph_vec3 p)
{
    return p.x >= bounds->min_m.x && p.x <= bounds->max_m.x && p.y >= bounds->min_m.y &&
           p.y <= bounds->max_m.y && p.z >= bounds->min_m.z && p.z <= bounds->max_m.z;
}

bool neph_clip_axis(double minimum, double maximum, double origin, double direction, double *t0,
                    double *t1)
{
    if (direction == 0.0)
        return origin >= minimum && origin <= maximum;
    double near = (minimum - origin) / direction;
    double far = (maximum - origin) / direction;
    if (direction < 0.0) {
        const double swap = near;
        near = far;
        far = swap;
    }
    *t0 = fmax(*t0, near);
    *t1 = fmin(*t1, far);
    return *t0 < *t1;
}

bool neph_bounds_clip(const struct neph_bounds *bounds, struct neph_vec3 origin_m,
                      struct neph_vec3 direction, double *t0_m, double *t1_m)
{
    return *t0_m < *t1_m &&
           neph_clip_axis(bounds->min_m.x, bounds->max_m.x, origin_m.x, direction.x, t0_m, t1_m) &&
           neph_clip_axis(bounds->min_m.y, bounds->max_m.y, origin_m.y, direction.y, t0_m, t1_m) &&
           neph_clip_axis(bounds->min_m.z, bounds->max_m.z, origin_m.z, direction.z, t0_m, t1_m);
}

struct neph_bounds neph_bounds_intersect(struct neph_bounds a, struct neph_bounds b)
{
    return (struct neph_bounds){
        {fmax(a.min_m.x, b.min_m.x), fmax(a.min_m.y, b.min_m.y), fmax(a.min_m.z, b.min_m.z)},
        {fmin(a.max_m.x, b.max_m.x), fmin(a.max_m.y, b.max_m.y), fmin(a.max_m.z, b.max_m.z)}};
}

struct neph_bounds neph_bounds_hull(struct neph_bounds a, struct neph_bounds b)
{
    return (struct neph_bounds){
        {fmin(a.min_m.x, b.min_m.x), fmin(a.min_m.y, b.min_m.y), fmin(a.min_m.z, b.min_m.z)},
        {fmax(a.max_m.x, b.max_m.x), fmax(a.max_m.y, b.max_m.y), fmax(a.max_m.z, b.max_m.z)}};
}

struct neph_bounds neph_bounds_narrow(struct neph_bounds a, struct neph_bounds b)
{
    struct neph_bounds box = neph_bounds_intersect(a, b);
    box.max_m.x = fmax(box.min_m.x, box.max_m.x);
    box.max_m.y = fmax(box.min_m.y, box.max_m.y);
    box.max_m.z = fmax(box.min_m.z, box.max_m.z);
    return box;
}

struct neph_vec3 neph_bounds_nearest(const struct neph_bounds *box, struct neph_vec3 point_m)
{
    return (struct neph_vec3){fmin(box->max_m.x, fmax(box->min_m.x, point_m.x)),
                              fmin(box->max_m.y, fmax(box->min_m.y, point_m.y)),
                              fmin(box->max_m.z, fmax(box->min_m.z, point_m.z))};
}

static double farther(double center, double low, double high)
{
    return center - low > high - center ? low : high;
}

struct neph_vec3 neph_bounds_middle(const struct neph_bounds *box)
{
    return neph_vec3_scale(neph_vec3_add(box->min_m, box->max_m), 0.5);
}

struct neph_vec3 neph_bounds_farthest(const struct neph_bounds *box, struct neph_vec3 point_m)
{
    return (struct neph_vec3){farther(point_m.x, box->min_m.x, box->max_m.x),
                              farther(point_m.y, box->min_m.y, box->max_m.y),
                              farther(point_m.z, box->min_m.z, box->max_m.z)};
}

struct neph_bounds neph_bounds_translate(struct neph_bounds bounds, struct neph_vec3 by_m)
{
    return (struct neph_bounds){neph_vec3_add(bounds.min_m, by_m),
                                neph_vec3_add(bounds.max_m, by_m)};
}

struct neph_bounds neph_bounds_around(struct neph_vec3 center_m, double radius_m)
{
    const struct neph_vec3 reach_m = {radius_m, radius_m, radius_m};
    return (struct neph_bounds){neph_vec3_sub(center_m, reach_m), neph_vec3_add(center_m, reach_m)};
}

bool neph_bounds_are_empty(const struct neph_bounds *bounds)
{
    return !(bounds->min_m.x <= bounds->max_m.x && bounds->min_m.y <= bounds->max_m.y &&
             bounds->min_m.z <= bounds->max_m.z);
}
