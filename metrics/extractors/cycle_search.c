/* SPDX-License-Identifier: MIT
 *
 * Forward selection of the wave that is most prominent above the noise. Each step is followed by
 * exchanges with near frequencies. Selection is generous; at the end, waves that the others explain
 * as well are removed at the final level.
 */
#include "metrics/extractors/cycle_search.h"

#include "metrics/extractors/cycle_floor.h"
#include "metrics/extractors/cycle_tableau.h"
#include "metrics/significance.h"

#include <float.h>
#include <math.h>

/* A wave is selected on trial above this score and this share of the total square sum. */
static const double trial_z = 3.0, trial_share = 1e-9;

/* Below this separation from the set, the gain of a wave is rounding error. */
static const double separation_min = 1e-4;

/* Reported waves need at least this separation from the other waves: in noise with a steep
 * spectrum, many waves close together follow the noise of lower frequencies. Two neighbours, of 31
 * and 32 frames in 256, are at 0.2. */
static const double reported_separation_min = 0.05;

/* From this separation on, the residual of a wave shows the noise at its own frequency. */
static const double separation_of_probe = 0.25;

/* Frequencies nearer than this [bins of 1 / N] may be confused. */
static const double near_bins = 4.0;

/* Twice the log-likelihood difference that distinguishes two waves. */
static const double likelihood_min = 20.0;

/* Rounding error of the sum of squares at one frequency, relative to the total. */
static const double rounding = 1e-14;

enum { ROUNDS = 4, SWEEPS = 4 };

struct search {
    int frame_count;
    const struct neph_cycle_frequencies *candidates; /* waves 1 .. of the tableau */
    double *per_frame;                               /* frequencies of waves 1 .., candidates and
                                                      * bins */
    double *bins;                                    /* see struct neph_cycle_probe */
    int count;                                       /* number of these waves */
    int window_count; /* number of additional windowed waves, for the correlation of the series */
    struct neph_cycle_tableau tableau;
    struct neph_cycle_probe *probes; /* room for all waves */
    struct neph_cycle_floor floor;
    double total;    /* sum of squares around the line */
    double residual; /* sum of squares not explained by the set */
    int inside_count;
};

/* ---- set-up ---------------------------------------------------------------------------------- */

/* Add bins of 1 / N in the gaps between the candidates, for the noise floor. */
static int add_bins(const struct search *search, double *per_frame, int count)
{
    const int candidate_count = search->candidates->count;
    const int half_lowest = (int)(0.5 * per_frame[0] * (double)search->frame_count);
    const int lowest = half_lowest > 2 ? half_lowest : 2;
    for (int k = lowest; 2 * k <= search->frame_count; k++) {
        const double here = (double)k / (double)search->frame_count;
        double nearest = INFINITY;
        for (int i = 0; i < candidate_count; i++)
            nearest = fmin(nearest, fabs(per_frame[i] - here) * (double)search->frame_count);
        if (nearest > 0.6)
            per_frame[count++] = here;
    }
    return count;
}

/* Add windowed waves, five bins apart. */
static int add_windowed(const struct search *search, double *per_frame)
{
    int count = 0;
    for (int k = 3; k + 3 <= search->frame_count / 2; k += 5)
        per_frame[count++] = (double)k / (double)search->frame_count;
    return count;
}

static void share_out_bins(struct search *search)
{
    const double n = (double)search->frame_count;
    for (int i = 0; i < search->count; i++) {
        double below = 1.0, above = 1.0;
        for (int j = 0; j < search->count; j++) {
            const double off = (search->per_frame[j] - search->per_frame[i]) * n;
            if (off < 0.0)
                below = fmin(below, -off);
            if (off > 0.0)
                above = fmin(above, off);
        }
        search->bins[i] = 0.5 * (below + above);
    }
}

