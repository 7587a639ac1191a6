/* SPDX-License-Identifier: MIT
 *
 * Draws recipes from tables and distributions. Lengths are in units of the scene's scale, so that
 * the same shapes occur in millimetres and in kilometres.
 */
#include "tests/random_scenes/recipe.h"

#include "base/hash.h"
#include "scenes/motion.h"

#include <math.h>
#include <string.h>

static const char *const form_names[FORM_COUNT] = {
    [FORM_HOMOGENEOUS] = "homogeneous",
    [FORM_FOG_OPEN] = "height fog",
    [FORM_FOG_BOXED] = "height fog with bounds",
    [FORM_FOG_TWO_LAYERS] = "height fog of two layers",
    [FORM_GAUSSIAN] = "Gaussian",
    [FORM_GAUSSIAN_BOXED] = "Gaussian with bounds",
    [FORM_SHELL] = "shell",
    [FORM_TENT] = "tent",
    [FORM_GRID] = "grid",
    [FORM_GRID_ENDLESS] = "endless grid",
    [FORM_SHEET] = "sheet",
    [FORM_PLUME] = "plume",
    [FORM_HORIZON] = "horizon",
};

const char *recipe_form_name(enum recipe_form form)
{
    return form_names[form];
}

/* ---- random numbers -------------------------------------------------------------------------- */

struct dice {
    uint64_t state;
};

