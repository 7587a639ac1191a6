/* SPDX-License-Identifier: MIT */
#include "scenes/radial.h"

#include <math.h>

struct offset {
    long double x, y, z;
};

static struct offset find_offset(struct neph_vec3 from_m, struct neph_vec3 to_m)
{
    return (struct offset){(long double)to_m.x - from_m.x, (long double)to_m.y - from_m.y,
                           (long double)to_m.z - from_m.z};
}

static long double length(struct offset a)
{
    return sqrtl(a.x * a.x + a.y * a.y + a.z * a.z);
}

struct neph_radial_line neph_radial_line(struct neph_vec3 center_m, struct neph_vec3 origin_m,
                                         struct neph_vec3 direction, double t0_m, double t1_m)
{
    const struct offset d = {direction.x, direction.y, direction.z};
    const struct offset from_m = find_offset(center_m, origin_m);
    const long double norm = length(d);
    const struct offset unit = {d.x / norm, d.y / norm, d.z / norm};
    const long double along_m = from_m.x * unit.x + from_m.y * unit.y + from_m.z * unit.z;
    const struct offset nearest_m = {from_m.x - along_m * unit.x, from_m.y - along_m * unit.y,
                                     from_m.z - along_m * unit.z};
    return (struct neph_radial_line){.impact_m = length(nearest_m),
                                     .s0_m = along_m + norm * t0_m,
                                     .s1_m = along_m + norm * t1_m,
                                     .length_m = norm * ((long double)t1_m - t0_m)};
}

long double neph_radial_distance_m(struct neph_vec3 center_m, struct neph_vec3 point_m)
{
    return length(find_offset(center_m, point_m));
}
