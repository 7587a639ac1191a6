/* SPDX-License-Identifier: MIT
 *
 * `neph study phase`: the radiance that a renderer loses or gains by drawing droplets with a
 * simpler phase function: plane clouds by doubling, without noise, and by engines. */
#include "harness/experiments/experiments.h"

#include "harness/document/table.h"
#include "harness/experiments/phase_engines.h"
#include "harness/progress.h"
#include "harness/study/phase_models.h"
#include "scenes/phase_table.h"
#include "truth/droplets.h"
#include "truth/slab.h"
#include "truth/water.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum {
    DEPTHS_MAX = 8,
    VIEWS = 12,
    AZIMUTHS = 73,
    ANGLES = 721,
    ENGINES_MAX = 16,
    OTHERS_MAX = 8,
    RANGES = NEPH_ANGLE_RANGES
};

struct request {
    struct neph_cli_shared shared;
    double radius_um, variance, sun_elevation_deg;
    struct neph_cli_list depths, other_radii, other_elevations, engines;
    int nodes, seeds;
};

#define AT(member) .at = offsetof(struct request, member)
static const struct neph_cli_option options[] = {
    {"effective-radius", 0, "UM", "Effective radius of the droplets in um", NEPH_CLI_REAL,
     AT(radius_um), "10", 0.5, 30},
    {"effective-variance", 0, "V", "Effective variance of the radii", NEPH_CLI_REAL, AT(variance),
     "0.1", 0.01, 0.4},
    {"optical-depth", 0, "TAU[,TAU]", "Optical depths of the clouds", NEPH_CLI_NUMBERS, AT(depths),
     "0.3,3,30", .maximum = DEPTHS_MAX},
    {"sun-elevation", 0, "DEG", "Elevation of the sun", NEPH_CLI_REAL, AT(sun_elevation_deg), "40",
     3, 90},
    {"nodes", 0, "N",
     "Directions per hemisphere; at optical depth 0.3 radiances still grow by 4 to 6 % from 64 to "
     "160",
     NEPH_CLI_INTEGER, AT(nodes), "64", 32, 256},
    {"other-radii", 0, "UM[,UM]",
     "Effective radii in um of further droplets; the models keep their parameters, but for the "
     "droplets' diameter",
     NEPH_CLI_NUMBERS, AT(other_radii), .maximum = OTHERS_MAX},
    {"other-elevations", 0, "DEG[,DEG]", "Further elevations of the sun", NEPH_CLI_NUMBERS,
     AT(other_elevations), .maximum = OTHERS_MAX},
    {"engine", 0, NULL,
     "Engines that render the clouds, too, with the droplets and with each model; "
     "ENGINE+KEY=VALUE changes one",
     NEPH_CLI_NAMES, AT(engines), .maximum = ENGINES_MAX},
    {"seeds", 0, NULL, "Seeds of engines with noise", NEPH_CLI_INTEGER, AT(seeds), "4", 1, 1000},
    {.name = "size", .otherwise = "48x27"},
    {.name = "output",
     .help = "Folder of the engines' frames, from which the same command "
             "continues; without it they are not kept"},
    {.name = "all", .help = "The table of all depths, models and angles"},
    {.name = "json", .help = "All numbers as JSON on stdout"},
    {.name = "csv", .help = "A line for each depth, model and range of angles"},
    {.name = "markdown", .help = "The table into a file, too"},
    {.name = "quiet"},
    {.name = NULL},
};
#undef AT

static const struct neph_cli_syntax syntax = {
    .options = options,
    .doc = "What is lost when droplets are drawn with a simpler phase function: a plane cloud of "
           "water droplets at 550 nm by Mie theory, and the same cloud with Henyey-Greenstein, two "
           "of them, "
           "Draine and Jendersie-d'Eon.\vAll orders of scattering, by doubling, without noise. "
           "Henyey-Greenstein, the pair and Draine have the mean cosine of the droplets; the "
           "remaining parameters of the pair and of Draine are those of the least logarithmic "
           "error. Differences are of the radiance that leaves the cloud above and below, in "
           "ranges of the angle between its direction and that of the sunlight: 0 is the aureole "
           "around the sun, about 140 the fogbow, 180 the glory. The peak of Jendersie-d'Eon is "
           "narrower than the directions resolve: beyond single scattering its aureole lacks that "
           "light. "
           "Engines render a frame towards the sun and one away from it, which are compared with "
           "the doubling of the droplets.\n\n"
           "Examples:\n"
           "  neph study phase\n"
           "  neph study phase --effective-radius 5 --optical-depth 1,10 --sun-elevation 20 --all\n"
           "  neph study phase --nodes 128 --csv phase.csv\n"
           "  neph study phase --other-radii 5,20 --other-elevations 20,60 --all\n"
           "  neph study phase -e tracer+samples=256,march_octaves,cycles --all",
};

