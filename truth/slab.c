/* SPDX-License-Identifier: MIT
 *
 * The solution uses Legendre moments of the phase function with delta-M (W. J. Wiscombe, J. Atmos.
 * Sci. 34, 1977), which is exact in the limit of many nodes, with an error below rounding where
 * radiances are allowed. Fourier modes in azimuth are added until they are negligible. The first
 * order of scattering is replaced by its closed form.
 */
#include "truth/slab.h"

#include "base/arena.h"
#include "base/threads.h"
#include "scenes/media.h"
#include "truth/doubling.h"

#include <math.h>
#include <stdlib.h>

/* Modes per batch, independent of the number of processors: same bits everywhere. */
enum { BATCH = 4, NODES_MIN = 32, NODES_MAX = 512, NODES_ENOUGH = 256 };

/* Allowed remainder of the phase function's series beyond the nodes, for radiances. */
static const double series_rest = 1e-9;
/* The largest one accepted at NODES_ENOUGH: straight lines between the rows of a table leave 1e-5,
 * and delta-M moves that part of the light straight ahead. */
static const double unresolved_rest = 1e-4;
/* Modes below this part of the largest one are negligible. */
static const double mode_rest = 1e-11;

struct neph_slab {
    double optical_depth, albedo, sun_cosine;
    struct neph_phase phase;
    struct neph_slab_fluxes fluxes;
    int view_count, mode_count;
    struct neph_arena arena; /* owner of the next members */
    double *view_cosines;
    double *up, *down; /* light scattered at least twice; [mode][view] */
};

/* The data of one solution, shared by the threads. */
struct work {
    double *memory; /* owned */
    struct neph_doubling layer;
    int first_mode;
    struct neph_doubling_light light[BATCH]; /* per row */
    enum neph_status status[BATCH];
    struct neph_diag diag[BATCH];
};

/* ---- parameters ---- */

static enum neph_status check(const struct neph_slab_params *params, struct neph_diag *diag)
{
    const struct {
        const char *name;
        double value, low, high;
    } ranges[] = {
        {"optical depth", params->optical_depth, 0.0, NEPH_SLAB_OPTICAL_DEPTH_MAX},
        {"albedo", params->albedo, 0.0, 1.0},
        {"asymmetry", params->phase.g, -0.999, 0.999},
        {"cosine of the sun", params->sun_cosine, NEPH_SLAB_COSINE_MIN, 1.0},
        {"number of views", params->view_count, 0.0, 1e6},
        {"number of nodes", params->node_count ? params->node_count : NODES_MIN, 2.0, NODES_MAX},
    };
    for (size_t i = 0; i < sizeof(ranges) / sizeof(ranges[0]); i++)
        if (!(ranges[i].value >= ranges[i].low && ranges[i].value <= ranges[i].high))
            return neph_fail(diag, NEPH_ERR_INPUT, "slab: %s is %g, not in %g..%g", ranges[i].name,
                             ranges[i].value, ranges[i].low, ranges[i].high);
    for (int i = 0; i < params->view_count; i++)
        if (!(params->view_cosines[i] >= NEPH_SLAB_COSINE_MIN && params->view_cosines[i] <= 1.0))
            return neph_fail(diag, NEPH_ERR_INPUT, "slab: cosine of view %d is %g, not in %g..1", i,
                             params->view_cosines[i], NEPH_SLAB_COSINE_MIN);
    if (params->view_count > 0 && fabs(params->phase.g) > NEPH_SLAB_RADIANCE_G_MAX)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "slab: radiances for an asymmetry of %g: above %g only fluxes are exact",
                         params->phase.g, NEPH_SLAB_RADIANCE_G_MAX);
    const double rest = neph_phase_moment(&params->phase, 2 * NODES_ENOUGH);
    if (params->view_count > 0 && !params->with_any_peak && fabs(rest) > unresolved_rest)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "slab: radiances for a phase function whose Legendre moment of degree %d "
                         "is %.2g, above %g: only fluxes are exact",
                         2 * NODES_ENOUGH, rest, unresolved_rest);
    return NEPH_OK;
}

/* The number of nodes that reaches series_rest. */
static int choose_nodes(const struct neph_slab_params *params)
{
    if (params->node_count > 0)
        return params->node_count;
    int nodes = 64;
    while (nodes < NODES_ENOUGH && fabs(neph_phase_moment(&params->phase, 2 * nodes)) > series_rest)
        nodes++;
    return nodes;
}

/* ---- memory ---- */

