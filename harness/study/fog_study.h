/* SPDX-License-Identifier: MIT
 *
 * A fog study: the error of each control of a scene's fog_look by itself, against engine `exact`.
 * Computed in double precision on the CPU (truth/fog_look.h); other tests compare the shader with
 * that. Radiances are means of the three channels.
 */
#ifndef NEPH_HARNESS_STUDY_FOG_STUDY_H
#define NEPH_HARNESS_STUDY_FOG_STUDY_H

#include "scenes/scene.h"

enum {
    /* For each model: all off, each control, the same with physical near fog, all on, and two rows
     * with physical parameters. */
    NEPH_FOG_ROWS_MAX = NEPH_FOG_MODEL_COUNT * (NEPH_FOG_CONTROL_COUNT + 5),
    NEPH_FOG_ROW_NAME_SIZE = 64,
};

struct neph_fog_study_params {
    const struct neph_scene *scene; /* borrowed; has a fog_look, and `exact` can render it */
    int model;                      /* enum neph_fog_model; -1: all models that support the fog */
    int width_px, height_px;
    int directions; /* number of directions over the sphere around the camera */
};

struct neph_fog_row {
    enum neph_fog_model model;
    char name[NEPH_FOG_ROW_NAME_SIZE];
    struct neph_fog_look look;
    bool near_by_physics; /* physical fog before the start distance */

    /* Over the frame: transmittance minus exact transmittance; radiance error over the exact mean.
     */
    double transmittance_bias, transmittance_worst, radiance_bias, radiance_rms;

    /* Over the sphere around the camera, relative to exact: the error of the fog's light and of all
     * arriving light; *_alone is the difference from the row with all controls off, the control's
     * part. */
    double fog_light, all_light, fog_light_alone, all_light_alone;

    /* The largest step over distance along rays from the camera: of transmittance, of the fog's
     * light [W m^-2 sr^-1], and its distance [m]. Below 1e-9: none. NaN: not measured. */
    double transmittance_jump, transmittance_jump_m, light_jump, light_jump_m;

    /* The directional lobe's integral over the sphere per sunlight that the fog scatters. 1: the
     * lobe conserves energy like a phase function; NaN: no lobe or no sun. */
    double lobe_over_sun;
};

struct neph_fog_study {
    const struct neph_fog_study_params *params; /* borrowed */
    int row_count;
    struct neph_fog_row rows[NEPH_FOG_ROWS_MAX];
    double exact_radiance;                   /* mean over the frame [W m^-2 sr^-1] */
    double exact_fog_light, exact_all_light; /* means over the sphere [W m^-2 sr^-1] */
};

/* NEPH_ERR_UNSUPPORTED: the scene has no fog_look, or `exact` cannot render it. */
enum neph_status neph_fog_study_run(const struct neph_fog_study_params *params,
                                    struct neph_fog_study *study, struct neph_diag *diag);

#endif
