/* SPDX-License-Identifier: MIT */
#include "harness/engines/cycles_surface.h"

#include "harness/engines/cycles_layers.h"

#include <math.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_PATTERN_COUNT == 2, "a new kind");

/* The texture image of a checker has one pixel per square. The image of a noise has one pixel per
 * value, with bilinear interpolation. */
enum { CHECKER_SIDE = 2 };

const char *neph_cycles_surface_obstacle(const struct neph_scene *scene)
{
    if (!scene->sun.present && scene->light_count == 0)
        return NULL;
    for (int i = 0; i < scene->solid_count; i++)
        if (neph_is_mirror(&scene->solids[i].surface))
            return "sun or lights with a mirror: Cycles does not find their reflected light on "
                   "other solids";
    return NULL;
}

static json_t *pixels_json(const struct neph_paint *texture, int side)
{
    json_t *pixels = json_array();
    for (int j = 0; j < side; j++)
        for (int i = 0; i < side; i++)
            neph_json_add(&pixels, json_real(neph_paint_value(texture, i, j)));
    return pixels;
}

static json_t *texture_json(const struct neph_paint *texture)
{
    if (!(texture->cell_m > 0.0))
        return json_null();
    const bool is_smooth = texture->pattern == NEPH_PATTERN_NOISE;
    const int side = is_smooth ? NEPH_NOISE_CELLS : CHECKER_SIDE;
    return json_pack("{s:f, s:b, s:i, s:o, s:[fff]}", "cell_m", texture->cell_m, "is_smooth",
                     is_smooth, "side", side, "pixels", pixels_json(texture, side), "other",
                     texture->other.r, texture->other.g, texture->other.b);
}

json_t *neph_cycles_surface(const struct neph_surface *surface)
{
    if (surface->metalness == 0.0 && !neph_is_textured(surface))
        return json_null();
    return json_pack("{s:f, s:f, s:o}", "metalness", surface->metalness, "roughness",
                     surface->roughness, "texture", texture_json(&surface->texture));
}

/* ---- layers ---------------------------------------------------------------------------------- */

static enum neph_status copy_layer(const struct neph_image *picture, const char *from,
                                   struct neph_image *frame, const char *to, struct neph_diag *diag)
{
    float *source[3], *target[3];
    enum neph_status status = neph_cycles_layer(picture, from, source, diag);
    if (!status)
        status = neph_image_add_rgb(frame, to, target, diag);
    for (int j = 0; j < 3 && !status; j++)
        for (size_t p = 0; p < neph_image_pixel_count(frame); p++) {
            if (!isfinite(source[j][p]))
                return neph_fail(diag, NEPH_ERR_ENGINE,
                                 "Blender's layer pass.%s has a value that is not finite", from);
            target[j][p] = source[j][p];
        }
    return status;
}

/* Set pixels whose centre hits no solid to `value`. One in a thousand of their samples may still
 * hit one, and Blender divides that light by the small colour value. */
static void clear_sky(const float *depth, struct neph_image *frame, const char *layer, float value)
{
    static const float sky_units = 1e10f;
    float *samples[3];
    if (!neph_image_rgb(frame, layer, samples))
        return;
    for (size_t p = 0; p < neph_image_pixel_count(frame); p++)
        for (int j = 0; j < 3 && depth[p] >= sky_units; j++)
            samples[j][p] = value;
}

enum neph_status neph_cycles_surface_layers(const struct neph_image *picture,
                                            struct neph_image *frame, struct neph_diag *diag)
{
    static const struct {
        const char *from, *to;
        float sky;
    } layers[] = {
        {"DiffDir", "diffuse_direct", 0},
        {"DiffInd", "diffuse_indirect", 0},
        {"GlossDir", "glossy_direct", 0},
        {"GlossInd", "glossy_indirect", 0},
        {"DiffCol", "diffuse_color", 0},
        {"GlossCol", "glossy_color", 0},
        {"AO", "ao", 1},
    };
    const float *depth = NULL;
    enum neph_status status = neph_cycles_depth(picture, &depth, diag);
    for (size_t i = 0; i < sizeof(layers) / sizeof(layers[0]) && !status; i++) {
        status = copy_layer(picture, layers[i].from, frame, layers[i].to, diag);
        if (!status)
            clear_sky(depth, frame, layers[i].to, layers[i].sky);
    }
    return status;
}
