/* SPDX-License-Identifier: MIT
 *
 * A fog study: what the controls of a scene's fog_look are off by, each alone, against engine
 * exact. In double precision on the CPU (truth/fog_look.h); the shader is held to that elsewhere.
 * Radiances are means of the three channels.
 */
#ifndef NEPH_HARNESS_STUDY_FOG_STUDY_H
#define NEPH_HARNESS_STUDY_FOG_STUDY_H

#include "scenes/scene.h"

enum {
    /* By model: all off, each control, its near fog by physics, all on, physics' own looks. */
    NEPH_FOG_ROWS_MAX = NEPH_FOG_MODEL_COUNT * (NEPH_FOG_CONTROL_COUNT + 5),
    NEPH_FOG_ROW_NAME_SIZE = 64,
};

struct neph_fog_study_params {
    const struct neph_scene *scene; /* borrowed; with a fog_look, and one that exact can render */
    int model;                      /* enum neph_fog_model; -1: all that know the fog */
    int width_px, height_px;
    int directions; /* over the sphere around the camera */
};

struct neph_fog_row {
    enum neph_fog_model model;
    char name[NEPH_FOG_ROW_NAME_SIZE];
    struct neph_fog_look look;
    bool near_by_physics; /* before the start of the fog it has exact's */

    /* Over the picture: transmittance less exact's, and radiance over exact's mean. */
    double transmittance_bias, transmittance_worst, radiance_bias, radiance_rms;

    /* Over the sphere of directions around the camera, as parts of what exact has: the light of the
     * fog, and all light that arrives, more or less than exact's; and than the look's with all
     * controls off, which is what the control gives or takes. */
    double fog_light, all_light, fog_light_alone, all_light_alone;

    /* The largest step over distance along rays from the camera: of transmittance, and of the
     * light of the fog [W m^-2 sr^-1], and where they are [m]. Below 1e-9: none.
     * NaN: nobody looked. */
    double transmittance_jump, transmittance_jump_m, light_jump, light_jump_m;

    /* The glow's lobe over the sphere, per irradiance that the fog scatters of the sun's. 1: as
     * much as a phase function; NaN: no glow, or no sun. */
    double lobe_over_sun;
};

struct neph_fog_study {
    const struct neph_fog_study_params *params; /* borrowed */
    int row_count;
    struct neph_fog_row rows[NEPH_FOG_ROWS_MAX];
    double exact_radiance;                   /* mean over the picture [W m^-2 sr^-1] */
    double exact_fog_light, exact_all_light; /* means over the sphere, the same */
};

/* NEPH_ERR_UNSUPPORTED: no look, or no exact answer for the scene. */
enum neph_status neph_fog_study_run(const struct neph_fog_study_params *params,
                                    struct neph_fog_study *study, struct neph_diag *diag);

#endif
