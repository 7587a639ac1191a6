/* SPDX-License-Identifier: MIT
 *
 * Scenes as POV-Ray 3.7 text. The text is made of fixed words and of numbers alone: no string of a
 * scene ever enters it, so no scene can make POV-Ray do anything but render.
 */
#ifndef NEPH_HARNESS_ENGINES_POVRAY_SCENE_H
#define NEPH_HARNESS_ENGINES_POVRAY_SCENE_H

#include "harness/engines/povray_world.h"
#include "scenes/grid.h"

#include <stdbool.h>

/* POV-Ray's media abort above ("internal nesting limit"). */
#define NEPH_POVRAY_INTERVALS_MAX 256

/* Directions that POV-Ray has for radiosity; of more it makes new ones. */
#define NEPH_POVRAY_RAYS_MAX 1600

enum neph_povray_kind {
    NEPH_POVRAY_BEAUTY,        /* for people: colours as they are */
    NEPH_POVRAY_VOLUME,        /* sunlight scattered by the media of one phase function */
    NEPH_POVRAY_SURFACE,       /* lit solids and background through absorbing media */
    NEPH_POVRAY_EMISSION,      /* what absorbing media emit, in the dark */
    NEPH_POVRAY_TRANSMITTANCE, /* background and solids of radiance 1 through absorbing media */
    NEPH_POVRAY_DEPTH,         /* three digits, povray_exposure.h */
    NEPH_POVRAY_KIND_COUNT,
};

/* One picture to render. All but BEAUTY and DEPTH are monochrome in three brackets. */
struct neph_povray_pass {
    enum neph_povray_kind kind;
    int channel; /* 0 R, 1 G, 2 B of albedos, extinctions, sun and background; not DEPTH */
    double gain;
    struct neph_phase phase; /* VOLUME */
};

/* The text of one pass, for the caller to free. */
enum neph_status neph_povray_text(const struct neph_povray_world *world,
                                  const struct neph_povray_pass *pass, char **text,
                                  struct neph_diag *diag);

/* The name of the density file, beside the text, of a grid medium, by its index in the scene. */
enum { NEPH_POVRAY_FILE_NAME_MAX = 32 };
void neph_povray_grid_name(int index, char name[NEPH_POVRAY_FILE_NAME_MAX]);

/* The grid for that file: its largest density stays below full scale, where POV-Ray's patterns wrap
 * to 0. It shares the values of `grid`. */
struct neph_grid neph_povray_grid(const struct neph_grid *grid);

/* The values of a noise (scenes/surface.h) for the file of this name, which is that of its seed: a
 * layer of whole places, the last again the first. For neph_grid_destroy(). */
void neph_povray_noise_name(int seed, char name[NEPH_POVRAY_FILE_NAME_MAX]);
enum neph_status neph_povray_noise(int seed, struct neph_grid **grid, struct neph_diag *diag);

/* Do two phase functions have the same shape? */
bool neph_povray_same_phase(const struct neph_phase *a, const struct neph_phase *b);

/* POV-Ray's phase factor k(cos) is 4 pi p(cos) times this. 1 but for Rayleigh, which POV-Ray
 * defines as 0.799372013 (1 + cos^2): its mean over the sphere is 4/3 of the constant. */
double neph_povray_phase_excess(enum neph_phase_kind kind);

/* Component 0, 1 or 2 of a colour. */
static inline double neph_povray_component(struct neph_rgb colour, int channel)
{
    return channel == 0 ? colour.r : channel == 1 ? colour.g : colour.b;
}

#endif