static const double wavelength_m = 550e-9;

/* Droplets of one radius under one sun. */
struct cloud {
    double radius_um, sun_elevation_deg;
    struct neph_phase droplets;
    double albedo;
    struct neph_phase_model models[NEPH_PHASE_MODELS_MAX];
    int model_count;
};

static enum neph_status compute_droplets(const struct request *request, struct neph_arena *arena,
                                         struct cloud *cloud, struct neph_diag *diag)
{
    double angles_deg[ANGLES], cosines[ANGLES], values[ANGLES];
    struct neph_droplet_optics optics;
    struct neph_droplets_params params = {.sizes = NEPH_DROPLETS_GAMMA,
                                          .effective_radius_m = 1e-6 * cloud->radius_um,
                                          .effective_variance = request->variance,
                                          .wavelength_m = wavelength_m,
                                          .density_kg_per_m3 = NEPH_WATER_DENSITY_KG_PER_M3,
                                          .angle_count = ANGLES,
                                          .cosines = cosines};
    for (int i = 0; i < ANGLES; i++) { /* dense towards the peak and the glory */
        const double part = (double)i / (ANGLES - 1);
        angles_deg[i] = 180.0 * part - 180.0 / (2.0 * M_PI) * 0.9 * sin(2.0 * M_PI * part);
        cosines[i] = cos(angles_deg[i] * M_PI / 180.0);
    }
    angles_deg[0] = 0.0;
    angles_deg[ANGLES - 1] = 180.0;
    enum neph_status status = neph_water_index(params.wavelength_m, &params.index, diag);
    if (!status)
        status = neph_droplets_compute(&params, &optics, values, diag);
    cloud->droplets = (struct neph_phase){.kind = NEPH_PHASE_TABLE};
    if (!status)
        status = neph_phase_table_make(ANGLES, angles_deg, values, arena, &cloud->droplets.table,
                                       diag);
    if (!status)
        cloud->albedo = optics.albedo;
    return status;
}

/* The radiance / E leaving a cloud, above and below, in the same order for every cloud. */
struct light {
    double per_sr[2 * VIEWS * AZIMUTHS];
};

/* The last view is that of the sun, for the aureole's centre and the glory's. */
static void list_views(double sun_cosine, double cosines[VIEWS])
{
    for (int v = 0; v < VIEWS - 1; v++)
        cosines[v] = 0.12 + 0.86 * v / (VIEWS - 2);
    cosines[VIEWS - 1] = sun_cosine;
}

static enum neph_status solve(const struct request *request, const struct cloud *cloud,
                              const struct neph_phase *phase, double depth, struct light *light,
                              struct neph_diag *diag)
{
    double cosines[VIEWS];
    struct neph_slab *slab = NULL;
    const double sun_cosine = sin(cloud->sun_elevation_deg * M_PI / 180.0);
    list_views(sun_cosine, cosines);
    const struct neph_slab_params params = {depth, cloud->albedo, *phase,         sun_cosine,
                                            VIEWS, cosines,       request->nodes, true};
    const enum neph_status status = neph_slab_create(&params, &slab, diag);
    for (int i = 0; i < VIEWS * AZIMUTHS && !status; i++) {
        const double azimuth_rad = M_PI * (i % AZIMUTHS) / (AZIMUTHS - 1);
        light->per_sr[2 * i] = neph_slab_reflected_per_sr(slab, i / AZIMUTHS, azimuth_rad);
        light->per_sr[2 * i + 1] = neph_slab_transmitted_per_sr(slab, i / AZIMUTHS, azimuth_rad);
    }
    neph_slab_destroy(slab);
    return status;
}

