/* SPDX-License-Identifier: MIT
 *
 * The check of phase functions accepts valid ones and rejects others.
 */
#include "tests/neph_test.h"

#include "harness/physics/phases.h"

static void test_all_kinds_pass(void **state)
{
    struct neph_phase_finding found[NEPH_PHASES_MAX];
    const int count = neph_phases_check(found);
    assert_true(count >= NEPH_PHASE_KIND_COUNT && count < NEPH_PHASES_MAX);
    for (int i = 0; i < count; i++)
        assert_true(found[i].agrees);
}

/* Beyond g = 1 the formula integrates to -1 / g. */
static void test_invalid_densities_are_detected(void **state)
{
    const struct neph_phase_finding found = neph_phase_check(
        &(struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, 1.25});
    neph_assert_close(found.integral, -0.8, 1e-9, 0.0);
    assert_false(found.agrees);
}

#include "tests/main.h"
