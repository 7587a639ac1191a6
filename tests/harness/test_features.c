/* SPDX-License-Identifier: MIT
 *
 * The table of features in scenes/README.md matches the engines' answers for small scenes that
 * differ in one feature each. `test_features --write` writes the table.
 */
#include "tests/mesh_builders.h"
#include "tests/printed_table.h"

#include "harness/engines/engines.h"
#include "scenes/media.h"

#include <stdio.h>

/* ---- scenes ---------------------------------------------------------------------------------- */

static const struct neph_bounds cube = {{-1, 80, -11}, {1, 360, -9}}; /* a part of a cloud layer */

/* Data that a scene points to. */
struct stage {
    struct test_scene test;
    struct neph_camera_key camera_keys[2];
    struct neph_sun_key sun_keys[2];
    struct neph_light_key light_keys[2];
    struct neph_wind_key wind_keys[1];
    struct neph_solid_key solid_keys[2];
    struct neph_mover mover;
    struct neph_grid *grid;
    struct neph_horizon *horizon;
    struct neph_mesh *mesh;
    struct neph_albedo_texture *leaf;
};

static void change_medium(struct stage *stage, enum neph_medium_kind kind)
{
    const struct neph_vec3 center_m = {0, 100, -10};
    const struct neph_horizon_params clouds = neph_horizon_defaults();
    struct neph_medium *medium = &stage->test.scene.media[0];
    *medium = make_homogeneous(0.1, cube);
    medium->kind = kind;
    medium->albedo = make_grey(0.5);
    medium->extinction_per_m = 0.1;
    medium->gaussian = (struct neph_gaussian){center_m, 0.5};
    medium->shell = (struct neph_shell){{0, -1000, 0}, 1000, 50};
    medium->tent = (struct neph_tent){{0, -1000, 0}, 1000, 100, 50};
    medium->plume = (struct neph_plume){center_m, {0, 1, 0}, 0.5, 20};
    medium->layer_count = neph_medium_is_fog(medium);
    medium->layers[0].falloff_per_m = kind == NEPH_MEDIUM_HEIGHT_FOG ? 0.01 : 0.0;
    if (kind == NEPH_MEDIUM_GRID && !stage->grid) {
        uint64_t seed = 1;
        stage->grid = random_lattice((const int[3]){2, 2, 2}, cube.min_m,
                                     (struct neph_vec3){1, 1, 1}, 0.5, &seed);
    }
    if (kind == NEPH_MEDIUM_HORIZON && !stage->horizon)
        neph_assert_ok(neph_horizon_create(&clouds, &stage->horizon, NULL), NULL);
    medium->grid = kind == NEPH_MEDIUM_GRID ? stage->grid : NULL;
    medium->horizon = kind == NEPH_MEDIUM_HORIZON ? stage->horizon : NULL;
}

/* A medium before the camera in sunlight. */
static void set_stage(struct stage *stage, enum neph_medium_kind kind,
                      enum neph_scattering scattering)
{
    test_scene_init(&stage->test);
    stage->test.scene.medium_count = 1;
    stage->test.scene.scattering = scattering;
    stage->test.scene.octaves = (struct neph_octaves){8, 0.5, 0.5, 0.5};
    change_medium(stage, kind);
}

static struct neph_medium *first_medium(struct stage *stage)
{
    return &stage->test.scene.media[0];
}

static void endless(struct stage *stage)
{
    first_medium(stage)->bounds = everywhere;
}

static void coloured(struct stage *stage)
{
    first_medium(stage)->extinction_color = (struct neph_rgb){0.5, 1, 2};
}

static void henyey_greenstein(struct stage *stage)
{
    first_medium(stage)->phase = (struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, 0.8};
}

static void rayleigh(struct stage *stage)
{
    first_medium(stage)->phase = (struct neph_phase){NEPH_PHASE_RAYLEIGH, 0.0};
}

static void two_phases(struct stage *stage)
{
    stage->test.scene.media[1] = *first_medium(stage);
    stage->test.scene.medium_count = 2;
    henyey_greenstein(stage);
}

/* Non-physical fog; other engines ignore its settings. */
static void look(struct stage *stage)
{
    first_medium(stage)->bounds = everywhere;
    stage->test.scene.fog_look = (struct neph_fog_look){.present = true, .max_opacity = 1.0};
}

/* Only the ground and its air, for engines of skies. */
static void planet(struct stage *stage)
{
    first_medium(stage)->bounds = (struct neph_bounds){{-1e4, -1e4, -1e4}, {1e4, 1e4, 1e4}};
    stage->test.scene.background_w_per_m2_sr = (struct neph_rgb){0, 0, 0};
    test_add_sphere(&stage->test, first_medium(stage)->shell.center_m, 1000.0);
}