/* The angle between the sunlight and the light of that entry [degrees]. */
static double find_angle_deg(const struct cloud *cloud, int entry)
{
    double cosines[VIEWS];
    const double sun_cosine = sin(cloud->sun_elevation_deg * M_PI / 180.0);
    list_views(sun_cosine, cosines);
    const int i = entry / 2;
    const double mu = cosines[i / AZIMUTHS], up = entry % 2 == 0 ? -1.0 : 1.0;
    const double azimuth_rad = M_PI * (i % AZIMUTHS) / (AZIMUTHS - 1);
    const double cosine = up * mu * sun_cosine +
                          sqrt((1.0 - mu * mu) * (1.0 - sun_cosine * sun_cosine)) *
                              cos(azimuth_rad);
    return acos(fmin(1.0, fmax(-1.0, cosine))) * 180.0 / M_PI;
}

static struct neph_phase_difference compare(const struct cloud *cloud, const struct light *truth,
                                            const struct light *light, int range)
{
    double truth_sum = 0.0, sum = 0.0, squares = 0.0;
    int count = 0;
    for (int e = 0; e < 2 * VIEWS * AZIMUTHS; e++) {
        const double angle_deg = find_angle_deg(cloud, e);
        if (angle_deg < neph_angle_ranges[range].from_deg ||
            angle_deg >= neph_angle_ranges[range].to_deg)
            continue;
        truth_sum += truth->per_sr[e];
        sum += light->per_sr[e] - truth->per_sr[e];
        squares += pow(light->per_sr[e] / truth->per_sr[e] - 1.0, 2.0);
        count++;
    }
    return count
               ? (struct neph_phase_difference){sum / truth_sum, NAN, sqrt(squares / count), count}
               : (struct neph_phase_difference){NAN, NAN, NAN, 0};
}

static void begin_table(struct neph_table *table)
{
    static const struct neph_column columns[] = {
        {.key = "effective_radius_um", .title = "radius [um]", .format = "%g"},
        {.key = "sun_elevation_deg", .title = "sun [degrees]", .format = "%g"},
        {.key = "optical_depth", .title = "optical depth", .format = "%g"},
        {.key = "engine", .title = "engine"},
        {.key = "model", .title = "phase function"},
        {.key = "range", .title = "range"},
        {.key = "from_deg", .title = "from", .format = "%g"},
        {.key = "to_deg", .title = "to [degrees]", .format = "%g"},
        {.key = "difference", .title = "mean difference [%]", .format = "%+.1f", .scale = 100},
        {.key = "error", .title = "standard error", .format = "%.1f", .scale = 100, .none = ""},
        {.key = "rms", .title = "rms [%]", .format = "%.1f", .scale = 100},
        {.key = "count", .title = "directions", .format = "%g"},
        {.key = "note", .title = "note"},
    };
    neph_table_columns(table, columns, sizeof(columns) / sizeof(columns[0]));
}

/* ---- results --------------------------------------------------------------------------------- */

struct study {
    const struct request *request;
    const struct neph_experiment_run *run;
    struct neph_progress progress;
    struct neph_table table;
    struct neph_answer *answer;
    struct neph_phase_engine engines[ENGINES_MAX];
};

static const char doubling[] = "doubling";

/* Whose rows: a phase function, by doubling or by an engine. */
struct entry {
    const struct cloud *cloud;
    double depth;
    const char *engine, *model, *note;
};

static void add_answer(struct study *study, const struct entry *entry,
                       const struct neph_phase_difference *found)
{
    const bool is_doubling = entry->engine == doubling;
    if (isnan(found[RANGES - 1].mean))
        neph_answer_add(study->answer, "optical depth %g, %s, %s: %s", entry->depth, entry->engine,
                        entry->model, entry->note);
    else
        neph_answer_add(study->answer,
                        "optical depth %g, %s%s%s: aureole %+.0f %%, side %+.0f %%, bow %+.0f %%, "
                        "glory %+.0f %%",
                        entry->depth, is_doubling ? "" : entry->engine, is_doubling ? "" : ", ",
                        entry->model, 100.0 * found[0].mean, 100.0 * found[2].mean,
                        100.0 * found[3].mean, 100.0 * found[5].mean);
}

