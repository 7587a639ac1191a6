/* SPDX-License-Identifier: MIT */
#include "truth/droplets.h"

#include "base/threads.h"
#include "truth/mie.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A new distribution breaks the build here until this file handles it. */
_Static_assert(NEPH_DROPLETS_COUNT == 2, "a new distribution");

enum {
    SPHERES_MIN = 400,    /* also of the narrowest distribution */
    SPHERES_FINE = 12000, /* as many average out resonances to 1 % of the glory */
    PARTS = 64,           /* each a sum of its own, in a fixed order, whatever the threads */
};
/* Steps of the size parameter, the second where the first needs more than SPHERES_FINE. */
static const double step_fine = 0.03, step_largest = 0.1;
static const double area_left = 1e-8;

/* ---- distributions --------------------------------------------------------------------------- */

/* The logarithm of n(r), without its constant factor; `radius` is r / r_e. */
static double log_number(enum neph_droplet_sizes sizes, double variance, double radius)
{
    if (sizes == NEPH_DROPLETS_GAMMA)
        return (1.0 - 3.0 * variance) / variance * log(radius) - radius / variance;
    const double square = log1p(variance), distance = log(radius) + 2.5 * square;
    return -distance * distance / (2.0 * square) - log(radius);
}

/* ln(r^2 n(r)), the area distribution. */
static double log_area(const struct neph_droplets_params *params, double radius)
{
    return log_number(params->sizes, params->effective_variance, radius) + 2.0 * log(radius);
}

/* The radius below (or above) `peak` where the area distribution falls to `area_left` of its value
 * there. */
static double find_end(const struct neph_droplets_params *params, double peak, double factor)
{
    double radius = peak;
    while (log_area(params, radius) > log_area(params, peak) + log(area_left))
        radius *= factor;
    return radius;
}

/* ---- sums ------------------------------------------------------------------------------------ */

struct sums {
    enum neph_status status;
    struct neph_diag diag;
    double number, area, volume; /* of n(r) dr, radii in r_e */
    double extinction, scattering, forward;
};

struct work {
    const struct neph_droplets_params *params;
    double low, step, log_scale; /* radii in r_e; the logarithm of the largest area density */
    int count;
    struct sums parts[PARTS];
    double *intensities; /* PARTS times angle_count: sums of S11 */
};

static void add_sphere(const struct work *work, int i, struct sums *sums, double *intensities,
                       double *scratch)
{
    const struct neph_droplets_params *params = work->params;
    const double radius = work->low + (i + 0.5) * work->step,
                 weight = work->step *
                          exp(log_number(params->sizes, params->effective_variance, radius) -
                              work->log_scale),
                 size_parameter = 2.0 * M_PI * radius * params->effective_radius_m /
                                  params->wavelength_m;
    struct neph_mie_efficiency q;
    sums->status = neph_mie_sphere(size_parameter, params->index, params->angle_count,
                                   params->cosines, &q, scratch, &sums->diag);
    if (sums->status)
        return;
    const double area = weight * radius * radius;
    sums->number += weight;
    sums->area += area;
    sums->volume += area * radius;
    sums->extinction += area * q.extinction;
    sums->scattering += area * q.scattering;
    sums->forward += area * q.scattering * q.asymmetry;
    for (int a = 0; a < params->angle_count; a++)
        intensities[a] += weight * scratch[a];
}

static void sum_part(int part, void *work_)
{
    struct work *work = work_;
    struct sums *sums = &work->parts[part];
    const size_t angles = (size_t)work->params->angle_count;
    double *scratch = malloc((angles + 1) * sizeof(*scratch));
    if (!scratch)
        sums->status = neph_fail_memory(&sums->diag);
    for (int i = part; i < work->count && !sums->status; i += PARTS)
        add_sphere(work, i, sums, work->intensities + (size_t)part * angles, scratch);
    free(scratch);
}

/* ---- all ------------------------------------------------------------------------------------- */

static enum neph_status check(const struct neph_droplets_params *params, struct neph_diag *diag)
{
    if (!(params->effective_radius_m > 0.0 && params->wavelength_m > 0.0 &&
          params->density_kg_per_m3 > 0.0))
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "effective radius, wavelength and density are above 0");
    if (!(params->effective_variance >= NEPH_DROPLETS_VARIANCE_MIN &&
          params->effective_variance <= NEPH_DROPLETS_VARIANCE_MAX))
        return neph_fail(diag, NEPH_ERR_INPUT, "the effective variance is %g, not in %g..%g",
                         params->effective_variance, NEPH_DROPLETS_VARIANCE_MIN,
                         NEPH_DROPLETS_VARIANCE_MAX);
    return NEPH_OK;
}

