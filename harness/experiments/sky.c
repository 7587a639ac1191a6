/* SPDX-License-Identifier: MIT
 *
 * `neph study sky [SCENE]`: models of a planet's atmosphere compared with a path tracer, by
 * elevation of the sun, altitude of the camera and direction. A cell is one sun and one altitude.
 * In each cell two wide frames look towards the sun and away from it; a direction is a tile of
 * their pixels.
 *
 * The error of a direction is the sum over channels of |model - reference| over the sum of the
 * reference, so that colour errors count, and dark directions count relative to their light. The
 * reference is rendered with two seeds; half the difference is its noise.
 */
#include "harness/experiments/experiments.h"

#include "harness/data.h"
#include "harness/document/table.h"
#include "harness/engines/engines.h"
#include "harness/progress.h"
#include "harness/run/seed.h"
#include "harness/study/light_models.h"
#include "scenes/skyward.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LIST_MAX = 16, VIEWS = 2, WHY_SIZE = 200 };

/* Towards the sun and away from it. The centre column of a frame covers elevations of -35 to 75
 * degrees, its corners reach the zenith. */
static const double view_azimuths_deg[VIEWS] = {0.0, 180.0};
static const double view_pitch_deg = 20.0, view_fov_deg = 110.0;
static const double cell_typical_s = 20.0;

/* Target values of the project, for suns at or above this elevation. */
static const double mean_wanted = 0.02, worst_wanted = 0.10, lowest_sun_deg = 5.0;

struct request {
    struct neph_cli_shared shared; /* operands: a scene */
    struct neph_cli_list models, suns, altitudes;
    const char *truth; /* tracer, oracle, exact; or ENGINE+KEY=VALUE+..., a model with finer
                          settings, for the error of its tables without noise */
    int samples, steps, tile_px;
    struct neph_scene *scene; /* owned */
};

#define AT(member) .at = offsetof(struct request, member)
static const struct neph_cli_option options[] = {
    {"model", 0, NULL, "Models to compare with the truth; ENGINE+KEY=VALUE changes one",
     NEPH_CLI_LIST, AT(models), "sky,sky+multiple=closure", .maximum = NEPH_LIGHT_MODELS_MAX},
    {"truth", 0, "ENGINE",
     "tracer or oracle; or a model with finer settings, ENGINE+KEY=VALUE+..., for the error of its "
     "tables, without noise",
     NEPH_CLI_WORD, AT(truth), "tracer"},
    {"elevations", 0, "A,B", "Elevations of the sun [degrees]", NEPH_CLI_NUMBERS, AT(suns),
     "90,60,30,15,10,5,2,0,-1,-2", .maximum = LIST_MAX},
    {"altitudes", 0, "A,B", "Altitudes of the camera [m]", NEPH_CLI_NUMBERS, AT(altitudes),
     "2,10000", .maximum = LIST_MAX},
    {.name = "size", .otherwise = "48x32"},
    {"tile", 0, "N", "Pixels along a side of a direction", NEPH_CLI_INTEGER, AT(tile_px), "4", 1,
     64},
    {"steps", 0, NULL, "Steps of every view ray, unless a model says otherwise", NEPH_CLI_INTEGER,
     AT(steps), "48", 2, 4096},
    {"samples", 0, NULL, "Samples a pixel of the truth, twice", NEPH_CLI_INTEGER, AT(samples),
     "4096", 2, 1 << 28},
    {.name = "jobs", .otherwise = "1"},
    {.name = "output", .help = "Folder of the store", .otherwise = "out/study"},
    {.name = "all", .help = "The tables of all cells"},
    {.name = "json", .help = "All numbers as JSON on stdout"},
    {.name = "markdown"},
    {.name = "quiet"},
    {.name = NULL},
};
#undef AT

static const struct neph_cli_operands operands = {
    .shown = "[SCENE]", .maximum = 1, .surplus = "one scene"};

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &operands,
    .doc =
        "Render the sky of a planet (default: sky_earth) with models and with a tracer, and "
        "print how far each model is from all orders of scattering: by elevation of the sun, "
        "altitude of the camera, and direction.\vEach cell is two wide frames, towards the "
        "sun and away from it. The truth is rendered twice, with two seeds, to measure its "
        "noise. Finished frames stay in DIR/store, and the same command continues from there.\n\n"
        "Examples:\n"
        "  neph study sky --markdown sky.md\n"
        "  neph study sky --elevations 10,5 --truth oracle --samples 1024\n"
        "  neph study sky --model sky+degree=0,sky+view=table --truth sky+degree=4+steps=96",
};

