/* SPDX-License-Identifier: MIT
 *
 * The changes that the reduction tries on a recipe, as a table, in the order of decreasing effect.
 */
#include "tests/random_scenes/recipe.h"

#include <math.h>
#include <string.h>

/* A change of the scene or of one of its media, lights or solids. False: it does not apply. */
typedef bool change_recipe(struct recipe *recipe, int at);

enum { SLOTS = RECIPE_SOLIDS_MAX };

static const struct neph_rgb grey = {0.5, 0.5, 0.5}, white = {1.0, 1.0, 1.0}, black = {0, 0, 0};

static bool is_same(struct neph_rgb a, struct neph_rgb b)
{
    return a.r == b.r && a.g == b.g && a.b == b.b;
}

static bool set_rgb(struct neph_rgb *color, struct neph_rgb value)
{
    const bool differs = !is_same(*color, value);
    *color = value;
    return differs;
}

static bool set_number(double *number, double value)
{
    const bool differs = *number != value;
    *number = value;
    return differs;
}

/* ---- removal --------------------------------------------------------------------------------- */

static bool remove_medium(struct recipe *recipe, int at)
{
    if (at >= recipe->medium_count)
        return false;
    recipe->medium_count--;
    for (int i = at; i < recipe->medium_count; i++)
        recipe->media[i] = recipe->media[i + 1];
    return true;
}

static bool remove_light(struct recipe *recipe, int at)
{
    if (at >= recipe->light_count)
        return false;
    recipe->light_count--;
    for (int i = at; i < recipe->light_count; i++)
        recipe->lights[i] = recipe->lights[i + 1];
    return true;
}

static bool remove_solid(struct recipe *recipe, int at)
{
    if (at >= recipe->solid_count)
        return false;
    recipe->solid_count--;
    for (int i = at; i < recipe->solid_count; i++)
        recipe->solids[i] = recipe->solids[i + 1];
    return true;
}

static bool remove_mesh(struct recipe *recipe, int at)
{
    if (at >= recipe->mesh_count)
        return false;
    recipe->mesh_count--;
    for (int i = at; i < recipe->mesh_count; i++)
        recipe->meshes[i] = recipe->meshes[i + 1];
    return true;
}

static bool stop_wind(struct recipe *recipe, int at)
{
    const bool had = recipe->has_wind;
    recipe->has_wind = false;
    return had && at == 0;
}

static bool stop_time(struct recipe *recipe, int at)
{
    if (recipe->frame == 0 || recipe->has_wind || at > 0)
        return false;
    recipe->frame = 0;
    return true;
}

static bool remove_sun(struct recipe *recipe, int at)
{
    const bool had = recipe->has_sun;
    recipe->has_sun = false;
    return had && at == 0;
}

static bool lower_scattering(struct recipe *recipe, int at)
{
    if (recipe->scattering == NEPH_SCATTERING_NONE || at > 0)
        return false;
    recipe->scattering = recipe->scattering == NEPH_SCATTERING_MULTIPLE ? NEPH_SCATTERING_SINGLE
                                                                        : NEPH_SCATTERING_NONE;
    return true;
}

static bool end_environment(struct recipe *recipe, int at)
{
    const bool had = recipe->environment_light;
    recipe->environment_light = false;
    return had && at == 0;
}

static bool darken_background(struct recipe *recipe, int at)
{
    return at == 0 && set_rgb(&recipe->background_w_per_m2_sr, black);
}

static bool see_in_perspective(struct recipe *recipe, int at)
{
    if (recipe->orthographic_height_m == 0.0 || at > 0)
        return false;
    recipe->orthographic_height_m = 0.0;
    recipe->vertical_fov_deg = 40.0;
    return true;
}

/* ---- simpler media --------------------------------------------------------------------------- */

static bool stop_emission(struct recipe *recipe, int at)
{
    return at < recipe->medium_count && set_rgb(&recipe->media[at].emission_w_per_m2_sr, black);
}

static bool make_medium_grey(struct recipe *recipe, int at)
{
    return at < recipe->medium_count && set_rgb(&recipe->media[at].color, white);
}

