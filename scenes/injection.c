/* SPDX-License-Identifier: MIT */
#include "scenes/injection.h"

#include <stdio.h>
#include <stdlib.h>

const struct neph_injections *neph_scene_injections(const struct neph_scene *scene)
{
    static const struct neph_injections none = {.history_count = 0};
    return scene->injections ? scene->injections : &none;
}

/* --- at a frame ------------------------------------------------------------------------------ */

const struct neph_injected_history *
neph_injected_history_at(const struct neph_injections *injections, int frame)
{
    for (int i = 0; i < injections->history_count; i++)
        if (injections->histories[i].frame == frame)
            return &injections->histories[i];
    return NULL;
}

const struct neph_injected_rays *neph_injected_rays_at(const struct neph_injections *injections,
                                                       int frame)
{
    for (int i = 0; i < injections->ray_count; i++)
        if (injections->rays[i].frame == frame)
            return &injections->rays[i];
    return NULL;
}

const struct neph_injected_size *neph_injected_size_at(const struct neph_injections *injections,
                                                       int frame)
{
    for (int i = 0; i < injections->size_count; i++)
        if (injections->sizes[i].frame == frame)
            return &injections->sizes[i];
    return NULL;
}

bool neph_injected_mirror_at(const struct neph_injections *injections, int frame)
{
    const struct neph_injected_mirror *mirror = &injections->mirror;
    return frame >= mirror->frame && frame - mirror->frame < mirror->count;
}

struct neph_vec3 neph_injected_origin_at(const struct neph_injections *injections, int frame)
{
    struct neph_vec3 by_m = {0.0, 0.0, 0.0};
    for (int i = 0; i < injections->origin_count && injections->origins[i].frame <= frame; i++)
        by_m = injections->origins[i].by_m;
    return by_m;
}

double neph_injected_exposure_at(const struct neph_injections *injections, int frame)
{
    double factor = 1.0;
    for (int i = 0; i < injections->exposure_count && injections->exposures[i].frame <= frame; i++)
        factor = injections->exposures[i].factor;
    return factor;
}

/* --- in words -------------------------------------------------------------------------------- */

static void put_all(FILE *out, const struct neph_injections *all)
{
    const char *before = "";
    for (int i = 0; i < all->history_count; i++, before = ", ")
        fprintf(out, "%shistory %s%s at %d", before,
                neph_injected_value_name(all->histories[i].value),
                all->histories[i].first ? " as if first" : "", all->histories[i].frame);
    for (int i = 0; i < all->ray_count; i++, before = ", ")
        fprintf(out, "%srays %d %s at %d", before, all->rays[i].count,
                neph_injected_value_name(all->rays[i].value), all->rays[i].frame);
    for (int i = 0; i < all->size_count; i++, before = ", ")
        fprintf(out, "%ssize by %.17g at %d", before, all->sizes[i].scale, all->sizes[i].frame);
    for (int i = 0; i < all->origin_count; i++, before = ", ")
        fprintf(out, "%sorigin by %.17g %.17g %.17g m at %d", before, all->origins[i].by_m.x,
                all->origins[i].by_m.y, all->origins[i].by_m.z, all->origins[i].frame);
    for (int i = 0; i < all->exposure_count; i++, before = ", ")
        fprintf(out, "%sexposure by %.17g at %d", before, all->exposures[i].factor,
                all->exposures[i].frame);
    const struct neph_injected_view *view = &all->view;
    if (view->left_px + view->top_px + view->right_px + view->bottom_px > 0) {
        fprintf(out, "%sview within %d %d %d %d px of %s", before, view->left_px, view->top_px,
                view->right_px, view->bottom_px, neph_injected_value_name(view->value));
        before = ", ";
    }
    if (all->mirror.count > 0)
        fprintf(out, "%smirror at %.17g m in %d from %d", before, all->mirror.height_m,
                all->mirror.count, all->mirror.frame);
}

char *neph_injections_text(const struct neph_injections *injections)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return NULL;
    put_all(out, injections);
    if (fclose(out) == 0)
        return text;
    free(text);
    return NULL;
}
