/* SPDX-License-Identifier: MIT */
#include "harness/physics/i3rc_case.h"

#include "base/path.h"
#include "harness/physics/i3rc_files.h"
#include "scenes/phase_table.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

const struct neph_i3rc_experiment neph_i3rc_experiments[] = {
    {1, 1, 0.0, 1.0, 0.0, false},   {1, 2, 60.0, 1.0, 0.0, false},  {1, 3, 0.0, 0.99, 0.0, false},
    {1, 4, 60.0, 0.99, 0.0, false}, {2, 1, 0.0, 1.0, 0.0, false},   {2, 2, 60.0, 1.0, 0.0, false},
    {2, 3, 0.0, 0.99, 0.0, false},  {2, 4, 60.0, 0.99, 0.0, false}, {2, 5, 60.0, 1.0, 0.4, false},
    {2, 6, 0.0, 1.0, 0.0, true},    {2, 7, 60.0, 1.0, 0.0, true},   {3, 1, 0.0, 1.0, 0.0, false},
    {3, 2, 60.0, 1.0, 0.0, false},  {3, 3, 0.0, 0.99, 0.0, false},  {3, 4, 60.0, 0.99, 0.0, false},
};
const int neph_i3rc_experiment_count = sizeof(neph_i3rc_experiments) /
                                       sizeof(neph_i3rc_experiments[0]);

static const double step_depths[2] = {2.0, 18.0};
static const double asymmetry_g = 0.85;
static const double far_m = NEPH_GRID_ENDLESS_M;

/* The lattice of a case. */
static const struct lattice {
    int columns_x, layers, columns_z;
    double column_m, layer_m, base_m;
} lattices[] = {
    {32, 1, 1, 15.625, 250.0, 0.0},
    {640, 54, 1, 50.0, 45.0, 0.0},
    {128, 0, 128, 30.0, 20.0, 200.0}, /* layers up to the highest column */
};

enum { RADAR_CELLS = 640 * 54, LANDSAT_COLUMNS = 128 * 128 };
static const struct neph_i3rc_file radar = {"mmcr_tau_32km_020898", "an optical depth", RADAR_CELLS,
                                            0.0, 1e3};
static const struct neph_i3rc_file landsat_depth = {"scene43.tau.128x128", "an optical depth",
                                                    LANDSAT_COLUMNS, 0.0, 1e3};
static const struct neph_i3rc_file landsat_thickness = {"scene43.dz.128x128", "a thickness in km",
                                                        LANDSAT_COLUMNS, 0.0, 20.0};

/* A periodic grid of constant cells with `layers` layers. */
static enum neph_status create_grid(const struct lattice *lattice, int layers,
                                    struct neph_grid **grid, struct neph_diag *diag)
{
    const struct neph_vec3 spacing_m = {lattice->column_m, lattice->layer_m, lattice->column_m};
    const struct neph_vec3 first_m = {0.5 * spacing_m.x, lattice->base_m + 0.5 * spacing_m.y,
                                      0.5 * spacing_m.z};
    const enum neph_status status = neph_grid_create(
        (const int[3]){lattice->columns_x, layers, lattice->columns_z}, first_m, spacing_m, grid,
        diag);
    if (status)
        return status;
    (*grid)->is_constant = true;
    (*grid)->is_endless[0] = (*grid)->is_endless[2] = true;
    return NEPH_OK;
}

static float *find_cell(struct neph_grid *grid, int x, int layer, int z)
{
    return &grid->values[((size_t)z * (size_t)grid->size[1] + (size_t)layer) *
                             (size_t)grid->size[0] +
                         (size_t)x];
}

static enum neph_status create_step_cloud(const struct lattice *lattice, const char *folder,
                                          struct neph_grid **grid, struct neph_diag *diag)
{
    (void)folder;
    const enum neph_status status = create_grid(lattice, lattice->layers, grid, diag);
    for (int x = 0; x < lattice->columns_x && !status; x++)
        *find_cell(*grid, x, 0,
                   0) = (float)(step_depths[x >= lattice->columns_x / 2] / lattice->layer_m);
    return status;
}