static bool set_albedo(struct recipe *recipe, int at)
{
    return at < recipe->medium_count && set_rgb(&recipe->media[at].albedo, grey);
}

static bool scatter_evenly(struct recipe *recipe, int at)
{
    if (at >= recipe->medium_count || recipe->media[at].phase.kind == NEPH_PHASE_ISOTROPIC)
        return false;
    recipe->media[at].phase = (struct neph_phase){NEPH_PHASE_ISOTROPIC, 0.0};
    return true;
}

static bool remove_layer(struct recipe *recipe, int at)
{
    if (at >= recipe->medium_count || recipe->media[at].layer_count < 2)
        return false;
    recipe->media[at].layer_count = 1;
    return true;
}

static bool remove_voxels(struct recipe *recipe, int at)
{
    if (at >= recipe->medium_count || recipe->media[at].voxels == 0)
        return false;
    recipe->media[at].voxels = 0;
    return true;
}

static bool remove_streaks(struct recipe *recipe, int at)
{
    if (at >= recipe->medium_count || !recipe->media[at].is_streaked)
        return false;
    recipe->media[at].is_streaked = false;
    return true;
}

static bool repeat_once(struct recipe *recipe, int at)
{
    bool differs = false;
    for (int i = 0; i < 3 && at < recipe->medium_count; i++) {
        int *repeat = &recipe->media[at].repeat[i];
        differs |= *repeat > 1;
        *repeat = *repeat > 1 ? 1 : *repeat;
    }
    return differs;
}

static bool fill_grid(struct recipe *recipe, int at)
{
    if (at >= recipe->medium_count ||
        (recipe->media[at].form != FORM_GRID && recipe->media[at].form != FORM_GRID_ENDLESS))
        return false;
    bool differs = false;
    const int *nodes = recipe->media[at].nodes;
    for (int i = 0; i < nodes[0] * nodes[1] * nodes[2]; i++)
        differs |= set_number(&recipe->media[at].values[i], 1.0);
    return differs;
}

static bool unbound(struct recipe *recipe, int at)
{
    if (at >= recipe->medium_count || !recipe->media[at].is_bounded)
        return false;
    const enum recipe_form form = recipe->media[at].form;
    if (form != FORM_GAUSSIAN_BOXED && form != FORM_GRID)
        return false;
    recipe->media[at].is_bounded = false;
    return true;
}

/* ---- simpler lights and solids --------------------------------------------------------------- */

static bool open_cone(struct recipe *recipe, int at)
{
    if (at >= recipe->light_count || !recipe->lights[at].is_spot)
        return false;
    recipe->lights[at].is_spot = false;
    return true;
}

static bool whiten_light(struct recipe *recipe, int at)
{
    return at < recipe->light_count && set_rgb(&recipe->lights[at].intensity_w_per_sr, white);
}

static bool stop_solid(struct recipe *recipe, int at)
{
    if (at >= recipe->solid_count || !recipe->solids[at].moves)
        return false;
    recipe->solids[at].moves = false;
    return true;
}

static bool blacken_solid(struct recipe *recipe, int at)
{
    return at < recipe->solid_count && set_rgb(&recipe->solids[at].albedo, black);
}

static bool grey_solid(struct recipe *recipe, int at)
{
    return at < recipe->solid_count && !is_same(recipe->solids[at].albedo, black) &&
           set_rgb(&recipe->solids[at].albedo, grey);
}

static bool blacken_mesh(struct recipe *recipe, int at)
{
    return at < recipe->mesh_count && set_rgb(&recipe->meshes[at].albedo, black);
}

static bool grey_mesh(struct recipe *recipe, int at)
{
    return at < recipe->mesh_count && !is_same(recipe->meshes[at].albedo, black) &&
           set_rgb(&recipe->meshes[at].albedo, grey);
}

static bool straighten_mesh(struct recipe *recipe, int at)
{
    return at < recipe->mesh_count && set_number(&recipe->meshes[at].turn_deg, 0.0);
}