static void emission(struct stage *stage)
{
    first_medium(stage)->emission_w_per_m2_sr = white;
}

static void solids(struct stage *stage)
{
    test_add_box(&stage->test, (struct neph_vec3){-9, -2, -19}, (struct neph_vec3){9, -1, -1});
    test_add_sphere(&stage->test, (struct neph_vec3){0, 100, -10}, 0.3);
}

static void add_only_solids(struct stage *stage)
{
    solids(stage);
    stage->test.scene.medium_count = 0;
}

static void meshed(struct stage *stage)
{
    solids(stage);
    if (!stage->mesh)
        stage->mesh = make_box_mesh((struct neph_vec3){-9, -2, -19}, (struct neph_vec3){9, -1, -1});
    stage->mesh->material = (struct neph_mesh_material){0};
    stage->test.solids[0] = (struct neph_solid){
        .kind = NEPH_SOLID_MESH, .mesh = stage->mesh, .scale_m = 1, .albedo = {0.5, 0.5, 0.5}};
}

/* No engine looks at the mesh's data before it renders. */
static void smooth_mesh(struct stage *stage)
{
    meshed(stage);
    stage->mesh->material.is_smooth = true;
}

static void textured_mesh(struct stage *stage)
{
    meshed(stage);
    if (!stage->leaf)
        stage->leaf = make_half_texture(1.0f, 0.0f);
    stage->mesh->material.texture = stage->leaf;
}

static void cut_out_mesh(struct stage *stage)
{
    textured_mesh(stage);
    stage->mesh->material.alpha = NEPH_ALPHA_CUTOUT;
}

static void covered_mesh(struct stage *stage)
{
    textured_mesh(stage);
    stage->mesh->material.alpha = NEPH_ALPHA_COVERAGE;
}

static void cut_out_mesh_in_clear_air(struct stage *stage)
{
    cut_out_mesh(stage);
    stage->test.scene.medium_count = 0;
}

static void textured(struct stage *stage)
{
    add_only_solids(stage);
    stage->test.solids[0].surface.texture = (struct neph_paint){
        .cell_m = 1, .pattern = NEPH_PATTERN_CHECKER, .other = white};
}

static void metal(struct stage *stage)
{
    add_only_solids(stage);
    stage->test.solids[0].surface = (struct neph_surface){.metalness = 1, .roughness = 0.5};
}

/* Under a sky only: Cycles finds no light from mirrors. */
static void mirror(struct stage *stage)
{
    metal(stage);
    stage->test.solids[0].surface.roughness = 0;
    stage->test.scene.sun.present = false;
    stage->test.scene.environment_light = true;
}

static void environment(struct stage *stage)
{
    stage->test.scene.environment_light = true;
}

static void orthographic(struct stage *stage)
{
    stage->test.scene.vertical_fov_rad = 0.0;
    stage->test.scene.orthographic_height_m = 10.0;
}

static void moving_camera(struct stage *stage)
{
    stage->camera_keys[0] = stage->camera_keys[1] = stage->test.key;
    stage->camera_keys[1].frame = 10.0;
    stage->camera_keys[1].position_m.x += 1.0;
    stage->test.scene.camera_keys = stage->camera_keys;
    stage->test.scene.camera_key_count = 2;
    stage->test.scene.frame_count = 11;
}

static void moving_sun(struct stage *stage)
{
    const struct neph_sun *sun = &stage->test.scene.sun;
    stage->sun_keys[0] = (struct neph_sun_key){0, sun->direction, sun->irradiance_w_per_m2};
    stage->sun_keys[1] = (struct neph_sun_key){10, {0, 1, 0}, sun->irradiance_w_per_m2};
    stage->test.scene.sun_keys = stage->sun_keys;
    stage->test.scene.sun_key_count = 2;
    stage->test.scene.frame_count = 11;
}

static void moving_solid(struct stage *stage)
{
    stage->test.solids[0] = make_box(-1, -1, -1, 1, 1, 1);
    stage->test.scene.solid_count = 1;
    stage->solid_keys[0] = (struct neph_solid_key){0, {0, 0, 0}, 0.5};
    stage->solid_keys[1] = (struct neph_solid_key){10, {1, 0, 0}, 1.0};
    stage->mover = (struct neph_mover){0, 1, 1, {0, 0, 0}, 2, stage->solid_keys};
    stage->test.scene.movers = &stage->mover;
    stage->test.scene.mover_count = 1;
    stage->test.scene.frame_count = 11;
}

static void lights(struct stage *stage)
{
    stage->test.scene.light_count = 1;
    stage->test.scene.lights[0] = (struct neph_light){.position_m = {0.0, 3.0, -4.0},
                                                      .intensity_w_per_sr = {1.0, 1.0, 1.0}};
}

