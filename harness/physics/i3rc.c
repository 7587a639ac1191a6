/* SPDX-License-Identifier: MIT */
#include "harness/physics/i3rc.h"

#include "harness/physics/i3rc_files.h"
#include "metrics/significance.h"
#include "metrics/z_test.h"

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

static const double normal_95 = 1.95996; /* half a 95 % interval, in standard errors */

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

/* A mean over columns or a correlation, with its standard error by their scatter. */
struct mean {
    double value, error;
};

static struct mean find_mean(const double *values, int count)
{
    double sum = 0.0, squares = 0.0;
    for (int i = 0; i < count; i++)
        sum += values[i] / count;
    for (int i = 0; i < count; i++)
        squares += (values[i] - sum) * (values[i] - sum) / count;
    return (struct mean){sum, sqrt(squares / fmax(1.0, count - 1.0))};
}

/* The squared difference of each column without our variance. */
static void find_rest(const struct neph_fluxes *fluxes, enum neph_flux flux,
                      const double *consensus, int count, double *rest)
{
    for (int i = 0; i < count; i++) {
        const struct neph_flux_estimate own = neph_flux_of_column(fluxes, flux, i, 0);
        const double off = own.mean - consensus[i];
        rest[i] = off * off - own.standard_error * own.standard_error;
    }
}

/* Fit the constant to all stages; `rest`: their rows one after the other, and room for another. */
static void fit_constant(double *rest, int count, struct neph_i3rc_columns *columns)
{
    double weights[NEPH_I3RC_STAGES], sum = 0.0, *fitted = rest + NEPH_I3RC_STAGES * count;
    for (int s = 0; s < NEPH_I3RC_STAGES; s++) {
        const double error = find_mean(rest + s * count, count).error;
        weights[s] = error > 0.0 ? 1.0 / (error * error) : 0.0;
        sum += weights[s];
    }
    weights[NEPH_I3RC_STAGES - 1] += sum > 0.0 ? 0.0 : 1.0;
    sum += sum > 0.0 ? 0.0 : 1.0;
    for (int i = 0; i < count; i++) {
        fitted[i] = 0.0;
        for (int s = 0; s < NEPH_I3RC_STAGES; s++)
            fitted[i] += weights[s] / sum * rest[s * count + i];
    }
    const struct mean square = find_mean(fitted, count);
    const double half = normal_95 * square.error;
    columns->constant = square.value > half ? sqrt(square.value) : NAN;
    columns->constant_low = sqrt(fmax(0.0, square.value - half));
    columns->constant_high = sqrt(fmax(0.0, square.value) + half);
    columns->fall = 0.0;
    for (int s = 0; s + 1 < NEPH_I3RC_STAGES; s++) {
        for (int i = 0; i < count; i++)
            rest[s * count + i] -= rest[(NEPH_I3RC_STAGES - 1) * count + i];
        const struct mean excess = find_mean(rest + s * count, count);
        const double fall = excess.error > 0.0 ? excess.value / excess.error : 0.0;
        columns->fall = fabs(fall) > fabs(columns->fall) ? fall : columns->fall;
    }
}

/* Correlation of the differences of a column and the next along x or z, periodic, with its standard
 * error for noise that differs from column to column (H. White, Econometrica 48, 1980). */
static struct mean correlate(const struct neph_flux_domain *domain, const double *differences,
                             int step_x, int step_z)
{
    const int nx = domain->columns_x, nz = domain->columns_z, columns = nx * nz;
    double mean = 0.0, product = 0.0, square = 0.0, fourth = 0.0;
    if ((step_x && nx < 2) || (step_z && nz < 2))
        return (struct mean){NAN, NAN};
    for (int i = 0; i < columns; i++)
        mean += differences[i] / columns;
    for (int i = 0; i < columns; i++) {
        const int next = (i % nx + step_x) % nx + nx * ((i / nx + step_z) % nz);
        const double own = (differences[i] - mean) * (differences[next] - mean);
        product += own;
        fourth += own * own;
        square += (differences[i] - mean) * (differences[i] - mean);
    }
    return square > 0.0 ? (struct mean){product / square, sqrt(fourth) / square}
                        : (struct mean){NAN, NAN};
}

