/* SPDX-License-Identifier: MIT
 *
 * `neph study phase`: the radiance that a renderer loses or gains by drawing droplets with a
 * simpler phase function, without noise: plane clouds by doubling. */
#include "harness/experiments/experiments.h"

#include "harness/document/table.h"
#include "harness/progress.h"
#include "harness/study/phase_models.h"
#include "scenes/phase_table.h"
#include "truth/droplets.h"
#include "truth/slab.h"
#include "truth/water.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { DEPTHS_MAX = 8, VIEWS = 12, AZIMUTHS = 73, ANGLES = 721 };

struct request {
    struct neph_cli_shared shared;
    double radius_um, variance, sun_elevation_deg;
    struct neph_cli_list depths;
    int nodes;
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
     "Directions per hemisphere: 64 resolve the fogbow to 1 %, 128 the glory and the aureole",
     NEPH_CLI_INTEGER, AT(nodes), "64", 32, 256},
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
           "narrower "
           "than the directions resolve: beyond single scattering its aureole lacks that light.\n\n"
           "Examples:\n"
           "  neph study phase\n"
           "  neph study phase --effective-radius 5 --optical-depth 1,10 --sun-elevation 20 --all\n"
           "  neph study phase --nodes 128 --csv phase.csv",
};

static const double wavelength_m = 550e-9;

/* Ranges of the scattering angle [degrees]. */
static const struct {
    double from_deg, to_deg;
    const char *name;
} ranges[] = {
    {0, 10, "aureole"}, {10, 60, "forward"},    {60, 120, "side"},
    {120, 150, "bow"},  {150, 176, "backward"}, {176, 181, "glory"},
};
enum { RANGES = sizeof(ranges) / sizeof(ranges[0]) };