static enum neph_status prepare(void *request_, struct neph_diag *diag)
{
    struct request *request = request_;
    const struct neph_cli_shared *shared = &request->shared;
    return neph_data_load_scene(shared->operand_count > 0 ? shared->operands[0] : "sky_earth",
                                &request->scene, diag);
}

static void finish(void *request)
{
    neph_scene_destroy(((struct request *)request)->scene);
}

/* A job for each cell; the altitude varies fastest. */
static bool part(void *request_, int index)
{
    struct request *request = request_;
    struct neph_cli_list *suns = &request->suns, *altitudes = &request->altitudes;
    if (index >= suns->count * altitudes->count)
        return false;
    suns->numbers[0] = suns->numbers[index / altitudes->count];
    altitudes->numbers[0] = altitudes->numbers[index % altitudes->count];
    suns->count = altitudes->count = 1;
    return true;
}

/* Errors over the directions of a cell, weighted by solid angle. */
struct gap {
    double mean, worst; /* relative error of a direction */
    double bias;        /* sum of the model over sum of the reference, minus 1 */
    double worst_elevation_deg, worst_azimuth_deg; /* the worst direction; azimuth from the sun's */
    double worst_noise;                            /* noise of the reference there */
    double render_s;                               /* both frames */
    char because[WHY_SIZE];                        /* reason for a missing result; "" otherwise */
};

struct cell {
    double sun_deg, altitude_m;
    int direction_count;
    double noise;   /* of the reference, mean over directions */
    double truth_s; /* render time of both frames of each view */
    struct gap gaps[NEPH_LIGHT_MODELS_MAX];
};

struct study {
    const struct request *request;
    const struct neph_experiment_run *run;
    struct neph_progress progress;
    struct neph_light_model truth; /* of any reference level */
    struct neph_light_model models[NEPH_LIGHT_MODELS_MAX];
    char settings[NEPH_LIGHT_MODELS_MAX][400]; /* complete settings of the models */
    struct cell *cells;                        /* owned */
    int cell_count;
};

/* The scenes of a cell's views, and their reference frames of two seeds. */
struct sky_views {
    struct neph_scene *scenes[VIEWS];
    struct neph_image *truths[VIEWS][2];
};

/* ---- frames ---------------------------------------------------------------------------------- */

static enum neph_status render(const struct study *study, const struct neph_light_model *by,
                               const struct neph_scene *scene, int seed, struct neph_image **frame,
                               double *seconds, struct neph_diag *diag)
{
    const struct neph_cli_size *size = &study->request->shared.size;
    const struct neph_shot shot = {.scene = scene,
                                   .width_px = size->width_px,
                                   .height_px = size->height_px,
                                   .layers = NEPH_LAYER_RADIANCE,
                                   .seed = neph_seed_for_scene(scene, seed),
                                   .device = study->run->device};
    return neph_light_model_render(by, &shot, study->run->store, frame, seconds, diag);
}

/* Render the reference. A deterministic reference is rendered once and used as both seeds. */
static enum neph_status trace(const struct study *study, struct sky_views *sky_views,
                              struct cell *cell, struct neph_diag *diag)
{
    const bool is_stochastic = study->truth.engine->stochastic;
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < 2 * VIEWS && !status; i++)
        status = render(study, &study->truth, sky_views->scenes[i / 2],
                        is_stochastic ? i % 2 + 1 : 1, &sky_views->truths[i / 2][i % 2],
                        &cell->truth_s, diag);
    return status;
}

/* ---- directions ------------------------------------------------------------------------------ */

struct tile {
    double light[3];
    double solid_angle; /* in arbitrary units */
    struct neph_vec3 direction;
};

/* The mean of a tile's pixels. */
static struct tile compute_tile_mean(const struct study *study, const struct neph_scene *scene,
                                     const struct neph_image *frame, int column, int row)
{
    const struct neph_cli_size *size = &study->request->shared.size;
    const struct neph_camera camera = neph_scene_camera(scene, 0.0);
    const int side = study->request->tile_px;
    float *rgb[3];
    struct tile tile = {.light = {0, 0, 0}};
    if (!neph_image_rgb(frame, NULL, rgb))
        return tile;
    for (int i = 0; i < side * side; i++) {
        const size_t x = (size_t)(column * side + i % side), y = (size_t)(row * side + i / side);
        for (int c = 0; c < 3; c++)
            tile.light[c] += (double)rgb[c][y * (size_t)size->width_px + x] / (side * side);
    }
    const double middle = 0.5 * (side - 1);
    const struct neph_pixel_ray ray = neph_camera_ray(&camera, size->width_px, size->height_px,
                                                      column * side + middle, row * side + middle);
    tile.direction = ray.direction;
    tile.solid_angle = pow(neph_vec3_dot(ray.direction, camera.forward), 3.0);
    return tile;
}

