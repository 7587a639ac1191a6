/* SPDX-License-Identifier: MIT
 *
 * Single paths of the tracer against noise-free truths: exact single scattering, slabs by doubling,
 * Chandrasekhar's half-space, the white furnace.
 *
 * Tolerances: 4.5 standard errors of the estimate itself (wrong once in 150 000 for a normal
 * variable; the seeds are fixed, so a passing test continues to pass), plus the truth's own error.
 */
#include "tests/scene_builders.h"

#include "scenes/grid.h"
#include "scenes/media.h"
#include "scenes/phase_table.h"
#include "truth/directions.h"
#include "truth/path.h"
#include "truth/slab.h"
#include "truth/transport.h"

static const double sigmas = 4.5;
/* ---- estimates ---- */

struct estimate {
    double mean[3], error[3]; /* standard error of the mean */
};

enum part { PART_ALL, PART_ORDER1 };

/* The view of sample n. */
typedef struct neph_view view_maker(const struct neph_scene *scene, struct neph_random *random,
                                    const void *context);

/* `flights`: with the tables of the first flight. */
static struct estimate estimate_with(const struct neph_scene *scene, view_maker *make,
                                     const void *context, enum part part, int all_samples,
                                     bool flights)
{
    const int samples = neph_test_paths(all_samples);
    struct neph_diag diag = {0};
    struct neph_tracker *tracker;
    neph_assert_ok(neph_tracker_create(scene, &tracker, &diag), &diag);
    struct neph_tracking_cost cost = {0, 0};
    struct neph_flight flight = {.count = 0};
    double sum[3] = {0}, squares[3] = {0};
    for (int n = 0; n < samples; n++) {
        struct neph_random random = neph_random_stream(5, 0, (uint64_t)n);
        const struct neph_view view = make(scene, &random, context);
        const struct neph_ray ray = {view.origin_m, view.direction, view.hit.t_m};
        if (flights && memcmp(&ray, &flight.ray, sizeof(ray)) != 0)
            neph_flight_init(&flight, scene, &ray);
        const struct neph_path_light light = neph_path_trace(
            scene, tracker, &view, flights ? &flight : NULL, &random, &cost);
        struct neph_rgb rgb = light.order1;
        if (part == PART_ALL)
            rgb = neph_rgb_add(view.unscattered, neph_rgb_add(light.volume, light.surface));
        const double value[3] = {rgb.r, rgb.g, rgb.b};
        for (int j = 0; j < 3; j++) {
            assert_true(isfinite(value[j]) && value[j] >= 0.0);
            sum[j] += value[j];
            squares[j] += value[j] * value[j];
        }
    }
    neph_tracker_destroy(tracker);
    struct estimate result;
    for (int j = 0; j < 3; j++) {
        result.mean[j] = sum[j] / samples;
        result.error[j] = sqrt(fmax(0.0, squares[j] / samples - result.mean[j] * result.mean[j]) /
                               (samples - 1));
    }
    return result;
}

static struct estimate estimate(const struct neph_scene *scene, view_maker *make,
                                const void *context, enum part part, int samples)
{
    return estimate_with(scene, make, context, part, samples, false);
}

struct line {
    struct neph_vec3 origin_m, direction;
};

static struct neph_view fixed_view(const struct neph_scene *scene, struct neph_random *random,
                                   const void *context)
{
    (void)random;
    const struct line *line = context;
    return neph_view_create(scene, line->origin_m, line->direction);
}

/* Lines from a point with directions by the cosine law about an axis: pi times the mean radiance is
 * the flux through a plane perpendicular to the axis. */
static struct neph_view flux_view(const struct neph_scene *scene, struct neph_random *random,
                                  const void *context)
{
    const struct line *axis = context;
    return neph_view_create(scene, axis->origin_m, neph_cosine_sample(axis->direction, random));
}

/* ---- media ---- */

static struct neph_medium two_fogs(void)
{
    struct neph_medium fog = make_height_fog(0.2, 0.5);
    fog.layers[1] = (struct neph_fog_layer){0.05, 0.1, 1.0};
    fog.layer_count = 2;
    return fog;
}

/* A planet of 90 m, the ground at y = -11, behind much of its air. */
static struct neph_medium planet(void)
{
    return make_shell(5.6, (struct neph_vec3){0, -101, 0}, 90, 3);
}