static enum neph_status compute_droplets(const struct request *request, struct neph_arena *arena,
                                         struct neph_phase *phase, double *albedo,
                                         struct neph_diag *diag)
{
    double angles_deg[ANGLES], cosines[ANGLES], values[ANGLES];
    struct neph_droplet_optics optics;
    struct neph_droplets_params params = {.sizes = NEPH_DROPLETS_GAMMA,
                                          .effective_radius_m = 1e-6 * request->radius_um,
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
    *phase = (struct neph_phase){.kind = NEPH_PHASE_TABLE};
    if (!status)
        status = neph_phase_table_make(ANGLES, angles_deg, values, arena, &phase->table, diag);
    if (!status)
        *albedo = optics.albedo;
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

static enum neph_status solve(const struct request *request, const struct neph_phase *phase,
                              double depth, double albedo, struct light *light,
                              struct neph_diag *diag)
{
    double cosines[VIEWS];
    struct neph_slab *slab = NULL;
    const double sun_cosine = sin(request->sun_elevation_deg * M_PI / 180.0);
    list_views(sun_cosine, cosines);
    const struct neph_slab_params params = {depth, albedo,  *phase,         sun_cosine,
                                            VIEWS, cosines, request->nodes, true};
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
static double find_angle_deg(const struct request *request, int entry)
{
    double cosines[VIEWS];
    const double sun_cosine = sin(request->sun_elevation_deg * M_PI / 180.0);
    list_views(sun_cosine, cosines);
    const int i = entry / 2;
    const double mu = cosines[i / AZIMUTHS], up = entry % 2 == 0 ? -1.0 : 1.0;
    const double azimuth_rad = M_PI * (i % AZIMUTHS) / (AZIMUTHS - 1);
    const double cosine = up * mu * sun_cosine +
                          sqrt((1.0 - mu * mu) * (1.0 - sun_cosine * sun_cosine)) *
                              cos(azimuth_rad);
    return acos(fmin(1.0, fmax(-1.0, cosine))) * 180.0 / M_PI;
}

struct difference {
    double mean; /* sum of the differences over the sum of the truth */
    double rms;  /* of the relative difference */
    int count;
};

static struct difference compare(const struct request *request, const struct light *truth,
                                 const struct light *light, int range)
{
    double truth_sum = 0.0, sum = 0.0, squares = 0.0;
    int count = 0;
    for (int e = 0; e < 2 * VIEWS * AZIMUTHS; e++) {
        const double angle_deg = find_angle_deg(request, e);
        if (angle_deg < ranges[range].from_deg || angle_deg >= ranges[range].to_deg)
            continue;
        truth_sum += truth->per_sr[e];
        sum += light->per_sr[e] - truth->per_sr[e];
        squares += pow(light->per_sr[e] / truth->per_sr[e] - 1.0, 2.0);
        count++;
    }
    return count ? (struct difference){sum / truth_sum, sqrt(squares / count), count}
                 : (struct difference){NAN, NAN, 0};
}

static void begin_table(struct neph_table *table)
{
    static const struct neph_column columns[] = {
        {.key = "optical_depth", .title = "optical depth", .format = "%g"},
        {.key = "model", .title = "phase function"},
        {.key = "range", .title = "range"},
        {.key = "from_deg", .title = "from", .format = "%g"},
        {.key = "to_deg", .title = "to [degrees]", .format = "%g"},
        {.key = "difference", .title = "mean difference [%]", .format = "%+.1f", .scale = 100},
        {.key = "rms", .title = "rms [%]", .format = "%.1f", .scale = 100},
        {.key = "count", .title = "directions", .format = "%g"},
    };
    neph_table_columns(table, columns, sizeof(columns) / sizeof(columns[0]));
}

/* The rows of one model at one depth, and its line of the answer. */
static void add_rows(const struct request *request, const struct light *truth,
                     const struct light *light, double depth, const struct neph_phase_model *model,
                     struct neph_table *table, struct neph_answer *answer)
{
    struct difference found[RANGES];
    for (int r = 0; r < RANGES; r++) {
        found[r] = compare(request, truth, light, r);
        neph_table_number(table, depth);
        neph_table_word(table, model->name);
        neph_table_word(table, ranges[r].name);
        neph_table_number(table, ranges[r].from_deg);
        neph_table_number(table, fmin(ranges[r].to_deg, 180.0));
        neph_table_number(table, found[r].mean);
        neph_table_number(table, found[r].rms);
        neph_table_number(table, found[r].count);
    }
    neph_answer_add(answer,
                    "optical depth %g, %s: aureole %+.0f %%, side %+.0f %%, bow %+.0f %%, glory "
                    "%+.0f %%",
                    depth, model->name, 100.0 * found[0].mean, 100.0 * found[2].mean,
                    100.0 * found[3].mean, 100.0 * found[5].mean);
}

static enum neph_status measure(const struct request *request, const struct neph_phase *droplets,
                                double albedo, double depth, const struct neph_phase_model *models,
                                int model_count, struct neph_progress *progress,
                                struct neph_table *table, struct neph_answer *answer,
                                struct neph_diag *diag)
{
    struct light truth, light;
    neph_progress_begin(progress, "droplets");
    enum neph_status status = solve(request, droplets, depth, albedo, &truth, diag);
    if (!status)
        neph_progress_over(progress, "droplets", "solved");
    for (int m = 0; m < model_count && !status; m++) {
        neph_progress_begin(progress, models[m].name);
        status = solve(request, &models[m].phase, depth, albedo, &light, diag);
        if (status)
            break;
        neph_progress_over(progress, models[m].name, "solved");
        add_rows(request, &truth, &light, depth, &models[m], table, answer);
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

static enum neph_status run(void *request_, const struct neph_experiment_run *run,
                            struct neph_publication *publication, struct neph_diag *diag)
{
    const struct request *request = request_;
    struct neph_table table = {.cells = NULL};
    struct neph_phase_model models[NEPH_PHASE_MODELS_MAX];
    struct neph_arena arena = {NULL};
    struct neph_phase droplets;
    double albedo = 1.0;
    int count = 0;
    enum neph_status status = compute_droplets(request, &arena, &droplets, &albedo, diag);
    if (!status)
        count = neph_phase_models(&droplets, request->radius_um, models);
    struct neph_progress progress = neph_progress_start(run->quiet,
                                                        request->depths.count * (count + 1));
    begin_table(&table);
    for (int d = 0; d < request->depths.count && !status; d++)
        status = measure(request, &droplets, albedo, request->depths.numbers[d], models, count,
                         &progress, &table, &publication->answer, diag);
    neph_progress_end(&progress);
    if (publication->text)
        neph_table_print(&table, publication->text);
    publication->json = json_pack("{s:s, s:o, s:o}", "format", "neph-phase-study-1", "rows",
                                  neph_table_json(&table), "droplets",
                                  status ? json_null() : models_json(&droplets, models, count));
    neph_publication_csv(publication, "\r\n", &table);
    neph_arena_finish(&arena);
    return status;
}

const struct neph_experiment neph_experiment_phase = {
    .syntax = &syntax, .request_size = sizeof(struct request), .run = run};
