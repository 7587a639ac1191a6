/* SPDX-License-Identifier: MIT */
#include "harness/physics/i3rc.h"

#include "harness/physics/i3rc_files.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const double neph_i3rc_stages[NEPH_I3RC_STAGES] = {1.0 / 16.0, 0.25, 1.0};

const struct neph_i3rc_quantity neph_i3rc_quantities[NEPH_I3RC_QUANTITIES] = {
    {"R", NEPH_FLUX_REFLECTED},  {"T", NEPH_FLUX_TRANSMITTED}, {"A", NEPH_FLUX_ABSORBED},
    {"H", NEPH_FLUX_HORIZONTAL}, {"Iu", NEPH_FLUX_NADIR},      {"Id", NEPH_FLUX_ZENITH}};

/* Photons of a column: standard errors of the domain's fluxes of 0.1 % or less, in a minute. */
static const int usual_paths[] = {16000, 4000, 512};

/* A difference from the consensus that its codes have among each other, and our standard errors. */
static const double allowed_part = 0.003, allowed_errors = 3.0;

/* ---- comparison ---- */

static double mean_square_error(const struct neph_fluxes *fluxes, enum neph_flux flux, int columns)
{
    double sum = 0.0;
    for (int i = 0; i < columns; i++) {
        const double error = neph_flux_of_column(fluxes, flux, i, 0).standard_error;
        sum += error * error / columns;
    }
    return sum;
}

static double mean_square_difference(const struct neph_fluxes *fluxes, enum neph_flux flux,
                                     const double *consensus, int columns)
{
    double sum = 0.0;
    for (int i = 0; i < columns; i++) {
        const double off = neph_flux_of_column(fluxes, flux, i, 0).mean - consensus[i];
        sum += off * off / columns;
    }
    return sum;
}

/* Correlation of the differences of a column and the next along x or z, periodic. */
static double correlate(const struct neph_flux_domain *domain, const double *differences,
                        int step_x, int step_z)
{
    const int nx = domain->columns_x, nz = domain->columns_z, columns = nx * nz;
    double mean = 0.0, product = 0.0, square = 0.0;
    if ((step_x && nx < 2) || (step_z && nz < 2))
        return NAN;
    for (int i = 0; i < columns; i++)
        mean += differences[i] / columns;
    for (int i = 0; i < columns; i++) {
        const int next = (i % nx + step_x) % nx + nx * ((i / nx + step_z) % nz);
        product += (differences[i] - mean) * (differences[next] - mean);
        square += (differences[i] - mean) * (differences[i] - mean);
    }
    return square > 0.0 ? product / square : NAN;
}

/* The column that differs most, in standard errors of both. */
static void find_worst(const struct neph_fluxes *fluxes, enum neph_flux flux,
                       const double *consensus, struct neph_i3rc_columns *columns)
{
    const int nx = fluxes->domain.columns_x, count = nx * fluxes->domain.columns_z;
    const double other = isnan(columns->constant) ? 0.0 : columns->constant;
    double most = -1.0;
    for (int i = 0; i < count; i++) {
        const struct neph_flux_estimate own = neph_flux_of_column(fluxes, flux, i, 0);
        const double error = hypot(own.standard_error, other);
        const double off = error > 0.0 ? fabs(own.mean - consensus[i]) / error : 0.0;
        if (off <= most)
            continue;
        most = off;
        columns->worst_x = i % nx;
        columns->worst_z = i / nx;
        columns->worst = own.mean;
        columns->worst_error = own.standard_error;
        columns->worst_consensus = consensus[i];
    }
}

static void compare_columns(const struct neph_fluxes stages[NEPH_I3RC_STAGES], enum neph_flux flux,
                            const double *consensus, double *differences,
                            struct neph_i3rc_columns *columns)
{
    const struct neph_fluxes *last = &stages[NEPH_I3RC_STAGES - 1];
    const int count = last->domain.columns_x * last->domain.columns_z;
    const double noise = mean_square_error(last, flux, count);
    for (int s = 0; s < NEPH_I3RC_STAGES; s++)
        columns->rms[s] = sqrt(mean_square_difference(&stages[s], flux, consensus, count));
    const double left = columns->rms[NEPH_I3RC_STAGES - 1] * columns->rms[NEPH_I3RC_STAGES - 1] -
                        noise;
    columns->noise = sqrt(noise);
    columns->constant = left > 0.0 ? sqrt(left) : NAN;
    for (int i = 0; i < count; i++)
        differences[i] = neph_flux_of_column(last, flux, i, 0).mean - consensus[i];
    columns->correlation_x = correlate(&last->domain, differences, 1, 0);
    columns->correlation_z = correlate(&last->domain, differences, 0, 1);
    columns->correlation_error = 1.0 / sqrt(count);
    find_worst(last, flux, consensus, columns);
}