static enum neph_status begin(struct search *search, const double *moments,
                              struct neph_arena *memory, struct neph_diag *diag)
{
    const int candidate_count = search->candidates->count, n = search->frame_count;
    const size_t room = (size_t)candidate_count + (size_t)n + 1;
    search->per_frame = neph_arena_allocate(memory, room, sizeof(*search->per_frame));
    search->bins = neph_arena_allocate(memory, room, sizeof(*search->bins));
    search->probes = neph_arena_allocate(memory, room, sizeof(*search->probes));
    enum neph_status status = neph_arena_check(memory, diag);
    if (status)
        return status;
    for (int i = 0; i < candidate_count; i++)
        search->per_frame[i] = neph_cycle_per_frame(search->candidates->items[i]);
    search->count = add_bins(search, search->per_frame, candidate_count);
    share_out_bins(search);
    search->window_count = add_windowed(search, search->per_frame + search->count);
    status = neph_cycle_tableau_begin(&search->tableau, n, moments, search->per_frame,
                                      search->count + search->window_count, search->window_count,
                                      memory, diag);
    if (status)
        return status;
    for (int t = 0; t < n; t++)
        search->total += moments[(size_t)t * (size_t)n + (size_t)t];
    search->total -= neph_cycle_gain(&search->tableau, 0);
    search->residual = search->total;
    return NEPH_OK;
}

/* ---- steps ----------------------------------------------------------------------------------- */

static void turn(struct search *search, int wave)
{
    const double gain = neph_cycle_gain(&search->tableau, wave);
    const bool leaves = search->tableau.inside[wave];
    search->residual += leaves ? gain : -gain;
    search->inside_count += leaves ? -1 : 1;
    neph_cycle_tableau_toggle(&search->tableau, wave);
}

static struct neph_cycle_probe make_noise_probe(const struct search *search, int wave)
{
    const struct neph_cycle_tableau *tableau = &search->tableau;
    const int dof = neph_cycle_dof(tableau, wave);
    const double least = rounding * search->total;
    return (struct neph_cycle_probe){
        .per_frame = search->per_frame[wave - 1],
        .power = fmax(neph_cycle_gain(tableau, wave) / (double)dof, least),
        .bins = search->bins[wave - 1],
        .dof = dof,
        .is_noise = !tableau->inside[wave] &&
                    neph_cycle_separation(tableau, wave) > separation_of_probe,
    };
}

/* Scatter of the noise power, from the coherence W of pairs and triples of waves without common
 * frequencies: the means of W_ij^2 and of W_ij W_jk W_ki are the sums of the squared and cubed
 * weights of the independent series. Independent pixels all count; noise that is half shared counts
 * as half. */
static struct neph_cycle_scatter estimate_noise_scatter(const struct search *search)
{
    const int first = search->count + 1, end = first + search->window_count;
    double squares = 0.0, cubes = 0.0, pairs = 0.0, triples = 0.0;
    for (int i = first; i < end; i++)
        for (int j = first; j < i; j++) {
            double ij[4];
            neph_cycle_coherence(&search->tableau, i, j, ij);
            for (int c = 0; c < 4; c++)
                squares += ij[c] * ij[c];
            pairs += 4.0;
            for (int k = first; k < j; k++) {
                double jk[4], ki[4];
                neph_cycle_coherence(&search->tableau, j, k, jk);
                neph_cycle_coherence(&search->tableau, k, i, ki);
                for (int c = 0; c < 8; c++)
                    cubes += ij[c & 3] * jk[(c & 1) << 1 | c >> 2] *
                             ki[(c >> 2) << 1 | (c & 3) >> 1];
                triples += 8.0;
            }
        }
    if (triples == 0.0 || squares == 0.0)
        return (struct neph_cycle_scatter){1.0, 1.0};
    /* Positive weights with sum 1 satisfy these bounds; estimates of them may not. */
    const double variance = fmin(squares / pairs, 1.0), most = variance * sqrt(variance);
    const double skew = fmin(fmax(cubes / triples, variance * variance), most);
    return (struct neph_cycle_scatter){variance, variance * variance * variance / (skew * skew)};
}

static void find_floor(struct search *search)
{
    for (int w = 1; w <= search->count; w++)
        search->probes[w - 1] = make_noise_probe(search, w);
    search->floor = neph_cycle_floor_fit(search->probes, search->count,
                                         1.0 / (double)search->frame_count,
                                         estimate_noise_scatter(search));
}