static void add_rows(struct study *study, const struct entry *entry,
                     const struct neph_phase_difference found[RANGES])
{
    struct neph_table *table = &study->table;
    for (int r = 0; r < RANGES; r++) {
        neph_table_number(table, entry->cloud->radius_um);
        neph_table_number(table, entry->cloud->sun_elevation_deg);
        neph_table_number(table, entry->depth);
        neph_table_word(table, entry->engine);
        neph_table_word(table, entry->model);
        neph_table_word(table, neph_angle_ranges[r].name);
        neph_table_number(table, neph_angle_ranges[r].from_deg);
        neph_table_number(table, fmin(neph_angle_ranges[r].to_deg, 180.0));
        neph_table_number(table, found[r].mean);
        neph_table_number(table, found[r].error);
        neph_table_number(table, found[r].rms);
        neph_table_number(table, found[r].count);
        neph_table_word(table, entry->note);
    }
    if (entry->cloud->radius_um == study->request->radius_um &&
        entry->cloud->sun_elevation_deg == study->request->sun_elevation_deg)
        add_answer(study, entry, found);
}

/* ---- measurements ---------------------------------------------------------------------------- */

static enum neph_status measure_models(struct study *study, const struct cloud *cloud, double depth,
                                       struct neph_diag *diag)
{
    struct light truth, light;
    neph_progress_begin(&study->progress, "droplets");
    enum neph_status status = solve(study->request, cloud, &cloud->droplets, depth, &truth, diag);
    if (!status)
        neph_progress_over(&study->progress, "droplets", "solved");
    for (int m = 0; m < cloud->model_count && !status; m++) {
        const struct neph_phase_model *model = &cloud->models[m];
        struct neph_phase_difference found[RANGES];
        neph_progress_begin(&study->progress, model->name);
        status = solve(study->request, cloud, &model->phase, depth, &light, diag);
        if (status)
            break;
        neph_progress_over(&study->progress, model->name, "solved");
        for (int r = 0; r < RANGES; r++)
            found[r] = compare(cloud, &truth, &light, r);
        add_rows(study, &(struct entry){cloud, depth, doubling, model->name, ""}, found);
    }
    return status;
}

/* The droplets, then each model. */
static enum neph_status measure_engine(struct study *study, const struct neph_phase_engine *engine,
                                       const struct neph_phase_frames *frames,
                                       const struct cloud *cloud, double depth,
                                       struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int m = -1; m < cloud->model_count && !status; m++) {
        struct neph_phase_difference found[RANGES];
        char note[256];
        const char *name = m < 0 ? "droplets" : cloud->models[m].name;
        neph_progress_begin(&study->progress, engine->words);
        status = neph_phase_engine_measure(engine, frames,
                                           m < 0 ? &cloud->droplets : &cloud->models[m].phase,
                                           study->request->seeds, study->run, found, note, diag);
        if (status)
            break;
        neph_progress_over(&study->progress, engine->words, name);
        add_rows(study, &(struct entry){cloud, depth, engine->words, name, note}, found);
    }
    return status;
}

static enum neph_status measure_engines(struct study *study, const struct cloud *cloud,
                                        double depth, struct neph_diag *diag)
{
    const struct neph_cli_size *size = &study->request->shared.size;
    const struct neph_phase_cloud droplets = {depth, cloud->albedo, cloud->sun_elevation_deg,
                                              cloud->droplets, study->request->nodes};
    struct neph_phase_frames *frames = NULL;
    if (study->request->engines.count == 0)
        return NEPH_OK;
    enum neph_status status = neph_phase_frames_create(&droplets, size->width_px, size->height_px,
                                                       &frames, diag);
    for (int e = 0; e < study->request->engines.count && !status; e++)
        status = measure_engine(study, &study->engines[e], frames, cloud, depth, diag);
    neph_phase_frames_destroy(frames);
    return status;
}

/* The first radius and elevation are those of the models and of the engines. */
static enum neph_status measure_cloud(struct study *study, const struct cloud *cloud,
                                      struct neph_diag *diag)
{
    const struct request *request = study->request;
    const bool is_first = cloud->radius_um == request->radius_um &&
                          cloud->sun_elevation_deg == request->sun_elevation_deg;
    enum neph_status status = NEPH_OK;
    for (int d = 0; d < request->depths.count && !status; d++) {
        status = measure_models(study, cloud, request->depths.numbers[d], diag);
        if (!status && is_first)
            status = measure_engines(study, cloud, request->depths.numbers[d], diag);
    }
    return status;
}

/* All elevations of the sun above droplets of one radius, whose models are made. */
static enum neph_status measure_droplets(struct study *study, struct cloud *cloud,
                                         struct neph_diag *diag)
{
    const struct neph_cli_list *others = &study->request->other_elevations;
    cloud->sun_elevation_deg = study->request->sun_elevation_deg;
    enum neph_status status = measure_cloud(study, cloud, diag);
    for (int i = 0; i < others->count && !status; i++) {
        cloud->sun_elevation_deg = others->numbers[i];
        status = measure_cloud(study, cloud, diag);
    }
    return status;
}

