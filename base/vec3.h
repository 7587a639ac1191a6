/* SPDX-License-Identifier: MIT
 *
 * Three doubles: positions [m], directions [1] and Rec.709 colours. World: right-handed, +Y up.
 */
#ifndef NEPH_BASE_VEC3_H
#define NEPH_BASE_VEC3_H

#include <math.h>

#define NEPH_RAD_PER_DEG (M_PI / 180.0)

struct neph_vec3 {
    double x, y, z;
};

/* Scene-linear Rec.709; the unit is in the variable's name. */
struct neph_rgb {
    double r, g, b;
};

static inline struct neph_vec3 neph_vec3_add(struct neph_vec3 a, struct neph_vec3 b)
{
    return (struct neph_vec3){a.x + b.x, a.y + b.y, a.z + b.z};
}

static inline struct neph_vec3 neph_vec3_sub(struct neph_vec3 a, struct neph_vec3 b)
{
    return (struct neph_vec3){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline struct neph_vec3 neph_vec3_scale(struct neph_vec3 a, double s)
{
    return (struct neph_vec3){a.x * s, a.y * s, a.z * s};
}

/* a + s b */
static inline struct neph_vec3 neph_vec3_along(struct neph_vec3 a, struct neph_vec3 b, double s)
{
    return (struct neph_vec3){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

static inline double neph_vec3_dot(struct neph_vec3 a, struct neph_vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline struct neph_vec3 neph_vec3_cross(struct neph_vec3 a, struct neph_vec3 b)
{
    return (struct neph_vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline double neph_vec3_length(struct neph_vec3 a)
{
    return sqrt(neph_vec3_dot(a, a));
}

/* The caller has checked that the length is not 0. */
static inline struct neph_vec3 neph_vec3_normalize(struct neph_vec3 a)
{
    return neph_vec3_scale(a, 1.0 / neph_vec3_length(a));
}

static inline struct neph_rgb neph_rgb_add(struct neph_rgb a, struct neph_rgb b)
{
    return (struct neph_rgb){a.r + b.r, a.g + b.g, a.b + b.b};
}

static inline struct neph_rgb neph_rgb_mul(struct neph_rgb a, struct neph_rgb b)
{
    return (struct neph_rgb){a.r * b.r, a.g * b.g, a.b * b.b};
}

/* Optical depth per channel; a channel of colour 0 stays 0 at an infinite depth. */
static inline struct neph_rgb neph_rgb_attenuation(struct neph_rgb color, double optical_depth)
{
    return (struct neph_rgb){color.r > 0.0 ? color.r * optical_depth : 0.0,
                             color.g > 0.0 ? color.g * optical_depth : 0.0,
                             color.b > 0.0 ? color.b * optical_depth : 0.0};
}

static inline struct neph_rgb neph_rgb_scale(struct neph_rgb a, double s)
{
    return (struct neph_rgb){a.r * s, a.g * s, a.b * s};
}

#endif
