/* SPDX-License-Identifier: MIT
 *
 * A check with its stages built and the truth of every pixel known: what participants render.
 */
#ifndef NEPH_HARNESS_PHYSICS_SCENERY_H
#define NEPH_HARNESS_PHYSICS_SCENERY_H

#include "harness/physics/checks.h"

enum { NEPH_SCENERY_PIXELS_MAX = 1024 };

struct neph_scenery_view {
    const struct neph_check_view *view;
    struct neph_stage *stage;
    int pixel_count;
    double truth[NEPH_SCENERY_PIXELS_MAX], weight[NEPH_SCENERY_PIXELS_MAX];
    double truth_error; /* relative, of the mean; 0: exact */
};

/* Large, and its views point into its check: not for copying. */
struct neph_scenery {
    struct neph_check check;
    struct neph_scenery_view views[NEPH_CHECK_VIEWS_MAX];
};

/* Build the check of that index. On success end it with _leave. */
enum neph_status neph_scenery_enter(int index, struct neph_scenery *scenery,
                                    struct neph_diag *diag);
void neph_scenery_leave(struct neph_scenery *scenery);

/* Give all views this light and hash their scenes: single scattering from the sun only, for
 * renderers without higher orders, and back. NEPH_ERR_MEMORY. */
enum neph_status neph_scenery_light(struct neph_scenery *scenery, enum neph_scattering scattering,
                                    bool environment_light, struct neph_diag *diag);

#endif