/* Sum over channels of |a - b|. */
static double sum_channel_distance(const double a[3], const double b[3])
{
    return fabs(a[0] - b[0]) + fabs(a[1] - b[1]) + fabs(a[2] - b[2]);
}

static double sum_channels(const double a[3])
{
    return a[0] + a[1] + a[2];
}

struct sums {
    double weight, off, noise, model, truth;
};

/* Add a direction; `model` NULL: only the noise of the reference. */
static void add_tile(const struct tile *first, const struct tile *second, const struct tile *model,
                     struct sums *sums, struct gap *gap)
{
    double truth[3];
    for (int c = 0; c < 3; c++)
        truth[c] = 0.5 * (first->light[c] + second->light[c]);
    const double light = sum_channels(truth);
    if (!(light > 0.0))
        return;
    const double noise = 0.5 * sum_channel_distance(first->light, second->light) / light;
    sums->weight += first->solid_angle;
    sums->noise += first->solid_angle * noise;
    if (!model)
        return;
    const double off = sum_channel_distance(model->light, truth) / light;
    sums->off += first->solid_angle * off;
    sums->truth += first->solid_angle * light;
    sums->model += first->solid_angle * sum_channels(model->light);
    if (off <= gap->worst)
        return;
    gap->worst = off;
    gap->worst_noise = noise;
    gap->worst_elevation_deg = asin(first->direction.y) / NEPH_RAD_PER_DEG;
    gap->worst_azimuth_deg = fabs(atan2(first->direction.x, -first->direction.z)) /
                             NEPH_RAD_PER_DEG;
}

/* Add all directions of a view; `frame` NULL: only the noise of the reference. Returns their
 * number. */
static int add_view(const struct study *study, const struct sky_views *sky_views, int view,
                    const struct neph_image *frame, struct sums *sums, struct gap *gap)
{
    const struct neph_cli_size *size = &study->request->shared.size;
    const int columns = size->width_px / study->request->tile_px;
    const int rows = size->height_px / study->request->tile_px;
    const struct neph_scene *scene = sky_views->scenes[view];
    for (int i = 0; i < columns * rows; i++) {
        const int x = i % columns, y = i / columns;
        const struct tile first = compute_tile_mean(study, scene, sky_views->truths[view][0], x, y);
        const struct tile second = compute_tile_mean(study, scene, sky_views->truths[view][1], x,
                                                     y);
        const struct tile model = frame ? compute_tile_mean(study, scene, frame, x, y) : first;
        add_tile(&first, &second, frame ? &model : NULL, sums, gap);
    }
    return columns * rows;
}

/* ---- a cell ---------------------------------------------------------------------------------- */

static enum neph_status run_model(struct study *study, const struct sky_views *sky_views, int model,
                                  struct gap *gap, struct neph_diag *diag)
{
    struct sums sums = {0};
    enum neph_status status = NEPH_OK;
    const struct neph_light_model *of = &study->models[model];
    if (!of->engine->can_render(sky_views->scenes[0], &of->settings, gap->because,
                                sizeof(gap->because)))
        return NEPH_OK;
    gap->because[0] = '\0';
    for (int view = 0; view < VIEWS && !status; view++) {
        struct neph_image *frame = NULL;
        status = render(study, of, sky_views->scenes[view], 1, &frame, &gap->render_s, diag);
        if (!status)
            add_view(study, sky_views, view, frame, &sums, gap);
        neph_image_destroy(frame);
    }
    gap->mean = sums.off / sums.weight;
    gap->bias = sums.model / sums.truth - 1.0;
    return status;
}

