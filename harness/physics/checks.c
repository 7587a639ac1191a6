/* SPDX-License-Identifier: MIT */
#include "harness/physics/checks.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Compiles only when this file handles every kind. */
_Static_assert(NEPH_CHECK_WEIGHT_COUNT == 2, "a new kind");
_Static_assert(NEPH_STAGE_MEDIUM_COUNT == 10, "a new kind");

#define ISO                                                                                        \
    {                                                                                              \
        NEPH_PHASE_ISOTROPIC, 0.0                                                                  \
    }
#define RAYLEIGH                                                                                   \
    {                                                                                              \
        NEPH_PHASE_RAYLEIGH, 0.0                                                                   \
    }
#define HG(g)                                                                                      \
    {                                                                                              \
        NEPH_PHASE_HENYEY_GREENSTEIN, (g)                                                          \
    }

#define DRAINE(asymmetry, alpha)                                                                   \
    {                                                                                              \
        .kind = NEPH_PHASE_DRAINE, .g = (asymmetry), .draine_alpha = (alpha)                       \
    }
#define TWO_LOBES(asymmetry, second, share)                                                        \
    {                                                                                              \
        .kind = NEPH_PHASE_DOUBLE_HENYEY_GREENSTEIN, .g = (asymmetry), .second_g = (second),       \
        .first_share = (share)                                                                     \
    }
#define DROPLETS(diameter_um)                                                                      \
    {                                                                                              \
        .kind = NEPH_PHASE_JENDERSIE_DEON, .droplet_diameter_um = (diameter_um)                    \
    }

/* The views of a check. */
enum observable {
    LOOK_DOWN,    /* one frame from above */
    LOOK_UP,      /* one frame from below */
    CONSERVATION, /* the hemispheres above and below a slab, as faces of a cube */
    RECIPROCITY,  /* two frames with camera and sun exchanged */
    NADIR,        /* one frame from high above, half a period of the step cloud wide */
};

enum { FURNACE, SINGLE, MULTIPLE, FOG, HALF_SPACE, CONSERVED, RECIPROCAL, COLUMNS };
const struct neph_check_rung neph_check_rungs[NEPH_CHECK_RUNGS] = {
    [FURNACE] = {"furnace", "furnace: in a uniform environment, a medium with albedo 1 or with "
                            "matching emission is invisible"},
    [SINGLE] = {"single", "single scattering against closed forms and quadrature"},
    [MULTIPLE] = {"slab", "slab, all orders, against adding-doubling"},
    [FOG] = {"fog", "height fog over black ground, all orders, against adding-doubling"},
    [HALF_SPACE] = {"half-space", "thick isotropic slab: Chandrasekhar's half-space"},
    [CONSERVED] = {"conservation", "R + T + direct = 1 for conservative slabs"},
    [RECIPROCAL] = {"reciprocity", "sun and camera exchanged"},
    [COLUMNS] = {"step-cloud", "the I3RC step cloud: light through the sides of its columns"},
};

struct row {
    const char *name;
    int rung;
    enum observable observable;
    enum neph_stage_medium medium;
    double optical_depth, albedo;
    struct neph_phase phase;
    double sun_cosine;
};