enum neph_status neph_i3rc_compare(const struct neph_fluxes stages[NEPH_I3RC_STAGES],
                                   enum neph_flux flux, const double *consensus,
                                   struct neph_i3rc_number *number, struct neph_diag *diag)
{
    const struct neph_flux_domain *domain = &stages[NEPH_I3RC_STAGES - 1].domain;
    const int count = domain->columns_x * domain->columns_z;
    double *differences = calloc((size_t)count, sizeof(*differences)), mean = 0.0;
    if (!differences)
        return neph_fail_memory(diag);
    compare_columns(stages, flux, consensus, differences, &number->columns);
    free(differences);
    for (int i = 0; i < count; i++)
        mean += consensus[i] / count;
    const double off = fabs(number->ours.mean - mean);
    number->has_consensus = true;
    number->consensus = mean;
    number->consensus_error = number->columns.constant / sqrt(count);
    number->agrees = off <= allowed_part * fabs(mean) ||
                     off <= allowed_errors * number->ours.standard_error;
    return NEPH_OK;
}

/* ---- a row ---- */

static enum neph_status measure_stages(const struct neph_i3rc_params *params,
                                       const struct neph_i3rc_scene *scene,
                                       const struct neph_i3rc_row *row,
                                       struct neph_fluxes stages[NEPH_I3RC_STAGES],
                                       struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int s = 0; s < NEPH_I3RC_STAGES && !status; s++) {
        const int paths = (int)ceil(row->paths * neph_i3rc_stages[s]);
        const struct neph_fluxes_job job = {
            .engine = params->engine,
            .what = scene->name,
            .params = {.columns_x = scene->columns_x,
                       .columns_z = scene->columns_z,
                       .bottom_m = NAN,
                       .top_m = NAN,
                       .paths = paths < NEPH_FLUX_PATHS_MIN ? NEPH_FLUX_PATHS_MIN : paths,
                       .seed = (uint64_t)s + 1},
            .device = params->device,
            .quiet = params->quiet};
        status = neph_fluxes_measure(&job, &scene->scene, &stages[s], diag);
    }
    return status;
}

static enum neph_status fill_number(const struct neph_i3rc_params *params,
                                    const struct neph_i3rc_experiment *experiment, int quantity,
                                    const struct neph_fluxes stages[NEPH_I3RC_STAGES],
                                    struct neph_i3rc_number *number, struct neph_diag *diag)
{
    const struct neph_fluxes *last = &stages[NEPH_I3RC_STAGES - 1];
    const enum neph_flux flux = neph_i3rc_quantities[quantity].flux;
    double *consensus = NULL;
    number->ours = neph_flux_of_domain(last, flux, 0);
    number->doubtful_columns = neph_flux_doubtful_columns(last, flux, 0);
    enum neph_status status = NEPH_OK;
    if (params->folder)
        status = neph_i3rc_consensus_read(params->folder, experiment->case_number,
                                          experiment->number, neph_i3rc_quantities[quantity].name,
                                          last->domain.columns_x * last->domain.columns_z,
                                          &consensus, diag);
    if (!status && consensus)
        status = neph_i3rc_compare(stages, flux, consensus, number, diag);
    free(consensus);
    return status;
}

static double find_balance(const struct neph_i3rc_row *row)
{
    const struct neph_i3rc_number *reflected = &row->numbers[0], *transmitted = &row->numbers[1],
                                  *absorbed = &row->numbers[2];
    const bool absorbs = row->experiment->albedo < 1.0;
    if (!reflected->has_consensus || !transmitted->has_consensus ||
        (absorbs && !absorbed->has_consensus))
        return NAN;
    return reflected->consensus + (absorbs ? absorbed->consensus : 0.0) +
           (1.0 - row->experiment->ground_albedo) * transmitted->consensus;
}

