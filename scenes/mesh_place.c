/* SPDX-License-Identifier: MIT */
#include "scenes/mesh_place.h"

#include "scenes/solids.h"

int neph_mesh_index(const struct neph_scene *scene, const struct neph_solid *solid)
{
    int index = 0;
    while (index + 1 < scene->mesh_count && scene->meshes[index] != solid->mesh)
        index++;
    return index;
}

void neph_mesh_axes(const struct neph_solid *solid, struct neph_vec3 axes[3])
{
    for (int i = 0; i < 3; i++) {
        axes[i] = (struct neph_vec3){i == 0, i == 1, i == 2};
        if (neph_is_turned(&solid->yaw))
            axes[i] = neph_rotate(&solid->yaw, axes[i]);
        if (neph_is_turned(&solid->turn))
            axes[i] = neph_rotate(&solid->turn, axes[i]);
    }
}
