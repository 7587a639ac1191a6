/* SPDX-License-Identifier: MIT */
#include "metrics/extractors/seen_gain.h"

#include "base/threads.h"
#include "metrics/eye.h"

#include <math.h>

/* Radius of the disk in De Lange's measurements; a pixel counts as the centre of such a disk. */
static const double disk_deg = 1.0;

static double sinc(double x)
{
    return x == 0.0 ? 1.0 : sin(M_PI * x) / (M_PI * x);
}

double neph_seen_gain(double frequency_hz, double frame_rate_hz, double luminance_cd_per_m2,
                      double radius_deg)
{
    if (frequency_hz < NEPH_EYE_FLICKER_HZ)
        return 0.0;
    const double image_hz = frame_rate_hz - frequency_hz;
    const double seen = neph_eye_sensitivity(frequency_hz, luminance_cd_per_m2, radius_deg) *
                        sinc(frequency_hz / frame_rate_hz);
    const double image = neph_eye_sensitivity(image_hz, luminance_cd_per_m2, radius_deg) *
                         sinc(image_hz / frame_rate_hz);
    return seen * seen + image * image;
}

struct work {
    struct neph_seen_gains *gains;
    double bin_hz, frame_rate_hz;
};

static void fill_bin(int bin, void *context)
{
    const struct work *work = context;
    const struct neph_seen_gains *gains = work->gains;
    for (int level = 0; level < NEPH_SEEN_LEVELS; level++) {
        const double luminance = gains->black_cd_per_m2 * exp2(level / gains->levels_per_octave);
        gains->values[bin * NEPH_SEEN_LEVELS + level] = (float)neph_seen_gain(
            bin * work->bin_hz, work->frame_rate_hz, luminance, disk_deg);
    }
}

enum neph_status neph_seen_gains_create(int bin_count, double bin_hz, double frame_rate_hz,
                                        double black_cd_per_m2, double white_cd_per_m2,
                                        struct neph_arena *memory, struct neph_seen_gains *gains,
                                        struct neph_diag *diag)
{
    *gains = (struct neph_seen_gains){
        .bin_count = bin_count,
        .black_cd_per_m2 = black_cd_per_m2,
        .levels_per_octave = (NEPH_SEEN_LEVELS - 1) / log2(white_cd_per_m2 / black_cd_per_m2),
        .values = neph_arena_allocate(memory, (size_t)bin_count * NEPH_SEEN_LEVELS,
                                      sizeof(*gains->values))};
    struct work work = {gains, bin_hz, frame_rate_hz};
    return gains->values ? neph_parallel_rows(bin_count, fill_bin, &work, diag)
                         : neph_fail_memory(diag);
}

float neph_seen_level(const struct neph_seen_gains *gains, double luminance_cd_per_m2)
{
    const double level = gains->levels_per_octave *
                         log2(luminance_cd_per_m2 / gains->black_cd_per_m2);
    return (float)fmin(fmax(level, 0.0), NEPH_SEEN_LEVELS - 1.001);
}