static void moving_light(struct stage *stage)
{
    lights(stage);
    struct neph_light *light = &stage->test.scene.lights[0];
    stage->light_keys[0] = (struct neph_light_key){0, light->position_m, light->intensity_w_per_sr,
                                                   light->axis, false};
    stage->light_keys[1] = stage->light_keys[0];
    stage->light_keys[1].frame = 10.0;
    stage->light_keys[1].position_m.x += 1.0;
    light->keys = stage->light_keys;
    light->key_count = 2;
    stage->test.scene.frame_count = 11;
}

static void wind(struct stage *stage)
{
    stage->wind_keys[0].velocity_m_per_s = (struct neph_vec3){1, 0, 0};
    stage->test.scene.wind_keys = stage->wind_keys;
    stage->test.scene.wind_key_count = 1;
    stage->test.scene.frame_count = 11;
}

/* ---- features -------------------------------------------------------------------------------- */

#define KIND(kind) (1u << NEPH_MEDIUM_##kind)
#define LIGHT(scattering) (1u << NEPH_SCATTERING_##scattering)

/* An engine has a feature if it renders it with any of these. */
enum {
    ANY_KIND = KIND(HOMOGENEOUS) | KIND(HORIZON),
    ANY_DRIFT = KIND(GAUSSIAN) | KIND(HORIZON),
    ANY_LIGHT = LIGHT(SINGLE) | LIGHT(MULTIPLE),
};

static const struct feature {
    const char *name;
    unsigned kinds, lights;
    void (*change)(struct stage *stage);
} features[] = {
    {"`homogeneous`", KIND(HOMOGENEOUS), ANY_LIGHT, NULL},
    {"`height_fog`", KIND(HEIGHT_FOG), ANY_LIGHT, NULL},
    {"`height_fog` without bounds", KIND(HEIGHT_FOG), ANY_LIGHT, endless},
    {"`fog_look`, or physics in its place", KIND(HEIGHT_FOG), ANY_LIGHT, look},
    {"`gaussian`", KIND(GAUSSIAN), ANY_LIGHT, NULL},
    {"`shell`", KIND(SHELL), ANY_LIGHT, NULL},
    {"`tent`", KIND(TENT), ANY_LIGHT, NULL},
    {"`shell` around the ground, nothing else", KIND(SHELL), ANY_LIGHT, planet},
    {"`grid`, `volume`, `voxels`", KIND(GRID), ANY_LIGHT, NULL},
    {"`horizon`", KIND(HORIZON), ANY_LIGHT, NULL},
    {"`plume`", KIND(PLUME), ANY_LIGHT, NULL},
    {"`extinction_color`", ANY_KIND, ANY_LIGHT, coloured},
    {"`henyey_greenstein`", ANY_KIND, ANY_LIGHT, henyey_greenstein},
    {"`rayleigh`", ANY_KIND, ANY_LIGHT, rayleigh},
    {"several phase functions in one place", ANY_KIND, ANY_LIGHT, two_phases},
    {"`scattering: none`", ANY_KIND, LIGHT(NONE), NULL},
    {"`scattering: single`", ANY_KIND, LIGHT(SINGLE), NULL},
    {"`scattering: multiple`", ANY_KIND, LIGHT(MULTIPLE), NULL},
    {"`emission_w_per_m2_sr`, seen", ANY_KIND, LIGHT(NONE) | LIGHT(SINGLE), emission},
    {"`emission_w_per_m2_sr`, scattered", ANY_KIND, LIGHT(MULTIPLE), emission},
    {"`environment_light`", ANY_KIND, ANY_LIGHT, environment},
    {"`lights`", ANY_KIND, ANY_LIGHT, lights},
    {"`solids`", ANY_KIND, ANY_LIGHT, solids},
    {"`solids` in clear air", ANY_KIND, ANY_LIGHT, add_only_solids},
    {"`solids` in clear air, and light between them", ANY_KIND, LIGHT(MULTIPLE), add_only_solids},
    {"`solids[].mesh`, `solids[].height_field`", ANY_KIND, ANY_LIGHT, meshed},
    {"`solids[].mesh.shading: smooth`", ANY_KIND, ANY_LIGHT, smooth_mesh},
    {"`solids[].mesh.albedo_texture`", ANY_KIND, ANY_LIGHT, textured_mesh},
    {"`solids[].mesh.alpha: cutout`", ANY_KIND, ANY_LIGHT, cut_out_mesh},
    {"`solids[].mesh.alpha: cutout` in clear air", ANY_KIND, ANY_LIGHT, cut_out_mesh_in_clear_air},
    {"`solids[].mesh.alpha: coverage`", ANY_KIND, ANY_LIGHT, covered_mesh},
    {"`solids[].*.texture`", ANY_KIND, ANY_LIGHT, textured},
    {"`solids[].*.metalness`", ANY_KIND, LIGHT(MULTIPLE), metal},
    {"`solids[].*.metalness`, `roughness: 0`", ANY_KIND, LIGHT(MULTIPLE), mirror},
    {"`orthographic_height_m`", ANY_KIND, ANY_LIGHT, orthographic},
    {"`camera.keys`", ANY_KIND, ANY_LIGHT, moving_camera},
    {"`sun.keys`", ANY_KIND, ANY_LIGHT, moving_sun},
    {"`lights[].keys`", ANY_KIND, ANY_LIGHT, moving_light},
    {"`wind`", ANY_DRIFT, ANY_LIGHT, wind},
    {"`solids[].*.motion`", ANY_KIND, ANY_LIGHT, moving_solid},
};

