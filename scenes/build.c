/* SPDX-License-Identifier: MIT */
#include "scenes/build.h"

#include "scenes/bake.h"

#include <stdlib.h>
#include <string.h>

static struct neph_vec3 vec3(const double v[3])
{
    return (struct neph_vec3){v[0], v[1], v[2]};
}

static struct neph_rgb rgb(const double v[3])
{
    return (struct neph_rgb){v[0], v[1], v[2]};
}

static bool copy_text(char **to, const char *from)
{
    *to = strdup(from);
    return *to;
}

static enum neph_status build_texts(const struct neph_raw_scene *raw, const char *path,
                                    struct neph_scene *scene, struct neph_diag *diag)
{
    if (copy_text(&scene->path, path) && copy_text(&scene->name, raw->name) &&
        copy_text(&scene->title, raw->title) && copy_text(&scene->physics, raw->physics))
        return NEPH_OK;
    return neph_fail_memory(diag);
}

static void build_light(const struct neph_raw_scene *raw, struct neph_scene *scene)
{
    if (raw->background_w_per_m2_sr)
        scene->background_w_per_m2_sr = rgb(raw->background_w_per_m2_sr);
    scene->environment_light = raw->environment_light;
    scene->scattering = raw->scattering;
}

/* --- Solids --- */

static int rail_count(const struct neph_raw_fence *fence)
{
    return fence->rails ? (int)fence->rails->heights_m_count : 0;
}

static int row_count(const struct neph_raw_fence *fence)
{
    return fence->rows ? *fence->rows : 1;
}

int neph_fence_solid_count(const struct neph_raw_fence *fence)
{
    return row_count(fence) * (fence->bars + rail_count(fence));
}

/* A thin box around a centre line. */
static struct neph_solid thin_box(struct neph_vec3 center_m, struct neph_vec3 size_m,
                                  struct neph_rgb albedo)
{
    return (struct neph_solid){
        .kind = NEPH_SOLID_BOX,
        .box = {neph_vec3_along(center_m, size_m, -0.5), neph_vec3_along(center_m, size_m, 0.5)},
        .albedo = albedo,
        .thin = true,
    };
}

/* The foot of the row's first bar: rows follow each other along -Z, away from a default camera. */
static struct neph_vec3 row_foot(const struct neph_raw_fence *fence, int row)
{
    struct neph_vec3 foot = vec3(fence->origin_m);
    if (row)
        foot.z -= row * *fence->row_spacing_m;
    return foot;
}

static struct neph_solid fence_bar(const struct neph_raw_fence *fence, int row, int bar)
{
    struct neph_vec3 center = row_foot(fence, row);
    center.x += bar * fence->pitch_m;
    center.y += 0.5 * fence->height_m;
    struct neph_vec3 size = {fence->bar_width_m, fence->height_m, fence->bar_depth_m};
    struct neph_solid solid = thin_box(center, size, rgb(fence->albedo));
    solid.box.min_m.y = fence->origin_m[1]; /* exactly on the ground */
    return solid;
}

/* From the middle of the first bar to the middle of the last: its ends hide inside them. */
static struct neph_solid fence_rail(const struct neph_raw_fence *fence, int row, int rail)
{
    double length_m = (fence->bars - 1) * fence->pitch_m;
    struct neph_vec3 center = row_foot(fence, row);
    center.x += 0.5 * length_m;
    center.y += fence->rails->heights_m[rail];
    struct neph_vec3 size = {length_m, fence->rails->width_m, fence->rails->depth_m};
    return thin_box(center, size, rgb(fence->albedo));
}

static struct neph_solid *append_fence(const struct neph_raw_fence *fence, struct neph_solid *next)
{
    for (int row = 0; row < row_count(fence); row++) {
        for (int bar = 0; bar < fence->bars; bar++)
            *next++ = fence_bar(fence, row, bar);
        for (int rail = 0; rail < rail_count(fence); rail++)
            *next++ = fence_rail(fence, row, rail);
    }
    return next;
}

