/* SPDX-License-Identifier: MIT */
#include "harness/physics/stage.h"

#include "scenes/horizon.h"
#include "scenes/media.h"
#include "truth/transport.h"

#include <math.h>
#include <stdlib.h>

/* Compiles only when this file handles every kind. */
_Static_assert(NEPH_STAGE_MEDIUM_COUNT == 10, "a new kind");
_Static_assert(NEPH_STAGE_TRUTH_COLUMNS == 4, "a new kind");

static const double slab_m = 10.0;
static const double wide_m = 1e5;
static const double fog_falloff_per_m = 0.1;
/* Only e^-30 = 1e-13 of the fog is above the camera. */
static const double fog_camera_m = 300.0;
static const double blob_width_m = 1.5;
static const double shell_radius_m = 2.0;
static const double shell_scale_m = 1.5;
static const double tent_altitude_m = 1.5;

/* Clouds of the cube's size, with full coverage. */
static const struct neph_horizon_params small_clouds = {
    .seed = 1,
    .planet_radius_m = 1e4,
    .bottom_m = 0.0,
    .thickness_m = 10.0,
    .coverage = 1.0,
    .density = 1.0,
    .texture_scale_m = 100.0,
    .base_repeats = 8.0,
    .detail_repeats = 40.0,
};

/* The step cloud of truth/step_cloud.h. At this height the rays are vertical within 0.6 degrees at
 * the edges; the error, symmetric about the middle, is 1e-4. */
static const double columns_camera_m = 4e5;
static const double column_m = 500.0;
static const double cloud_m = 250.0;
static const double column_depths[2] = {2.0, 18.0};
static const int64_t column_photons = 4000000;

static struct neph_vec3 polar(double azimuth_rad, double elevation_rad)
{
    return (struct neph_vec3){cos(elevation_rad) * cos(azimuth_rad), sin(elevation_rad),
                              cos(elevation_rad) * sin(azimuth_rad)};
}

static struct neph_bounds cube(void)
{
    return (struct neph_bounds){{-0.5 * slab_m, 0.0, -0.5 * slab_m},
                                {0.5 * slab_m, slab_m, 0.5 * slab_m}};
}

static struct neph_vec3 cube_center(void)
{
    return (struct neph_vec3){0.0, 0.5 * slab_m, 0.0};
}

static void place_camera(struct neph_stage *stage)
{
    const struct neph_stage_params *params = &stage->params;
    const struct neph_vec3 view = polar(params->view_azimuth_rad, params->view_elevation_rad);
    const bool down = params->view_elevation_rad < 0.0;
    struct neph_vec3 eye_m = {0.0, down ? 2.0 * slab_m : -slab_m, 0.0};
    if (params->medium == NEPH_STAGE_STEP_CLOUD) {
        const bool thick = params->optical_depth == column_depths[1];
        eye_m = (struct neph_vec3){(thick ? 12.0 : 4.0) * 1000.0, columns_camera_m, 0.0};
        stage->key = (struct neph_camera_key){
            .position_m = eye_m,
            .look_at_m = neph_vec3_along(eye_m, (struct neph_vec3){0, -1, 0}, columns_camera_m)};
        stage->scene.camera_up = (struct neph_vec3){0, 0, -1};
        return;
    }
    if (params->medium == NEPH_STAGE_FOG)
        eye_m.y = fog_camera_m;
    else if (params->medium != NEPH_STAGE_SLAB)
        eye_m = neph_vec3_along(cube_center(), view, -2.0 * slab_m);
    stage->key = (struct neph_camera_key){.position_m = eye_m,
                                          .look_at_m = neph_vec3_along(eye_m, view, slab_m)};
}

