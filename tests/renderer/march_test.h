/* SPDX-License-Identifier: MIT
 *
 * One frame of the ray marcher, for tests that expect errors.
 */
#ifndef NEPH_TESTS_MARCH_TEST_H
#define NEPH_TESTS_MARCH_TEST_H

#include "tests/renderer/renderer_test.h"

#include "renderer/march.h"

/* `stats` may be NULL. */
static inline enum neph_status
test_march_frame(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                 const struct neph_march_params *params, struct neph_image **frame,
                 struct neph_march_stats *stats, struct neph_diag *diag)
{
    struct neph_march *march = NULL;
    enum neph_status status = neph_march_create(vulkan, scene, params, &march, diag);
    if (!status)
        status = neph_march_frame(march, scene, params->frame, NULL, frame, stats, diag);
    neph_march_destroy(march);
    return status;
}

#endif
