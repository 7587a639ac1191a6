/* SPDX-License-Identifier: MIT */
#include "harness/study/phase_models.h"

#include <math.h>

static double measure_log_error(const struct neph_phase *phase, const struct neph_phase *droplets)
{
    double sum = 0.0;
    for (int degree = 0; degree <= 180; degree++) {
        const double cosine = cos(degree * M_PI / 180.0);
        sum += pow(log(neph_phase_per_sr(phase, cosine) / neph_phase_per_sr(droplets, cosine)),
                   2.0);
    }
    return sqrt(sum / 181.0);
}

static void keep_better(struct neph_phase phase, const struct neph_phase *droplets,
                        struct neph_phase_model *model)
{
    const double error = measure_log_error(&phase, droplets);
    if (error < model->log_error) {
        model->phase = phase;
        model->log_error = error;
    }
}

static struct neph_phase_model fit_henyey_greenstein(const struct neph_phase *droplets)
{
    struct neph_phase_model model = {.name = "Henyey-Greenstein", .log_error = INFINITY};
    const struct neph_phase phase = {NEPH_PHASE_HENYEY_GREENSTEIN,
                                     neph_phase_mean_cosine(droplets)};
    keep_better(phase, droplets, &model);
    return model;
}

/* The share of the first lobe follows from the mean cosine. */
static struct neph_phase_model fit_two_lobes(const struct neph_phase *droplets)
{
    struct neph_phase_model model = {.name = "double Henyey-Greenstein", .log_error = INFINITY};
    const double mean = neph_phase_mean_cosine(droplets);
    for (int first = 0; first < 199; first++)
        for (int second = 0; second <= 30; second++) {
            struct neph_phase phase = {.kind = NEPH_PHASE_DOUBLE_HENYEY_GREENSTEIN,
                                       .g = 0.005 * first,
                                       .second_g = -0.9 + 0.05 * second};
            phase.first_share = (mean - phase.second_g) / (phase.g - phase.second_g);
            if (phase.g > mean && phase.second_g < mean && phase.first_share <= 1.0)
                keep_better(phase, droplets, &model);
        }
    return model;
}

/* Alpha follows from the mean cosine, g (1 + alpha (3 + 2 g^2) / 5) / (1 + alpha (1 + 2 g^2) / 3).
 */
static struct neph_phase_model fit_draine(const struct neph_phase *droplets)
{
    struct neph_phase_model model = {.name = "Draine", .log_error = INFINITY};
    const double mean = neph_phase_mean_cosine(droplets);
    for (int i = 0; i < 199; i++) {
        const double g = 0.005 * i, above = mean - g;
        const double per_alpha = g * (3.0 + 2.0 * g * g) / 5.0 - mean * (1.0 + 2.0 * g * g) / 3.0;
        const double alpha = above / per_alpha;
        if (above > 0.0 && per_alpha > 0.0 && alpha <= 1000.0)
            keep_better(
                (struct neph_phase){.kind = NEPH_PHASE_DRAINE, .g = g, .draine_alpha = alpha},
                droplets, &model);
    }
    return model;
}

/* Whether droplet_diameter_um is in the model's range. */
static bool is_diameter(double diameter_um)
{
    return diameter_um >= 5.0 && diameter_um <= 50.0;
}

static struct neph_phase_model fit_jendersie_deon(const struct neph_phase *droplets,
                                                  double radius_um)
{
    struct neph_phase_model model = {.name = "Jendersie-d'Eon", .log_error = INFINITY};
    const struct neph_phase phase = {.kind = NEPH_PHASE_JENDERSIE_DEON,
                                     .droplet_diameter_um = 2.0 * radius_um};
    if (is_diameter(2.0 * radius_um))
        keep_better(phase, droplets, &model);
    return model;
}

int neph_phase_models(const struct neph_phase *droplets, double radius_um,
                      struct neph_phase_model models[NEPH_PHASE_MODELS_MAX])
{
    const struct neph_phase_model all[] = {fit_henyey_greenstein(droplets), fit_two_lobes(droplets),
                                           fit_draine(droplets),
                                           fit_jendersie_deon(droplets, radius_um)};
    int count = 0;
    for (size_t i = 0; i < sizeof(all) / sizeof(all[0]); i++)
        if (isfinite(all[i].log_error))
            models[count++] = all[i];
    return count;
}

int neph_phase_models_at(const struct neph_phase_model *models, int count, double radius_um,
                         struct neph_phase_model at[NEPH_PHASE_MODELS_MAX])
{
    int kept = 0;
    for (int m = 0; m < count; m++) {
        struct neph_phase_model model = models[m];
        const bool has_diameter = neph_phase_has(model.phase.kind, NEPH_PHASE_PARAMETER_DIAMETER);
        if (has_diameter)
            model.phase.droplet_diameter_um = 2.0 * radius_um;
        if (!has_diameter || is_diameter(2.0 * radius_um))
            at[kept++] = model;
    }
    return kept;
}