static enum neph_status create_view_scenes(const struct study *study, const struct cell *cell,
                                           struct sky_views *sky_views, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int view = 0; view < VIEWS && !status; view++) {
        const struct neph_skyward skyward = {
            .sun_elevation_rad = cell->sun_deg * NEPH_RAD_PER_DEG,
            .altitude_m = cell->altitude_m,
            .azimuth_rad = view_azimuths_deg[view] * NEPH_RAD_PER_DEG,
            .pitch_rad = view_pitch_deg * NEPH_RAD_PER_DEG,
            .vertical_fov_rad = view_fov_deg * NEPH_RAD_PER_DEG,
        };
        status = neph_scene_skyward(study->request->scene, &skyward, &sky_views->scenes[view],
                                    diag);
    }
    return status;
}

static enum neph_status run_cell(struct study *study, struct cell *cell, struct neph_diag *diag)
{
    char what[120];
    struct sky_views sky_views = {0};
    struct sums noise = {0};
    snprintf(what, sizeof(what), "sun at %g degrees, %g m up", cell->sun_deg, cell->altitude_m);
    neph_progress_begin(&study->progress, what);
    enum neph_status status = create_view_scenes(study, cell, &sky_views, diag);
    if (!status)
        status = trace(study, &sky_views, cell, diag);
    for (int view = 0; view < VIEWS && !status; view++)
        cell->direction_count += add_view(study, &sky_views, view, NULL, &noise, NULL);
    cell->noise = noise.noise / noise.weight;
    for (int model = 0; model < study->request->models.count && !status; model++)
        status = run_model(study, &sky_views, model, &cell->gaps[model], diag);
    if (!status)
        neph_progress_over(&study->progress, what, "measured");
    for (int i = 0; i < VIEWS; i++) {
        neph_image_destroy(sky_views.truths[i][0]);
        neph_image_destroy(sky_views.truths[i][1]);
        neph_scene_destroy(sky_views.scenes[i]);
    }
    return status;
}

/* ---- the study ------------------------------------------------------------------------------- */

static enum neph_status parse_truth(struct study *study, struct neph_diag *diag)
{
    char *copy = strdup(study->request->truth), *rest = copy;
    struct neph_light_model *truth = &study->truth;
    if (!copy)
        return neph_fail_memory(diag);
    const struct neph_engine *engine = neph_engine_find(strsep(&rest, "+"));
    enum neph_status status = NEPH_OK;
    if (!engine || (engine->rung > NEPH_LEVEL_TRACER && !rest))
        status = neph_fail(
            diag, NEPH_ERR_USAGE,
            "'%s' is not a truth: use exact, oracle, tracer, or a model with finer settings",
            study->request->truth);
    else
        *truth = neph_light_model_default(engine, study->run->device);
    if (!status && neph_engine_samples(engine) >= 0)
        status = neph_light_model_set(truth, "samples", study->request->samples, diag);
    while (rest && !status)
        status = neph_settings_set(engine, &truth->settings, strsep(&rest, "+"), diag);
    free(copy);
    return status;
}

static enum neph_status parse_model(struct study *study, int index, struct neph_diag *diag)
{
    struct neph_light_model *model = &study->models[index];
    enum neph_status status = neph_light_model_parse(study->request->models.words[index],
                                                     study->request->steps, study->run->device,
                                                     model, diag);
    char *text = status ? NULL : neph_settings_text(model->engine, &model->settings);
    if (!status && !text)
        status = neph_fail_memory(diag);
    if (!status)
        snprintf(study->settings[index], sizeof(study->settings[index]), "%s", text);
    free(text);
    return status;
}

static enum neph_status run_cells(struct study *study, struct neph_diag *diag)
{
    const struct neph_cli_list *suns = &study->request->suns;
    const struct neph_cli_list *altitudes = &study->request->altitudes;
    enum neph_status status = parse_truth(study, diag);
    for (int model = 0; model < study->request->models.count && !status; model++)
        status = parse_model(study, model, diag);
    if (status)
        return status;
    study->cell_count = suns->count * altitudes->count;
    study->cells = calloc((size_t)study->cell_count, sizeof(*study->cells));
    if (!study->cells)
        return neph_fail_memory(diag);
    neph_progress_expect(&study->progress, 0, study->cell_count, cell_typical_s);
    for (int i = 0; i < study->cell_count && !status; i++) {
        study->cells[i].sun_deg = suns->numbers[i / altitudes->count];
        study->cells[i].altitude_m = altitudes->numbers[i % altitudes->count];
        status = run_cell(study, &study->cells[i], diag);
    }
    neph_progress_end(&study->progress);
    if (status == NEPH_ERR_INTERRUPTED)
        neph_hint(diag, "finished frames are in the store: the same command continues from there");
    return status;
}