static void place_light(struct neph_stage *stage)
{
    struct neph_scene *scene = &stage->scene;
    const bool furnace = stage->params.truth == NEPH_STAGE_TRUTH_FURNACE;
    scene->scattering = stage->params.truth == NEPH_STAGE_TRUTH_RAY ? NEPH_SCATTERING_SINGLE
                                                                    : NEPH_SCATTERING_MULTIPLE;
    scene->sun.direction = (struct neph_vec3){0, 1, 0};
    if (furnace) {
        const double surround = NEPH_STAGE_SURROUND_W_PER_M2_SR;
        scene->environment_light = true;
        scene->background_w_per_m2_sr = (struct neph_rgb){surround, surround, surround};
        return;
    }
    const double irradiance = NEPH_STAGE_IRRADIANCE_W_PER_M2;
    scene->sun.present = true;
    scene->sun.direction = polar(0.0, asin(stage->params.sun_cosine));
    scene->sun.irradiance_w_per_m2 = (struct neph_rgb){irradiance, irradiance, irradiance};
}

/* Voxels of a fixed pattern between 0 and 1. No libm, so they are identical on every machine. */
static enum neph_status fill_grid(struct neph_stage *stage, struct neph_diag *diag)
{
    enum { SIDE = 4 };
    const double spacing_m = slab_m / (SIDE + 1); /* so the density is 0 on the faces of the cube */
    const struct neph_vec3 first_m = {-0.5 * slab_m + spacing_m, spacing_m,
                                      -0.5 * slab_m + spacing_m};
    enum neph_status status = neph_grid_create((const int[3]){SIDE, SIDE, SIDE}, first_m,
                                               (struct neph_vec3){spacing_m, spacing_m, spacing_m},
                                               &stage->grid, diag);
    if (status)
        return status;
    for (int i = 0; i < SIDE * SIDE * SIDE; i++)
        stage->grid->values[i] = (float)((i * 37 + 11) % 64) / 64.0f;
    return neph_grid_seal(stage->grid, diag);
}

/* Alternate thin and thick halves, from x = -16 km; the middle period is 0 to 16 km. */
static void place_columns(struct neph_stage *stage)
{
    struct neph_scene *scene = &stage->scene;
    const struct neph_medium first = scene->media[0];
    const double half_m = 0.5 * NEPH_STAGE_COLUMNS * column_m;
    scene->medium_count = 6;
    for (int i = 0; i < scene->medium_count; i++) {
        const double low_m = (i - 2) * half_m;
        scene->media[i] = first;
        scene->media[i].bounds = (struct neph_bounds){{low_m, 0.0, -wide_m},
                                                      {low_m + half_m, cloud_m, wide_m}};
        scene->media[i].layers[0].extinction_per_m = column_depths[i % 2] / cloud_m;
    }
}

