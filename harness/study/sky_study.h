/* SPDX-License-Identifier: MIT
 *
 * A sky study: models of a planet's atmosphere side by side with a tracer's light of all orders, by
 * elevation of the sun, altitude of the camera and direction. In each cell, a sun and an altitude,
 * two wide pictures look towards the sun and away from it; tiles of their pixels are directions.
 *
 * A direction is off by the sum over the channels of |model - truth| over the sum of the truth, so
 * that colours count, and dark ones by what they are. The truth is rendered twice, with two seeds;
 * what a direction of it would be off by its own noise is half their difference.
 */
#ifndef NEPH_HARNESS_STUDY_SKY_STUDY_H
#define NEPH_HARNESS_STUDY_SKY_STUDY_H

#include "harness/json.h"
#include "harness/run/job.h"
#include "harness/study/light_models.h"

enum { NEPH_SKY_LIST_MAX = 16, NEPH_SKY_WHY_SIZE = 200 };

/* What issue and design ask for, down to a sun of so many degrees. */
#define NEPH_SKY_MEAN_WANTED 0.02
#define NEPH_SKY_WORST_WANTED 0.10
#define NEPH_SKY_LOWEST_SUN_DEG 5.0

struct neph_sky_study_params {
    const struct neph_scene *scene;
    const char *const *models; /* of neph_light_model_parse() */
    int model_count;           /* 1 .. NEPH_LIGHT_MODELS_MAX */
    const char *truth; /* tracer, oracle, exact; or a model with finer settings, for what its
                          tables leave, without noise: ENGINE+KEY=VALUE+... */
    double suns_deg[NEPH_SKY_LIST_MAX], altitudes_m[NEPH_SKY_LIST_MAX];
    int sun_count, altitude_count;
    int width_px, height_px;           /* of a picture */
    int tile_px;                       /* side of a direction */
    int steps;                         /* of every view ray, unless a model says otherwise */
    int samples;                       /* of a picture of the truth, for a tracer */
    struct neph_shared_device *device; /* as neph_shot.device */
    bool quiet;
};

/* Over the directions of a cell, weighted by their solid angles. */
struct neph_sky_gap {
    double mean, worst; /* of what directions are off by */
    double bias;        /* sum of the model over sum of the truth, less 1 */
    double worst_elevation_deg, worst_azimuth_deg; /* of that direction; azimuth from the sun's */
    double worst_noise;                            /* of the truth there */
    double render_s;                               /* of both pictures */
    char because[NEPH_SKY_WHY_SIZE];               /* why there is nothing; "" when there is */
};

struct neph_sky_cell {
    double sun_deg, altitude_m;
    int direction_count;
    double noise; /* of the truth, mean over directions */
    double truth_s;
    struct neph_sky_gap gaps[NEPH_LIGHT_MODELS_MAX];
};

struct neph_sky_study {
    const struct neph_sky_study_params *params; /* borrowed */
    char device[128];                           /* of the truth */
    char settings[NEPH_LIGHT_MODELS_MAX][400];  /* of the models, in full */
    struct neph_sky_cell *cells;                /* owned; altitudes run fastest */
    int cell_count;
};

/* Whether a cell is one of those that a model must be good in; and whether it is. */
bool neph_sky_is_held(const struct neph_sky_cell *cell);
bool neph_sky_is_good(const struct neph_sky_gap *gap);

/* For _finish in any case. NEPH_ERR_INTERRUPTED: what is finished stays in the store. */
enum neph_status neph_sky_study_run(const struct neph_sky_study_params *params,
                                    struct neph_store *store, struct neph_sky_study *study,
                                    struct neph_diag *diag);
void neph_sky_study_finish(struct neph_sky_study *study);

/* As Markdown, for the caller to free; and as JSON, NULL when memory is short. */
enum neph_status neph_sky_study_text(const struct neph_sky_study *study, char **text,
                                     struct neph_diag *diag);
json_t *neph_sky_study_json(const struct neph_sky_study *study);

#endif
