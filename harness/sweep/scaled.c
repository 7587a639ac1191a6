/* SPDX-License-Identifier: MIT
 *
 * Scenes resampled to a given number of voxels.
 */
#include "harness/sweep/scaled.h"

#include "scenes/bake.h"
#include "scenes/media.h"

#include <stdlib.h>

/* `scene` is the first member, so that a pointer to it is a pointer to the struct. */
struct scaled {
    struct neph_scene scene;
    int bake_count;
    struct neph_bake bakes[NEPH_SCENE_MEDIA_MAX]; /* owned */
};

void neph_scaled_destroy(struct neph_scene *made)
{
    struct scaled *scaled = (struct scaled *)made;
    for (int i = 0; scaled && i < scaled->bake_count; i++)
        neph_bake_finish(&scaled->bakes[i]);
    free(scaled);
}

static enum neph_status sample(const struct neph_scene *scene, int nodes, struct scaled *scaled,
                               struct neph_medium *medium, double *count, struct neph_diag *diag)
{
    struct neph_bake *bake = &scaled->bakes[scaled->bake_count];
    double cut_error;
    const struct neph_bounds box = neph_medium_container(scene, medium, &cut_error);
    const enum neph_status status = neph_medium_sample(medium, &box, nodes, bake, diag);
    if (status)
        return status;
    scaled->bake_count++;
    *medium = neph_medium_from_bake(medium, bake);
    *count += (double)bake->grid->size[0] * bake->grid->size[1] * bake->grid->size[2];
    return NEPH_OK;
}

enum neph_status neph_scaled_make(const struct neph_scene *scene, int nodes,
                                  struct neph_scene **made, double *count, struct neph_diag *diag)
{
    struct scaled *scaled = calloc(1, sizeof(*scaled));
    if (!scaled)
        return neph_fail_memory(diag);
    scaled->scene = *scene;
    scaled->scene.borrows = true;
    scaled->scene.is_as_filed = false;
    *count = 0.0;
    enum neph_status status = NEPH_OK;
    for (int m = 0; m < scene->medium_count && !status; m++)
        if (!neph_medium_is_fog(&scene->media[m]))
            status = sample(scene, nodes, scaled, &scaled->scene.media[m], count, diag);
    if (!status && scaled->bake_count == 0)
        status = neph_fail(diag, NEPH_ERR_UNSUPPORTED, "%s has only fog, which has no voxels",
                           scene->name);
    if (!status)
        status = neph_scene_hash(&scaled->scene, diag);
    if (status)
        neph_scaled_destroy(&scaled->scene);
    else
        *made = &scaled->scene;
    return status;
}