/* ---- results --------------------------------------------------------------------------------- */

/* True when the limits apply to this cell. */
static bool is_limited(const struct cell *cell)
{
    return cell->sun_deg >= lowest_sun_deg;
}

static bool is_good(const struct gap *gap)
{
    return gap->mean <= mean_wanted && gap->worst <= worst_wanted;
}

static void add_gap_row(const struct cell *cell, const struct gap *gap, struct neph_table *table)
{
    const bool has_numbers = !gap->because[0] && !isnan(gap->mean);
    const double numbers[] = {gap->mean,        gap->worst, gap->worst_elevation_deg,
                              gap->worst_noise, gap->bias,  cell->noise};
    neph_table_numbers(table, 2, (const double[]){cell->sun_deg, cell->altitude_m / 1000.0});
    for (size_t i = 0; i < sizeof(numbers) / sizeof(numbers[0]); i++) {
        neph_table_number(table, has_numbers ? numbers[i] : NAN);
        if (i == 2 && has_numbers)
            neph_table_shown(table, "%+.0f, %.0f", numbers[i], gap->worst_azimuth_deg);
    }
    neph_table_word(table, !has_numbers       ? "no light"
                           : is_good(gap)     ? "holds"
                           : is_limited(cell) ? "**fails**"
                                              : "no limit");
    if (gap->because[0])
        neph_table_shown(table, "cannot: %s", gap->because);
}

static void print_model(const struct study *study, int model, struct neph_publication *publication)
{
    static const struct neph_column columns[] = {
        {.title = "sun [degrees]", .format = "%g"},
        {.title = "altitude [km]", .format = "%g"},
        {.title = "mean [%]", .format = "%.2f", .scale = 100.0},
        {.title = "worst [%]", .format = "%.1f", .scale = 100.0},
        {.title = "at elevation, azimuth", .format = "%+.0f"},
        {.title = "noise there [%]", .format = "%.1f", .scale = 100.0},
        {.title = "bias [%]", .format = "%+.2f", .scale = 100.0},
        {.title = "noise, mean [%]", .format = "%.2f", .scale = 100.0},
        {.title = ""},
    };
    struct neph_table table = {.cells = NULL};
    FILE *out = publication->text;
    double seconds = 0.0;
    neph_table_columns(&table, columns, sizeof(columns) / sizeof(columns[0]));
    for (int i = 0; i < study->cell_count; i++) {
        add_gap_row(&study->cells[i], &study->cells[i].gaps[model], &table);
        seconds += study->cells[i].gaps[model].render_s;
    }
    fprintf(out, "\n**%s**\n\n`%s`\n\n", study->request->models.words[model],
            study->settings[model]);
    neph_publication_table(publication, &table);
    fprintf(out,
            "\n"
            "%.3g s a frame, tables included.\n",
            seconds / (2.0 * fmax(1.0, study->cell_count)));
}

static void print_text(const struct study *study, struct neph_publication *publication)
{
    const struct request *request = study->request;
    const struct neph_cli_size *size = &request->shared.size;
    fprintf(publication->text,
            "neph %s, %s of %s on %s: %d samples, %dx%d, directions of %dx%d pixels.\n"
            "The error of a direction is the sum over channels of abs(model - truth) over the sum "
            "of the truth; means over directions by\n"
            "their solid angles; noise is the error between two truths. Wanted from %g degrees on: "
            "mean <= %g %%, worst <= %g %%.\n",
            NEPH_VERSION, request->scene->name, request->truth, study->truth.info.device,
            request->samples, size->width_px, size->height_px, request->tile_px, request->tile_px,
            lowest_sun_deg, 100.0 * mean_wanted, 100.0 * worst_wanted);
    for (int model = 0; model < request->models.count; model++)
        print_model(study, model, publication);
}

/* A model over the cells with numbers. */
struct summary {
    double mean, worst;
    int cells, limited, good; /* with numbers; of these with a limit; of these within it */
};

static struct summary summarize(const struct study *study, int model)
{
    struct summary made = {0};
    for (int i = 0; i < study->cell_count; i++) {
        const struct gap *gap = &study->cells[i].gaps[model];
        if (gap->because[0] || isnan(gap->mean))
            continue;
        made.cells++;
        made.mean += gap->mean;
        made.worst = fmax(made.worst, gap->worst);
        made.limited += is_limited(&study->cells[i]);
        made.good += is_limited(&study->cells[i]) && is_good(gap);
    }
    made.mean = made.cells > 0 ? made.mean / made.cells : NAN;
    return made;
}

