/* SPDX-License-Identifier: MIT */
#include "harness/compare/direction.h"

#include <string.h>

/* Directions by the prefix of a metric's name; the first match applies. Metrics without a
 * direction, such as a gain that should be 1, are only reported as higher or lower. */
static const struct direction {
    const char *begin;
    enum neph_direction is;
} directions[] = {
    {"bias", NEPH_SMALLER_IS_BETTER},       {"rel_", NEPH_SMALLER_IS_BETTER},
    {"mae", NEPH_SMALLER_IS_BETTER},        {"rmse", NEPH_SMALLER_IS_BETTER},
    {"max_", NEPH_SMALLER_IS_BETTER},       {"p50", NEPH_SMALLER_IS_BETTER},
    {"p95", NEPH_SMALLER_IS_BETTER},        {"p99", NEPH_SMALLER_IS_BETTER},
    {"stops_", NEPH_SMALLER_IS_BETTER},     {"flip_", NEPH_SMALLER_IS_BETTER},
    {"seen_c", NEPH_SMALLER_IS_BETTER},     {"seen_s", NEPH_SMALLER_IS_BETTER},
    {"std_", NEPH_SMALLER_IS_BETTER},       {"a4_", NEPH_SMALLER_IS_BETTER},
    {"a2_", NEPH_SMALLER_IS_BETTER},        {"block_a4_", NEPH_SMALLER_IS_BETTER},
    {"block_a2_", NEPH_SMALLER_IS_BETTER},  {"mad_", NEPH_SMALLER_IS_BETTER},
    {"p2p_", NEPH_SMALLER_IS_BETTER},       {"pop_", NEPH_SMALLER_IS_BETTER},
    {"seen_p", NEPH_SMALLER_IS_BETTER},     {"worst_tile_c", NEPH_SMALLER_IS_BETTER},
    {"coherent_c", NEPH_SMALLER_IS_BETTER}, {"flip40_", NEPH_SMALLER_IS_BETTER},
    {"cycle_share", NEPH_NO_DIRECTION},     {"cycle_", NEPH_SMALLER_IS_BETTER},
    {"cyclic_", NEPH_SMALLER_IS_BETTER},    {"restless_", NEPH_SMALLER_IS_BETTER},
    {"half_life_", NEPH_SMALLER_IS_BETTER}, {"residual_change_rms", NEPH_SMALLER_IS_BETTER},
    {"pu_psnr", NEPH_LARGER_IS_BETTER},     {"residual_change_psnr", NEPH_LARGER_IS_BETTER},
    {"ssim_", NEPH_LARGER_IS_BETTER},       {"ms_ssim", NEPH_LARGER_IS_BETTER},
    {"tev_", NEPH_SMALLER_IS_BETTER},       {"pbrt_", NEPH_SMALLER_IS_BETTER},
    {"smape", NEPH_SMALLER_IS_BETTER},      {"srgb_psnr", NEPH_LARGER_IS_BETTER},
};

enum neph_direction neph_metric_direction(const struct neph_metric *metric)
{
    for (size_t i = 0; i < sizeof(directions) / sizeof(directions[0]); i++)
        if (strncmp(directions[i].begin, metric->name, strlen(directions[i].begin)) == 0)
            return directions[i].is;
    return NEPH_NO_DIRECTION;
}