static const struct row rows[] = {
    {"furnace_box_4", FURNACE, LOOK_DOWN, NEPH_STAGE_BOX, 4.0, 1.0, ISO, 0.7},
    {"furnace_box_64", FURNACE, LOOK_DOWN, NEPH_STAGE_BOX, 64.0, 1.0, HG(0.85), 0.7},
    {"furnace_gaussian_16", FURNACE, LOOK_DOWN, NEPH_STAGE_GAUSSIAN, 16.0, 1.0, HG(0.5), 0.7},
    {"furnace_grid_16", FURNACE, LOOK_DOWN, NEPH_STAGE_GRID, 16.0, 1.0, RAYLEIGH, 0.7},
    {"furnace_fog_8", FURNACE, LOOK_DOWN, NEPH_STAGE_FOG_BOX, 8.0, 1.0, HG(0.5), 0.7},
    {"furnace_shell_8", FURNACE, LOOK_DOWN, NEPH_STAGE_SHELL, 8.0, 1.0, RAYLEIGH, 0.7},
    {"furnace_tent_8", FURNACE, LOOK_DOWN, NEPH_STAGE_TENT, 8.0, 1.0, HG(0.5), 0.7},
    {"furnace_clouds_16", FURNACE, LOOK_DOWN, NEPH_STAGE_CLOUDS, 16.0, 1.0, HG(0.85), 0.7},
    {"furnace_droplets_16", FURNACE, LOOK_DOWN, NEPH_STAGE_BOX, 16.0, 1.0, DROPLETS(20.0), 0.7},
    {"furnace_glow_4", FURNACE, LOOK_DOWN, NEPH_STAGE_BOX, 4.0, 0.5, HG(0.5), 0.7},
    {"single_slab_thin", SINGLE, LOOK_DOWN, NEPH_STAGE_SLAB, 0.1, 1.0, ISO, 0.7},
    {"single_slab_4_back", SINGLE, LOOK_DOWN, NEPH_STAGE_SLAB, 4.0, 0.9, HG(-0.3), 0.4},
    {"single_box_1", SINGLE, LOOK_DOWN, NEPH_STAGE_BOX, 1.0, 1.0, RAYLEIGH, 0.7},
    {"single_box_8", SINGLE, LOOK_UP, NEPH_STAGE_BOX, 8.0, 0.9, HG(0.85), 0.6},
    {"single_fog_2", SINGLE, LOOK_DOWN, NEPH_STAGE_FOG, 2.0, 0.9, HG(0.6), 0.5},
    {"single_gaussian_5", SINGLE, LOOK_DOWN, NEPH_STAGE_GAUSSIAN, 5.0, 1.0, HG(0.6), 0.7},
    {"single_grid_5", SINGLE, LOOK_UP, NEPH_STAGE_GRID, 5.0, 1.0, ISO, 0.7},
    {"single_shell_5", SINGLE, LOOK_DOWN, NEPH_STAGE_SHELL, 5.0, 1.0, HG(0.6), 0.7},
    {"single_tent_5", SINGLE, LOOK_DOWN, NEPH_STAGE_TENT, 5.0, 1.0, RAYLEIGH, 0.7},
    {"single_slab_spike", SINGLE, LOOK_UP, NEPH_STAGE_SLAB, 1.0, 1.0, HG(0.999), 0.7},
    {"single_droplets_1", SINGLE, LOOK_DOWN, NEPH_STAGE_BOX, 1.0, 1.0, DROPLETS(20.0), 0.7},
    {"slab_iso_thin", MULTIPLE, LOOK_DOWN, NEPH_STAGE_SLAB, 0.1, 1.0, ISO, 0.7},
    {"slab_iso_1", MULTIPLE, LOOK_DOWN, NEPH_STAGE_SLAB, 1.0, 1.0, ISO, 0.7},
    {"slab_iso_4", MULTIPLE, LOOK_UP, NEPH_STAGE_SLAB, 4.0, 0.9, ISO, 0.7},
    {"slab_hg85_1", MULTIPLE, LOOK_DOWN, NEPH_STAGE_SLAB, 1.0, 1.0, HG(0.85), 0.7},
    {"slab_hg85_4", MULTIPLE, LOOK_DOWN, NEPH_STAGE_SLAB, 4.0, 1.0, HG(0.85), 0.7},
    {"slab_hg85_4_below", MULTIPLE, LOOK_UP, NEPH_STAGE_SLAB, 4.0, 1.0, HG(0.85), 0.7},
    {"slab_hg85_16", MULTIPLE, LOOK_DOWN, NEPH_STAGE_SLAB, 16.0, 1.0, HG(0.85), 0.7},
    {"slab_hg85_16_below", MULTIPLE, LOOK_UP, NEPH_STAGE_SLAB, 16.0, 0.99, HG(0.85), 0.7},
    {"slab_hg50_64", MULTIPLE, LOOK_DOWN, NEPH_STAGE_SLAB, 64.0, 1.0, HG(0.5), 0.5},
    {"slab_draine_4", MULTIPLE, LOOK_UP, NEPH_STAGE_SLAB, 4.0, 1.0, DRAINE(0.6, 20.0), 0.7},
    {"slab_two_lobes_16", MULTIPLE, LOOK_DOWN, NEPH_STAGE_SLAB, 16.0, 0.99,
     TWO_LOBES(0.85, -0.3, 0.9), 0.7},
    {"fog_iso_1", FOG, LOOK_DOWN, NEPH_STAGE_FOG, 1.0, 1.0, ISO, 0.7},
    {"fog_hg60_8", FOG, LOOK_DOWN, NEPH_STAGE_FOG, 8.0, 1.0, HG(0.6), 0.5},
    {"half_space_90", HALF_SPACE, LOOK_DOWN, NEPH_STAGE_SLAB, 100.0, 0.9, ISO, 0.7},
    {"conservation_4", CONSERVED, CONSERVATION, NEPH_STAGE_SLAB, 4.0, 1.0, HG(0.7), 0.7},
    {"reciprocity_4", RECIPROCAL, RECIPROCITY, NEPH_STAGE_SLAB, 4.0, 1.0, HG(0.7), 0.7},
    {"reciprocity_draine_4", RECIPROCAL, RECIPROCITY, NEPH_STAGE_SLAB, 4.0, 1.0, DRAINE(0.6, 20.0),
     0.7},
    {"step_cloud_thin_0", COLUMNS, NADIR, NEPH_STAGE_STEP_CLOUD, 2.0, 1.0, HG(0.85), 1.0},
    {"step_cloud_thick_60", COLUMNS, NADIR, NEPH_STAGE_STEP_CLOUD, 18.0, 1.0, HG(0.85), 0.5},
    {"step_cloud_thick_60_99", COLUMNS, NADIR, NEPH_STAGE_STEP_CLOUD, 18.0, 0.99, HG(0.85), 0.5},
};

