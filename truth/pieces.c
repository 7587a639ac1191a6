/* SPDX-License-Identifier: MIT */
#include "truth/pieces.h"

#include "scenes/media.h"

static struct neph_rgb depth_between(const struct neph_pieces *pieces, double t0_m, double t1_m)
{
    return neph_scene_optical_depth(pieces->scene, pieces->origin_m, pieces->direction, t0_m, t1_m);
}

void neph_pieces_sum_depths(struct neph_pieces *pieces)
{
    struct neph_rgb depth = {0, 0, 0};
    double from_m = 0.0;
    for (int i = 0; i < pieces->count; i++) {
        depth = neph_rgb_add(depth, depth_between(pieces, from_m, pieces->at_m[i].low));
        from_m = pieces->at_m[i].low;
        pieces->depth_before[i] = depth;
    }
}

struct neph_rgb neph_pieces_depth_to(const struct neph_pieces *pieces, double t_m)
{
    int low = 0, high = pieces->count;
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        if (pieces->at_m[middle].low <= t_m)
            low = middle;
        else
            high = middle;
    }
    return neph_rgb_add(pieces->depth_before[low],
                        depth_between(pieces, pieces->at_m[low].low, t_m));
}

double neph_pieces_integrate(const struct neph_scene *scene, neph_integrand *integrand,
                             void *context, const struct neph_interval *pieces, int piece_count,
                             double rough_tolerance, double result[3])
{
    for (int m = 0; m < scene->medium_count; m++)
        if (neph_medium_facts(scene->media[m].kind)->has_kinks)
            return neph_integrate_rough(integrand, context, pieces, piece_count, rough_tolerance,
                                        result);
    return neph_integrate(integrand, context, pieces, piece_count, result);
}
