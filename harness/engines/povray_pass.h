/* SPDX-License-Identifier: MIT
 *
 * The kinds of images that POV-Ray renders for a frame.
 */
#ifndef NEPH_HARNESS_ENGINES_POVRAY_PASS_H
#define NEPH_HARNESS_ENGINES_POVRAY_PASS_H

#include "scenes/scene.h"

/* Size of the name of a file beside the scene text. */
enum { NEPH_POVRAY_FILE_NAME_MAX = 32 };

enum neph_povray_kind {
    NEPH_POVRAY_BEAUTY,        /* for display: colours as they are */
    NEPH_POVRAY_VOLUME,        /* sunlight scattered by the media of one phase function */
    NEPH_POVRAY_SURFACE,       /* lit solids and background through absorbing media */
    NEPH_POVRAY_EMISSION,      /* emission of absorbing media, without lights */
    NEPH_POVRAY_TRANSMITTANCE, /* background and solids of radiance 1 through absorbing media */
    NEPH_POVRAY_DEPTH,         /* three digits, povray_exposure.h */
    NEPH_POVRAY_KIND_COUNT,
};

/* One image to render. All but BEAUTY and DEPTH are monochrome in three brackets. */
struct neph_povray_pass {
    enum neph_povray_kind kind;
    int channel; /* 0 R, 1 G, 2 B of albedos, extinctions, sun and background; unused for DEPTH */
    double gain;
    struct neph_phase phase; /* of VOLUME */
};

/* Component 0, 1 or 2 of a colour. */
static inline double neph_povray_component(struct neph_rgb colour, int channel)
{
    return channel == 0 ? colour.r : channel == 1 ? colour.g : colour.b;
}

#endif
