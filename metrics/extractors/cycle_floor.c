/* SPDX-License-Identifier: MIT */
#include "metrics/extractors/cycle_floor.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

enum { TERMS = NEPH_CYCLE_FLOOR_TERMS, ROUNDS = 40 };

/* Bins per term of the curve: with fewer, a line could pull the curve up. For noise with much
 * scatter, more terms would fit the noise. */
static const double bins_per_term = 10.0;

/* Range of neighbours [bins]: far enough to be unaffected by a line, near enough that an error of
 * the curve is about the same. */
static const double nearby_from = 1.2, nearby_to = 6.0;

static const double upper_quartile_z = 0.6744897501960817;

static double log_power(const struct neph_cycle_probe *probe)
{
    return log(fmax(probe->power, DBL_MIN));
}

static void chebyshev(const struct neph_cycle_floor *floor, double per_frame, double terms[TERMS])
{
    const double middle = 0.5 * (floor->low + floor->high), half = 0.5 * (floor->high - floor->low);
    const double x = half > 0.0 ? (log(per_frame) - middle) / half : 0.0;
    terms[0] = 1.0;
    terms[1] = x;
    for (int i = 2; i < TERMS; i++)
        terms[i] = 2.0 * x * terms[i - 1] - terms[i - 2];
}

static double log_floor(const struct neph_cycle_floor *floor, double per_frame)
{
    double terms[TERMS], sum = 0.0;
    chebyshev(floor, per_frame, terms);
    for (int i = 0; i < floor->term_count; i++)
        sum += floor->coefficients[i] * terms[i];
    return sum;
}

double neph_cycle_floor_at(const struct neph_cycle_floor *floor, double per_frame)
{
    return exp(log_floor(floor, per_frame)) / floor->median;
}

/* ---- the curve ------------------------------------------------------------------------------- */

/* Gauss-Jordan elimination without pivoting, which normal equations do not need. */
static void solve(double m[TERMS][TERMS + 1], int count, double *solution)
{
    for (int i = 0; i < count; i++)
        for (int k = 0; k < count; k++) {
            const double factor = k == i || m[i][i] == 0.0 ? 0.0 : m[k][i] / m[i][i];
            for (int j = 0; j <= count; j++)
                m[k][j] -= factor * m[i][j];
        }
    for (int i = 0; i < count; i++)
        solution[i] = m[i][i] != 0.0 ? m[i][count] / m[i][i] : 0.0;
}

/* One iteration: each probe's weight is the inverse of its last deviation. */
static void refit(const struct neph_cycle_probe *probes, int count, bool is_first,
                  struct neph_cycle_floor *floor)
{
    double m[TERMS][TERMS + 1] = {{0.0}};
    for (int p = 0; p < count; p++) {
        if (!probes[p].is_noise)
            continue;
        double terms[TERMS + 1];
        chebyshev(floor, probes[p].per_frame, terms);
        const double y = log_power(&probes[p]);
        const double off = is_first ? 1.0 : fabs(y - log_floor(floor, probes[p].per_frame));
        const double weight = probes[p].bins / fmax(off, 1e-6);
        terms[floor->term_count] = y;
        for (int i = 0; i < floor->term_count; i++)
            for (int j = 0; j <= floor->term_count; j++)
                m[i][j] += weight * terms[i] * terms[j];
    }
    solve(m, floor->term_count, floor->coefficients);
}

static double fit_curve(const struct neph_cycle_probe *probes, int count,
                        struct neph_cycle_floor *floor)
{
    double bins = 0.0;
    for (int p = 0; p < count; p++) {
        if (!probes[p].is_noise)
            continue;
        bins += probes[p].bins;
        floor->low = fmin(floor->low, log(probes[p].per_frame));
        floor->high = fmax(floor->high, log(probes[p].per_frame));
    }
    const int affordable = (int)(bins / bins_per_term);
    const int useful = 3 + (int)(-0.5 * log2(floor->scatter.variance));
    const int terms = affordable < useful ? affordable : useful;
    floor->term_count = terms < 2 ? 2 : terms > TERMS ? TERMS : terms;
    for (int round = 0; round < ROUNDS; round++)
        refit(probes, count, round == 0, floor);
    return bins;
}

/* ---- the scatter ----------------------------------------------------------------------------- */

/* Adapt the scatter to the degrees of freedom: one degree has half as many squares, of the same
 * skewness each. */
static struct neph_cycle_scatter scatter_for(struct neph_cycle_scatter scatter, int dof)
{
    const double part = 0.5 * (double)dof;
    return (struct neph_cycle_scatter){scatter.variance / part, scatter.shape * part};
}

