/* SPDX-License-Identifier: MIT */
#include "metrics/extractors/phase_age.h"

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_SLOT_ORDER_COUNT == 3, "a new kind");

/* Position of each phase in the order. */
static const int places[][NEPH_PHASE_COUNT] = {
    [NEPH_SLOT_CLOCKWISE] = {0, 1, 3, 2},
    [NEPH_SLOT_Z] = {0, 1, 2, 3},
    [NEPH_SLOT_DIAGONAL] = {0, 2, 3, 1},
};

int neph_slot_phase(const struct neph_phase_age *scheme, int x_px, int y_px)
{
    const int column = x_px / scheme->slot_px, row = y_px / scheme->slot_px;
    return (column & 1) + 2 * (row & 1);
}

/* In frame t the phase at position (t + first_slot + ahead) mod 4 is traced. */
int neph_slot_frame_at_age(const struct neph_phase_age *scheme, int x_px, int y_px, int age)
{
    const int tile_px = 2 * scheme->slot_px;
    const bool even = ((x_px / tile_px + y_px / tile_px) & 1) == 0;
    const int ahead = scheme->checkerboard && even ? 1 : 0;
    const int place = places[scheme->order][neph_slot_phase(scheme, x_px, y_px)];
    return (place + age - scheme->first_slot - ahead + 2 * NEPH_AGE_COUNT) % NEPH_AGE_COUNT;
}

double neph_age_slope(const double values[NEPH_AGE_COUNT])
{
    /* sum (a - 3/2) v / sum (a - 3/2)^2 */
    return (3.0 * (values[3] - values[0]) + (values[2] - values[1])) / 10.0;
}