static enum neph_status place_medium(struct neph_stage *stage, struct neph_diag *diag)
{
    const struct neph_stage_params *params = &stage->params;
    const double a = params->albedo, depth = params->optical_depth;
    const double hot = params->truth == NEPH_STAGE_TRUTH_FURNACE ? NEPH_STAGE_SURROUND_W_PER_M2_SR
                                                                 : 0.0;
    struct neph_medium *medium = &stage->scene.media[0];
    *medium = (struct neph_medium){.kind = NEPH_MEDIUM_HOMOGENEOUS,
                                   .bounds = cube(),
                                   .extinction_color = {1, 1, 1},
                                   .albedo = {a, a, a},
                                   .emission_w_per_m2_sr = {hot, hot, hot},
                                   .phase = params->phase,
                                   .layer_count = 1,
                                   .layers = {{.extinction_per_m = depth / slab_m}}};
    stage->scene.medium_count = 1;
    switch (params->medium) {
    case NEPH_STAGE_BOX:
    case NEPH_STAGE_MEDIUM_COUNT:
        break;
    case NEPH_STAGE_SLAB:
        medium->bounds = (struct neph_bounds){{-wide_m, 0.0, -wide_m}, {wide_m, slab_m, wide_m}};
        break;
    case NEPH_STAGE_FOG:
        medium->kind = NEPH_MEDIUM_HEIGHT_FOG;
        medium->bounds = (struct neph_bounds){{-INFINITY, -INFINITY, -INFINITY},
                                              {INFINITY, INFINITY, INFINITY}};
        medium->layers[0].extinction_per_m = depth * fog_falloff_per_m;
        medium->layers[0].falloff_per_m = fog_falloff_per_m;
        stage->ground = (struct neph_solid){
            .kind = NEPH_SOLID_BOX, .box = {{-wide_m, -slab_m, -wide_m}, {wide_m, 0.0, wide_m}}};
        stage->scene.solids = &stage->ground;
        stage->scene.solid_count = 1;
        break;
    case NEPH_STAGE_GAUSSIAN:
        medium->kind = NEPH_MEDIUM_GAUSSIAN;
        medium->gaussian = (struct neph_gaussian){cube_center(), blob_width_m};
        medium->extinction_per_m = depth / (blob_width_m * sqrt(2.0 * M_PI));
        break;
    case NEPH_STAGE_GRID:
        medium->kind = NEPH_MEDIUM_GRID;
        medium->extinction_per_m = depth / (0.5 * slab_m); /* about 1/2 is the mean of the
                                                              pattern */
        if (fill_grid(stage, diag))
            return NEPH_ERR_MEMORY;
        medium->grid = stage->grid;
        break;
    case NEPH_STAGE_FOG_BOX:
        medium->kind = NEPH_MEDIUM_HEIGHT_FOG;
        medium->layers[0].falloff_per_m = 2.0 / slab_m;
        medium->layers[0].extinction_per_m = depth * 2.0 / slab_m / -expm1(-2.0);
        break;
    case NEPH_STAGE_SHELL:
        medium->kind = NEPH_MEDIUM_SHELL;
        medium->shell = (struct neph_shell){cube_center(), shell_radius_m, shell_scale_m};
        medium->extinction_per_m = 0.5 * depth / shell_scale_m; /* one column on either side of the
                                                                   ball */
        break;
    case NEPH_STAGE_TENT:
        medium->kind = NEPH_MEDIUM_TENT;
        medium->tent = (struct neph_tent){cube_center(), shell_radius_m, tent_altitude_m,
                                          tent_altitude_m};
        medium->extinction_per_m = 0.5 * depth / tent_altitude_m; /* one column on either side of
                                                                     the ball */
        break;
    case NEPH_STAGE_CLOUDS:
        medium->kind = NEPH_MEDIUM_HORIZON;
        medium->extinction_per_m = depth / (0.5 * slab_m);
        if (neph_horizon_create(&small_clouds, &stage->horizon, diag))
            return NEPH_ERR_MEMORY;
        medium->horizon = stage->horizon;
        break;
    case NEPH_STAGE_STEP_CLOUD:
        place_columns(stage);
        break;
    }
    if (medium->extinction_per_m > 0.0) /* the medium has no layers */
        medium->layer_count = 0;
    return NEPH_OK;
}

/* The range of cosines to the vertical within the frame, corners and edges included. */
static void find_cosines(const struct neph_stage *stage, double *low, double *high)
{
    enum { SIDE = 33 };
    const struct neph_camera camera = neph_scene_camera(&stage->scene, 0.0);
    const double tangent = tan(0.5 * stage->params.vertical_fov_rad);
    const double side = stage->params.view_elevation_rad < 0.0 ? -1.0 : 1.0;
    *low = 1.0;
    *high = NEPH_SLAB_COSINE_MIN;
    for (int i = 0; i < SIDE * SIDE; i++) {
        const double x = (2.0 * (i % SIDE) / (SIDE - 1) - 1.0) * tangent * stage->params.aspect;
        const double y = (2.0 * (i / SIDE) / (SIDE - 1) - 1.0) * tangent;
        const struct neph_vec3 ray = neph_vec3_normalize(
            neph_vec3_along(neph_vec3_along(camera.forward, camera.right, x), camera.up, y));
        *low = fmin(*low, fmax(side * ray.y, NEPH_SLAB_COSINE_MIN));
        *high = fmax(*high, side * ray.y);
    }
    *high = fmin(*high, 1.0);
}

