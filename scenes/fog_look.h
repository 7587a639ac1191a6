/* SPDX-License-Identifier: MIT
 * The non-physical controls of height fog in game engines: the settings that Unreal Engine and
 * Filament have for artists besides the layers of the fog, which are those of the scene's height
 * fog. No physical engine reads them; engine `fog_look` does, and marches with fog=unreal or
 * fog=filament. Their physical counterparts are in scenes/fog_translation.h, the formulas in
 * truth/fog_look.h.
 */
#ifndef NEPH_SCENES_FOG_LOOK_H
#define NEPH_SCENES_FOG_LOOK_H

#include "base/vec3.h"

#include <stdbool.h>
#include <stddef.h>

/* The engine whose formula is used. */
enum neph_fog_model {
    NEPH_FOG_UNREAL,
    NEPH_FOG_FILAMENT,
    NEPH_FOG_MODEL_COUNT,
};

#define NEPH_FOG_EXPONENT_MAX 64 /* of directional_exponent; as in Unreal */
#define NEPH_FOG_NO_OBSERVER_M 1e6

/* As written in a scene file; a control at its `off` value has no effect. */
struct neph_fog_look {
    bool present;
    struct neph_rgb inscattering_w_per_m2_sr; /* radiance of fog of infinite depth */
    struct neph_rgb sky_light;        /* factor of the background's radiance that is added to it */
    double start_distance_m;          /* nearer fog is left out; 0: none */
    double end_distance_m;            /* farther fog is left out, horizontally; 0: none */
    double cutoff_distance_m;         /* objects farther away are seen without fog; 0: none */
    double max_opacity;               /* 0..1 */
    double volumetric_fog_distance_m; /* nearer fog is left to froxels; 0: none */
    double observer_height_max_m;     /* a camera above is treated as at this height */
    struct neph_rgb directional_w_per_m2_sr; /* radiance in the direction of the sun */
    double directional_exponent;             /* of the cosine between view and sun */
    double directional_start_m;              /* its start, from the start of the fog */
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
    NEPH_FOG_DIRECTIONAL_START, /* no effect without NEPH_FOG_DIRECTIONAL */
    NEPH_FOG_CONTROL_COUNT,
};

#define NEPH_FOG_CONTROLS_ALL ((1u << NEPH_FOG_CONTROL_COUNT) - 1u)

struct neph_fog_control_row {
    const char *name;     /* "start_distance" */
    const char *key;      /* of the scene file */
    const char *unreal;   /* name in Unreal's component */
    const char *filament; /* name in Filament's FogOptions; NULL: it has none */
    const char *physics;  /* its difference from any physical medium */
    size_t at;            /* offset in struct neph_fog_look, of `count` doubles */
    int count;
    double off;
};

/* All controls, in the order of enum neph_fog_control. */
const struct neph_fog_control_row *neph_fog_controls(void);

/* Whether a control differs from its `off` value. */
bool neph_fog_control_is_on(const struct neph_fog_look *look, enum neph_fog_control control);

/* A copy in which all controls are off that are not in the bit mask `controls`. */
struct neph_fog_look neph_fog_look_mask_controls(const struct neph_fog_look *look,
                                                 unsigned controls);

/* "unreal", "filament"; ends with NULL. */
extern const char *const neph_fog_model_words[];

#endif
