/* SPDX-License-Identifier: MIT
 *
 * The look of height fog in game engines: what Unreal Engine and Filament let an artist set beside
 * the layers of the fog themselves, which are those of the scene's height fog. None of it is
 * physics, and those look at it that are told to: engine `fog_look`, and marches with fog=unreal or
 * fog=filament. What physics has for it is in scenes/fog_translation.h, the formulas are in
 * truth/fog_look.h.
 */
#ifndef NEPH_SCENES_FOG_LOOK_H
#define NEPH_SCENES_FOG_LOOK_H

#include "base/vec3.h"

#include <stdbool.h>
#include <stddef.h>

/* Whose formula. */
enum neph_fog_model {
    NEPH_FOG_UNREAL,
    NEPH_FOG_FILAMENT,
    NEPH_FOG_MODEL_COUNT,
};

#define NEPH_FOG_EXPONENT_MAX 64 /* of a look's cosine; Unreal's, too */
#define NEPH_FOG_NO_OBSERVER_M 1e6

/* As written in a scene file; every control at its `off` is none. */
struct neph_fog_look {
    bool present;
    struct neph_rgb inscattering_w_per_m2_sr; /* what fog without end looks like */
    struct neph_rgb sky_light;        /* so much of the background's radiance is added to it */
    double start_distance_m;          /* fog nearer than this is left out; 0: none is */
    double end_distance_m;            /* so is fog beyond, over ground; 0: none is */
    double cutoff_distance_m;         /* what lies beyond is seen without any fog; 0: nothing is */
    double max_opacity;               /* 0..1 */
    double volumetric_fog_distance_m; /* nearer fog is left to a volume of froxels; 0: none is */
    double observer_height_max_m;     /* a camera above it is taken to be there */
    struct neph_rgb directional_w_per_m2_sr; /* where one looks into the sun */
    double directional_exponent;             /* of the cosine between view and sun */
    double directional_start_m;              /* this glow begins so far behind where the fog does */
};

enum neph_fog_control {
    NEPH_FOG_SKY_LIGHT,
    NEPH_FOG_START,
    NEPH_FOG_END,
    NEPH_FOG_CUTOFF,
    NEPH_FOG_MAX_OPACITY,
    NEPH_FOG_HAND_OVER,
    NEPH_FOG_OBSERVER,
    NEPH_FOG_DIRECTIONAL,
    NEPH_FOG_DIRECTIONAL_START, /* does nothing without the one before */
    NEPH_FOG_CONTROL_COUNT,
};

#define NEPH_FOG_CONTROLS_ALL ((1u << NEPH_FOG_CONTROL_COUNT) - 1u)

struct neph_fog_control_row {
    const char *name;     /* "start_distance" */
    const char *key;      /* of the scene file */
    const char *unreal;   /* what Unreal's component calls it */
    const char *filament; /* what Filament's FogOptions calls it; NULL: it has none */
    const char *physics;  /* what it does that no medium does */
    size_t at;            /* in struct neph_fog_look: so many doubles */
    int count;
    double off;
};

/* All of them, in their order. */
const struct neph_fog_control_row *neph_fog_controls(void);

/* Whether it is set to anything but off. */
bool neph_fog_control_is_on(const struct neph_fog_look *look, enum neph_fog_control control);

/* A look with all controls off that are not in `controls`, a bit each. */
struct neph_fog_look neph_fog_look_only(const struct neph_fog_look *look, unsigned controls);

/* "unreal", "filament"; ends with NULL. */
extern const char *const neph_fog_model_words[];

#endif
