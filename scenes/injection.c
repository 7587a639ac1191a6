/* SPDX-License-Identifier: MIT */
#include "scenes/injection.h"

#include <stdio.h>
#include <stdlib.h>

/* --- at a picture ---------------------------------------------------------------------------- */

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

static void put_history(FILE *out, const char *before, const struct neph_injected_history *history)
{
    fprintf(out, "%shistory %s%s at %d", before, neph_injected_value_name(history->value),
            history->first ? " as if first" : "", history->frame);
}

static void put_rays(FILE *out, const char *before, const struct neph_injected_rays *rays)
{
    fprintf(out, "%srays %d %s at %d", before, rays->count, neph_injected_value_name(rays->value),
            rays->frame);
}

static void put_size(FILE *out, const char *before, const struct neph_injected_size *size)
{
    fprintf(out, "%ssize by %.17g at %d", before, size->scale, size->frame);
}

static void put_view(FILE *out, const char *before, const struct neph_injected_view *view)
{
    fprintf(out, "%sview within %d %d %d %d px of %s", before, view->left_px, view->top_px,
            view->right_px, view->bottom_px, neph_injected_value_name(view->value));
}

static void put_mirror(FILE *out, const char *before, const struct neph_injected_mirror *mirror)
{
    fprintf(out, "%smirror at %.17g m in %d from %d", before, mirror->height_m, mirror->count,
            mirror->frame);
}

static void put_origin(FILE *out, const char *before, const struct neph_injected_origin *origin)
{
    fprintf(out, "%sorigin by %.17g %.17g %.17g m at %d", before, origin->by_m.x, origin->by_m.y,
            origin->by_m.z, origin->frame);
}

static void put_exposure(FILE *out, const char *before,
                         const struct neph_injected_exposure *exposure)
{
    fprintf(out, "%sexposure by %.17g at %d", before, exposure->factor, exposure->frame);
}

static bool has_view(const struct neph_injected_view *view)
{
    return view->left_px + view->top_px + view->right_px + view->bottom_px > 0;
}

static void put_all(FILE *out, const struct neph_injections *injections)
{
    const char *before = "";
    for (int i = 0; i < injections->history_count; i++, before = ", ")
        put_history(out, before, &injections->histories[i]);
    for (int i = 0; i < injections->ray_count; i++, before = ", ")
        put_rays(out, before, &injections->rays[i]);
    for (int i = 0; i < injections->size_count; i++, before = ", ")
        put_size(out, before, &injections->sizes[i]);
    for (int i = 0; i < injections->origin_count; i++, before = ", ")
        put_origin(out, before, &injections->origins[i]);
    for (int i = 0; i < injections->exposure_count; i++, before = ", ")
        put_exposure(out, before, &injections->exposures[i]);
    if (has_view(&injections->view)) {
        put_view(out, before, &injections->view);
        before = ", ";
    }
    if (injections->mirror.count > 0)
        put_mirror(out, before, &injections->mirror);
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
