/* SPDX-License-Identifier: MIT
 *
 * Light between solids in clear air, along single paths: light that the surface in view reflects,
 * split as screen-space methods and Cycles' passes part it. No clamp, roulette only at low
 * throughput, so that the mean of the samples is the truth.
 *
 * Sun and lights are points: a path looks for them at every surface. A mirror throws their light on
 * others, and no path finds that by chance. So a surface also looks for them in each face of the
 * mirror, which is exact where the scene has one mirror, a box: it is convex, and light that has
 * left it does not come back to it before it has met another surface.
 */
#ifndef NEPH_TRUTH_REFLECTED_H
#define NEPH_TRUTH_REFLECTED_H

#include "scenes/solids.h"
#include "truth/on_screen.h"
#include "truth/random.h"

/* So many bounces stand for all of them. */
#define NEPH_ALL_BOUNCES 1024

enum neph_reflected_part {
    NEPH_DIFFUSE_DIRECT,   /* of sun, lights and surroundings, straight from there */
    NEPH_DIFFUSE_INDIRECT, /* of other surfaces */
    NEPH_GLOSSY_DIRECT,    /* the same two of the metal */
    NEPH_GLOSSY_INDIRECT,
    NEPH_AMBIENT, /* visibility, 0..1: see neph_reflected_limits.ao_distance_m */
    /* The part of indirect light from places that the screen shows; visibility where only these
     * places hide. */
    NEPH_DIFFUSE_ON_SCREEN,
    NEPH_GLOSSY_ON_SCREEN,
    NEPH_AMBIENT_ON_SCREEN,
    NEPH_REFLECTED_PARTS,
};

/* The surface in view, and the part of its light that needs no random numbers. */
struct neph_reflected_view {
    struct neph_hit hit;       /* no solid: the sky */
    struct neph_vec3 point_m;  /* just outside of it */
    struct neph_vec3 from;     /* unit, towards the eye */
    struct neph_rgb color[2];  /* that of the diffuse and of the glossy parts is multiplied by */
    struct neph_rgb direct[2]; /* of sun and lights, diffuse and glossy */
};

struct neph_reflected_limits {
    int bounces;          /* surfaces that light meets before the one in view, at most */
    double ao_distance_m; /* farther solids hide nothing; +inf: no limit */
    const struct neph_screen *screen; /* NULL: it shows nothing */
};

/* Per unit of the view's colours [W m^-2 sr^-1]; `part[NEPH_AMBIENT]` the cosine-weighted part of
 * the hemisphere in which no solid lies within the distance. 0 where the view has no such part. */
struct neph_reflected {
    struct neph_rgb part[NEPH_REFLECTED_PARTS];
};

/* False, with the reason in words: media, and sun or lights in a mirrored ball or in several
 * mirrors. */
bool neph_reflected_can(const struct neph_scene *scene, char *reason, size_t reason_size);

struct neph_reflected_view neph_reflected_view(const struct neph_scene *scene,
                                               struct neph_vec3 origin_m,
                                               struct neph_vec3 direction);

/* One sample, `direct` included. The view has a solid. */
struct neph_reflected neph_reflected_sample(const struct neph_scene *scene,
                                            const struct neph_reflected_view *view,
                                            const struct neph_reflected_limits *limits,
                                            struct neph_random *random);

/* Its radiance [W m^-2 sr^-1]: parts times colours. */
struct neph_rgb neph_reflected_radiance(const struct neph_reflected_view *view,
                                        const struct neph_reflected *light);

#endif
