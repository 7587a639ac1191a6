/* SPDX-License-Identifier: MIT
 *
 * The scenes of the physics suite, made in memory: media whose light is known without any renderer,
 * a camera that sees it at many angles at once, and the truth of every pixel.
 */
#ifndef NEPH_HARNESS_PHYSICS_STAGE_H
#define NEPH_HARNESS_PHYSICS_STAGE_H

#include "scenes/grid.h"
#include "scenes/scene.h"
#include "truth/slab.h"
#include "truth/step_cloud.h"

enum neph_stage_medium {
    NEPH_STAGE_SLAB,     /* homogeneous, 10 m thick, 200 km wide; sun above, black below */
    NEPH_STAGE_FOG,      /* height fog without end over black ground: the slab of its whole depth */
    NEPH_STAGE_BOX,      /* a homogeneous cube of 10 m */
    NEPH_STAGE_GAUSSIAN, /* a blob in a cube of 10 m */
    NEPH_STAGE_GRID,     /* 4^3 voxels of seeded density in a cube of 10 m */
    NEPH_STAGE_FOG_BOX,  /* height fog in a cube of 10 m */
    NEPH_STAGE_SHELL, /* an atmosphere around a ball of 2 m, in a cube of 10 m; the ball is empty */
    NEPH_STAGE_TENT,  /* a layer from 2 m to 5 m from the middle of that cube */
    NEPH_STAGE_CLOUDS, /* Horizon clouds of seed 1, made small, in a cube of 10 m */
    /* Half a period of 8 km of each optical depth of truth/step_cloud.h in turn, three periods of
     * them: what lies beyond is far out of reach of light in 250 m of cloud. */
    NEPH_STAGE_STEP_CLOUD,
    NEPH_STAGE_MEDIUM_COUNT,
};

enum neph_stage_truth {
    NEPH_STAGE_TRUTH_SLAB,       /* truth/slab.h: all orders */
    NEPH_STAGE_TRUTH_RAY,        /* truth/transport.h: single scattering, exact */
    NEPH_STAGE_TRUTH_FURNACE,    /* the surround's radiance, everywhere; media are as hot as that */
    NEPH_STAGE_TRUTH_HALF_SPACE, /* Chandrasekhar's H function: all orders, isotropic, seen from
                                    above; for a slab so thick that its bottom does not matter */
    NEPH_STAGE_TRUTH_COLUMNS,    /* truth/step_cloud.h: all orders, with noise of its own */
};

/* What is on the stage. */
struct neph_stage_params {
    const char *name; /* of the scene; a plain identifier */
    enum neph_stage_medium medium;
    enum neph_stage_truth truth;
    double optical_depth; /* vertical; through the middle for box, Gaussian and grid;
                             about that for shell and clouds; of the half of
                             the step cloud that is looked at */
    double albedo;
    struct neph_phase phase;
    double sun_cosine; /* of the sun's angle to the vertical; not used by the furnace */
    /* Where the camera looks: azimuth from the sun's, elevation above the level. It stands above a
     * slab or fog when it looks down and below when it looks up, and outside a cube on the far
     * side of what it looks at. */
    double view_azimuth_rad, view_elevation_rad, vertical_fov_rad;
    double aspect; /* width / height of the picture */
};

/* Slabs are solved at these cosines of the view and interpolated between (Chebyshev points, so the
 * polynomial converges as fast as the radiance is smooth: a test says how well). */
enum { NEPH_STAGE_COSINES = 32, NEPH_STAGE_COLUMNS = 32 };

/* Owns everything that its scene points to; do not copy. */
struct neph_stage {
    struct neph_stage_params params;
    struct neph_scene scene;
    struct neph_camera_key key;
    struct neph_solid ground;
    struct neph_grid *grid;
    struct neph_horizon *horizon;
    struct neph_slab *slab; /* the solved truth of NEPH_STAGE_TRUTH_SLAB */
    double cosines[NEPH_STAGE_COSINES];
    struct neph_estimate columns[NEPH_STAGE_COLUMNS]; /* of NEPH_STAGE_TRUTH_COLUMNS [1/sr] */
};

/* From its camera, half the width of half a period of the step cloud over its distance. */
#define NEPH_STAGE_COLUMNS_TANGENT (4e3 / (4e5 - 250.0))

#define NEPH_STAGE_IRRADIANCE_W_PER_M2 10.0
#define NEPH_STAGE_SURROUND_W_PER_M2_SR 1.0 /* of the furnace */

/* Free with neph_stage_destroy. */
enum neph_status neph_stage_create(const struct neph_stage_params *params,
                                   struct neph_stage **stage, struct neph_diag *diag);
void neph_stage_destroy(struct neph_stage *stage); /* NULL is fine */

/* The true radiance (all channels alike) along a ray of the camera. */
double neph_stage_truth_w_per_m2_sr(const struct neph_stage *stage, struct neph_vec3 direction);

/* The standard error of the mean of that over the picture, as a fraction of it; 0 but for
 * NEPH_STAGE_TRUTH_COLUMNS. */
double neph_stage_truth_error(const struct neph_stage *stage);

#endif