/* Lines of the table from the first to the last with a cloud. */
static void find_cloudy_lines(const double *depths, const struct lattice *lattice, int *first,
                              int *last)
{
    *first = lattice->layers - 1;
    *last = 0;
    for (int i = 0; i < lattice->layers * lattice->columns_x; i++)
        if (depths[i] > 0.0) {
            const int line = i / lattice->columns_x;
            *first = line < *first ? line : *first;
            *last = line > *last ? line : *last;
        }
}

static enum neph_status create_radar_cloud(const struct lattice *lattice, const char *folder,
                                           struct neph_grid **grid, struct neph_diag *diag)
{
    struct lattice cloud = *lattice;
    double *depths = NULL;
    int first, last;
    enum neph_status status = neph_i3rc_file_read(folder, &radar, &depths, diag);
    if (status)
        return status;
    find_cloudy_lines(depths, lattice, &first, &last);
    if (first > last)
        status = neph_fail(diag, NEPH_ERR_INPUT, "%s: every optical depth is 0", radar.name);
    cloud.base_m += (lattice->layers - 1 - last) * lattice->layer_m;
    if (!status)
        status = create_grid(&cloud, last - first + 1, grid, diag);
    for (int line = first; line <= last && !status; line++)
        for (int x = 0; x < lattice->columns_x; x++)
            *find_cell(*grid, x, last - line,
                       0) = (float)(depths[line * lattice->columns_x + x] / lattice->layer_m);
    free(depths);
    return status;
}

static enum neph_status check_columns(const double *depths, const double *thicknesses_km,
                                      struct neph_diag *diag)
{
    for (int i = 0; i < LANDSAT_COLUMNS; i++)
        if ((depths[i] > 0.0) != (thicknesses_km[i] > 0.0)) {
            neph_fail(diag, NEPH_ERR_INPUT,
                      "value %d has the optical depth %g in %s and the thickness %g km in %s: both "
                      "must be 0, or neither",
                      i + 1, depths[i], landsat_depth.name, thicknesses_km[i],
                      landsat_thickness.name);
            return NEPH_ERR_INPUT;
        }
    return NEPH_OK;
}

static void fill_column(struct neph_grid *grid, int x, int z, double depth, double thickness_m)
{
    const double layer_m = grid->spacing_m.y;
    for (int layer = 0; layer < grid->size[1] && depth > 0.0; layer++) {
        const double filled = fmin(1.0, fmax(0.0, thickness_m / layer_m - layer));
        *find_cell(grid, x, layer, z) = (float)(depth / thickness_m * filled);
    }
}

static enum neph_status create_landsat_cloud(const struct lattice *lattice, const char *folder,
                                             struct neph_grid **grid, struct neph_diag *diag)
{
    double *depths = NULL, *thicknesses_km = NULL, highest_km = 0.0;
    enum neph_status status = neph_i3rc_file_read(folder, &landsat_depth, &depths, diag);
    if (!status)
        status = neph_i3rc_file_read(folder, &landsat_thickness, &thicknesses_km, diag);
    if (!status)
        status = check_columns(depths, thicknesses_km, diag);
    for (int i = 0; i < LANDSAT_COLUMNS && !status; i++)
        highest_km = fmax(highest_km, thicknesses_km[i]);
    const int layers = (int)fmax(1.0, ceil(1000.0 * highest_km / lattice->layer_m - 1e-6));
    if (!status)
        status = create_grid(lattice, layers, grid, diag);
    for (int i = 0; i < LANDSAT_COLUMNS && !status; i++)
        fill_column(*grid, i % lattice->columns_x, i / lattice->columns_x, depths[i],
                    1000.0 * thicknesses_km[i]);
    free(depths);
    free(thicknesses_km);
    return status;
}

static enum neph_status (*const clouds[])(const struct lattice *lattice, const char *folder,
                                          struct neph_grid **grid, struct neph_diag *diag) = {
    create_step_cloud, create_radar_cloud, create_landsat_cloud};

static double mean_optical_depth(const struct neph_grid *grid)
{
    const int columns = grid->size[0] * grid->size[2], cells = columns * grid->size[1];
    double sum = 0.0;
    for (int i = 0; i < cells; i++)
        sum += (double)grid->values[i];
    return sum * grid->spacing_m.y / columns;
}

