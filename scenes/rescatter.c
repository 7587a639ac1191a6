/* SPDX-License-Identifier: MIT */
#include "scenes/rescatter.h"

#include <stdlib.h>

enum neph_status neph_scene_rescatter(const struct neph_scene *scene,
                                      enum neph_scattering scattering, struct neph_scene **made,
                                      struct neph_diag *diag)
{
    struct neph_scene *other = malloc(sizeof(*other));
    if (!other)
        return neph_fail_memory(diag);
    *other = *scene;
    other->borrows = true;
    other->is_as_filed = false;
    other->scattering = scattering;
    const enum neph_status status = neph_scene_hash(other, diag);
    if (status)
        free(other);
    else
        *made = other;
    return status;
}