/* Rough voxels, a third of them empty. */
static struct neph_medium voxels(struct neph_vec3 origin_m, double spacing_m,
                                 double extinction_per_m)
{
    uint64_t seed = 99;
    const struct neph_vec3 spacing = {spacing_m, spacing_m, spacing_m};
    return make_voxels(extinction_per_m,
                       random_lattice((const int[3]){7, 6, 5}, origin_m, spacing, -0.5, &seed));
}

static void free_media(struct neph_scene *scene)
{
    for (int m = 0; m < scene->medium_count; m++)
        neph_grid_destroy(scene->media[m].grid);
}

static const struct neph_bounds cube = {{-2, -1, -2}, {2, 2, 2}};
static const struct neph_phase forward = {NEPH_PHASE_HENYEY_GREENSTEIN, 0.6};
static const struct neph_phase rayleigh = {NEPH_PHASE_RAYLEIGH, 0.0};

static struct neph_scene sunny(enum neph_scattering scattering)
{
    return (struct neph_scene){
        .scattering = scattering,
        .sun = {true, neph_vec3_normalize((struct neph_vec3){0.5, 0.7, 0.3}), {3, 2, 1}},
        .background_w_per_m2_sr = {0.02, 0.03, 0.05},
    };
}

static void add_medium(struct neph_scene *scene, struct neph_medium medium,
                       const struct neph_phase *phase, struct neph_rgb color,
                       struct neph_rgb albedo)
{
    medium.extinction_color = color;
    medium.albedo = albedo;
    if (phase)
        medium.phase = *phase;
    scene->media[scene->medium_count++] = medium;
}

/* The grey scene of one channel of a coloured scene. Shares the grids. */
static struct neph_scene one_channel(const struct neph_scene *scene, int channel)
{
    struct neph_scene grey = *scene;
    for (int m = 0; m < scene->medium_count; m++) {
        struct neph_medium *medium = &grey.media[m];
        const double color[3] = {medium->extinction_color.r, medium->extinction_color.g,
                                 medium->extinction_color.b};
        medium->extinction_color = white;
        medium->extinction_per_m *= color[channel];
        for (int l = 0; l < medium->layer_count; l++)
            medium->layers[l].extinction_per_m *= color[channel];
    }
    return grey;
}

static double rgb_component(struct neph_rgb rgb, int channel)
{
    return channel == 0 ? rgb.r : channel == 1 ? rgb.g : rgb.b;
}

/* ---- single scattering ---- */

static const struct line lines[] = {
    {{-6, 1.5, 0.5}, {0.98, -0.17, -0.1}}, /* through all from outside */
    {{0.2, 0.3, 0.4}, {0.1, 0.2, 1}},      /* from inside, upwards */
    {{-1, 6, 0}, {0.1, -1, 0.1}},          /* from above */
    {{0.1, 1.5, 0.1}, {1, 0, 0}},          /* level, above the wall */
};

enum { BRUTE_STEPS = 3000 };

/* Single scattering of one channel by the midpoint rule on its definition, all media together, in t
 * = e^u - 1 m out to 3 km. */
static double brute_force(const struct neph_scene *grey, const struct line *line, int channel,
                          int steps)
{
    const struct neph_hit hit = neph_scene_hit(grey, line->origin_m, line->direction);
    const double step = log1p(fmin(3000.0, hit.t_m)) / steps;
    const double cosine = neph_vec3_dot(line->direction, grey->sun.direction);
    double sum = 0.0, depth = 0.0;
    for (int i = 0; i < steps; i++) {
        const double t_m = expm1((i + 0.5) * step), step_m = step * (1.0 + t_m);
        const struct neph_vec3 p = neph_vec3_along(line->origin_m, line->direction, t_m);
        double scattered = 0.0, extinction_per_m = 0.0;
        for (int m = 0; m < grey->medium_count; m++) {
            const struct neph_medium *medium = &grey->media[m];
            const double own_per_m = neph_medium_extinction_per_m(medium, p);
            extinction_per_m += own_per_m;
            scattered += own_per_m * rgb_component(medium->albedo, channel) *
                         neph_phase_per_sr(&medium->phase, cosine);
        }
        depth += 0.5 * extinction_per_m * step_m;
        if (scattered > 0.0 && depth < 40.0 && neph_scene_is_sun_visible(grey, p))
            sum += scattered * step_m *
                   exp(-depth -
                       neph_scene_optical_depth(grey, p, grey->sun.direction, 0.0, INFINITY).r);
        depth += 0.5 * extinction_per_m * step_m;
    }
    return sum * rgb_component(grey->sun.irradiance_w_per_m2, channel);
}