static enum neph_status slab_alloc(const struct neph_slab_params *params, int mode_max,
                                   struct neph_slab **slab, struct neph_diag *diag)
{
    const size_t views = (size_t)params->view_count, modes = (size_t)mode_max;
    struct neph_slab *made = calloc(1, sizeof(*made));
    if (!made)
        return neph_fail_memory(diag);
    *made = (struct neph_slab){.optical_depth = params->optical_depth,
                               .albedo = params->albedo,
                               .sun_cosine = params->sun_cosine,
                               .phase = params->phase,
                               .view_count = params->view_count};
    made->view_cosines = neph_arena_allocate(&made->arena, views, sizeof(double));
    made->up = neph_arena_allocate(&made->arena, views * modes, sizeof(double));
    made->down = neph_arena_allocate(&made->arena, views * modes, sizeof(double));
    if (made->arena.is_short) {
        neph_slab_destroy(made);
        return neph_fail_memory(diag);
    }
    for (size_t i = 0; i < views; i++)
        made->view_cosines[i] = params->view_cosines[i];
    *slab = made;
    return NEPH_OK;
}

void neph_slab_destroy(struct neph_slab *slab)
{
    if (!slab)
        return;
    neph_arena_finish(&slab->arena);
    free(slab);
}

/* ---- solving ---- */

/* Take the next `count` numbers of a block. */
static double *take(double **block, int count)
{
    double *taken = *block;
    *block += count;
    return taken;
}

static enum neph_status work_init(struct work *work, const struct neph_slab_params *params,
                                  struct neph_diag *diag)
{
    const int nodes = choose_nodes(params), rows = nodes + params->view_count;
    work->memory = calloc((size_t)(4 * nodes + 1) + (size_t)rows * (1 + 4 * BATCH), sizeof(double));
    if (!work->memory)
        return neph_fail_memory(diag);
    double *block = work->memory, *moments = take(&block, 2 * nodes);
    double *weights = take(&block, nodes), *row_cosines = take(&block, rows);
    double *column_cosines = take(&block, nodes + 1);
    neph_gauss_legendre(nodes, row_cosines, weights);
    for (int i = 0; i < nodes; i++)
        column_cosines[i] = row_cosines[i];
    column_cosines[nodes] = params->sun_cosine;
    for (int i = 0; i < params->view_count; i++)
        row_cosines[nodes + i] = params->view_cosines[i];
    /* Delta-M: the part `peak` of the scattering is not deflected. */
    const double peak = neph_phase_moment(&params->phase, 2 * nodes);
    for (int l = 0; l < 2 * nodes; l++)
        moments[l] = (neph_phase_moment(&params->phase, l) - peak) / (1.0 - peak);
    work->layer = (struct neph_doubling){
        .optical_depth = params->optical_depth * (1.0 - params->albedo * peak),
        .albedo = params->albedo * (1.0 - peak) / (1.0 - params->albedo * peak),
        .moment_count = 2 * nodes,
        .moments = moments,
        .node_count = nodes,
        .node_weights = weights,
        .view_count = params->view_count,
        .row_cosines = row_cosines,
        .column_cosines = column_cosines};
    for (int i = 0; i < BATCH; i++)
        work->light[i] = (struct neph_doubling_light){take(&block, rows), take(&block, rows),
                                                      take(&block, rows), take(&block, rows)};
    return NEPH_OK;
}

static void solve_mode(int index, void *context)
{
    struct work *work = context;
    work->status[index] = neph_doubling_mode(&work->layer, work->first_mode + index,
                                             &work->light[index], &work->diag[index]);
}

/* Compute the fluxes, which are integrals of mode 0 over the nodes. */
static void store_fluxes(const struct neph_doubling *layer, const struct neph_doubling_light *light,
                         struct neph_slab *slab)
{
    double up = 0.0, down = 0.0;
    for (int i = 0; i < layer->node_count; i++) {
        up += layer->node_weights[i] * layer->row_cosines[i] * light->up[i];
        down += layer->node_weights[i] * layer->row_cosines[i] * light->down[i];
    }
    /* Light that delta-M treats as undeflected was scattered in reality. */
    const double unturned = exp(-layer->optical_depth / slab->sun_cosine);
    slab->fluxes.direct = exp(-slab->optical_depth / slab->sun_cosine);
    slab->fluxes.reflected = up / slab->sun_cosine;
    slab->fluxes.transmitted = down / slab->sun_cosine + (unturned - slab->fluxes.direct);
}