/* ---- answers --------------------------------------------------------------------------------- */

enum { ANSWER_SIZE = 64 };

static bool accepts(const struct neph_engine *engine, const struct neph_scene *scene,
                    const struct neph_settings *settings)
{
    char reason[512] = "";
    return engine->can_render(scene, settings, reason, sizeof(reason));
}

/* A choice of an option with which the engine can render the scene. */
static bool find_choice(const struct neph_engine *engine, const struct neph_scene *scene,
                        char answer[ANSWER_SIZE])
{
    for (int o = 0; engine->options[o].name; o++)
        for (int c = 0; engine->options[o].choices && engine->options[o].choices[c]; c++) {
            struct neph_settings settings = neph_settings_default(engine);
            settings.values[o] = c;
            if (!accepts(engine, scene, &settings))
                continue;
            snprintf(answer, ANSWER_SIZE, "`%s=%s`", engine->options[o].name,
                     engine->options[o].choices[c]);
            return true;
        }
    return false;
}

/* Higher is better; `answer` is set when the result exceeds `best`. */
static int ask(const struct neph_engine *engine, const struct neph_scene *scene, int best,
               char answer[ANSWER_SIZE])
{
    const struct neph_settings settings = neph_settings_default(engine);
    const bool is_look = engine->rung == NEPH_LEVEL_MODEL &&
                         scene->scattering == NEPH_SCATTERING_MULTIPLE;
    const int worth = is_look ? 2 : 3;
    if (best < worth && accepts(engine, scene, &settings)) {
        snprintf(answer, ANSWER_SIZE, "%s", is_look ? "look" : "yes");
        return worth;
    }
    return best < 1 && find_choice(engine, scene, answer) ? 1 : best;
}

static void answer_for(const struct neph_engine *engine, const struct feature *feature,
                       struct stage *stage, char answer[ANSWER_SIZE])
{
    int best = 0;
    snprintf(answer, ANSWER_SIZE, "no");
    for (int kind = 0; kind < NEPH_MEDIUM_KIND_COUNT; kind++)
        for (int light = 0; light <= NEPH_SCATTERING_MULTIPLE; light++) {
            if (!(feature->kinds >> kind & 1u) || !(feature->lights >> light & 1u))
                continue;
            set_stage(stage, (enum neph_medium_kind)kind, (enum neph_scattering)light);
            if (feature->change)
                feature->change(stage);
            best = ask(engine, &stage->test.scene, best, answer);
        }
}

static void print_row(FILE *file, const struct feature *feature, struct stage *stage)
{
    int count;
    const struct neph_engine *const *engines = neph_engines(&count);
    fprintf(file, "| %s |", feature->name);
    for (int e = 0; e < count; e++) {
        char answer[ANSWER_SIZE];
        answer_for(engines[e], feature, stage, answer);
        fprintf(file, " %s |", answer);
    }
    fprintf(file, "\n");
}

static void print_features(FILE *file)
{
    int count;
    struct stage stage = {.grid = NULL};
    const struct neph_engine *const *engines = neph_engines(&count);
    fprintf(file, "| |");
    for (int e = 0; e < count; e++)
        fprintf(file, " `%s` |", engines[e]->name);
    fprintf(file, "\n| --- |");
    for (int e = 0; e < count; e++)
        fprintf(file, " --- |");
    fprintf(file, "\n");
    for (size_t i = 0; i < COUNT(features); i++)
        print_row(file, &features[i], &stage);
    neph_grid_destroy(stage.grid);
    neph_horizon_destroy(stage.horizon);
    stage.mesh->material.texture = NULL;
    neph_albedo_texture_destroy(stage.leaf);
    neph_mesh_destroy(stage.mesh);
}

/* ---- the file -------------------------------------------------------------------------------- */

static void test_readme_has_the_features(void **state)
{
    const struct printed_table table = {NEPH_SOURCE_DIR "/scenes/README.md",
                                        "<!-- written by tests/test_features --write -->\n",
                                        "<!-- end -->\n", print_features};
    check_readme(&table, *state);
}

int main(int count, char **arguments)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_prestate(test_readme_has_the_features, writes_readme(count, arguments)),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