static enum neph_status solve_slab(struct neph_stage *stage, struct neph_diag *diag)
{
    const struct neph_stage_params *params = &stage->params;
    double low, high;
    find_cosines(stage, &low, &high);
    for (int i = 0; i < NEPH_STAGE_COSINES; i++) {
        const double x = cos(M_PI * i / (NEPH_STAGE_COSINES - 1));
        stage->cosines[i] = fmin(1.0, fmax(low, 0.5 * (low + high) + 0.5 * (high - low) * x));
    }
    return neph_slab_create(&(struct neph_slab_params){.optical_depth = params->optical_depth,
                                                       .albedo = params->albedo,
                                                       .phase = params->phase,
                                                       .sun_cosine = params->sun_cosine,
                                                       .view_count = NEPH_STAGE_COSINES,
                                                       .view_cosines = stage->cosines},
                            &stage->slab, diag);
}

/* The stage's sun is at +x, so its light travels to -x: the mirror image of step_cloud.h. Thin
 * columns come first here, therefore last there. */
static enum neph_status solve_columns(struct neph_stage *stage, struct neph_diag *diag)
{
    double depths[NEPH_STAGE_COLUMNS];
    struct neph_estimate mirrored[NEPH_STAGE_COLUMNS];
    struct neph_step_cloud_fluxes fluxes;
    for (int i = 0; i < NEPH_STAGE_COLUMNS; i++)
        depths[i] = column_depths[i < NEPH_STAGE_COLUMNS / 2];
    const enum neph_status status = neph_step_cloud_solve(
        &(struct neph_step_cloud_params){.column_count = NEPH_STAGE_COLUMNS,
                                         .optical_depths = depths,
                                         .column_width_m = column_m,
                                         .thickness_m = cloud_m,
                                         .albedo = stage->params.albedo,
                                         .phase = stage->params.phase,
                                         .sun_cosine = stage->params.sun_cosine,
                                         .seed = 1,
                                         .photons = column_photons},
        &fluxes, mirrored, diag);
    for (int i = 0; i < NEPH_STAGE_COLUMNS && !status; i++)
        stage->columns[i] = mirrored[NEPH_STAGE_COLUMNS - 1 - i];
    return status;
}

enum neph_status neph_stage_create(const struct neph_stage_params *params,
                                   struct neph_stage **stage, struct neph_diag *diag)
{
    struct neph_stage *made = calloc(1, sizeof(*made));
    if (!made)
        return neph_fail_memory(diag);
    made->params = *params;
    struct neph_scene *scene = &made->scene;
    scene->path = scene->title = scene->name = params->name;
    scene->description = "a scene of the physics suite";
    scene->camera_key_count = 1;
    scene->camera_keys = &made->key;
    scene->camera_up = (struct neph_vec3){0, 1, 0};
    scene->vertical_fov_rad = params->vertical_fov_rad;
    scene->frame_count = 1;
    scene->frame_rate_hz = 30.0;
    scene->octaves = (struct neph_octaves){8, 0.5, 0.5, 0.5};
    place_camera(made);
    place_light(made);
    enum neph_status status = place_medium(made, diag);
    if (!status)
        status = neph_scene_hash(scene, diag);
    if (!status && params->truth == NEPH_STAGE_TRUTH_SLAB)
        status = solve_slab(made, diag);
    if (!status && params->truth == NEPH_STAGE_TRUTH_COLUMNS)
        status = solve_columns(made, diag);
    if (status)
        neph_stage_destroy(made);
    else
        *stage = made;
    return status;
}

void neph_stage_destroy(struct neph_stage *stage)
{
    if (!stage)
        return;
    neph_slab_destroy(stage->slab);
    neph_grid_destroy(stage->grid);
    neph_horizon_destroy(stage->horizon);
    free(stage);
}

