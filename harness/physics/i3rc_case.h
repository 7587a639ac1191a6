/* SPDX-License-Identifier: MIT
 *
 * The experiments of I3RC as scenes. World: +y up; the columns of a table count along x, its lines
 * along z; at an azimuth of 0 sunlight travels towards +x.
 *
 * Case 1, the step cloud: 32 columns of 15.625 m, 250 m thick, optical depth 2 in the first half
 * and 18 in the second (truth/step_cloud.h). Case 2, a cloud of a radar: 640 columns of 50 m, 54
 * layers of 45 m, an optical depth for each cell, the top layer first. Case 3, a cloud of Landsat:
 * 128 x 128 columns of 30 m with an optical depth and a thickness each, above one flat base.
 * Periodic, also across.
 *
 * Fluxes count at the top of the highest cell with a cloud and at the bottom of the lowest. In case
 * 2 the transmittance of the consensus is there: 630 m lower, at the bottom of the table, light has
 * spread over ten columns, and the differences of neighbours are correlated. The ground of
 * experiment 5 is at the bottom of the table, where its transmittance agrees best. Layers of case 3
 * are 20 m, as in the driver of the code by R. Pincus and F. Evans (i3rc-monte-carlo-model). That
 * driver rounds each thickness to whole layers; here the topmost layer of a column has its part of
 * the optical depth.
 */
#ifndef NEPH_HARNESS_PHYSICS_I3RC_CASE_H
#define NEPH_HARNESS_PHYSICS_I3RC_CASE_H

#include "scenes/grid.h"
#include "scenes/scene.h"

struct neph_i3rc_experiment {
    int case_number, number;
    double sun_zenith_deg, albedo, ground_albedo;
    /* The phase function of cloud C.1, the file C.1_PF of the folder; else Henyey-Greenstein with
     * g = 0.85. */
    bool has_c1;
};

extern const struct neph_i3rc_experiment neph_i3rc_experiments[];
extern const int neph_i3rc_experiment_count;

/* Owns everything that its scene points to; do not copy. */
struct neph_i3rc_scene {
    struct neph_scene scene;
    struct neph_camera_key key;
    struct neph_solid ground;
    struct neph_grid *grid;
    struct neph_phase phase;
    struct neph_arena arena; /* of its table */
    char name[32];
    int columns_x, columns_z;
    double optical_depth; /* mean over the columns */
};

/* Read the cloud and the phase function of an experiment from the folder and build its scene; case
 * 1 needs no folder. Free with neph_i3rc_scene_destroy(). Errors as of neph_i3rc_file_read();
 * NEPH_ERR_INPUT also for columns of case 3 with an optical depth but no thickness, or the reverse.
 */
enum neph_status neph_i3rc_scene_create(const struct neph_i3rc_experiment *experiment,
                                        const char *folder, struct neph_i3rc_scene **scene,
                                        struct neph_diag *diag);

void neph_i3rc_scene_destroy(struct neph_i3rc_scene *scene); /* NULL is allowed */

#endif