static double compute_wave_score(const struct search *search, int wave)
{
    const struct neph_cycle_probe probe = make_noise_probe(search, wave);
    return neph_cycle_floor_z(&search->floor, &probe);
}

/* Whether a wave may be selected on trial; `*z`: its score. */
static bool is_wave_selectable(const struct search *search, int wave, double *z)
{
    const struct neph_cycle_tableau *tableau = &search->tableau;
    if (tableau->inside[wave] || neph_cycle_gain(tableau, wave) < trial_share * search->total ||
        neph_cycle_separation(tableau, wave) < separation_min)
        return false;
    const struct neph_cycle_probe probe = make_noise_probe(search, wave);
    *z = neph_cycle_floor_z(&search->floor, &probe);
    return *z > trial_z || neph_cycle_floor_is_outlier(&search->floor, &probe);
}

/* The most prominent candidate outside of the set; 0: none. */
static int most_prominent(const struct search *search)
{
    int best = 0;
    double best_z = -INFINITY;
    for (int w = 1; w <= search->candidates->count; w++) {
        double z;
        if (is_wave_selectable(search, w, &z) && z > best_z) {
            best_z = z;
            best = w;
        }
    }
    return best;
}

static bool is_near(const struct search *search, int a, int b)
{
    const double off = search->per_frame[a - 1] - search->per_frame[b - 1];
    return fabs(off) * (double)search->frame_count < near_bins;
}

/* The candidate outside of the set and near `wave` that would explain most; `wave` is outside,
 * too. */
static int best_near(const struct search *search, int wave)
{
    int best = wave;
    double best_gain = neph_cycle_gain(&search->tableau, wave) + 1e-12 * search->total;
    for (int w = 1; w <= search->candidates->count; w++) {
        if (search->tableau.inside[w] || w == wave || !is_near(search, w, wave) ||
            neph_cycle_separation(&search->tableau, w) < separation_min)
            continue;
        const double gain = neph_cycle_gain(&search->tableau, w);
        if (gain > best_gain) {
            best_gain = gain;
            best = w;
        }
    }
    return best;
}

/* Exchange members near `around` (0: all) for better neighbours until none is better. */
static void exchange(struct search *search, int around)
{
    bool changed = true;
    for (int sweep = 0; sweep < SWEEPS && changed; sweep++) {
        changed = false;
        for (int w = 1; w <= search->candidates->count; w++) {
            if (!search->tableau.inside[w] || (around && !is_near(search, w, around)))
                continue;
            turn(search, w);
            const int better = best_near(search, w);
            turn(search, better);
            changed = changed || better != w;
        }
    }
}

/* Exchange two members for the two near candidates that together explain most; single exchanges may
 * not find this pair. */
static void exchange_pair(struct search *search, int one, int other)
{
    const int count = search->candidates->count;
    int best[2] = {one, other};
    double least = search->residual - 1e-12 * search->total;
    turn(search, one);
    turn(search, other);
    for (int w = 1; w <= count; w++) {
        if (search->tableau.inside[w] || !is_near(search, w, one) ||
            neph_cycle_separation(&search->tableau, w) < separation_min)
            continue;
        turn(search, w);
        const int partner = best_near(search, other == w ? one : other);
        const double left = search->residual - neph_cycle_gain(&search->tableau, partner);
        if (left < least) {
            least = left;
            best[0] = w;
            best[1] = partner;
        }
        turn(search, w);
    }
    turn(search, best[0]);
    turn(search, best[1]);
}

static void exchange_pairs(struct search *search)
{
    const int count = search->candidates->count;
    for (int one = 1; one <= count; one++)
        for (int other = one + 1; other <= count; other++)
            if (search->tableau.inside[one] && search->tableau.inside[other] &&
                is_near(search, one, other))
                exchange_pair(search, one, other);
    neph_cycle_tableau_refresh(&search->tableau);
}

static void take(struct search *search)
{
    const int most = search->frame_count / 4 - 1;
    while (search->inside_count < most) {
        find_floor(search);
        const int wave = most_prominent(search);
        if (!wave)
            break;
        turn(search, wave);
        exchange(search, wave);
    }
}