static struct neph_solid *append_solid(const struct neph_raw_solid *raw, struct neph_solid *next)
{
    if (raw->fence)
        return append_fence(raw->fence, next);
    if (raw->box) {
        *next = (struct neph_solid){.kind = NEPH_SOLID_BOX,
                                    .box = {vec3(raw->box->min_m), vec3(raw->box->max_m)},
                                    .albedo = rgb(raw->box->albedo)};
    } else {
        *next = (struct neph_solid){.kind = NEPH_SOLID_SPHERE,
                                    .center_m = vec3(raw->sphere->center_m),
                                    .radius_m = raw->sphere->radius_m,
                                    .albedo = rgb(raw->sphere->albedo)};
    }
    return next + 1;
}

static enum neph_status build_solids(const struct neph_raw_scene *raw, struct neph_scene *scene,
                                     struct neph_diag *diag)
{
    int count = 0;
    for (unsigned i = 0; i < raw->solids_count; i++)
        count += raw->solids[i].fence ? neph_fence_solid_count(raw->solids[i].fence) : 1;
    if (!count)
        return NEPH_OK;
    scene->solids = calloc((size_t)count, sizeof(*scene->solids));
    if (!scene->solids)
        return neph_fail_memory(diag);
    struct neph_solid *next = scene->solids;
    for (unsigned i = 0; i < raw->solids_count; i++)
        next = append_solid(&raw->solids[i], next);
    scene->solid_count = count;
    return NEPH_OK;
}

/* --- The rest --- */

static void build_octaves(const struct neph_raw_octaves *raw, struct neph_scene *scene)
{
    struct neph_octaves *octaves = &scene->octaves;
    *octaves = (struct neph_octaves){8, 0.5, 0.5, 0.5};
    if (!raw)
        return;
    octaves->count = raw->count ? *raw->count : octaves->count;
    octaves->contribution = raw->contribution ? *raw->contribution : octaves->contribution;
    octaves->attenuation = raw->attenuation ? *raw->attenuation : octaves->attenuation;
    octaves->eccentricity = raw->eccentricity ? *raw->eccentricity : octaves->eccentricity;
}

/* --- Gates --- */

static enum neph_status build_gates(const struct neph_raw_scene *raw, struct neph_scene *scene,
                                    struct neph_diag *diag)
{
    if (!raw->gates_count)
        return NEPH_OK;
    scene->gates = calloc(raw->gates_count, sizeof(*scene->gates));
    if (!scene->gates)
        return neph_fail_memory(diag);
    scene->gate_count = (int)raw->gates_count;
    for (unsigned i = 0; i < raw->gates_count; i++) {
        const struct neph_raw_gate *from = &raw->gates[i];
        struct neph_gate *to = &scene->gates[i];
        to->quantity = from->quantity;
        to->maximum = from->maximum;
        if (!copy_text(&to->engine, from->engine) ||
            !copy_text(&to->metric, neph_schema_metric_name(from->metric)) ||
            !copy_text(&to->mask, neph_schema_mask_name(from->mask ? *from->mask : 0)) ||
            !copy_text(&to->reason, from->reason))
            return neph_fail_memory(diag);
    }
    return NEPH_OK;
}

enum neph_status neph_scene_build(const struct neph_raw_scene *raw, struct neph_document *document,
                                  const char *path, struct neph_scene **scene,
                                  struct neph_diag *diag)
{
    struct neph_scene *made = calloc(1, sizeof(*made));
    if (!made)
        return neph_fail_memory(diag);
    made->bake_resolution = raw->bake_resolution ? *raw->bake_resolution
                                                 : NEPH_BAKE_RESOLUTION_DEFAULT;
    made->exposure_ev = raw->display ? raw->display->exposure_ev : 0;
    build_light(raw, made);
    build_octaves(raw->octaves, made);
    enum neph_status status = neph_build_media(raw, document, path, made, diag);
    if (!status)
        status = build_texts(raw, path, made, diag);
    if (!status)
        status = neph_build_motion(raw, made, diag);
    if (!status)
        status = build_solids(raw, made, diag);
    if (!status)
        status = build_gates(raw, made, diag);
    if (status)
        neph_scene_destroy(made);
    else
        *scene = made;
    return status;
}