int neph_check_count(void)
{
    return (int)(sizeof(rows) / sizeof(rows[0]));
}

static enum neph_stage_truth find_row_reference(const struct row *row)
{
    return row->rung == FURNACE      ? NEPH_STAGE_TRUTH_FURNACE
           : row->rung == SINGLE     ? NEPH_STAGE_TRUTH_RAY
           : row->rung == HALF_SPACE ? NEPH_STAGE_TRUTH_HALF_SPACE
           : row->rung == COLUMNS    ? NEPH_STAGE_TRUTH_COLUMNS
                                     : NEPH_STAGE_TRUTH_SLAB;
}

/* A frame with a vertical field of view of 40 degrees, at 60 degrees azimuth from the sun. */
static struct neph_check_view look(const struct row *row, const char *name, double elevation_rad)
{
    return (struct neph_check_view){
        .stage = {.name = name,
                  .medium = row->medium,
                  .truth = find_row_reference(row),
                  .optical_depth = row->optical_depth,
                  .albedo = row->albedo,
                  .phase = row->phase,
                  .sun_cosine = row->sun_cosine,
                  .view_azimuth_rad = 60.0 * NEPH_RAD_PER_DEG,
                  .view_elevation_rad = elevation_rad,
                  .vertical_fov_rad = 40.0 * NEPH_RAD_PER_DEG,
                  .aspect = 1.5},
        .weight = NEPH_CHECK_MEAN,
        .factor = 1.0,
        .width_px = 24,
        .height_px = 16,
    };
}

/* The face towards the slab and the near halves of the four horizontal faces. The radiance is
 * symmetric about the sun's vertical plane, so one of the two faces across it counts twice. */