static enum neph_status measure_row(const struct neph_i3rc_params *params,
                                    const struct neph_i3rc_scene *scene, struct neph_i3rc *suite,
                                    struct neph_i3rc_row *row, struct neph_diag *diag)
{
    struct neph_fluxes stages[NEPH_I3RC_STAGES] = {{.sums = NULL}};
    row->optical_depth = scene->optical_depth;
    enum neph_status status = measure_stages(params, scene, row, stages, diag);
    for (int q = 0; q < NEPH_I3RC_QUANTITIES && !status; q++) {
        struct neph_i3rc_number *number = &row->numbers[q];
        status = fill_number(params, row->experiment, q, stages, number, diag);
        suite->compared += !status && number->has_consensus;
        suite->failed += !status && number->has_consensus && !number->agrees;
    }
    row->consensus_balance = find_balance(row);
    if (!status) {
        row->paths = stages[NEPH_I3RC_STAGES - 1].paths;
        for (int s = 0; s < NEPH_I3RC_STAGES; s++)
            row->wall_s += stages[s].wall_s;
        neph_fluxes_warn(scene->name, &stages[NEPH_I3RC_STAGES - 1]);
    }
    for (int s = 0; s < NEPH_I3RC_STAGES; s++)
        neph_fluxes_finish(&stages[s]);
    return status;
}

static enum neph_status run_row(const struct neph_i3rc_params *params, struct neph_i3rc *suite,
                                struct neph_i3rc_row *row, struct neph_diag *diag)
{
    const struct neph_i3rc_experiment *experiment = row->experiment;
    struct neph_i3rc_scene *scene = NULL;
    if (!params->folder && experiment->case_number > 1) {
        row->missing = neph_arena_format(&suite->arena, "not here: %s names no folder",
                                         NEPH_I3RC_VARIABLE);
        return NEPH_OK;
    }
    enum neph_status status = neph_i3rc_scene_create(experiment, params->folder, &scene, diag);
    if (status == NEPH_ERR_NOT_FOUND || status == NEPH_ERR_UNSUPPORTED) {
        row->missing = neph_arena_format(&suite->arena, "not here: %s", diag->message);
        *diag = (struct neph_diag){.line = 0};
        return NEPH_OK;
    }
    row->paths = params->paths > 0 ? params->paths : usual_paths[experiment->case_number - 1];
    if (!status)
        status = measure_row(params, scene, suite, row, diag);
    neph_i3rc_scene_destroy(scene);
    return status;
}

/* ---- the suite ---- */

/* "case2_exp5" */
static void name_experiment(const struct neph_i3rc_experiment *experiment, char name[32])
{
    snprintf(name, 32, "case%d_exp%d", experiment->case_number, experiment->number);
}

static bool is_chosen(const struct neph_i3rc_params *params,
                      const struct neph_i3rc_experiment *experiment)
{
    char name[32];
    bool chosen = params->only_count == 0;
    name_experiment(experiment, name);
    for (int i = 0; i < params->only_count; i++)
        chosen |= strstr(name, params->only[i]) != NULL;
    return chosen;
}

enum neph_status neph_i3rc_run(const struct neph_i3rc_params *params, struct neph_i3rc *suite,
                               struct neph_diag *diag)
{
    struct neph_diag own = {.line = 0}; /* rows read its message */
    suite->rows = neph_arena_allocate(&suite->arena, (size_t)neph_i3rc_experiment_count,
                                      sizeof(*suite->rows));
    enum neph_status status = neph_arena_check(&suite->arena, &own);
    for (int i = 0; i < neph_i3rc_experiment_count && !status; i++) {
        if (!is_chosen(params, &neph_i3rc_experiments[i]))
            continue;
        struct neph_i3rc_row *row = &suite->rows[suite->row_count++];
        row->experiment = &neph_i3rc_experiments[i];
        status = run_row(params, suite, row, &own);
    }
    if (!status && suite->row_count == 0) {
        status = neph_fail(&own, NEPH_ERR_USAGE, "no experiment has '%s' in its name",
                           params->only[0]);
        neph_hint(&own, "names are case1_exp1 to case3_exp4");
    }
    if (diag && status)
        *diag = own;
    return status ? status : neph_arena_check(&suite->arena, diag);
}

void neph_i3rc_finish(struct neph_i3rc *suite)
{
    neph_arena_finish(&suite->arena);
}