/* `error`: of brute force twice the difference to half as many steps, a bound for a rule of second
 * order (including the few steps that straddle a face or a kink). */
struct truth {
    double value, error;
};

/* Radiance of one channel: exact if every medium is a fog, otherwise brute force. */
static struct truth single_scattering(const struct neph_scene *scene, const struct line *line,
                                      int channel)
{
    const struct neph_scene grey = one_channel(scene, channel);
    bool all_fogs = true;
    for (int m = 0; m < grey.medium_count; m++)
        all_fogs = all_fogs && grey.media[m].layer_count > 0;
    if (all_fogs) {
        const struct neph_ray_light light = neph_transport_ray(&grey, line->origin_m,
                                                               line->direction);
        return (struct truth){rgb_component(light.radiance, channel), light.quadrature_error};
    }
    const struct neph_view view = neph_view_create(&grey, line->origin_m, line->direction);
    const double fine = brute_force(&grey, line, channel, BRUTE_STEPS);
    const double coarse = brute_force(&grey, line, channel, BRUTE_STEPS / 2);
    return (struct truth){rgb_component(view.unscattered, channel) + fine,
                          2.0 * fabs(fine - coarse)};
}

static void check_line(const char *name, const struct neph_scene *scene, const struct line *line,
                       const struct truth truth[3], bool flights)
{
    enum { SAMPLES = 12000 };
    const struct estimate found = estimate_with(scene, fixed_view, line, PART_ALL, SAMPLES,
                                                flights);
    const double most = fmax(truth[0].value, fmax(truth[1].value, truth[2].value));
    double error = 0.0;
    for (int j = 0; j < 3; j++) {
        /* A channel with very little extinction has too few lit paths for a standard error: it must
         * be accurate to 2e-3 of the brightest. */
        const double allowed = sigmas * found.error[j] + truth[j].error + 2e-3 * most;
        const double off = fabs(found.mean[j] - truth[j].value);
        if (!(off <= allowed))
            print_error("%s, channel %d, table %d: %.9g +- %.2g, expected %.9g +- %.2g\n", name, j,
                        flights, found.mean[j], found.error[j], truth[j].value, truth[j].error);
        assert_true(off <= allowed);
        error = fmax(error, found.error[j] + truth[j].error);
    }
    assert_true(error < neph_test_noise(0.04) * most); /* the test can fail */
}

/* Each channel of the tracer's single scattering against its grey scene. */
static void check_single_scattering(const char *name, const struct neph_scene *scene)
{
    for (size_t i = 0; i < COUNT(lines); i++) {
        const struct line line = {lines[i].origin_m, neph_vec3_normalize(lines[i].direction)};
        struct truth truth[3];
        for (int j = 0; j < 3; j++)
            truth[j] = single_scattering(scene, &line, j);
        check_line(name, scene, &line, truth, false);
        check_line(name, scene, &line, truth, true);
    }
}

static void check_one_medium(const char *name, struct neph_medium medium)
{
    struct neph_scene scene = sunny(NEPH_SCATTERING_SINGLE);
    add_medium(&scene, medium, &forward, white, (struct neph_rgb){0.9, 0.5, 1});
    check_single_scattering(name, &scene);
    scene.media[0].extinction_color = (struct neph_rgb){0.5, 1, 2.5};
    check_single_scattering(name, &scene);
    free_media(&scene);
}

static void test_single_scattering_of_one_medium(void **state)
{
    check_one_medium("homogeneous", make_homogeneous(0.7, cube));
    check_one_medium("two fogs", two_fogs());
    check_one_medium("Gaussian", make_blob(0.9, (struct neph_vec3){0.5, 0.4, 0.3}, 0.8));
    check_one_medium("shell", planet());
    check_one_medium("voxels", voxels((struct neph_vec3){-1.5, -0.5, -1}, 0.5, 1.3));
}