static uint64_t next_bits(struct dice *dice)
{
    uint64_t z = (dice->state += 0x9e3779b97f4a7c15u); /* splitmix64 */
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static double uniform(struct dice *dice, double low, double high)
{
    return low + (high - low) * (double)(next_bits(dice) >> 11) * 0x1p-53;
}

static double log_uniform(struct dice *dice, double low, double high)
{
    return exp(uniform(dice, log(low), log(high)));
}

static bool happens(struct dice *dice, double probability)
{
    return uniform(dice, 0.0, 1.0) < probability;
}

static int whole(struct dice *dice, int low, int high)
{
    return low + (int)(next_bits(dice) % (uint64_t)(high - low + 1));
}

static struct neph_vec3 in_cube(struct dice *dice, double half)
{
    return (struct neph_vec3){uniform(dice, -half, half), uniform(dice, -half, half),
                              uniform(dice, -half, half)};
}

static struct neph_vec3 any_direction(struct dice *dice)
{
    const double y = uniform(dice, -1.0, 1.0), azimuth = uniform(dice, 0.0, 2.0 * M_PI);
    const double across = sqrt(1.0 - y * y);
    return (struct neph_vec3){across * cos(azimuth), y, across * sin(azimuth)};
}

static struct neph_rgb any_color(struct dice *dice, double low, double high)
{
    return (struct neph_rgb){uniform(dice, low, high), uniform(dice, low, high),
                             uniform(dice, low, high)};
}

static struct neph_rgb times(struct neph_rgb c, double factor)
{
    return (struct neph_rgb){c.r * factor, c.g * factor, c.b * factor};
}

static struct neph_vec3 along(struct neph_vec3 from, struct neph_vec3 direction, double by)
{
    return neph_vec3_add(from, neph_vec3_scale(direction, by));
}

/* ---- selection of forms ---------------------------------------------------------------------- */

enum {
    SINGLES = FORM_COUNT,
    PAIRS = FORM_COUNT * (FORM_COUNT + 1) / 2,                      /* with itself, too */
    TRIPLES = FORM_COUNT * (FORM_COUNT - 1) * (FORM_COUNT - 2) / 6, /* different ones */
    PERIOD = SINGLES + PAIRS + TRIPLES,
    STRIDE = 149, /* coprime to PERIOD: neighbours differ */
};

int recipe_period(void)
{
    return PERIOD;
}

static int find_triple(int at, enum recipe_form forms[RECIPE_MEDIA_MAX])
{
    for (int a = 0; a < FORM_COUNT; a++)
        for (int b = a + 1; b < FORM_COUNT; b++)
            for (int c = b + 1; c < FORM_COUNT; c++)
                if (at-- == 0) {
                    forms[0] = (enum recipe_form)a;
                    forms[1] = (enum recipe_form)b;
                    forms[2] = (enum recipe_form)c;
                    return 3;
                }
    return 0;
}

static int find_pair(int at, enum recipe_form forms[RECIPE_MEDIA_MAX])
{
    for (int a = 0; a < FORM_COUNT; a++)
        for (int b = a; b < FORM_COUNT; b++)
            if (at-- == 0) {
                forms[0] = (enum recipe_form)a;
                forms[1] = (enum recipe_form)b;
                return 2;
            }
    return 0;
}

static int find_forms(int index, enum recipe_form forms[RECIPE_MEDIA_MAX])
{
    const int at = (int)((int64_t)index * STRIDE % PERIOD);
    if (at < SINGLES) {
        forms[0] = (enum recipe_form)at;
        return 1;
    }
    return at < SINGLES + PAIRS ? find_pair(at - SINGLES, forms)
                                : find_triple(at - SINGLES - PAIRS, forms);
}

/* ---- media ----------------------------------------------------------------------------------- */

/* Common values of all media of a scene. */
struct stage {
    double scale_m;
    struct neph_vec3 eye_m, ahead, center_m; /* center_m: of the camera's target */
    struct neph_vec3 planet_m;
    double planet_radius_m, eye_altitude_m;
    bool eye_in_media, eye_on_face;
};

/* Most media are neither clear nor opaque; some are almost one of them. */
static double any_depth(struct dice *dice)
{
    const double kind = uniform(dice, 0.0, 1.0);
    return kind < 0.08  ? log_uniform(dice, 1e-5, 1e-2)
           : kind < 0.9 ? log_uniform(dice, 0.05, 3.0)
                        : log_uniform(dice, 3.0, 30.0);
}

static struct neph_vec3 near_center(struct dice *dice, const struct stage *stage)
{
    return neph_vec3_add(stage->center_m, in_cube(dice, 0.7 * stage->scale_m));
}

static struct neph_bounds any_box(struct dice *dice, const struct stage *stage)
{
    const double scale_m = stage->scale_m;
    const struct neph_vec3 half_m = {scale_m * uniform(dice, 0.3, 1.3),
                                     scale_m * uniform(dice, 0.3, 1.3),
                                     scale_m * uniform(dice, 0.3, 1.3)};
    const struct neph_vec3 center_m = stage->eye_in_media && happens(dice, 0.6)
                                          ? along(stage->eye_m, stage->ahead, 0.3 * scale_m)
                                          : near_center(dice, stage);
    struct neph_bounds box = {neph_vec3_sub(center_m, half_m), neph_vec3_add(center_m, half_m)};
    if (!stage->eye_on_face)
        return box;
    /* One face goes exactly through the eye. */
    const double *eye = &stage->eye_m.x, *ahead = &stage->ahead.x;
    double *low = &box.min_m.x, *high = &box.max_m.x;
    int axis = 0;
    for (int i = 0; i < 3; i++) {
        low[i] = fmin(low[i], eye[i] - 0.3 * scale_m);
        high[i] = fmax(high[i], eye[i] + 0.3 * scale_m);
        axis = fabs(ahead[i]) > fabs(ahead[axis]) ? i : axis;
    }
    if (ahead[axis] > 0.0)
        low[axis] = eye[axis];
    else
        high[axis] = eye[axis];
    return box;
}

static double box_size_m(const struct neph_bounds *box)
{
    const struct neph_vec3 size_m = neph_vec3_sub(box->max_m, box->min_m);
    return cbrt(size_m.x * size_m.y * size_m.z);
}

static struct neph_phase any_phase(struct dice *dice)
{
    static const double asymmetries[] = {-0.9, -0.4, 0.1, 0.5, 0.76, 0.9};
    struct neph_phase phase = {NEPH_PHASE_ISOTROPIC, 0.0};
    const int kind = whole(dice, 0, 3);
    if (kind == 1)
        phase.kind = NEPH_PHASE_RAYLEIGH;
    if (kind > 1)
        phase = (struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, asymmetries[whole(dice, 0, 5)]};
    return phase;
}

static void draw_optics(struct dice *dice, bool is_open, struct recipe_medium *medium)
{
    /* With all orders of scattering in an infinite fog, absorption limits the length of paths. */
    const double most = is_open ? 0.9 : 1.0;
    const int kind = whole(dice, 0, 4);
    medium->albedo = any_color(dice, 0.3, 0.95 * most);
    if (kind == 0)
        medium->albedo = (struct neph_rgb){most, most, most};
    if (kind == 1)
        medium->albedo = (struct neph_rgb){0, 0, 0};
    medium->color = happens(dice, 0.4) ? any_color(dice, 0.2, 1.5) : (struct neph_rgb){1, 1, 1};
    if (happens(dice, 0.12))
        medium->emission_w_per_m2_sr = any_color(dice, 0.0, 1.0);
    medium->phase = any_phase(dice);
}

static void draw_fog(struct dice *dice, const struct stage *stage, struct recipe_medium *medium)
{
    const double scale_m = stage->scale_m;
    medium->is_bounded = medium->form == FORM_FOG_BOXED;
    medium->layer_count = medium->form == FORM_FOG_TWO_LAYERS ? 2 : happens(dice, 0.2) ? 2 : 1;
    if (medium->form == FORM_FOG_OPEN)
        medium->layer_count = 1;
    if (medium->is_bounded)
        medium->bounds = any_box(dice, stage);
    for (int i = 0; i < medium->layer_count; i++) {
        struct neph_fog_layer *layer = &medium->layers[i];
        layer->extinction_per_m = 0.4 * any_depth(dice) / scale_m;
        layer->falloff_per_m = fmin(log_uniform(dice, 0.2, 4.0) / scale_m, 10.0);
        layer->height_m = stage->eye_m.y + scale_m * uniform(dice, -1.5, 0.5);
        if (happens(dice, 0.05))
            layer->falloff_per_m = 0.0;
    }
}

static void draw_ball_layer(struct dice *dice, const struct stage *stage,
                            struct recipe_medium *medium)
{
    const double scale_m = stage->scale_m;
    medium->center_m = stage->planet_m;
    medium->radius_m = stage->planet_radius_m;
    medium->scale_m = scale_m * uniform(dice, 0.2, 1.0);
    medium->altitude_m = scale_m * uniform(dice, 0.4, 2.0);
    if (medium->form == FORM_TENT)
        medium->scale_m = medium->altitude_m * uniform(dice, 0.3, 1.0);
    /* The approximate length of a level ray in it. */
    const double way_m = sqrt(2.0 * M_PI * medium->radius_m * medium->scale_m);
    medium->extinction_per_m = any_depth(dice) / way_m;
    const double half_m = medium->radius_m + 15.0 * medium->scale_m + medium->altitude_m;
    const struct neph_vec3 half = {half_m, half_m, half_m};
    medium->is_bounded = medium->form == FORM_SHELL;
    medium->bounds = (struct neph_bounds){neph_vec3_sub(medium->center_m, half),
                                          neph_vec3_add(medium->center_m, half)};
}

static void draw_values(struct dice *dice, struct recipe_medium *medium)
{
    const double low = happens(dice, 0.3) ? 0.2 : -0.4;
    const int count = medium->nodes[0] * medium->nodes[1] * medium->nodes[2];
    bool is_empty = true;
    for (int i = 0; i < count; i++) {
        medium->values[i] = (double)(float)fmax(0.0, uniform(dice, low, 1.0));
        is_empty &= medium->values[i] == 0.0;
    }
    if (is_empty)
        medium->values[0] = 1.0;
}

static void draw_grid(struct dice *dice, const struct stage *stage, struct recipe_medium *medium)
{
    const struct neph_bounds box = any_box(dice, stage);
    const struct neph_vec3 size_m = neph_vec3_sub(box.max_m, box.min_m);
    for (int i = 0; i < 3; i++) {
        medium->nodes[i] = whole(dice, 1, 4);
        medium->repeat[i] = happens(dice, 0.25) ? whole(dice, 2, 3) : 1;
    }
    if (medium->form == FORM_GRID_ENDLESS)
        medium->repeat[0] = medium->repeat[2] = 0;
    medium->origin_m = box.min_m;
    const int *nodes = medium->nodes, *repeat = medium->repeat;
    medium->spacing_m = (struct neph_vec3){size_m.x / (nodes[0] * fmax(1, repeat[0])),
                                           size_m.y / (nodes[1] * fmax(1, repeat[1])),
                                           size_m.z / (nodes[2] * fmax(1, repeat[2]))};
    medium->extinction_per_m = 1.5 * any_depth(dice) / box_size_m(&box);
    if (happens(dice, 0.15) && medium->form == FORM_GRID) {
        medium->is_bounded = true;
        medium->bounds = any_box(dice, stage);
    }
    draw_values(dice, medium);
}

static void draw_shape(struct dice *dice, const struct stage *stage, struct recipe_medium *medium)
{
    const double scale_m = stage->scale_m;
    switch (medium->form) {
    case FORM_HOMOGENEOUS:
        medium->is_bounded = true;
        medium->bounds = any_box(dice, stage);
        medium->extinction_per_m = any_depth(dice) / box_size_m(&medium->bounds);
        break;
    case FORM_FOG_OPEN:
    case FORM_FOG_BOXED:
    case FORM_FOG_TWO_LAYERS:
        draw_fog(dice, stage, medium);
        break;
    case FORM_GAUSSIAN:
    case FORM_GAUSSIAN_BOXED:
        medium->center_m = stage->eye_in_media ? stage->eye_m : near_center(dice, stage);
        medium->width_m = scale_m * uniform(dice, 0.15, 0.7);
        medium->extinction_per_m = any_depth(dice) / (2.5 * medium->width_m);
        medium->is_bounded = medium->form == FORM_GAUSSIAN_BOXED;
        medium->bounds = any_box(dice, stage);
        if (happens(dice, 0.15))
            medium->voxels = whole(dice, 3, 8);
        break;
    case FORM_SHELL:
    case FORM_TENT:
        draw_ball_layer(dice, stage, medium);
        break;
    case FORM_GRID:
    case FORM_GRID_ENDLESS:
        draw_grid(dice, stage, medium);
        break;
    case FORM_SHEET:
        medium->center_m = near_center(dice, stage);
        medium->width_m = scale_m * uniform(dice, 1.0, 5.0);
        medium->scale_m = scale_m * uniform(dice, 0.1, 0.6);
        medium->extinction_per_m = any_depth(dice);
        medium->nodes[0] = whole(dice, 4, 16);
        medium->is_streaked = happens(dice, 0.5);
        medium->seed = whole(dice, 0, 1000);
        break;
    case FORM_PLUME:
        medium->axis = any_direction(dice);
        medium->center_m = along(near_center(dice, stage), medium->axis, -0.5 * scale_m);
        medium->width_m = scale_m * uniform(dice, 0.15, 0.6);
        medium->scale_m = scale_m * uniform(dice, 0.3, 1.5);
        medium->extinction_per_m = any_depth(dice) / (2.5 * medium->width_m);
        break;
    case FORM_HORIZON: /* the default layer, of 80 to 360 m */
        medium->is_bounded = true;
        medium->bounds = (struct neph_bounds){{-600.0, 50.0, -1200.0}, {600.0, 400.0, 0.0}};
        medium->extinction_per_m = 0.01 * any_depth(dice);
        medium->seed = whole(dice, 0, 1000);
        break;
    case FORM_COUNT:
        break;
    }
}

static bool is_open(enum recipe_form form)
{
    return form == FORM_FOG_OPEN || form == FORM_FOG_TWO_LAYERS || form == FORM_GRID_ENDLESS;
}

/* ---- light ----------------------------------------------------------------------------------- */

static struct recipe_light any_light(struct dice *dice, const struct stage *stage)
{
    const double scale_m = stage->scale_m;
    struct recipe_light light = {.is_spot = happens(dice, 0.4)};
    light.position_m = neph_vec3_add(stage->center_m, in_cube(dice, 2.0 * scale_m));
    light.intensity_w_per_sr = times(any_color(dice, 0.2, 4.0), scale_m * scale_m);
    light.axis = neph_vec3_sub(neph_vec3_add(stage->center_m, in_cube(dice, 0.5 * scale_m)),
                               light.position_m);
    light.axis = neph_vec3_normalize(light.axis);
    light.inner_deg = uniform(dice, 0.0, 50.0);
    light.outer_deg = light.inner_deg + uniform(dice, 1.0, 60.0);
    return light;
}

/* Lights whose distance to a camera ray is small or 0. */
enum nearness {
    NEAR_EYE, /* 1e-6 to 0.1 m from the eye */
    NEAR_RAY, /* likewise, from the ray of a pixel */
    AT_EYE,   /* exactly, where there is no medium */
    ON_RAY,   /* exactly, where there is no medium */
    NEARNESS_COUNT,
};

/* A light on a ray needs a place without medium: media ahead begin no nearer than this. */
static const double clear_air = 0.8;

static void move_near_ray(struct dice *dice, const struct recipe *recipe, enum nearness nearness,
                          struct recipe_light *light)
{
    const struct neph_camera camera = recipe_camera(recipe);
    const struct neph_pixel_ray ray = neph_camera_ray(&camera, RECIPE_WIDTH_PX, RECIPE_HEIGHT_PX,
                                                      whole(dice, 0, RECIPE_WIDTH_PX - 1),
                                                      whole(dice, 0, RECIPE_HEIGHT_PX - 1));
    const double at = nearness == ON_RAY ? uniform(dice, 0.05, clear_air) : uniform(dice, 0.2, 5.0);
    const double off_m = log_uniform(dice, 1e-6, 1e-1);
    const bool is_exact = nearness == AT_EYE || nearness == ON_RAY;
    light->position_m = nearness == NEAR_EYE || nearness == AT_EYE
                            ? recipe->eye_m
                            : along(ray.origin_m, ray.direction, at * recipe->scale_m);
    if (!is_exact)
        light->position_m = along(light->position_m, any_direction(dice), off_m);
    if (light->is_spot)
        light->axis = along(ray.direction, any_direction(dice), 0.2);
}

static void draw_lights(struct dice *dice, const struct stage *stage, bool is_near,
                        struct recipe *recipe)
{
    recipe->light_count = happens(dice, 0.45) ? whole(dice, 1, RECIPE_LIGHTS_MAX) : 0;
    if (is_near && recipe->light_count == 0)
        recipe->light_count = 1;
    for (int i = 0; i < recipe->light_count; i++)
        recipe->lights[i] = any_light(dice, stage);
    recipe->has_near_light = is_near;
    if (is_near)
        move_near_ray(dice, recipe, (enum nearness)whole(dice, 0, NEARNESS_COUNT - 1),
                      &recipe->lights[0]);
    recipe->has_sun = happens(dice, recipe->light_count > 0 ? 0.4 : 0.9);
    recipe->sun_direction = any_direction(dice);
    if (happens(dice, 0.8))
        recipe->sun_direction.y = fabs(recipe->sun_direction.y);
    recipe->sun_w_per_m2 = any_color(dice, 1.0, 10.0);
    recipe->background_w_per_m2_sr = happens(dice, 0.6) ? any_color(dice, 0.0, 0.5)
                                                        : (struct neph_rgb){0, 0, 0};
    recipe->environment_light = recipe->scattering != NEPH_SCATTERING_NONE && happens(dice, 0.12);
}

/* ---- solids ---------------------------------------------------------------------------------- */

static struct recipe_solid any_solid(struct dice *dice, const struct stage *stage)
{
    const double scale_m = stage->scale_m;
    struct recipe_solid solid = {.kind = (enum recipe_solid_kind)whole(dice, 0, 2),
                                 .albedo = any_color(dice, 0.0, 0.9),
                                 .axis = "xyz"[whole(dice, 0, 2)]};
    const struct neph_vec3 half_m = {scale_m * uniform(dice, 0.05, 0.6),
                                     scale_m * uniform(dice, 0.05, 0.6),
                                     scale_m * uniform(dice, 0.05, 0.6)};
    solid.center_m = neph_vec3_add(stage->center_m, in_cube(dice, 1.2 * scale_m));
    solid.radius_m = scale_m * uniform(dice, 0.1, 0.6);
    solid.box = (struct neph_bounds){neph_vec3_sub(solid.center_m, half_m),
                                     neph_vec3_add(solid.center_m, half_m)};
    solid.bars = whole(dice, 2, 6);
    solid.pitch_m = scale_m * uniform(dice, 0.1, 0.4);
    solid.height_m = scale_m * uniform(dice, 0.3, 1.5);
    solid.moves = solid.kind != RECIPE_FENCE && happens(dice, 0.3);
    solid.move_m = in_cube(dice, 0.4 * scale_m);
    solid.turn_deg = uniform(dice, -180.0, 180.0);
    return solid;
}

/* A floor below the eye. */
static struct recipe_solid any_ground(struct dice *dice, const struct stage *stage)
{
    const double scale_m = stage->scale_m;
    const double top_m = stage->eye_m.y - scale_m * uniform(dice, 0.3, 1.5);
    const double half_m = scale_m * log_uniform(dice, 3.0, 100.0);
    return (struct recipe_solid){
        .kind = RECIPE_BOX,
        .box = {{stage->eye_m.x - half_m, top_m - scale_m, stage->eye_m.z - half_m},
                {stage->eye_m.x + half_m, top_m, stage->eye_m.z + half_m}},
        .albedo = any_color(dice, 0.0, 0.9),
        .axis = 'y',
    };
}

static void draw_solids(struct dice *dice, const struct stage *stage, bool has_planet,
                        struct recipe *recipe)
{
    const int count = happens(dice, 0.5) ? whole(dice, 1, RECIPE_SOLIDS_MAX - 2) : 0;
    for (int i = 0; i < count; i++)
        recipe->solids[recipe->solid_count++] = any_solid(dice, stage);
    if (has_planet && happens(dice, 0.6))
        recipe->solids[recipe->solid_count++] = (struct recipe_solid){
            .kind = RECIPE_SPHERE,
            .center_m = stage->planet_m,
            .radius_m = stage->planet_radius_m,
            .albedo = any_color(dice, 0.0, 0.9),
            .axis = 'y',
        };
    else if (happens(dice, 0.3))
        recipe->solids[recipe->solid_count++] = any_ground(dice, stage);
}

/* ---- meshes ---------------------------------------------------------------------------------- */

static void draw_corners(struct dice *dice, struct recipe_mesh *mesh)
{
    const struct neph_vec3 across = any_direction(dice),
                           half = {uniform(dice, 0.1, 1.0), uniform(dice, 0.1, 1.0),
                                   uniform(dice, 0.1, 1.0)};
    const struct neph_vec3 along_u = neph_vec3_normalize(
        neph_vec3_cross(across, any_direction(dice)));
    const struct neph_vec3 along_v = neph_vec3_cross(across, along_u);
    for (int i = 0; i < RECIPE_CORNERS_MAX; i++) {
        const struct neph_vec3 sides = {i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y,
                                        i & 4 ? half.z : -half.z};
        const struct neph_vec3 flat = along(neph_vec3_scale(along_u, i % 3 - 1), along_v,
                                            i / 3 - 1);
        const struct neph_vec3 random = in_cube(dice, 1.0);
        mesh->corners[i] = mesh->kind == RECIPE_TETRAHEDRON ? random
                           : mesh->kind == RECIPE_BLOCK     ? sides
                                                            : along(flat, random, 0.3);
    }
}

static struct recipe_mesh any_mesh(struct dice *dice, const struct stage *stage)
{
    const double scale_m = stage->scale_m;
    struct recipe_mesh mesh = {
        .kind = (enum recipe_mesh_kind)whole(dice, 0, RECIPE_MESH_KINDS - 1),
        .position_m = neph_vec3_add(stage->center_m, in_cube(dice, 1.2 * scale_m)),
        .scale_m = scale_m * uniform(dice, 0.1, 0.7),
        .turn_deg = uniform(dice, -180.0, 180.0),
        .albedo = any_color(dice, 0.0, 0.9),
    };
    draw_corners(dice, &mesh);
    return mesh;
}

static void draw_meshes(struct dice *dice, const struct stage *stage, struct recipe *recipe)
{
    recipe->mesh_count = happens(dice, 0.3) ? whole(dice, 1, RECIPE_MESHES_MAX) : 0;
    for (int i = 0; i < recipe->mesh_count; i++)
        recipe->meshes[i] = any_mesh(dice, stage);
}

/* ---- a scene --------------------------------------------------------------------------------- */

static void draw_camera(struct dice *dice, bool is_high, struct recipe *recipe)
{
    const double scale_m = recipe->scale_m;
    const double azimuth = uniform(dice, 0.0, 2.0 * M_PI);
    double elevation = uniform(dice, -0.6, 0.6);
    if (happens(dice, 0.1))
        elevation = happens(dice, 0.5) ? 1.5 : -1.5;
    recipe->up = (struct neph_vec3){0.0, 1.0, 0.0};
    recipe->eye_m = in_cube(dice, scale_m);
    if (happens(dice, 0.08)) /* far from the world's origin */
        recipe->eye_m = neph_vec3_add(recipe->eye_m, in_cube(dice, fmin(1e4 * scale_m, 5e5)));
    struct neph_vec3 ahead = {cos(elevation) * cos(azimuth), sin(elevation),
                              cos(elevation) * sin(azimuth)};
    if (is_high) { /* clouds of a fixed height are ahead */
        recipe->eye_m = (struct neph_vec3){uniform(dice, -50, 50), uniform(dice, 0, 20), 0.0};
        ahead = (struct neph_vec3){uniform(dice, -0.5, 0.5), uniform(dice, 0.1, 0.8), -1.0};
        ahead = neph_vec3_normalize(ahead);
    }
    recipe->look_at_m = along(recipe->eye_m, ahead, 2.5 * scale_m);
    recipe->vertical_fov_deg = uniform(dice, 15.0, 75.0);
    if (happens(dice, 0.2)) {
        recipe->vertical_fov_deg = 0.0;
        recipe->orthographic_height_m = scale_m * uniform(dice, 0.3, 3.0);
    }
}

static void draw_time(struct dice *dice, struct recipe *recipe)
{
    bool drifts = false;
    for (int i = 0; i < recipe->medium_count; i++)
        drifts |= recipe->media[i].form >= FORM_GRID || recipe->media[i].form == FORM_GAUSSIAN ||
                  recipe->media[i].form == FORM_GAUSSIAN_BOXED;
    recipe->frame = happens(dice, 0.6) ? 0 : whole(dice, 1, RECIPE_KEY_FRAME);
    recipe->has_wind = drifts && happens(dice, 0.4);
    recipe->is_wind_keyed = happens(dice, 0.3);
    if (recipe->has_wind && recipe->frame == 0)
        recipe->frame = RECIPE_KEY_FRAME / 2;
    const double way_m = recipe->scale_m * uniform(dice, 0.2, 0.8);
    recipe->wind_m_per_s = neph_vec3_scale(any_direction(dice),
                                           way_m * 30.0 / fmax(1, recipe->frame));
}

static struct stage make_stage(struct dice *dice, const struct recipe *recipe)
{
    struct stage stage = {.scale_m = recipe->scale_m, .eye_m = recipe->eye_m};
    stage.ahead = neph_vec3_normalize(neph_vec3_sub(recipe->look_at_m, recipe->eye_m));
    stage.center_m = recipe->look_at_m;
    stage.planet_radius_m = fmax(1.0, recipe->scale_m * log_uniform(dice, 3.0, 300.0));
    stage.eye_altitude_m = recipe->scale_m * uniform(dice, 0.05, 3.0);
    stage.planet_m = stage.eye_m;
    stage.planet_m.y -= stage.planet_radius_m + stage.eye_altitude_m;
    stage.eye_in_media = happens(dice, 0.2);
    stage.eye_on_face = happens(dice, 0.08);
    return stage;
}

struct recipe recipe_draw(uint64_t seed, int index, int attempt)
{
    struct dice dice = {seed * 0x9e3779b97f4a7c15u + (uint64_t)index * 0xd1342543de82ef95u +
                        (uint64_t)attempt * 0xaf251af3b0f025b5u};
    static const enum neph_scattering scatterings[] = {
        NEPH_SCATTERING_NONE,    NEPH_SCATTERING_SINGLE, NEPH_SCATTERING_SINGLE,
        NEPH_SCATTERING_SINGLE,  NEPH_SCATTERING_SINGLE, NEPH_SCATTERING_MULTIPLE,
        NEPH_SCATTERING_MULTIPLE};
    struct recipe recipe = {.seed = seed, .index = index};
    enum recipe_form forms[RECIPE_MEDIA_MAX] = {FORM_HOMOGENEOUS};
    recipe.medium_count = find_forms(index, forms);
    bool is_high = false, has_planet = false;
    for (int i = 0; i < recipe.medium_count; i++) {
        is_high |= forms[i] == FORM_HORIZON;
        has_planet |= forms[i] == FORM_SHELL || forms[i] == FORM_TENT;
    }
    recipe.scattering = scatterings[whole(&dice, 0, 6)];
    recipe.scale_m = is_high ? 120.0 : log_uniform(&dice, 0.5, 500.0);
    draw_camera(&dice, is_high, &recipe);
    const struct stage stage = make_stage(&dice, &recipe);
    for (int i = 0; i < recipe.medium_count; i++) {
        struct recipe_medium *medium = &recipe.media[i];
        medium->form = forms[i];
        draw_optics(&dice, is_open(forms[i]), medium);
        draw_shape(&dice, &stage, medium);
    }
    draw_time(&dice, &recipe);
    draw_solids(&dice, &stage, has_planet, &recipe);
    draw_lights(&dice, &stage, index % 4 == 1, &recipe);
    draw_meshes(&dice, &stage, &recipe);
    return recipe;
}

struct neph_camera recipe_camera(const struct recipe *recipe)
{
    struct neph_camera_key key = {.position_m = recipe->eye_m, .look_at_m = recipe->look_at_m};
    const struct neph_scene scene = {
        .camera_key_count = 1,
        .camera_keys = &key,
        .camera_up = recipe->up,
        .vertical_fov_rad = recipe->vertical_fov_deg * NEPH_RAD_PER_DEG,
        .orthographic_height_m = recipe->orthographic_height_m,
    };
    return neph_scene_camera(&scene, 0.0);
}

/* ---- wind, computed independently ------------------------------------------------------------ */

static void shift(struct neph_vec3 *place_m, struct neph_vec3 by_m)
{
    *place_m = neph_vec3_add(*place_m, by_m);
}

static void carry(struct recipe_medium *medium, struct neph_vec3 by_m)
{
    switch (medium->form) {
    case FORM_GAUSSIAN:
    case FORM_GAUSSIAN_BOXED:
    case FORM_GRID:
    case FORM_GRID_ENDLESS:
    case FORM_SHEET:
    case FORM_PLUME:
        shift(&medium->center_m, by_m);
        shift(&medium->origin_m, by_m);
        shift(&medium->bounds.min_m, by_m);
        shift(&medium->bounds.max_m, by_m);
        break;
    case FORM_HORIZON:
        shift(&medium->wind_m, by_m);
        break;
    default: /* uniform along the wind */
        break;
    }
}

struct recipe recipe_without_wind(const struct recipe *recipe)
{
    struct recipe still = *recipe;
    if (!recipe->has_wind)
        return still;
    /* The mean velocity of the frames 0 .. frame, times the time. */
    const double growth = recipe->is_wind_keyed ? 0.5 * recipe->frame / RECIPE_KEY_FRAME : 0.0;
    const struct neph_vec3 by_m = neph_vec3_scale(recipe->wind_m_per_s,
                                                  (1.0 + growth) * recipe->frame / 30.0);
    for (int i = 0; i < still.medium_count; i++)
        carry(&still.media[i], by_m);
    still.has_wind = false;
    return still;
}