static enum neph_status measure_others(struct study *study, struct cloud *cloud,
                                       struct neph_arena *arena, struct neph_diag *diag)
{
    const struct neph_cli_list *others = &study->request->other_radii;
    struct cloud other = *cloud;
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < others->count && !status; i++) {
        other.radius_um = others->numbers[i];
        other.model_count = neph_phase_models_at(cloud->models, cloud->model_count, other.radius_um,
                                                 other.models);
        status = compute_droplets(study->request, arena, &other, diag);
        if (!status)
            status = measure_droplets(study, &other, diag);
    }
    return status;
}

static json_t *models_json(const struct neph_phase *droplets, const struct neph_phase_model *models,
                           int count)
{
    json_t *list = json_array();
    for (int m = 0; m < count; m++) {
        char text[128];
        neph_phase_describe(&models[m].phase, text, sizeof(text));
        neph_json_add(&list,
                      json_pack("{s:s, s:s, s:f, s:f}", "name", models[m].name, "phase", text,
                                "mean_cosine", neph_phase_mean_cosine(&models[m].phase),
                                "log_error", models[m].log_error));
    }
    return json_pack("{s:f, s:o}", "droplets_mean_cosine", neph_phase_mean_cosine(droplets),
                     "models", list);
}

static enum neph_status measure(struct study *study, struct cloud *cloud, struct neph_arena *arena,
                                struct neph_diag *diag)
{
    const struct request *request = study->request;
    enum neph_status status = NEPH_OK;
    for (int e = 0; e < request->engines.count && !status; e++)
        status = neph_phase_engine_find(request->engines.words[e], study->run->device,
                                        &study->engines[e], diag);
    if (!status)
        status = compute_droplets(request, arena, cloud, diag);
    if (status)
        return status;
    cloud->model_count = neph_phase_models(&cloud->droplets, request->radius_um, cloud->models);
    const int clouds = (1 + request->other_radii.count) * (1 + request->other_elevations.count);
    study->progress = neph_progress_start(study->run->quiet, request->depths.count *
                                                                 (cloud->model_count + 1) *
                                                                 (clouds + request->engines.count));
    status = measure_droplets(study, cloud, diag);
    if (!status)
        status = measure_others(study, cloud, arena, diag);
    neph_progress_end(&study->progress);
    return status;
}

static enum neph_status check_others(const struct request *request, struct neph_diag *diag)
{
    const struct neph_cli_list *radii = &request->other_radii, *suns = &request->other_elevations;
    for (int i = 0; i < radii->count; i++)
        if (!(radii->numbers[i] >= 0.5 && radii->numbers[i] <= 30.0))
            return neph_fail(diag, NEPH_ERR_USAGE, "--other-radii %g: 0.5 to 30 um",
                             radii->numbers[i]);
    for (int i = 0; i < suns->count; i++)
        if (!(suns->numbers[i] >= 3.0 && suns->numbers[i] <= 90.0))
            return neph_fail(diag, NEPH_ERR_USAGE, "--other-elevations %g: 3 to 90 degrees",
                             suns->numbers[i]);
    return NEPH_OK;
}

static enum neph_status run(void *request_, const struct neph_experiment_run *run,
                            struct neph_publication *publication, struct neph_diag *diag)
{
    const struct request *request = request_;
    struct study study = {.request = request, .run = run, .answer = &publication->answer};
    struct neph_arena arena = {NULL};
    struct cloud cloud = {.radius_um = request->radius_um};
    begin_table(&study.table);
    enum neph_status status = check_others(request, diag);
    if (!status)
        status = measure(&study, &cloud, &arena, diag);
    if (publication->text)
        neph_table_print(&study.table, publication->text);
    publication->json = json_pack(
        "{s:s, s:o, s:o}", "format", "neph-phase-study-2", "rows", neph_table_json(&study.table),
        "droplets",
        status ? json_null() : models_json(&cloud.droplets, cloud.models, cloud.model_count));
    neph_publication_csv(publication, "\r\n", &study.table);
    neph_arena_finish(&arena);
    return status;
}

const struct neph_experiment neph_experiment_phase = {
    .syntax = &syntax, .request_size = sizeof(struct request), .run = run};