static void place_light(struct neph_scene *scene, double zenith_deg)
{
    const double zenith_rad = zenith_deg * M_PI / 180.0;
    scene->scattering = NEPH_SCATTERING_MULTIPLE;
    scene->sun = (struct neph_sun){.present = true,
                                   .direction = {-sin(zenith_rad), cos(zenith_rad), 0.0},
                                   .irradiance_w_per_m2 = {1.0, 1.0, 1.0}};
}

/* At the bottom of the table. */
static void place_ground(struct neph_i3rc_scene *made, double bottom_m, double albedo)
{
    made->ground = (struct neph_solid){
        .kind = NEPH_SOLID_BOX,
        .box = {{-far_m, bottom_m - 1.0, -far_m}, {far_m, bottom_m, far_m}},
        .albedo = {albedo, albedo, albedo}};
    made->scene.solids = &made->ground;
    made->scene.solid_count = 1;
}

static enum neph_status fill_scene(struct neph_i3rc_scene *made,
                                   const struct neph_i3rc_experiment *experiment,
                                   struct neph_diag *diag)
{
    struct neph_scene *scene = &made->scene;
    const double albedo = experiment->albedo;
    snprintf(made->name, sizeof(made->name), "i3rc_case%d_exp%d", experiment->case_number,
             experiment->number);
    scene->path = scene->title = scene->name = made->name;
    scene->description = "an experiment of I3RC";
    made->key = (struct neph_camera_key){.position_m = {0.0, 1e4, 0.0}};
    scene->camera_key_count = 1;
    scene->camera_keys = &made->key;
    scene->camera_up = (struct neph_vec3){0, 0, -1};
    scene->orthographic_height_m = 1e4;
    scene->frame_count = 1;
    scene->frame_rate_hz = 30.0;
    scene->octaves = (struct neph_octaves){8, 0.5, 0.5, 0.5};
    place_light(scene, experiment->sun_zenith_deg);
    if (experiment->ground_albedo > 0.0)
        place_ground(made, lattices[experiment->case_number - 1].base_m, experiment->ground_albedo);
    scene->medium_count = 1;
    scene->media[0] = (struct neph_medium){
        .kind = NEPH_MEDIUM_GRID,
        .bounds = {{-far_m, -far_m, -far_m}, {far_m, far_m, far_m}},
        .extinction_color = {1, 1, 1},
        .albedo = {albedo, albedo, albedo},
        .phase = made->phase,
        .extinction_per_m = 1.0,
        .grid = made->grid};
    return neph_scene_hash(scene, diag);
}

static enum neph_status read_phase(const struct neph_i3rc_experiment *experiment,
                                   const char *folder, struct neph_i3rc_scene *made,
                                   struct neph_diag *diag)
{
    made->phase = (struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, asymmetry_g};
    if (!experiment->has_c1)
        return NEPH_OK;
    made->phase = (struct neph_phase){.kind = NEPH_PHASE_TABLE};
    return neph_phase_table_read(neph_path_format("%s/C.1_PF", folder).text, &made->arena,
                                 &made->phase.table, diag);
}

enum neph_status neph_i3rc_scene_create(const struct neph_i3rc_experiment *experiment,
                                        const char *folder, struct neph_i3rc_scene **scene,
                                        struct neph_diag *diag)
{
    const int index = experiment->case_number - 1;
    struct neph_i3rc_scene *made = calloc(1, sizeof(*made));
    if (!made)
        return neph_fail_memory(diag);
    enum neph_status status = read_phase(experiment, folder, made, diag);
    if (!status)
        status = clouds[index](&lattices[index], folder, &made->grid, diag);
    if (!status)
        status = neph_grid_seal(made->grid, diag);
    if (!status)
        status = fill_scene(made, experiment, diag);
    if (status) {
        neph_i3rc_scene_destroy(made);
        return status;
    }
    made->columns_x = made->grid->size[0];
    made->columns_z = made->grid->size[2];
    made->optical_depth = mean_optical_depth(made->grid);
    *scene = made;
    return NEPH_OK;
}

void neph_i3rc_scene_destroy(struct neph_i3rc_scene *scene)
{
    if (!scene)
        return;
    neph_grid_destroy(scene->grid);
    neph_arena_finish(&scene->arena);
    free(scene);
}