/* The difference of a column in standard errors of both. Those of ours are uncertain: by their
 * relative variance of the variance, 2 / doubt degrees of freedom (Satterthwaite, Biometrics
 * Bulletin 2, 1946); the score is the normal deviate with the probability of Student's t. */
static double find_score(const struct neph_flux_estimate *own, double consensus, double constant)
{
    const double noise = own->standard_error * own->standard_error,
                 variance = noise + constant * constant;
    if (!(variance > 0.0))
        return 0.0;
    const double dof = own->doubt > 0.0 ? 2.0 / own->doubt * pow(variance / noise, 2.0) : INFINITY;
    const double t = (own->mean - consensus) / sqrt(variance);
    return isfinite(dof) ? neph_z_from_student(t, dof) : t;
}

/* The differences of all columns, and the column with the largest score. */
static void find_worst(const struct neph_fluxes *fluxes, enum neph_flux flux,
                       const double *consensus, double *differences,
                       struct neph_i3rc_columns *columns)
{
    const int nx = fluxes->domain.columns_x, count = nx * fluxes->domain.columns_z;
    const double other = isnan(columns->constant) ? 0.0 : columns->constant;
    double most = -1.0;
    for (int i = 0; i < count; i++) {
        const struct neph_flux_estimate own = neph_flux_of_column(fluxes, flux, i, 0);
        const double score = find_score(&own, consensus[i], other);
        differences[i] = own.mean - consensus[i];
        if (fabs(score) <= most)
            continue;
        most = fabs(score);
        columns->worst_score = score;
        columns->worst_x = i % nx;
        columns->worst_z = i / nx;
        columns->worst = own.mean;
        columns->worst_error = own.standard_error;
        columns->worst_consensus = consensus[i];
    }
    columns->worst_p = -expm1(count * log1p(-neph_normal_p(most))); /* Sidak */
}

/* `room`: NEPH_I3RC_STAGES + 1 numbers of each column. */
static void compare_columns(const struct neph_fluxes stages[NEPH_I3RC_STAGES], enum neph_flux flux,
                            const double *consensus, double *room,
                            struct neph_i3rc_columns *columns)
{
    const struct neph_fluxes *last = &stages[NEPH_I3RC_STAGES - 1];
    const int count = last->domain.columns_x * last->domain.columns_z;
    for (int s = 0; s < NEPH_I3RC_STAGES; s++) {
        columns->rms[s] = sqrt(mean_square_difference(&stages[s], flux, consensus, count));
        find_rest(&stages[s], flux, consensus, count, room + s * count);
    }
    columns->noise = sqrt(mean_square_error(last, flux, count));
    fit_constant(room, count, columns);
    find_worst(last, flux, consensus, room, columns);
    for (int along = 0; along < 2; along++) {
        const struct mean found = correlate(&last->domain, room, along == 0, along == 1);
        columns->correlation[along] = found.value;
        columns->correlation_error[along] = found.error;
    }
}

enum neph_status neph_i3rc_compare(const struct neph_fluxes stages[NEPH_I3RC_STAGES],
                                   enum neph_flux flux, const double *consensus,
                                   struct neph_i3rc_number *number, struct neph_diag *diag)
{
    const struct neph_flux_domain *domain = &stages[NEPH_I3RC_STAGES - 1].domain;
    const int count = domain->columns_x * domain->columns_z;
    double *room = calloc((NEPH_I3RC_STAGES + 1) * (size_t)count, sizeof(*room)), mean = 0.0;
    if (!room)
        return neph_fail_memory(diag);
    compare_columns(stages, flux, consensus, room, &number->columns);
    free(room);
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
