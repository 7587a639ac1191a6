/* SPDX-License-Identifier: MIT */
#include "metrics/extractors/seen_contrast.h"

#include "metrics/vector_math.h"

#include <math.h>

enum { LANES = NEPH_SEEN_LANES };

NEPH_VECTOR
static void weigh_all(const struct neph_seen_gains *gains, const float *levels,
                      const float *luminances, float *energies, float *squares)
{
    int level[LANES];
    float share[LANES], scale[LANES];
    for (int l = 0; l < LANES; l++) {
        level[l] = (int)levels[l];
        share[l] = levels[l] - (float)level[l];
        scale[l] = 1.0f / (luminances[l] * luminances[l]);
        squares[l] = 0.0f;
    }
    for (int bin = 0; bin < gains->bin_count; bin++) {
        const float *values = gains->values + (size_t)bin * NEPH_SEEN_LEVELS;
        float *energy = energies + (size_t)bin * LANES;
        NEPH_LANES
        for (int l = 0; l < LANES; l++) {
            const float low = values[level[l]], high = values[level[l] + 1];
            energy[l] *= (low + share[l] * (high - low)) * scale[l];
            squares[l] += energy[l];
        }
    }
}

NEPH_VECTOR
static void find_largest(const float *energies, int bin_count, int *largest)
{
    float most[LANES] = {0.0f};
    for (int l = 0; l < LANES; l++)
        largest[l] = 0;
    for (int bin = 0; bin < bin_count; bin++) {
        const float *energy = energies + (size_t)bin * LANES;
        NEPH_LANES
        for (int l = 0; l < LANES; l++) {
            largest[l] = energy[l] > most[l] ? bin : largest[l];
            most[l] = energy[l] > most[l] ? energy[l] : most[l];
        }
    }
}

/* The Hann window spreads a line over bins up to two away. */
static float centre_hz(const float *energies, size_t stride, int bin_count, int largest,
                       double bin_hz)
{
    double sum = 0.0, moment = 0.0;
    for (int bin = largest - 2; bin <= largest + 2; bin++) {
        if (bin < 0 || bin >= bin_count)
            continue;
        sum += (double)energies[(size_t)bin * stride];
        moment += bin * (double)energies[(size_t)bin * stride];
    }
    return sum > 0.0 ? (float)(bin_hz * moment / sum) : NAN;
}

void neph_seen_weigh(const struct neph_seen_gains *gains, const float *levels,
                     const float *luminances_cd_per_m2, double bin_hz, float *energies,
                     struct neph_seen_lanes *found)
{
    float squares[LANES];
    int largest[LANES];
    weigh_all(gains, levels, luminances_cd_per_m2, energies, squares);
    find_largest(energies, gains->bin_count, largest);
    for (int l = 0; l < LANES; l++) {
        found->contrast[l] = sqrtf(squares[l]);
        found->hertz[l] = centre_hz(energies + l, LANES, gains->bin_count, largest[l], bin_hz);
    }
}

float neph_seen_peak_hz(const float *energies, size_t stride, int bin_count, double bin_hz)
{
    int largest = 0;
    for (int bin = 0; bin < bin_count; bin++)
        if (energies[(size_t)bin * stride] > energies[(size_t)largest * stride])
            largest = bin;
    return centre_hz(energies, stride, bin_count, largest, bin_hz);
}

NEPH_VECTOR
void neph_seen_pops(const float *series, size_t stride, int frame_count, double fade, float *room,
                    float pops[NEPH_SEEN_LANES])
{
    const float keep = (float)fade;
    float average[LANES];
    for (int l = 0; l < LANES; l++) {
        average[l] = series[l];
        pops[l] = 0.0f;
    }
    for (int t = 0; t < frame_count; t++) { /* room: average of the frames up to t */
        const float *frame = series + (size_t)t * stride;
        float *before = room + (size_t)t * LANES;
        NEPH_LANES
        for (int l = 0; l < LANES; l++) {
            average[l] = frame[l] + keep * (average[l] - frame[l]);
            before[l] = average[l];
        }
    }
    for (int l = 0; l < LANES; l++)
        average[l] = series[(size_t)(frame_count - 1) * stride + (size_t)l];
    for (int t = frame_count - 1; t > 0; t--) { /* average: of the frames from t on */
        const float *frame = series + (size_t)t * stride, *before = room + (size_t)(t - 1) * LANES;
        NEPH_LANES
        for (int l = 0; l < LANES; l++) {
            average[l] = frame[l] + keep * (average[l] - frame[l]);
            const float response = fabsf(average[l] - before[l]);
            pops[l] = response > pops[l] ? response : pops[l];
        }
    }
}