/* The area distribution peaks at (1 - v) r_e (gamma), or r_e exp(-3/2 s^2) (log-normal). */
static enum neph_status choose_radii(struct work *work, struct neph_diag *diag)
{
    const struct neph_droplets_params *params = work->params;
    const double v = params->effective_variance,
                 peak = params->sizes == NEPH_DROPLETS_GAMMA ? 1.0 - v : pow(1.0 + v, -1.5);
    const double high = find_end(params, peak, 1.01);
    const double per_radius = 2.0 * M_PI * params->effective_radius_m / params->wavelength_m;
    if (!(high * per_radius <= NEPH_MIE_SIZE_MAX))
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "the largest droplets have a size parameter 2 pi radius / wavelength of "
                         "%g: at most %g",
                         high * per_radius, NEPH_MIE_SIZE_MAX);
    work->low = find_end(params, peak, 1.0 / 1.01);
    const double sizes = (high - work->low) * per_radius;
    work->count = (int)ceil(
        fmax(fmax(fmin(sizes / step_fine, SPHERES_FINE), sizes / step_largest), SPHERES_MIN));
    work->step = (high - work->low) / work->count;
    work->log_scale = log_area(params, peak);
    return NEPH_OK;
}

static void add_parts(struct work *work, struct sums *all)
{
    const int angles = work->params->angle_count;
    for (int p = 0; p < PARTS; p++) {
        const struct sums *part = &work->parts[p];
        all->number += part->number;
        all->area += part->area;
        all->volume += part->volume;
        all->extinction += part->extinction;
        all->scattering += part->scattering;
        all->forward += part->forward;
        for (int a = 0; a < angles && p > 0; a++)
            work->intensities[a] += work->intensities[p * angles + a];
    }
}

static void finish(const struct work *work, const struct sums *all,
                   struct neph_droplet_optics *optics, double *phase_per_sr)
{
    const struct neph_droplets_params *params = work->params;
    const double radius_m = params->effective_radius_m, r3_m3 = pow(radius_m, 3.0),
                 mass_kg = 4.0 / 3.0 * M_PI * params->density_kg_per_m3 * r3_m3 * all->volume /
                           all->number;
    *optics = (struct neph_droplet_optics){
        .extinction_efficiency = all->extinction / all->area,
        .extinction_m2_per_kg = 3.0 * all->extinction /
                                (4.0 * params->density_kg_per_m3 * radius_m * all->volume),
        .albedo = all->scattering / all->extinction,
        .asymmetry = all->forward / all->scattering,
        .droplets_per_kg = 1.0 / mass_kg,
        .sphere_count = work->count};
    /* dC/dOmega = S11 / k^2, over C = pi r^2 Q. */
    const double k_radius = 2.0 * M_PI * radius_m / params->wavelength_m;
    for (int a = 0; a < params->angle_count; a++)
        phase_per_sr[a] = work->intensities[a] / (k_radius * k_radius * M_PI * all->scattering);
}

enum neph_status neph_droplets_compute(const struct neph_droplets_params *params,
                                       struct neph_droplet_optics *optics, double *phase_per_sr,
                                       struct neph_diag *diag)
{
    enum neph_status status = check(params, diag);
    if (status)
        return status;
    struct work *work = calloc(1, sizeof(*work));
    double *intensities = calloc((size_t)PARTS * (size_t)params->angle_count + 1,
                                 sizeof(*intensities));
    struct sums all = {.number = 0.0};
    if (!work || !intensities) {
        free(work);
        free(intensities);
        return neph_fail_memory(diag);
    }
    work->params = params;
    work->intensities = intensities;
    status = choose_radii(work, diag);
    if (!status)
        status = neph_parallel_rows(PARTS, sum_part, work, diag);
    for (int p = 0; p < PARTS && !status; p++) {
        status = work->parts[p].status;
        if (status && diag)
            *diag = work->parts[p].diag;
    }
    if (!status) {
        add_parts(work, &all);
        finish(work, &all, optics, phase_per_sr);
    }
    free(intensities);
    free(work);
    return status;
}
