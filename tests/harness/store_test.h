/* SPDX-License-Identifier: MIT
 *
 * A store in the folder of a test, and what lies in it.
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

static inline void write_text(const char *folder, const char *name, const char *text)
{
    char *path = neph_path_join(folder, name);
    neph_assert_ok(neph_file_write(path, text, strlen(text), NULL), NULL);
    free(path);
}

/* The number of things in a folder of the test. */
static inline int count_in(void **state, const char *name)
{
    char path[SCRATCH_PATH_MAX];
    struct scratch inner;
    snprintf(inner.folder, sizeof(inner.folder), "%.250s", scratch_path(state, path, name));
    void *inner_state = &inner;
    return scratch_count(&inner_state);
}

#endif