/* The power relative to its mean at a normal score. */
static double power_ratio_at_score(struct neph_cycle_scatter scatter, double z)
{
    const double k = scatter.shape;
    const double root = 1.0 - 1.0 / (9.0 * k) + z / (3.0 * sqrt(k));
    return 1.0 + sqrt(scatter.variance * k) * (root * root * root - 1.0);
}

static double score_at_power_ratio(struct neph_cycle_scatter scatter, double ratio)
{
    const double k = scatter.shape;
    const double gamma = 1.0 + (ratio - 1.0) / sqrt(scatter.variance * k);
    return 3.0 * sqrt(k) * (cbrt(gamma) - 1.0 + 1.0 / (9.0 * k));
}

static double raw_score(const struct neph_cycle_floor *floor, const struct neph_cycle_probe *probe)
{
    const double off = log_power(probe) - log_floor(floor, probe->per_frame);
    return score_at_power_ratio(scatter_for(floor->scatter, probe->dof), exp(off) * floor->median);
}

static int by_score(const void *a, const void *b)
{
    const double x = ((const struct neph_cycle_probe *)a)->score;
    const double y = ((const struct neph_cycle_probe *)b)->score;
    return (x > y) - (x < y);
}

/* Standard deviation of the noise among probes sorted by score: from the lower half, or from the
 * upper quartile if that is larger. */
static double compute_score_deviation(const struct neph_cycle_probe *sorted, int count, double bins)
{
    double below = 0.0, squares = 0.0, lower = 0.0, upper = 0.0;
    for (int i = 0; i < count; i++) {
        if (!sorted[i].is_noise)
            continue;
        if (sorted[i].score < 0.0) {
            lower += sorted[i].bins;
            squares += sorted[i].bins * sorted[i].score * sorted[i].score;
        }
        below += sorted[i].bins;
        if (below <= 0.75 * bins)
            upper = sorted[i].score;
    }
    const double of_lower = lower > 0.0 ? sqrt(squares / lower) : 0.0;
    return fmax(of_lower, upper / upper_quartile_z);
}

struct neph_cycle_floor neph_cycle_floor_fit(struct neph_cycle_probe *probes, int count, double bin,
                                             struct neph_cycle_scatter scatter)
{
    struct neph_cycle_floor floor = {.low = INFINITY,
                                     .high = -INFINITY,
                                     .scatter = scatter,
                                     .median = power_ratio_at_score(scatter, 0.0),
                                     .probes = probes,
                                     .probe_count = count,
                                     .bin = bin};
    const double bins = fit_curve(probes, count, &floor);
    for (int p = 0; p < count; p++)
        probes[p].score = raw_score(&floor, &probes[p]);
    qsort(probes, (size_t)count, sizeof(*probes), by_score);
    const double free_bins = fmax(bins - (double)floor.term_count, 1.0);
    floor.widened = fmax(compute_score_deviation(probes, count, bins), 1.0) *
                    (1.0 + 1.0 / sqrt(free_bins));
    return floor;
}

static bool is_nearby(const struct neph_cycle_floor *floor, const struct neph_cycle_probe *probe,
                      const struct neph_cycle_probe *other)
{
    const double off = fabs(probe->per_frame - other->per_frame) / floor->bin;
    return off > nearby_from && off < nearby_to;
}

static double median_nearby(const struct neph_cycle_floor *floor,
                            const struct neph_cycle_probe *probe)
{
    double bins = 0.0, below = 0.0;
    for (int p = 0; p < floor->probe_count; p++)
        bins += is_nearby(floor, probe, &floor->probes[p]) ? floor->probes[p].bins : 0.0;
    for (int p = 0; p < floor->probe_count; p++) {
        below += is_nearby(floor, probe, &floor->probes[p]) ? floor->probes[p].bins : 0.0;
        if (below > 0.5 * bins)
            return floor->probes[p].score;
    }
    return 0.0;
}

bool neph_cycle_floor_is_outlier(const struct neph_cycle_floor *floor,
                                 const struct neph_cycle_probe *probe)
{
    double bins = 0.0, below = 0.0;
    for (int p = 0; p < floor->probe_count; p++) {
        const struct neph_cycle_probe *other = &floor->probes[p];
        if (!other->is_noise || !is_nearby(floor, probe, other))
            continue;
        bins += other->bins;
        below += other->power < probe->power / 8.0 ? other->bins : 0.0;
    }
    return bins > 0.0 && below > 0.5 * bins;
}

double neph_cycle_floor_z(const struct neph_cycle_floor *floor,
                          const struct neph_cycle_probe *probe)
{
    const double above = raw_score(floor, probe) - fmax(median_nearby(floor, probe), 0.0);
    return above / floor->widened;
}

double neph_cycle_floor_ratio(const struct neph_cycle_floor *floor, double z)
{
    return power_ratio_at_score(floor->scatter, z * floor->widened);
}
