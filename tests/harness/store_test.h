/* SPDX-License-Identifier: MIT
 *
 * A store in the folder of a test.
 */
#ifndef NEPH_TESTS_STORE_TEST_H
#define NEPH_TESTS_STORE_TEST_H

#include "tests/base/scratch.h"

#include "harness/run/store.h"

static inline struct neph_store *open_store(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_store *store = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_store_open(scratch_path(state, path, "store"), &store, &diag), &diag);
    return store;
}

#endif