/* A visible wall and a bar that casts a shadow. */
static void add_solids(struct neph_scene *scene, struct neph_solid solids[2])
{
    solids[0] = (struct neph_solid){
        .kind = NEPH_SOLID_BOX, .box = {{3, -5, -9}, {4, 1, 9}}, .albedo = {0.5, 0.6, 0.7}};
    solids[1] = (struct neph_solid){
        .kind = NEPH_SOLID_SPHERE, .center_m = {0.6, 3.0, 0.5}, .radius_m = 0.8};
    scene->solid_count = 2;
    scene->solids = solids;
}

/* Overlapping, with different colours, phase functions and albedos; one medium is absent in one
 * channel. */
static void test_single_scattering_of_coloured_media_and_solids(void **state)
{
    struct neph_solid solids[2];
    struct neph_scene scene = sunny(NEPH_SCATTERING_SINGLE);
    add_solids(&scene, solids);
    add_medium(&scene, make_homogeneous(0.3, cube), &forward, (struct neph_rgb){0.4, 1, 2},
               (struct neph_rgb){0.9, 0.8, 0.7});
    add_medium(&scene, two_fogs(), NULL, (struct neph_rgb){2, 1, 0}, (struct neph_rgb){1, 1, 1});
    check_single_scattering("two analytic media", &scene);
    add_medium(&scene, make_blob(0.4, (struct neph_vec3){1, 0, 0}, 1.0), &rayleigh,
               (struct neph_rgb){1, 0.5, 3}, (struct neph_rgb){0.5, 1, 1});
    add_medium(&scene, voxels((struct neph_vec3){-1.5, -0.5, -1}, 0.5, 1.0), &forward,
               (struct neph_rgb){0.2, 1, 1}, (struct neph_rgb){1, 0.7, 0.9});
    check_single_scattering("four media", &scene);
    scene.media[0] = scene.media[3]; /* two that need candidates, with different colours */
    scene.media[1] = scene.media[2];
    scene.medium_count = 2;
    check_single_scattering("voxels and Gaussian", &scene);
    neph_grid_destroy(scene.media[0].grid);
}

/* ---- all orders ---- */

static const struct neph_bounds layer = {{-INFINITY, 0, -INFINITY}, {INFINITY, 1, INFINITY}};
static const struct neph_vec3 above_m = {0, 2, 0}, below_m = {0, -1, 0};
static const struct neph_vec3 up = {0, 1, 0}, down = {0, -1, 0};

/* A layer of 1 m under a sun of irradiance 1. */
static struct neph_scene slab_scene(double optical_depth, double albedo, struct neph_phase phase,
                                    double sun_cosine)
{
    struct neph_scene scene = {.scattering = NEPH_SCATTERING_MULTIPLE};
    const double sine = sqrt(1.0 - sun_cosine * sun_cosine);
    scene.sun = (struct neph_sun){true, {sine, sun_cosine, 0}, white};
    add_medium(&scene, make_homogeneous(optical_depth, layer), &phase, white,
               (struct neph_rgb){albedo, albedo, albedo});
    return scene;
}

/* Light that enters along the sun's direction and ends in the surroundings, which are visible only
 * above (or below), as a black plane closes the other side: reflectance (transmittance). */
static struct estimate share_that_leaves(const struct neph_scene *slab, bool upwards, int samples)
{
    struct neph_solid plane = {.kind = NEPH_SOLID_BOX};
    plane.box = upwards ? (struct neph_bounds){{-1e9, -2, -1e9}, {1e9, -1, 1e9}}
                        : (struct neph_bounds){{-1e9, 3, -1e9}, {1e9, 4, 1e9}};
    struct neph_scene scene = *slab;
    scene.sun.present = false;
    scene.environment_light = true;
    scene.background_w_per_m2_sr = white;
    scene.solid_count = 1;
    scene.solids = &plane;
    const struct line line = {above_m, neph_vec3_scale(slab->sun.direction, -1.0)};
    return estimate(&scene, fixed_view, &line, PART_ALL, samples);
}