/* Models by mean error, smallest first; models without a number last. */
static void answer_models(const struct study *study, double noise, struct neph_answer *answer)
{
    struct summary models[NEPH_LIGHT_MODELS_MAX];
    int order[NEPH_LIGHT_MODELS_MAX];
    const int count = study->request->models.count;
    for (int m = 0; m < count; m++) {
        int place = m;
        models[m] = summarize(study, m);
        for (; place > 0 && (models[m].mean < models[order[place - 1]].mean ||
                             (isfinite(models[m].mean) && isnan(models[order[place - 1]].mean)));
             place--)
            order[place] = order[place - 1];
        order[place] = m;
    }
    for (int i = 0; i < count; i++) {
        const struct summary *of = &models[order[i]];
        const char *name = study->request->models.words[order[i]];
        const bool is_best = i == 0 && count > 1;
        const bool is_told = is_best && fabs(models[order[1]].mean - of->mean) > noise;
        if (of->cells == 0)
            neph_answer_add(answer, "%s: not measured: %s", name,
                            study->cells[0].gaps[order[i]].because);
        else
            neph_answer_add(answer,
                            "%s%s: error %.2f %% in the mean, %.1f %% at most, over %d cells; "
                            "within the limits in %d of %d%s",
                            is_best ? "nearest: " : "", name, 100.0 * of->mean, 100.0 * of->worst,
                            of->cells, of->good, of->limited,
                            is_best && !is_told
                                ? "; the next is not told apart, by the noise of the truth"
                                : "");
    }
}

static void answer(const struct study *study, struct neph_answer *answer)
{
    double noise = 0.0;
    for (int i = 0; i < study->cell_count; i++)
        noise += study->cells[i].noise / study->cell_count;
    answer_models(study, noise, answer);
    neph_answer_add(answer,
                    "truth: %s with a noise of %.2f %% in the mean; limits: mean %g %%, "
                    "worst %g %%, with the sun at %g degrees or higher",
                    study->request->truth, 100.0 * noise, 100.0 * mean_wanted, 100.0 * worst_wanted,
                    lowest_sun_deg);
}

static json_t *gap_json(const struct gap *gap)
{
    if (gap->because[0])
        return json_pack("{s:s}", "cannot", gap->because);
    return json_pack(
        "{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:b}", "mean", neph_json_number(gap->mean), "worst",
        neph_json_number(gap->worst), "bias", neph_json_number(gap->bias), "worst_elevation_deg",
        neph_json_number(gap->worst_elevation_deg), "worst_azimuth_deg",
        neph_json_number(gap->worst_azimuth_deg), "worst_noise", neph_json_number(gap->worst_noise),
        "render_s", neph_json_number(gap->render_s), "good", is_good(gap));
}

static json_t *cell_json(const struct study *study, const struct cell *cell)
{
    json_t *models = json_object();
    for (int m = 0; m < study->request->models.count; m++)
        neph_json_set(&models, study->request->models.words[m], gap_json(&cell->gaps[m]));
    return json_pack("{s:f, s:f, s:i, s:o, s:b, s:o}", "sun_deg", cell->sun_deg, "altitude_m",
                     cell->altitude_m, "directions", cell->direction_count, "noise",
                     neph_json_number(cell->noise), "held", is_limited(cell), "models", models);
}

static enum neph_status run(void *request_, const struct neph_experiment_run *run,
                            struct neph_publication *publication, struct neph_diag *diag)
{
    const struct request *request = request_;
    struct study study = {
        .request = request, .run = run, .progress = neph_progress_start(run->quiet, 0)};
    enum neph_status status = run_cells(&study, diag);
    if (!status) {
        json_t *cells = json_array();
        if (publication->text)
            print_text(&study, publication);
        answer(&study, &publication->answer);
        for (int i = 0; i < study.cell_count; i++)
            neph_json_add(&cells, cell_json(&study, &study.cells[i]));
        publication->json = json_pack("{s:s, s:s, s:s, s:o}", "scene", request->scene->name,
                                      "truth", request->truth, "device", study.truth.info.device,
                                      "cells", cells);
    }
    free(study.cells);
    return status;
}

const struct neph_experiment neph_experiment_sky = {.syntax = &syntax,
                                                    .request_size = sizeof(struct request),
                                                    .prepare = prepare,
                                                    .part = part,
                                                    .run = run,
                                                    .finish = finish};
