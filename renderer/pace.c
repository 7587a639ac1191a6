/* SPDX-License-Identifier: MIT */
#include "renderer/pace.h"

#include <math.h>

static const double dispatch_s = 0.03;

void neph_pace_update(struct neph_pace *pace, double work, double gpu_s)
{
    if (gpu_s > 0.0 && isfinite(gpu_s))
        pace->work_per_s = work / gpu_s;
}

uint64_t neph_pace_work(const struct neph_pace *pace, uint64_t first)
{
    const double most = 0x1p62;
    if (pace->work_per_s == 0.0)
        return first;
    return (uint64_t)fmin(most, fmax(1.0, pace->work_per_s * dispatch_s));
}
