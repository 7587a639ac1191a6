/* SPDX-License-Identifier: MIT */
#include "scenes/medium_bounds.h"

#include "scenes/solids.h"

void neph_medium_turn_bounds(struct neph_medium *medium, const struct neph_turn *turn)
{
    medium->box = medium->bounds;
    medium->turn = *turn;
    medium->bounds = neph_turned_box_bounds(&medium->box, turn);
}

void neph_medium_move_bounds(struct neph_medium *medium, struct neph_vec3 by_m)
{
    medium->bounds = neph_bounds_translate(medium->bounds, by_m);
    medium->box = neph_bounds_translate(medium->box, by_m);
}

struct neph_bounds neph_medium_own_box(const struct neph_medium *medium)
{
    return neph_is_turned(&medium->turn) ? medium->box : medium->bounds;
}

struct neph_vec3 neph_medium_own_direction(const struct neph_medium *medium,
                                           struct neph_vec3 direction)
{
    return neph_is_turned(&medium->turn) ? neph_rotate_back(&medium->turn, direction) : direction;
}

struct neph_vec3 neph_medium_own_point_m(const struct neph_medium *medium, struct neph_vec3 point_m)
{
    if (!neph_is_turned(&medium->turn))
        return point_m;
    const struct neph_vec3 middle_m = neph_bounds_middle(&medium->box);
    return neph_vec3_add(middle_m,
                         neph_rotate_back(&medium->turn, neph_vec3_sub(point_m, middle_m)));
}

bool neph_medium_contains(const struct neph_medium *medium, struct neph_vec3 point_m)
{
    return neph_bounds_contain(neph_is_turned(&medium->turn) ? &medium->box : &medium->bounds,
                               neph_medium_own_point_m(medium, point_m));
}

bool neph_medium_clip(const struct neph_medium *medium, struct neph_vec3 origin_m,
                      struct neph_vec3 direction, double *t0_m, double *t1_m)
{
    return neph_bounds_clip(neph_is_turned(&medium->turn) ? &medium->box : &medium->bounds,
                            neph_medium_own_point_m(medium, origin_m),
                            neph_medium_own_direction(medium, direction), t0_m, t1_m);
}