/* Light that reaches the camera travels along -direction, sunlight along -sun: the angle between
 * their horizontal parts is the difference of the azimuths of view and sun. */
static double slab_radiance(const struct neph_stage *stage, struct neph_vec3 direction)
{
    const double azimuth_rad = atan2(direction.z, direction.x);
    const double cosine = fabs(direction.y);
    double sum = 0.0, weights = 0.0;
    /* Barycentric interpolation at Chebyshev points of the second kind (J.-P. Berrut, L. N.
     * Trefethen, SIAM Review 46, 2004). */
    for (int i = 0; i < NEPH_STAGE_COSINES; i++) {
        const double per_sr = direction.y < 0.0
                                  ? neph_slab_reflected_per_sr(stage->slab, i, azimuth_rad)
                                  : neph_slab_transmitted_per_sr(stage->slab, i, azimuth_rad);
        const double off = cosine - stage->cosines[i];
        const double end = i == 0 || i == NEPH_STAGE_COSINES - 1 ? 0.5 : 1.0;
        if (off == 0.0)
            return per_sr * NEPH_STAGE_IRRADIANCE_W_PER_M2;
        const double weight = (i % 2 ? -end : end) / off;
        sum += weight * per_sr;
        weights += weight;
    }
    return sum / weights * NEPH_STAGE_IRRADIANCE_W_PER_M2;
}

/* Law of diffuse reflection of a half-space (S. Chandrasekhar, "Radiative Transfer", 1960). */
static double half_space_radiance(const struct neph_stage *stage, struct neph_vec3 direction)
{
    const double albedo = stage->params.albedo, sun = stage->params.sun_cosine;
    const double view = fabs(direction.y);
    return NEPH_STAGE_IRRADIANCE_W_PER_M2 * albedo / (4.0 * M_PI) * sun / (view + sun) *
           neph_chandrasekhar_h(albedo, view) * neph_chandrasekhar_h(albedo, sun);
}

static double column_radiance(const struct neph_stage *stage, struct neph_vec3 direction)
{
    const struct neph_vec3 eye_m = stage->key.position_m;
    const double x_m = eye_m.x + (eye_m.y - cloud_m) * direction.x / -direction.y;
    const int column = (int)fmin(NEPH_STAGE_COLUMNS - 1, fmax(0.0, floor(x_m / column_m)));
    return stage->columns[column].mean * NEPH_STAGE_IRRADIANCE_W_PER_M2;
}

double neph_stage_truth_error(const struct neph_stage *stage)
{
    const int half = NEPH_STAGE_COLUMNS / 2;
    const int first = stage->params.optical_depth == column_depths[1] ? half : 0;
    double sum = 0.0, variance = 0.0;
    if (stage->params.truth != NEPH_STAGE_TRUTH_COLUMNS)
        return 0.0;
    for (int i = first; i < first + half; i++) {
        sum += stage->columns[i].mean;
        variance += stage->columns[i].standard_error * stage->columns[i].standard_error;
    }
    return sqrt(variance) / sum;
}

double neph_stage_truth_w_per_m2_sr(const struct neph_stage *stage, struct neph_vec3 direction)
{
    switch (stage->params.truth) {
    case NEPH_STAGE_TRUTH_SLAB:
        return slab_radiance(stage, direction);
    case NEPH_STAGE_TRUTH_RAY:
        return neph_transport_ray(&stage->scene, stage->key.position_m, direction).radiance.g;
    case NEPH_STAGE_TRUTH_HALF_SPACE:
        return half_space_radiance(stage, direction);
    case NEPH_STAGE_TRUTH_COLUMNS:
        return column_radiance(stage, direction);
    case NEPH_STAGE_TRUTH_FURNACE:
        break;
    }
    return NEPH_STAGE_SURROUND_W_PER_M2_SR;
}