void neph_check_hemisphere(const struct neph_stage_params *stage, double side,
                           struct neph_check_view views[NEPH_CHECK_FACES])
{
    static const struct {
        double azimuth_rad, elevation_rad, factor;
    } faces[NEPH_CHECK_FACES] = {{0.0, 90.0 * NEPH_RAD_PER_DEG, 1.0},
                                 {0.0, 0.0, 1.0},
                                 {180.0 * NEPH_RAD_PER_DEG, 0.0, 1.0},
                                 {90.0 * NEPH_RAD_PER_DEG, 0.0, 2.0}};
    for (int i = 0; i < NEPH_CHECK_FACES; i++) {
        /* Horizontal faces are tilted by 1e-9 rad towards the slab, which puts their camera on this
         * side of it. */
        const double elevation_rad = fmax(faces[i].elevation_rad, 1e-9);
        views[i] = (struct neph_check_view){.stage = *stage,
                                            .weight = NEPH_CHECK_FLUX,
                                            .factor = faces[i].factor,
                                            .width_px = 16,
                                            .height_px = 16};
        views[i].stage.view_azimuth_rad = faces[i].azimuth_rad;
        views[i].stage.view_elevation_rad = side * fmin(elevation_rad, 89.99 * NEPH_RAD_PER_DEG);
        views[i].stage.vertical_fov_rad = 90.0 * NEPH_RAD_PER_DEG;
        views[i].stage.aspect = 1.0;
    }
}

static void add_hemisphere(const struct row *row, struct neph_check *check, double side)
{
    const struct neph_check_view view = look(row, check->name, side);
    neph_check_hemisphere(&view.stage, side, &check->views[check->view_count]);
    check->view_count += NEPH_CHECK_FACES;
}

/* Three rays for each column. The height of the frame is Cycles' smallest field of view. */
static void add_nadir(const struct row *row, struct neph_check *check)
{
    struct neph_check_view view = look(row, check->name, -90.0 * NEPH_RAD_PER_DEG);
    view.width_px = 48;
    view.height_px = 16;
    view.stage.aspect = 3.0;
    view.stage.vertical_fov_rad = 2.0 * atan(NEPH_STAGE_COLUMNS_TANGENT / view.stage.aspect);
    check->views[check->view_count++] = view;
}

/* Two narrow frames; in the second one the cosines of sun and camera are exchanged. */
static void add_reciprocal(const struct row *row, struct neph_check *check)
{
    const double cosines[2] = {row->sun_cosine, 0.35};
    for (int i = 0; i < 2; i++) {
        struct neph_check_view view = look(row, check->name, -asin(cosines[1 - i]));
        view.stage.sun_cosine = cosines[i];
        view.stage.vertical_fov_rad = 4.0 * NEPH_RAD_PER_DEG;
        view.factor = (i == 0 ? 1.0 : -1.0) / cosines[i];
        check->views[check->view_count++] = view;
    }
}

