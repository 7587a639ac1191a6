/* SPDX-License-Identifier: MIT
 *
 * Fault injection into a running renderer, to test its robustness: values that no pass computed,
 * memory outside the view, a second view, another origin, another exposure. Written in the scene's
 * file under `inject`. The scene itself does not change: the reference ignores injections, and only
 * engines with the flag for them (harness/engines/engine.h) apply them. Frame numbers are those of
 * rendered frames.
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
    NEPH_INJECTED_HUGE,     /* 1e30; the largest half in half formats */
    NEPH_INJECTED_GARBAGE,  /* pseudo-random bits */
    NEPH_INJECTED_BLACK,    /* 0 */
    NEPH_INJECTED_VALUES,
};

/* Injection into all histories of a frame. */
struct neph_injected_history {
    int frame;
    enum neph_injected_value value;
    bool first; /* the frame is treated as the first: without history */
};

/* Injection into rays of a frame, evenly spread over it. */
struct neph_injected_rays {
    int frame;
    int count; /* >= 1; all rays if there are fewer */
    enum neph_injected_value value;
};

/* The frame is a rectangle of larger buffers; the other texels have the value. */
struct neph_injected_view {
    int left_px, top_px; /* multiples of 4 */
    int right_px, bottom_px;
    enum neph_injected_value value;
};

/* In these frames a second view, mirrored at the plane y = height_m, is rendered first; the frame
 * then reads its history. */
struct neph_injected_mirror {
    int frame, count; /* count 0: there is none */
    double height_m;
};

/* Before this frame a frame of another size is rendered, and the size changes back. */
struct neph_injected_size {
    int frame;
    double scale; /* factor of the frame's size */
};

/* From this frame on the world, with the camera, is displaced by this vector. */
struct neph_injected_origin {
    int frame;
    struct neph_vec3 by_m;
};

/* From this frame on the camera multiplies light by this factor before it is stored. Output frames
 * are still radiance. */
struct neph_injected_exposure {
    int frame;
    double factor; /* > 0 */
};

/* Zero-initialised: no injections. Lists are in ascending order of frames. */
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

/* The injections of the scene's file; none for a scene that was built in memory. Never NULL. */
const struct neph_injections *neph_scene_injections(const struct neph_scene *scene);

/* All injections in words, such as "history nan at 16, rays 1 infinite at 20"; the caller frees the
 * text. "" without any, NULL when memory is short. Different injections give different texts. */
char *neph_injections_text(const struct neph_injections *injections);

const char *neph_injected_value_name(enum neph_injected_value value);

/* The injection into a frame's history, into its rays, or before the frame; NULL: none. */
const struct neph_injected_history *
neph_injected_history_at(const struct neph_injections *injections, int frame);
const struct neph_injected_rays *neph_injected_rays_at(const struct neph_injections *injections,
                                                       int frame);
const struct neph_injected_size *neph_injected_size_at(const struct neph_injections *injections,
                                                       int frame);

/* Whether a mirrored view is rendered before this frame. */
bool neph_injected_mirror_at(const struct neph_injections *injections, int frame);

/* Displacement of the world in a frame from its place in the file. */
struct neph_vec3 neph_injected_origin_at(const struct neph_injections *injections, int frame);

/* Factor of the camera's exposure in a frame; 1 by default. */
double neph_injected_exposure_at(const struct neph_injections *injections, int frame);

#endif