static void check_fluxes(const struct neph_scene *scene, double reflected, double transmitted,
                         int samples)
{
    const struct estimate r = share_that_leaves(scene, true, samples);
    const struct estimate t = share_that_leaves(scene, false, samples);
    print_message("tau %4g: R %.4f +- %.4f, truth %.4f; T %.4f +- %.4f, truth %.4f\n",
                  scene->media[0].layers[0].extinction_per_m, r.mean[0], r.error[0], reflected,
                  t.mean[0], t.error[0], transmitted);
    neph_assert_close(r.mean[0], reflected, 0.0, sigmas * r.error[0] + 5e-5);
    neph_assert_close(t.mean[0], transmitted, 0.0, sigmas * t.error[0] + 5e-5);
}

/* R and T = 1 - R of Henyey-Greenstein 0.85, no absorption, sun cosine 0.7, to the digits given
 * (doubling of 128 streams, checked against DISORT); and the same from sunlight. */
static void test_conservative_slabs(void **state)
{
    static const struct {
        double optical_depth, reflected;
        int samples;
    } rows[] = {{1, 0.0907, 200000}, {4, 0.3109, 100000}, {16, 0.6397, 40000}, {64, 0.8749, 10000}};
    const struct neph_phase phase = {NEPH_PHASE_HENYEY_GREENSTEIN, 0.85};
    for (size_t i = 0; i < COUNT(rows); i++) {
        const struct neph_scene scene = slab_scene(rows[i].optical_depth, 1.0, phase, 0.7);
        check_fluxes(&scene, rows[i].reflected, 1.0 - rows[i].reflected, rows[i].samples);
        const struct line top = {above_m, down}, bottom = {below_m, up};
        const int samples = rows[i].samples / 10;
        const struct estimate r = estimate(&scene, flux_view, &top, PART_ALL, samples);
        const struct estimate t = estimate(&scene, flux_view, &bottom, PART_ALL, samples);
        const double direct = exp(-rows[i].optical_depth / 0.7), per_flux = M_PI / 0.7;
        neph_assert_close(per_flux * r.mean[0], rows[i].reflected, 0.0,
                          sigmas * per_flux * r.error[0] + 5e-5);
        neph_assert_close(per_flux * t.mean[0] + direct, 1.0 - rows[i].reflected, 0.0,
                          sigmas * per_flux * t.error[0] + 5e-5);
    }
}

/* Radiances upwards and downwards against doubling. */
static void check_slab(double optical_depth, double albedo, struct neph_phase phase, int samples)
{
    static const double cosines[] = {0.25, 0.8};
    const struct neph_slab_params params = {.optical_depth = optical_depth,
                                            .albedo = albedo,
                                            .phase = phase,
                                            .sun_cosine = 0.6,
                                            .view_count = COUNT(cosines),
                                            .view_cosines = cosines,
                                            .node_count = 24};
    struct neph_diag diag = {0};
    struct neph_slab *slab;
    neph_assert_ok(neph_slab_create(&params, &slab, &diag), &diag);
    const struct neph_scene scene = slab_scene(optical_depth, albedo, phase, params.sun_cosine);
    for (int v = 0; v < params.view_count; v++) {
        const double sine = sqrt(1.0 - cosines[v] * cosines[v]), azimuth = 2.0;
        /* Light leaves upwards with azimuth `azimuth` against the sunlight's direction of travel,
         * along -x; the camera looks in the opposite direction. */
        const struct neph_vec3 side = {sine * cos(azimuth), 0, -sine * sin(azimuth)};
        const struct line from_top = {above_m, {side.x, -cosines[v], side.z}};
        const struct line from_bottom = {below_m, {side.x, cosines[v], side.z}};
        const struct estimate r = estimate(&scene, fixed_view, &from_top, PART_ALL, samples);
        const struct estimate t = estimate(&scene, fixed_view, &from_bottom, PART_ALL, samples);
        neph_assert_close(r.mean[0], neph_slab_reflected_per_sr(slab, v, azimuth), 1e-5,
                          sigmas * r.error[0]);
        neph_assert_close(t.mean[0], neph_slab_transmitted_per_sr(slab, v, azimuth), 1e-5,
                          sigmas * t.error[0]);
    }
    neph_slab_destroy(slab);
}

static void test_slabs_against_doubling(void **state)
{
    check_slab(0.5, 1.0, (struct neph_phase){NEPH_PHASE_ISOTROPIC, 0.0}, 30000);
    check_slab(3.0, 0.9, rayleigh, 30000);
    check_slab(8.0, 0.99, (struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, 0.5}, 20000);
    check_slab(2.0, 0.95, (struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, -0.4}, 20000);
}

