/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/suns.h"

#include "base/vec3.h"

#include <math.h>

static const double unlike_part = 0.1, unlike_rad = 0.1;

static const struct neph_sun *find_earlier_sun(const struct neph_rt_sun_history *suns,
                                               uint32_t frame_count)
{
    return &suns->suns[(suns->last - frame_count) % NEPH_RT_SUNS_MAX];
}

static bool is_within_tolerance(double a, double b)
{
    return fabs(a - b) < unlike_part * fmax(a, b) || a == b;
}

static bool are_suns_similar(const struct neph_sun *a, const struct neph_sun *b)
{
    const struct neph_rgb x = a->irradiance_w_per_m2, y = b->irradiance_w_per_m2;
    if (!a->present || !b->present)
        return a->present == b->present;
    return is_within_tolerance(x.r, y.r) && is_within_tolerance(x.g, y.g) &&
           is_within_tolerance(x.b, y.b) &&
           neph_vec3_dot(a->direction, b->direction) > cos(unlike_rad);
}

void neph_rt_sun_history_add(struct neph_rt_sun_history *suns, uint32_t number,
                             const struct neph_sun *sun)
{
    const bool is_again = suns->count > 0 && number == suns->last;
    const bool is_next = suns->count > 0 && number == suns->last + 1;
    if (is_next && suns->count < NEPH_RT_SUNS_MAX)
        suns->count++;
    else if (!is_next && !is_again)
        suns->count = 1;
    suns->last = number;
    suns->suns[number % NEPH_RT_SUNS_MAX] = *sun;
}

bool neph_rt_sun_history_is_periodic(const struct neph_rt_sun_history *suns, uint32_t period)
{
    bool is_steady = true;
    if (period > NEPH_RT_SUNS_MAX / 2 || suns->count < 2 * period)
        return false;
    for (uint32_t i = 0; i < period; i++) {
        if (!are_suns_similar(find_earlier_sun(suns, i), find_earlier_sun(suns, i + period)))
            return false;
        is_steady = is_steady &&
                    are_suns_similar(find_earlier_sun(suns, 0), find_earlier_sun(suns, i));
    }
    return !is_steady;
}

bool neph_rt_sun_history_has_jump(const struct neph_rt_sun_history *suns, uint32_t frame_count)
{
    for (uint32_t i = 0; i < frame_count && i + 1 < suns->count; i++)
        if (!are_suns_similar(find_earlier_sun(suns, i), find_earlier_sun(suns, i + 1)))
            return true;
    return false;
}
