/* SPDX-License-Identifier: MIT
 *
 * Light between solids in clear air, by single paths: the light that the visible surface reflects,
 * split into the parts of screen-space methods and of Cycles' passes. No clamp, Russian roulette
 * only at low throughput: unbiased.
 *
 * Sun and lights are points, so a path samples them at every surface. A mirror reflects their light
 * onto other surfaces, which random paths cannot find. So a surface also samples them in each face
 * of the mirror. This is exact if the scene has one mirror, a box: it is convex, so light that has
 * left it meets another surface before it returns.
 */
#ifndef NEPH_TRUTH_REFLECTED_H
#define NEPH_TRUTH_REFLECTED_H

#include "scenes/solids.h"
#include "truth/on_screen.h"
#include "truth/random.h"

/* Number of bounces that counts as unlimited. */
#define NEPH_ALL_BOUNCES 1024

enum neph_reflected_part {
    NEPH_DIFFUSE_DIRECT,   /* of sun, lights and environment, directly */
    NEPH_DIFFUSE_INDIRECT, /* of other surfaces */
    NEPH_GLOSSY_DIRECT,    /* the same for the metal */
    NEPH_GLOSSY_INDIRECT,
    NEPH_AMBIENT, /* visibility, 0..1: see neph_reflected_limits.ao_distance_m */
    /* The parts of the indirect light from points inside the frame; visibility with occluders
     * inside the frame only. */
    NEPH_DIFFUSE_ON_SCREEN,
    NEPH_GLOSSY_ON_SCREEN,
    NEPH_AMBIENT_ON_SCREEN,
    NEPH_REFLECTED_PARTS,
};

/* The visible surface, and its deterministic light. */
struct neph_reflected_view {
    struct neph_hit hit;       /* no solid: the sky */
    struct neph_vec3 point_m;  /* just outside of the surface */
    struct neph_vec3 from;     /* unit, towards the eye */
    struct neph_rgb color[2];  /* colours of the diffuse and of the glossy parts */
    struct neph_rgb direct[2]; /* of sun and lights, diffuse and glossy */
};

struct neph_reflected_limits {
    int bounces;                      /* limit of surfaces before the visible one */
    double ao_distance_m;             /* farther solids do not occlude; +inf: no limit */
    const struct neph_screen *screen; /* NULL: no on-screen parts */
};

/* Light per unit of the view's colours [W m^-2 sr^-1]. `part[NEPH_AMBIENT]` is the cosine-weighted
 * part of the hemisphere without a solid within the distance. 0 if the view has no such part. */
struct neph_reflected {
    struct neph_rgb part[NEPH_REFLECTED_PARTS];
};

/* Whether the scene is supported; else the reason as text: media; sun or lights in a mirrored
 * sphere or in several mirrors. */
bool neph_reflected_is_supported(const struct neph_scene *scene, char *reason, size_t reason_size);

struct neph_reflected_view neph_reflected_view(const struct neph_scene *scene,
                                               struct neph_vec3 origin_m,
                                               struct neph_vec3 direction);

/* Compute one sample, including `direct`. The view must have a solid. */
struct neph_reflected neph_reflected_sample(const struct neph_scene *scene,
                                            const struct neph_reflected_view *view,
                                            const struct neph_reflected_limits *limits,
                                            struct neph_random *random);

/* The radiance [W m^-2 sr^-1]: parts times colours. */
struct neph_rgb neph_reflected_radiance(const struct neph_reflected_view *view,
                                        const struct neph_reflected *light);

#endif
