/* SPDX-License-Identifier: MIT */
#include "renderer/sky/air.h"

#include "scenes/media.h"
#include "scenes/solids.h"
#include "scenes/surfaces.h"

#include <math.h>
#include <stdio.h>

/* Does not compile with a new kind: this file then needs a change. */
_Static_assert(NEPH_MEDIUM_KIND_COUNT == 8, "a new kind");
_Static_assert(NEPH_SOLID_KIND_COUNT == 3, "a new kind");

/* Top of an exponential layer; e^-14 = 8e-7 of its density is left there. */
static const double top_scale_heights = 14.0;

/* --- supported scenes ------------------------------------------------------------------------- */

static bool is_same_point(struct neph_vec3 a, struct neph_vec3 b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

/* NULL: none. */
static const char *find_medium_obstacle(const struct neph_medium *medium,
                                        const struct neph_solid *ground)
{
    const bool is_tent = medium->kind == NEPH_MEDIUM_TENT;
    if (!is_tent && medium->kind != NEPH_MEDIUM_SHELL)
        return "a medium that is not a layer around a sphere: march and realtime can render such "
               "media in air from tables with sky=tables";
    const struct neph_vec3 center_m = is_tent ? medium->tent.center_m : medium->shell.center_m;
    const double radius_m = is_tent ? medium->tent.radius_m : medium->shell.radius_m;
    if (!is_same_point(center_m, ground->center_m) || radius_m != ground->radius_m)
        return "layers that are not around the sphere of the ground";
    if (medium->emission_w_per_m2_sr.r > 0.0 || medium->emission_w_per_m2_sr.g > 0.0 ||
        medium->emission_w_per_m2_sr.b > 0.0)
        return "a medium that emits light";
    if (!neph_phase_is_in_shaders(medium->phase.kind))
        return "a phase function other than isotropic, Henyey-Greenstein and Rayleigh";
    return NULL;
}

/* Whether bounds cut off more of a layer than the container of the medium would. */
static bool is_layer_cut(const struct neph_medium *medium)
{
    struct neph_medium whole = *medium;
    double lost;
    whole.bounds = (struct neph_bounds){{-INFINITY, -INFINITY, -INFINITY},
                                        {INFINITY, INFINITY, INFINITY}};
    const struct neph_bounds box = neph_medium_container(&(struct neph_scene){0}, &whole, &lost);
    const struct neph_bounds *bounds = &medium->bounds;
    return neph_is_turned(&medium->turn) || bounds->min_m.x > box.min_m.x ||
           bounds->min_m.y > box.min_m.y || bounds->min_m.z > box.min_m.z ||
           bounds->max_m.x < box.max_m.x || bounds->max_m.y < box.max_m.y ||
           bounds->max_m.z < box.max_m.z;
}

static bool is_black(struct neph_rgb color)
{
    return color.r == 0.0 && color.g == 0.0 && color.b == 0.0;
}

static const char *find_air_obstacle(const struct neph_scene *scene)
{
    if (scene->medium_count == 0)
        return "a scene without an atmosphere";
    if (scene->solid_count == 0 || scene->solids[0].kind != NEPH_SOLID_SPHERE)
        return "a first solid that is not a sphere, the ground";
    if (!is_black(scene->background_w_per_m2_sr))
        return "a background behind the atmosphere";
    if (neph_surfaces_obstacle(scene))
        return neph_surfaces_obstacle(scene);
    if (scene->light_count > 0)
        return "lights other than the sun";
    for (int i = 0; i < scene->medium_count; i++) {
        const char *obstacle = find_medium_obstacle(&scene->media[i], &scene->solids[0]);
        if (!obstacle && is_layer_cut(&scene->media[i]))
            obstacle = "bounds that cut the atmosphere";
        if (obstacle)
            return obstacle;
    }
    return NULL;
}

/* --- layers ----------------------------------------------------------------------------------- */

static struct neph_sky_layer convert_layer(const struct neph_medium *medium)
{
    const bool is_tent = medium->kind == NEPH_MEDIUM_TENT;
    struct neph_sky_layer layer = {
        .is_tent = is_tent,
        .middle_m = is_tent ? medium->tent.altitude_m : 0.0,
        .scale_m = is_tent ? medium->tent.half_width_m : medium->shell.scale_height_m,
        .phase = medium->phase,
    };
    const double *color = &medium->extinction_color.r, *albedo = &medium->albedo.r;
    for (int c = 0; c < 3; c++) {
        layer.extinction_per_m[c] = medium->extinction_per_m * color[c];
        layer.scattering_per_m[c] = layer.extinction_per_m[c] * albedo[c];
    }
    for (int l = 0; l <= NEPH_SKY_DEGREE_MAX; l++)
        layer.legendre[l] = neph_phase_moment(&medium->phase, l);
    return layer;
}

static double compute_layer_top(const struct neph_sky_layer *layer)
{
    return layer->is_tent ? layer->middle_m + layer->scale_m : top_scale_heights * layer->scale_m;
}

bool neph_sky_read_air(const struct neph_scene *scene, struct neph_sky_air *air, char *reason,
                       size_t reason_size)
{
    const char *obstacle = find_air_obstacle(scene);
    if (obstacle) {
        snprintf(reason, reason_size, "%s", obstacle);
        return false;
    }
    const struct neph_solid *ground = &scene->solids[0];
    *air = (struct neph_sky_air){
        .radius_m = ground->radius_m,
        .ground_albedo = {ground->albedo.r, ground->albedo.g, ground->albedo.b},
        .layer_count = scene->medium_count,
        .center_m = ground->center_m,
    };
    for (int i = 0; i < air->layer_count; i++) {
        air->layers[i] = convert_layer(&scene->media[i]);
        air->top_m = fmax(air->top_m, compute_layer_top(&air->layers[i]));
    }
    return true;
}

/* --- densities -------------------------------------------------------------------------------- */

static double density_at(const struct neph_sky_layer *layer, double altitude_m)
{
    if (layer->is_tent)
        return fmax(0.0, 1.0 - fabs(altitude_m - layer->middle_m) / layer->scale_m);
    return exp(-fmax(0.0, altitude_m) / layer->scale_m);
}

struct neph_sky_coefficients neph_sky_coefficients_at(const struct neph_sky_air *air,
                                                      double altitude_m)
{
    struct neph_sky_coefficients mix = {.extinction_per_m = {0, 0, 0}};
    for (int i = 0; i < air->layer_count; i++) {
        const struct neph_sky_layer *layer = &air->layers[i];
        const double density = density_at(layer, altitude_m);
        for (int c = 0; c < 3; c++) {
            mix.extinction_per_m[c] += density * layer->extinction_per_m[c];
            mix.scattering_per_m[i][c] = density * layer->scattering_per_m[c];
        }
    }
    return mix;
}

/* The layer as a medium around the origin, with extinction 1 at density 1. */
static struct neph_medium make_unit_medium(const struct neph_sky_layer *layer, double radius_m)
{
    struct neph_medium medium = {
        .kind = layer->is_tent ? NEPH_MEDIUM_TENT : NEPH_MEDIUM_SHELL,
        .bounds = {{-INFINITY, -INFINITY, -INFINITY}, {INFINITY, INFINITY, INFINITY}},
        .extinction_per_m = 1.0,
        .shell = {{0, 0, 0}, radius_m, layer->scale_m},
        .tent = {{0, 0, 0}, radius_m, layer->middle_m, layer->scale_m},
    };
    return medium;
}

void neph_sky_depth_to_space(const struct neph_sky_air *air, double altitude_m, double cosine,
                             double depth[3])
{
    const struct neph_vec3 origin_m = {0.0, air->radius_m + altitude_m, 0.0};
    const struct neph_vec3 direction = {sqrt(fmax(0.0, 1.0 - cosine * cosine)), cosine, 0.0};
    depth[0] = depth[1] = depth[2] = 0.0;
    for (int i = 0; i < air->layer_count; i++) {
        const struct neph_medium medium = make_unit_medium(&air->layers[i], air->radius_m);
        const double column_m = neph_medium_optical_depth(&medium, origin_m, direction, 0.0,
                                                          INFINITY);
        for (int c = 0; c < 3; c++)
            depth[c] += column_m * air->layers[i].extinction_per_m[c];
    }
}