/* Store the light scattered at least twice; returns its largest value over the views. */
static double store_mode(const struct neph_doubling *layer, const struct neph_doubling_light *light,
                         struct neph_slab *slab, int mode)
{
    double largest = 0.0;
    for (int v = 0; v < slab->view_count; v++) {
        const int row = layer->node_count + v;
        const size_t at = (size_t)mode * (size_t)slab->view_count + (size_t)v;
        slab->up[at] = light->up[row] - light->once_up[row];
        slab->down[at] = light->down[row] - light->once_down[row];
        largest = fmax(largest, fmax(fabs(slab->up[at]), fabs(slab->down[at])));
    }
    return largest;
}

/* Solve modes from the lowest on, until a whole batch is negligible. */
static enum neph_status solve_modes(struct work *work, struct neph_slab *slab, int mode_max,
                                    struct neph_diag *diag)
{
    double largest = 0.0;
    while (slab->mode_count < mode_max) {
        const int count = mode_max - slab->mode_count < BATCH ? mode_max - slab->mode_count : BATCH;
        work->first_mode = slab->mode_count;
        const enum neph_status status = neph_parallel_rows(count, solve_mode, work, diag);
        if (status)
            return status;
        double batch_largest = 0.0;
        for (int i = 0; i < count; i++) {
            if (work->status[i])
                return neph_fail(diag, work->status[i], "%s", work->diag[i].message);
            if (work->first_mode + i == 0)
                store_fluxes(&work->layer, &work->light[i], slab);
            const double size = store_mode(&work->layer, &work->light[i], slab,
                                           work->first_mode + i);
            batch_largest = fmax(batch_largest, size);
        }
        slab->mode_count += count;
        largest = fmax(largest, batch_largest);
        if (batch_largest <= mode_rest * largest)
            return NEPH_OK;
    }
    return NEPH_OK;
}

/* Number of modes: doubly scattered light has the modes of the phase function's series; fluxes have
 * one. */
static int mode_max(const struct neph_slab_params *params, int moment_count)
{
    int modes = params->view_count == 0 ? 1 : moment_count;
    while (modes > 1 && neph_phase_moment(&params->phase, modes - 1) == 0.0)
        modes--;
    return modes;
}

enum neph_status neph_slab_create(const struct neph_slab_params *params, struct neph_slab **slab,
                                  struct neph_diag *diag)
{
    struct work work = {.memory = NULL};
    struct neph_slab *made = NULL;
    enum neph_status status = check(params, diag);
    if (!status)
        status = work_init(&work, params, diag);
    if (!status)
        status = slab_alloc(params, mode_max(params, work.layer.moment_count), &made, diag);
    if (!status && params->optical_depth == 0.0)
        made->fluxes.direct = 1.0;
    else if (!status)
        status = solve_modes(&work, made, mode_max(params, work.layer.moment_count), diag);
    free(work.memory);
    if (status) {
        neph_slab_destroy(made);
        return status;
    }
    *slab = made;
    return NEPH_OK;
}

/* ---- results ---- */

struct neph_slab_fluxes neph_slab_fluxes(const struct neph_slab *slab)
{
    return slab->fluxes;
}

static double sum_modes(const struct neph_slab *slab, const double *modes, int view,
                        double azimuth_rad)
{
    double sum = 0.0;
    for (int m = slab->mode_count - 1; m >= 0; m--)
        sum += (m == 0 ? 1.0 : 2.0) * cos(m * azimuth_rad) *
               modes[(size_t)m * (size_t)slab->view_count + (size_t)view];
    return sum / (2.0 * M_PI);
}

/* Cosine of the scattering angle between sunlight and a view; `side`: 1 through the slab, -1 back
 * up. */
static double turn_cosine(const struct neph_slab *slab, int view, double azimuth_rad, double side)
{
    const double mu = slab->view_cosines[view], mu0 = slab->sun_cosine;
    return side * mu * mu0 +
           sqrt((1.0 - mu) * (1.0 + mu) * (1.0 - mu0) * (1.0 + mu0)) * cos(azimuth_rad);
}

double neph_slab_reflected_per_sr(const struct neph_slab *slab, int view, double azimuth_rad)
{
    const double cosine = turn_cosine(slab, view, azimuth_rad, -1.0);
    return sum_modes(slab, slab->up, view, azimuth_rad) +
           slab->albedo * neph_phase_per_sr(&slab->phase, cosine) *
               neph_once_up(slab->optical_depth, slab->view_cosines[view], slab->sun_cosine);
}

double neph_slab_transmitted_per_sr(const struct neph_slab *slab, int view, double azimuth_rad)
{
    const double cosine = turn_cosine(slab, view, azimuth_rad, 1.0);
    return sum_modes(slab, slab->down, view, azimuth_rad) +
           slab->albedo * neph_phase_per_sr(&slab->phase, cosine) *
               neph_once_down(slab->optical_depth, slab->view_cosines[view], slab->sun_cosine);
}