/* Henyey-Greenstein, written as two equal lobes: kinds that can have a peak have some directions
 * drawn around the sun. The mean is that of doubling, or of Henyey-Greenstein itself, and seen from
 * below, where few paths bring the sunlight by chance, its error is less. */
static struct neph_phase twice(double g)
{
    return (struct neph_phase){NEPH_PHASE_DOUBLE_HENYEY_GREENSTEIN, g, g, 0.5};
}

static void test_directions_around_the_sun_against_doubling(void **state)
{
    check_slab(0.5, 1.0, twice(0.5), 20000);
    check_slab(4.0, 0.95, twice(0.7), 20000);
}

static void test_directions_around_the_sun_keep_the_mean(void **state)
{
    static const struct line views[] = {{{0, 3, 0}, {0, -0.6, 0.8}}, {{0, -1, 0}, {0, 0.8, 0.6}}};
    struct neph_solid ground = {.kind = NEPH_SOLID_BOX,
                                .box = {{-1e9, -5, -1e9}, {1e9, -4, 1e9}},
                                .albedo = {0.6, 0.5, 0.4}};
    struct neph_scene scenes[2];
    for (int i = 0; i < 2; i++) {
        scenes[i] = slab_scene(1.5, 0.98, twice(0.97), 0.6);
        scenes[i].solids = &ground;
        scenes[i].solid_count = 1;
        scenes[i].media[0].extinction_color = (struct neph_rgb){0.8, 1, 1.2};
    }
    scenes[1].media[0].phase = (struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, 0.97};
    for (size_t i = 0; i < COUNT(views); i++) {
        const struct estimate some = estimate(&scenes[0], fixed_view, &views[i], PART_ALL, 40000);
        const struct estimate none = estimate(&scenes[1], fixed_view, &views[i], PART_ALL, 40000);
        for (int j = 0; j < 3; j++) {
            print_message("%.5f +- %.5f, without %.5f +- %.5f\n", some.mean[j], some.error[j],
                          none.mean[j], none.error[j]);
            neph_assert_close(some.mean[j], none.mean[j], 0.0,
                              sigmas * hypot(some.error[j], none.error[j]));
            if (i == 1 && neph_test_path_step() <= 3) /* not under the sanitizers */
                assert_true(some.error[j] < 0.5 * none.error[j]);
        }
    }
}

/* A table of three channels above a ground, whose reflection is the same in all of them: each
 * channel is that of the table of its column. */
static void test_directions_around_the_sun_by_channel(void **state)
{
    enum { ROWS = 1801 };
    static const double lobes[3] = {0.95, 0.8, 0.3};
    static double angles_deg[ROWS], columns[3][ROWS], values[3 * ROWS];
    const struct line view = {{0, -1, 0}, {0, -0.8, 0.6}};
    struct neph_solid ground = {.kind = NEPH_SOLID_BOX,
                                .box = {{-1e9, -5, -1e9}, {1e9, -4, 1e9}},
                                .albedo = {0.8, 0.8, 0.8}};
    struct neph_arena arena = {NULL};
    struct neph_phase phase = {.kind = NEPH_PHASE_TABLE};
    for (int i = 0; i < ROWS; i++) {
        angles_deg[i] = 0.1 * i;
        for (int c = 0; c < 3; c++) {
            const struct neph_phase lobe = {NEPH_PHASE_HENYEY_GREENSTEIN, lobes[c]};
            columns[c][i] = values[3 * i + c] = neph_phase_per_sr(
                &lobe, cos(angles_deg[i] * M_PI / 180.0));
        }
    }
    neph_assert_ok(
        neph_phase_table_make_coloured(ROWS, angles_deg, values, &arena, &phase.table, NULL), NULL);
    struct neph_scene scene = slab_scene(1.0, 1.0, phase, 0.8);
    scene.solids = &ground;
    scene.solid_count = 1;
    const struct estimate all = estimate(&scene, fixed_view, &view, PART_ALL, 60000);
    for (int c = 0; c < 3; c++) {
        neph_assert_ok(neph_phase_table_make(ROWS, angles_deg, columns[c], &arena,
                                             &scene.media[0].phase.table, NULL),
                       NULL);
        const struct estimate own = estimate(&scene, fixed_view, &view, PART_ALL, 60000);
        print_message("%.5f +- %.5f, alone %.5f +- %.5f\n", all.mean[c], all.error[c], own.mean[c],
                      own.error[c]);
        neph_assert_close(all.mean[c], own.mean[c], 0.0,
                          sigmas * hypot(all.error[c], own.error[c]));
        assert_true(own.error[c] < neph_test_noise(0.02) * own.mean[c]);
    }
    neph_arena_finish(&arena);
}

