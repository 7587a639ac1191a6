/* SPDX-License-Identifier: MIT
 *
 * What is put into a running renderer, to see whether it gets over it: values that no pass has
 * made, memory that is not its own, a second view, another origin, another exposure. Written in
 * the scene's file under `inject`. The scene itself stays what it is: the truth knows nothing of
 * it, and of all engines only those that say so (harness/engines/engine.h) put it in. Frames are
 * of pictures.
 */
#ifndef NEPH_SCENES_INJECTION_H
#define NEPH_SCENES_INJECTION_H

#include "base/vec3.h"
#include "scenes/scene.h"

#include <stdbool.h>

enum neph_injected_value {
    NEPH_INJECTED_NAN,
    NEPH_INJECTED_INFINITE,
    NEPH_INJECTED_NEGATIVE, /* -1 */
    NEPH_INJECTED_HUGE,     /* 1e30; the largest half where it is kept in halves */
    NEPH_INJECTED_GARBAGE,  /* bits at random */
    NEPH_INJECTED_BLACK,    /* 0 */
    NEPH_INJECTED_VALUES,
};

/* All that a picture takes for its past. */
struct neph_injected_history {
    int frame;
    enum neph_injected_value value;
    bool first; /* the picture is told that it is the first: it has no past */
};

/* Rays of a picture, evenly spread over it. */
struct neph_injected_rays {
    int frame;
    int count; /* >= 1; all where there are no more */
    enum neph_injected_value value;
};

/* The picture is a rectangle of larger buffers, whose rest holds the value. */
struct neph_injected_view {
    int left_px, top_px; /* multiples of 4 */
    int right_px, bottom_px;
    enum neph_injected_value value;
};

/* In these pictures a second camera, mirrored at the plane y = height_m, is rendered first and
 * leaves its history to this one. */
struct neph_injected_mirror {
    int frame, count; /* count 0: there is none */
    double height_m;
};

/* Before this picture one of another size, and back. */
struct neph_injected_size {
    int frame;
    double scale; /* of the picture's size */
};

/* From this picture on the world, the camera included, lies so far from where it was. */
struct neph_injected_origin {
    int frame;
    struct neph_vec3 by_m;
};

/* From this picture on the camera multiplies light by so much before it is kept. Pictures come out
 * as radiance all the same. */
struct neph_injected_exposure {
    int frame;
    double factor; /* > 0 */
};

/* All zero: nothing. Lists by ascending frames. */
struct neph_injections {
    int history_count, ray_count, size_count, origin_count, exposure_count;
    struct neph_injected_history *histories;
    struct neph_injected_rays *rays;
    struct neph_injected_size *sizes;
    struct neph_injected_origin *origins;
    struct neph_injected_exposure *exposures;
    struct neph_injected_view view;
    struct neph_injected_mirror mirror;
};

/* Those of the scene's file; none of a scene that was built in memory. Never NULL. */
const struct neph_injections *neph_scene_injections(const struct neph_scene *scene);

/* All of it in words, such as "history nan at 16, rays 1 infinite at 20", for the caller to free;
 * "" without any, NULL when memory is short. No two that differ have the same words. */
char *neph_injections_text(const struct neph_injections *injections);

const char *neph_injected_value_name(enum neph_injected_value value);

/* What is put into the history of a picture, its rays or before it; NULL: nothing. */
const struct neph_injected_history *
neph_injected_history_at(const struct neph_injections *injections, int frame);
const struct neph_injected_rays *neph_injected_rays_at(const struct neph_injections *injections,
                                                       int frame);
const struct neph_injected_size *neph_injected_size_at(const struct neph_injections *injections,
                                                       int frame);

/* Whether a picture comes after its mirrored one. */
bool neph_injected_mirror_at(const struct neph_injections *injections, int frame);

/* Where the world lies in a picture, from where the file has it. */
struct neph_vec3 neph_injected_origin_at(const struct neph_injections *injections, int frame);

/* What the camera of a picture multiplies light by; 1 where nobody says. */
double neph_injected_exposure_at(const struct neph_injections *injections, int frame);

#endif
