/* SPDX-License-Identifier: MIT */
#include "scenes/medium_bounds.h"

#include "scenes/solids.h"

#include <math.h>

static struct neph_vec3 find_middle(const struct neph_bounds *box)
{
    return neph_vec3_scale(neph_vec3_add(box->min_m, box->max_m), 0.5);
}

/* By symmetry the magnitudes of four corners suffice. */
static struct neph_bounds find_hull(const struct neph_bounds *box, const struct neph_turn *turn)
{
    const struct neph_vec3 middle_m = find_middle(box),
                           half_m = neph_vec3_sub(box->max_m, middle_m);
    struct neph_vec3 most_m = {0, 0, 0};
    for (int corner = 0; corner < 4; corner++) {
        const struct neph_vec3 arm_m = {corner & 1 ? -half_m.x : half_m.x,
                                        corner & 2 ? -half_m.y : half_m.y, half_m.z};
        const struct neph_vec3 to_m = neph_rotate(turn, arm_m);
        most_m = (struct neph_vec3){fmax(most_m.x, fabs(to_m.x)), fmax(most_m.y, fabs(to_m.y)),
                                    fmax(most_m.z, fabs(to_m.z))};
    }
    return (struct neph_bounds){neph_vec3_sub(middle_m, most_m), neph_vec3_add(middle_m, most_m)};
}

void neph_medium_turn_bounds(struct neph_medium *medium, const struct neph_turn *turn)
{
    medium->box = medium->bounds;
    medium->turn = *turn;
    medium->bounds = find_hull(&medium->box, turn);
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
    const struct neph_vec3 middle_m = find_middle(&medium->box);
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
