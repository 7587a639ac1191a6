/* SPDX-License-Identifier: MIT
 *
 * The scenes of the physics suite, built in memory: media with a known solution of the transport
 * problem, a camera that covers many angles at once, and the reference radiance of every pixel.
 */
#ifndef NEPH_HARNESS_PHYSICS_STAGE_H
#define NEPH_HARNESS_PHYSICS_STAGE_H

#include "scenes/grid.h"
#include "scenes/scene.h"
#include "truth/slab.h"
#include "truth/step_cloud.h"

enum neph_stage_medium {
    NEPH_STAGE_SLAB,     /* homogeneous, 10 m thick, 200 km wide; sun above, black below */
    NEPH_STAGE_FOG,      /* infinite height fog over black ground; equals a slab of its total
                            depth */
    NEPH_STAGE_BOX,      /* a homogeneous cube of 10 m */
    NEPH_STAGE_GAUSSIAN, /* a Gaussian blob in a cube of 10 m */
    NEPH_STAGE_GRID,     /* 4^3 voxels of seeded density in a cube of 10 m */
    NEPH_STAGE_FOG_BOX,  /* height fog in a cube of 10 m */
    NEPH_STAGE_SHELL, /* an exponential atmosphere around an empty ball of 2 m, in a cube of 10 m */
    NEPH_STAGE_TENT,  /* a layer at 2 m to 5 m from the centre of such a cube */
    NEPH_STAGE_CLOUDS, /* Horizon clouds of seed 1, scaled to a cube of 10 m */
    /* Alternating halves of a period, 8 km each, with the two optical depths of truth/step_cloud.h.
     * Three periods suffice: light in a cloud 250 m thick does not travel farther. */
    NEPH_STAGE_STEP_CLOUD,
    NEPH_STAGE_MEDIUM_COUNT,
};

enum neph_stage_truth {
    NEPH_STAGE_TRUTH_SLAB,       /* truth/slab.h: all orders */
    NEPH_STAGE_TRUTH_RAY,        /* truth/transport.h: single scattering, exact */
    NEPH_STAGE_TRUTH_FURNACE,    /* the environment's radiance everywhere; media emit as much */
    NEPH_STAGE_TRUTH_HALF_SPACE, /* Chandrasekhar's H function: all orders, isotropic, from above;
                                    for a slab so thick that its bottom is irrelevant */
    NEPH_STAGE_TRUTH_COLUMNS,    /* truth/step_cloud.h: all orders; a Monte Carlo estimate */
};

/* Parameters of a scene. */
struct neph_stage_params {
    const char *name; /* name of the scene; a plain identifier */
    enum neph_stage_medium medium;
    enum neph_stage_truth truth;
    double optical_depth; /* vertical; through the centre for box, Gaussian and grid; approximate
                             for shell and clouds; of the visible half for the step cloud */
    double albedo;
    struct neph_phase phase;
    double sun_cosine; /* of the sun's zenith angle; unused by the furnace */
    /* View direction: azimuth from the sun's azimuth, elevation above the horizontal. The camera is
     * above a slab or fog when it looks down, below a slab when it looks up, and outside a cube on
     * the opposite side of the view direction. */
    double view_azimuth_rad, view_elevation_rad, vertical_fov_rad;
    double aspect; /* width / height of the frame */
};

/* Slabs are solved at these view cosines and interpolated between them. The cosines are Chebyshev
 * points, so the interpolation converges as fast as the radiance is smooth; a test measures its
 * error. */
enum { NEPH_STAGE_COSINES = 32, NEPH_STAGE_COLUMNS = 32 };

/* Owns everything that its scene points to; do not copy. */
struct neph_stage {
    struct neph_stage_params params;
    struct neph_scene scene;
    struct neph_camera_key key;
    struct neph_solid ground;
    struct neph_grid *grid;
    struct neph_horizon *horizon;
    struct neph_slab *slab; /* solution for NEPH_STAGE_TRUTH_SLAB */
    double cosines[NEPH_STAGE_COSINES];
    struct neph_estimate columns[NEPH_STAGE_COLUMNS]; /* for NEPH_STAGE_TRUTH_COLUMNS [1/sr] */
};

/* Tangent of half the view angle of half a period of the step cloud, from its camera. */
#define NEPH_STAGE_COLUMNS_TANGENT (4e3 / (4e5 - 250.0))

#define NEPH_STAGE_IRRADIANCE_W_PER_M2 10.0
#define NEPH_STAGE_SURROUND_W_PER_M2_SR 1.0 /* for the furnace */

/* Build a scene and solve its reference. Free with neph_stage_destroy(). */
enum neph_status neph_stage_create(const struct neph_stage_params *params,
                                   struct neph_stage **stage, struct neph_diag *diag);
void neph_stage_destroy(struct neph_stage *stage); /* NULL is allowed */

/* The reference radiance (equal in all channels) along a ray of the camera. */
double neph_stage_truth_w_per_m2_sr(const struct neph_stage *stage, struct neph_vec3 direction);

/* The relative standard error of the mean reference radiance of the frame; 0 for all references but
 * NEPH_STAGE_TRUTH_COLUMNS. */
double neph_stage_truth_error(const struct neph_stage *stage);

#endif
