/* SPDX-License-Identifier: MIT */
#include "metrics/extractors/flicker_verdict.h"

#include "metrics/significance.h"

#include <math.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_FLICKER_KIND_COUNT == 3, "a new kind");

bool neph_flicker_is_cyclic(const struct neph_flicker_spectrum *luma)
{
    if (luma->a4 <= NEPH_FLICKER_STEP && luma->a2 <= NEPH_FLICKER_STEP)
        return false;
    const double alpha = neph_sidak_alpha(NEPH_FLICKER_ALPHA, 2);
    return (luma->a4 > NEPH_FLICKER_STEP && neph_flicker_quarter_p(luma) < alpha) ||
           (luma->a2 > NEPH_FLICKER_STEP && neph_flicker_half_p(luma) < alpha);
}

double neph_flicker_unrest(double mad, double peak_to_peak, int frame_count)
{
    return fmax(0.0, mad - 2.0 * peak_to_peak / (double)(frame_count - 1));
}

enum neph_flicker_kind neph_flicker_verdict(double cyclic_share, double restless_share)
{
    if (cyclic_share > NEPH_FLICKER_SHARE)
        return NEPH_FLICKER_CYCLIC;
    return restless_share > NEPH_FLICKER_SHARE ? NEPH_FLICKER_RESTLESS : NEPH_FLICKER_CALM;
}

const char *neph_flicker_kind_name(enum neph_flicker_kind kind)
{
    static const char *const names[] = {
        [NEPH_FLICKER_CALM] = "calm",
        [NEPH_FLICKER_RESTLESS] = "restless",
        [NEPH_FLICKER_CYCLIC] = "cyclic",
    };
    return names[kind];
}

double neph_flicker_edge_ratio(double edge_a4_p95, double other_a4_p95)
{
    return edge_a4_p95 / fmax(other_a4_p95, 0.25 * NEPH_FLICKER_STEP);
}

bool neph_flicker_reference_limited(double test, double reference)
{
    return reference > test / 3.0;
}