static bool whiten_sun(struct recipe *recipe, int at)
{
    return at == 0 && recipe->has_sun && set_rgb(&recipe->sun_w_per_m2, white);
}

/* ---- rounder numbers ------------------------------------------------------------------------- */

/* To two decimal digits. */
static bool round_number(double *number)
{
    if (*number == 0.0 || !isfinite(*number))
        return false;
    const double unit = pow(10.0, floor(log10(fabs(*number))) - 1.0);
    return set_number(number, round(*number / unit) * unit);
}

static bool round_three(struct neph_vec3 *v)
{
    const bool x = round_number(&v->x), y = round_number(&v->y), z = round_number(&v->z);
    return x || y || z;
}

static bool round_camera(struct recipe *recipe, int at)
{
    if (at > 0)
        return false;
    const bool eye = round_three(&recipe->eye_m), ahead = round_three(&recipe->look_at_m);
    const bool fov = round_number(&recipe->vertical_fov_deg);
    return round_number(&recipe->orthographic_height_m) || eye || ahead || fov;
}

static bool round_sun(struct recipe *recipe, int at)
{
    return at == 0 && recipe->has_sun && round_three(&recipe->sun_direction);
}

static bool round_light(struct recipe *recipe, int at)
{
    return at < recipe->light_count && round_three(&recipe->lights[at].position_m);
}

static bool round_solid(struct recipe *recipe, int at)
{
    if (at >= recipe->solid_count)
        return false;
    struct recipe_solid *solid = &recipe->solids[at];
    const bool low = round_three(&solid->box.min_m), high = round_three(&solid->box.max_m);
    const bool center = round_three(&solid->center_m);
    return round_number(&solid->radius_m) || low || high || center;
}

static bool round_mesh(struct recipe *recipe, int at)
{
    if (at >= recipe->mesh_count)
        return false;
    struct recipe_mesh *mesh = &recipe->meshes[at];
    bool differs = round_three(&mesh->position_m);
    for (int i = 0; i < RECIPE_CORNERS_MAX; i++)
        differs |= round_three(&mesh->corners[i]);
    return round_number(&mesh->scale_m) || differs;
}

static bool round_medium(struct recipe *recipe, int at)
{
    if (at >= recipe->medium_count)
        return false;
    struct recipe_medium *medium = &recipe->media[at];
    double *const numbers[] = {&medium->extinction_per_m,
                               &medium->width_m,
                               &medium->scale_m,
                               &medium->altitude_m,
                               &medium->layers[0].extinction_per_m,
                               &medium->layers[0].falloff_per_m,
                               &medium->layers[0].height_m};
    bool differs = false;
    for (size_t i = 0; i < sizeof(numbers) / sizeof(numbers[0]); i++)
        differs |= round_number(numbers[i]);
    differs |= round_three(&medium->bounds.min_m);
    differs |= round_three(&medium->bounds.max_m);
    differs |= round_three(&medium->center_m);
    differs |= round_three(&medium->origin_m);
    return round_three(&medium->spacing_m) || differs;
}

/* ---- table ----------------------------------------------------------------------------------- */

static change_recipe *const changes[] = {
    remove_medium,     remove_solid,     remove_mesh,     remove_light,       stop_wind,
    stop_time,         lower_scattering, remove_sun,      end_environment,    stop_solid,
    darken_background, remove_layer,     remove_voxels,   see_in_perspective, open_cone,
    stop_emission,     make_medium_grey, set_albedo,      scatter_evenly,     repeat_once,
    fill_grid,         remove_streaks,   unbound,         blacken_solid,      grey_solid,
    blacken_mesh,      grey_mesh,        straighten_mesh, whiten_light,       whiten_sun,
    round_camera,      round_sun,        round_medium,    round_light,        round_solid,
    round_mesh,
};

int recipe_change_count(void)
{
    return (int)(sizeof(changes) / sizeof(changes[0])) * SLOTS;
}

bool recipe_simplify(struct recipe *recipe, int change)
{
    return changes[change / SLOTS](recipe, change % SLOTS);
}