/* Any vertical profile is equivalent to a slab of its whole depth: fog above black ground, a wide
 * grid with an uneven profile, and the atmosphere of a planet so large that it is flat to 1e-5. */
static void check_profile(const char *name, struct neph_medium medium, double optical_depth,
                          bool flights)
{
    static const double cosine = 0.8;
    const struct neph_phase phase = {NEPH_PHASE_HENYEY_GREENSTEIN, 0.5};
    const struct neph_slab_params params = {.optical_depth = optical_depth,
                                            .albedo = 0.95,
                                            .phase = phase,
                                            .sun_cosine = 0.6,
                                            .view_count = 1,
                                            .view_cosines = &cosine,
                                            .node_count = 24};
    struct neph_diag diag = {0};
    struct neph_slab *slab;
    neph_assert_ok(neph_slab_create(&params, &slab, &diag), &diag);
    struct neph_scene scene = slab_scene(optical_depth, 0.95, phase, params.sun_cosine);
    medium.albedo = scene.media[0].albedo;
    medium.phase = phase;
    scene.media[0] = medium;
    struct neph_solid ground = {.kind = NEPH_SOLID_BOX, .box = {{-2e4, -1e4, -2e4}, {2e4, 0, 2e4}}};
    scene.solids = &ground;
    scene.solid_count = 1;
    const struct line line = {{0, 100, 0}, {-0.6, -cosine, 0}}; /* azimuth 0 */
    const struct estimate found = estimate_with(&scene, fixed_view, &line, PART_ALL, 30000,
                                                flights);
    const double truth = neph_slab_reflected_per_sr(slab, 0, M_PI);
    print_message("%s: %.6f +- %.6f, truth %.6f\n", name, found.mean[0], found.error[0], truth);
    neph_assert_close(found.mean[0], truth, 1e-5, sigmas * found.error[0]);
    neph_slab_destroy(slab);
}

static void test_vertical_profiles_are_slabs(void **state)
{
    struct neph_medium fog = two_fogs();
    fog.layers[0] = (struct neph_fog_layer){0.3, 0.2, 0.0};
    fog.layers[1] = (struct neph_fog_layer){0.05, 0.1, 5.0};
    check_profile("fog", fog, 0.3 / 0.2 + 0.05 * exp(0.5) / 0.1, true);

    struct neph_diag diag = {0};
    struct neph_grid *grid;
    neph_assert_ok(neph_grid_create((const int[3]){2, 6, 2}, (struct neph_vec3){-1e4, 2, -1e4},
                                    (struct neph_vec3){2e4, 1.5, 2e4}, &grid, &diag),
                   &diag);
    static const float profile[6] = {0.2f, 1.5f, 0.0f, 0.0f, 2.5f, 0.1f};
    double sum = 0.0;
    for (int n = 0; n < 24; n++)
        grid->values[n] = profile[n / 2 % 6];
    for (int j = 0; j < 6; j++)
        sum += (double)profile[j] * 1.5;
    neph_assert_ok(neph_grid_seal(grid, &diag), &diag);
    const struct neph_medium voxel_layers = {.kind = NEPH_MEDIUM_GRID,
                                             .bounds = everywhere,
                                             .extinction_color = white,
                                             .extinction_per_m = 0.5,
                                             .grid = grid};
    check_profile("grid", voxel_layers, 0.5 * sum, false);
    check_profile("grid, with table", voxel_layers, 0.5 * sum, true);
    neph_grid_destroy(grid);

    const struct neph_medium atmosphere = {.kind = NEPH_MEDIUM_SHELL,
                                           .bounds = everywhere,
                                           .extinction_color = white,
                                           .extinction_per_m = 0.25,
                                           .shell = {{0, -1e6, 0}, 1e6, 8}};
    check_profile("shell", atmosphere, 2.0, false);
}