static double z_needed(const struct search *search)
{
    /* Only too large powers count: the two-sided test at twice the level. */
    return neph_normal_critical(2.0 *
                                neph_sidak_alpha(NEPH_CYCLE_ALPHA, search->candidates->count));
}

/* Remove the least certain wave until all are certain. */
static void drop(struct search *search)
{
    const double needed = z_needed(search);
    neph_cycle_tableau_refresh(&search->tableau);
    for (;;) {
        int worst = 0;
        double worst_z = INFINITY;
        find_floor(search);
        for (int w = 1; w <= search->candidates->count; w++) {
            if (!search->tableau.inside[w])
                continue;
            const bool is_much = neph_cycle_gain(&search->tableau, w) >=
                                 NEPH_CYCLE_SHARE_MIN * search->total;
            const bool is_apart = neph_cycle_separation(&search->tableau, w) >=
                                  reported_separation_min;
            const double z = is_much ? compute_wave_score(search, w) : -DBL_MAX;
            if ((z < needed || !is_apart) && z < worst_z) {
                worst = w;
                worst_z = z;
            }
        }
        if (!worst)
            break;
        turn(search, worst);
    }
}

/* ---- the result ------------------------------------------------------------------------------ */

/* The period of a wave that explains the series better than `wave`, or not significantly worse; 0:
 * none. */
static int also_period(struct search *search, int wave)
{
    const double noise = neph_cycle_floor_at(&search->floor, search->per_frame[wave - 1]);
    const double needed = likelihood_min * noise * search->floor.scatter.variance;
    turn(search, wave);
    const double own = neph_cycle_gain(&search->tableau, wave);
    int also = 0;
    double best = own - needed;
    for (int w = 1; w <= search->candidates->count; w++) {
        if (search->tableau.inside[w] || w == wave || !is_near(search, w, wave))
            continue;
        const double gain = neph_cycle_gain(&search->tableau, w);
        if (gain > best && neph_cycle_separation(&search->tableau, w) > separation_min) {
            best = gain;
            also = search->candidates->items[w - 1].period;
        }
    }
    turn(search, wave);
    return also;
}

static enum neph_status report(struct search *search, struct neph_arena *memory,
                               struct neph_cycle_findings *findings, struct neph_diag *diag)
{
    struct neph_cycle_found *items = neph_arena_allocate(memory, (size_t)search->inside_count + 1,
                                                         sizeof(*items));
    if (!items)
        return neph_fail_memory(diag);
    const double n = (double)search->frame_count;
    const double white = search->residual / (n - 2.0 - 2.0 * (double)search->inside_count);
    int count = 0;
    for (int w = 1; w <= search->candidates->count; w++) {
        if (!search->tableau.inside[w])
            continue;
        const double noise = neph_cycle_floor_at(&search->floor, search->per_frame[w - 1]);
        items[count++] = (struct neph_cycle_found){
            .frequency = search->candidates->items[w - 1],
            .noise = white > 0.0 ? noise / white : 1.0,
            .also_period = also_period(search, w),
        };
    }
    *findings = (struct neph_cycle_findings){
        .items = items,
        .count = count,
        .scatter = sqrt(search->floor.scatter.variance),
        .ratio_min = neph_cycle_floor_ratio(&search->floor, z_needed(search)),
    };
    return NEPH_OK;
}

enum neph_status neph_cycle_search(int frame_count, const double *moments,
                                   const struct neph_cycle_frequencies *candidates,
                                   struct neph_arena *memory, struct neph_cycle_findings *findings,
                                   struct neph_diag *diag)
{
    struct neph_arena at_work = {0};
    struct search search = {.frame_count = frame_count, .candidates = candidates};
    enum neph_status status = begin(&search, moments, &at_work, diag);
    for (int round = 0; round < ROUNDS && !status && search.total > 0.0; round++) {
        take(&search);
        exchange(&search, 0);
        drop(&search);
        if (round + 1 < ROUNDS)
            exchange_pairs(&search);
    }
    if (!status)
        status = report(&search, memory, findings, diag);
    neph_arena_finish(&at_work);
    return status;
}