static void describe(const struct row *row, char *text, size_t size)
{
    static const char *const media[] = {
        [NEPH_STAGE_SLAB] = "a homogeneous slab, endless sideways, black below",
        [NEPH_STAGE_FOG] = "height fog without end over black ground",
        [NEPH_STAGE_BOX] = "a homogeneous cube",
        [NEPH_STAGE_GAUSSIAN] = "a Gaussian blob",
        [NEPH_STAGE_GRID] = "a cube of 4 x 4 x 4 uneven voxels",
        [NEPH_STAGE_FOG_BOX] = "height fog in a cube",
        [NEPH_STAGE_SHELL] = "an atmosphere around a small ball, in a cube",
        [NEPH_STAGE_TENT] = "a layer around a small ball, in a cube",
        [NEPH_STAGE_CLOUDS] = "Horizon clouds in a cube",
        [NEPH_STAGE_STEP_CLOUD] = "columns of optical depth 2 and 18 in turn, 8 km of each",
    };
    static const char *const observables[] = {
        [LOOK_DOWN] = "seen from above",
        [LOOK_UP] = "seen from below",
        [CONSERVATION] =
            "all light that leaves it, above and below, by the faces of two half cubes",
        [NADIR] = "from high above, straight down on 8 km of the depth named",
        [RECIPROCITY] = "two narrow views, one with the places of camera and sun exchanged",
    };
    const struct neph_phase_row *phase = neph_phase_row(row->phase.kind);
    char g[32] = "", light[64] = "lit evenly from all sides";
    if (phase->parameters & NEPH_PHASE_PARAMETER_G)
        snprintf(g, sizeof(g), ", g = %g", row->phase.g);
    if (row->rung == FURNACE && row->albedo < 1.0)
        snprintf(light, sizeof(light), "lit evenly from all sides, and as hot as that");
    if (row->rung != FURNACE)
        snprintf(light, sizeof(light), "sun %.0f degrees high",
                 asin(row->sun_cosine) / NEPH_RAD_PER_DEG);
    snprintf(text, size, "%s: optical depth %g, albedo %g, %s scattering%s; %s; %s",
             media[row->medium], row->optical_depth, row->albedo, phase->title, g, light,
             observables[row->observable]);
}

void neph_check_get(int index, struct neph_check *check)
{
    const struct row *row = &rows[index];
    memset(check, 0, sizeof(*check));
    describe(row, check->what, sizeof(check->what));
    snprintf(check->name, sizeof(check->name), "%s", row->name);
    check->rung = neph_check_rungs[row->rung].name;
    check->uneven = row->medium != NEPH_STAGE_SLAB && row->medium != NEPH_STAGE_BOX &&
                    row->medium != NEPH_STAGE_STEP_CLOUD; /* which consists of homogeneous boxes */
    /* Without absorption the number n of scatterings falls off as e^(-n pi^2 / (3 tau^2)): at tau =
     * 30, one in 40 of the long paths has more than 1024. */
    check->deep = row->optical_depth >= 30.0 && row->albedo > 0.99;
    check->truth_only = row->observable == CONSERVATION;
    switch (row->observable) {
    case LOOK_DOWN:
    case LOOK_UP: {
        const double side = row->observable == LOOK_DOWN ? -1.0 : 1.0;
        check->views[check->view_count++] = look(row, check->name, side * 50.0 * NEPH_RAD_PER_DEG);
        break;
    }
    case CONSERVATION:
        add_hemisphere(row, check, -1.0);
        add_hemisphere(row, check, 1.0);
        break;
    case RECIPROCITY:
        add_reciprocal(row, check);
        break;
    case NADIR:
        add_nadir(row, check);
        break;
    }
}

struct neph_pixel_ray neph_check_ray(const struct neph_check_view *view,
                                     const struct neph_camera *camera, int pixel)
{
    return neph_camera_ray(camera, view->width_px, view->height_px, pixel % view->width_px,
                           pixel / view->width_px);
}

double neph_check_pixel_weight(const struct neph_check_view *view, const struct neph_camera *camera,
                               struct neph_vec3 direction)
{
    const double pixels = (double)view->width_px * (double)view->height_px;
    if (view->weight == NEPH_CHECK_MEAN)
        return 1.0 / pixels;
    const double side = view->stage.view_elevation_rad < 0.0 ? -1.0 : 1.0;
    const double cosine = side * direction.y;
    if (cosine <= 0.0)
        return 0.0;
    /* Solid angle of a pixel on a flat sensor at distance 1: its area times the cube of the
     * off-axis cosine. */
    const double height = 2.0 * tan(0.5 * view->stage.vertical_fov_rad);
    const double width = height * view->width_px / view->height_px;
    const double off_axis = neph_vec3_dot(direction, camera->forward);
    const double solid_angle_sr = width * height / pixels * off_axis * off_axis * off_axis;
    return cosine * solid_angle_sr / (view->stage.sun_cosine * NEPH_STAGE_IRRADIANCE_W_PER_M2);
}