/* A half-space of absorbing fog that thickens downwards to infinity. */
static void test_half_space_against_chandrasekhar(void **state)
{
    const double albedo = 0.9, view_cosine = 0.7, sun_cosine = 0.5;
    struct neph_scene scene = slab_scene(1.0, albedo, (struct neph_phase){0}, sun_cosine);
    scene.media[0].kind = NEPH_MEDIUM_HEIGHT_FOG;
    scene.media[0].bounds = everywhere;
    scene.media[0].layers[0] = (struct neph_fog_layer){0.5, 0.8, 0.0};
    const double sine = sqrt(1.0 - view_cosine * view_cosine);
    const struct line line = {{3, 60, 4}, {0, -view_cosine, sine}};
    const struct estimate found = estimate(&scene, fixed_view, &line, PART_ALL, 100000);
    const double truth = albedo / (4.0 * M_PI) * sun_cosine / (view_cosine + sun_cosine) *
                         neph_chandrasekhar_h(albedo, view_cosine) *
                         neph_chandrasekhar_h(albedo, sun_cosine);
    neph_assert_close(found.mean[0], truth, 0.0, sigmas * found.error[0]);
}

/* ---- colour ---- */

/* All orders, surfaces and surroundings: each channel agrees with its grey scene, which is another
 * estimate with another path for every sample. */
static void test_colour_of_all_orders(void **state)
{
    enum { SAMPLES = 20000 };
    struct neph_solid solids[2];
    struct neph_scene scene = sunny(NEPH_SCATTERING_MULTIPLE);
    add_solids(&scene, solids);
    solids[1].albedo = (struct neph_rgb){0.9, 0.5, 0.1};
    scene.environment_light = true;
    add_medium(&scene, make_homogeneous(0.6, cube), &forward, (struct neph_rgb){0.5, 1, 3},
               (struct neph_rgb){0.99, 0.9, 0.95});
    add_medium(&scene, voxels((struct neph_vec3){-1.5, -0.5, -1}, 0.5, 1.5), &rayleigh,
               (struct neph_rgb){3, 1, 0}, (struct neph_rgb){0.95, 1, 1});
    for (size_t i = 0; i < COUNT(lines); i++) {
        const struct line line = {lines[i].origin_m, neph_vec3_normalize(lines[i].direction)};
        const struct estimate found = estimate_with(&scene, fixed_view, &line, PART_ALL, SAMPLES,
                                                    i % 2 == 0);
        for (int j = 0; j < 3; j++) {
            const struct neph_scene grey = one_channel(&scene, j);
            const struct estimate alone = estimate_with(&grey, fixed_view, &line, PART_ALL, SAMPLES,
                                                        i % 2 == 1);
            const double error = hypot(found.error[j], alone.error[j]);
            neph_assert_close(found.mean[j], alone.mean[j], 0.0, sigmas * error);
            assert_true(error < neph_test_noise(0.03) * alone.mean[j]); /* the test can fail */
        }
    }
    free_media(&scene);
}

/* ---- furnace ---- */

/* No light is lost: solids and media of albedo 1 in uniform surroundings. */
static void test_white_furnace(void **state)
{
    struct neph_solid solids[2];
    struct neph_scene scene = sunny(NEPH_SCATTERING_MULTIPLE);
    add_solids(&scene, solids);
    solids[0].albedo = solids[1].albedo = white;
    scene.sun.present = false;
    scene.environment_light = true;
    scene.background_w_per_m2_sr = (struct neph_rgb){1, 2, 3};
    add_medium(&scene, make_homogeneous(2.0, cube), &forward, (struct neph_rgb){0.3, 1, 2}, white);
    for (size_t i = 0; i < COUNT(lines); i++) {
        const struct line line = {lines[i].origin_m, neph_vec3_normalize(lines[i].direction)};
        const struct estimate found = estimate_with(&scene, fixed_view, &line, PART_ALL, 10000,
                                                    i % 2 == 0);
        for (int j = 0; j < 3; j++)
            neph_assert_close(found.mean[j] / (j + 1.0), 1.0, 0.0,
                              sigmas * found.error[j] / (j + 1.0) + 1e-12);
    }
}

#include "tests/main.h"
