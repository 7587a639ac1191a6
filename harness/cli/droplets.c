/* SPDX-License-Identifier: MIT
 *
 * `neph droplets`: what a cloud of droplets does to light, from their sizes.
 */
#include "harness/cli/cli.h"

#include "base/text.h"
#include "base/written.h"
#include "harness/cli/droplets_plot.h"
#include "truth/droplets.h"
#include "truth/water.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A new distribution breaks the build here until this file handles it. */
_Static_assert(NEPH_DROPLETS_COUNT == 2, "a new distribution");

static const char *const size_names[NEPH_DROPLETS_COUNT] = {
    [NEPH_DROPLETS_GAMMA] = "gamma",
    [NEPH_DROPLETS_LOG_NORMAL] = "log-normal",
};

struct request {
    struct neph_cli_shared shared;
    double radius_um, variance, water_g_per_m3;
    const char *sizes, *plot;
    struct neph_cli_list wavelengths_nm, index;
};

#define AT(member) .at = offsetof(struct request, member)
static const struct neph_cli_option options[] = {
    {"effective-radius", 0, "UM", "Effective radius in um: the mean of r^3 over the mean of r^2",
     NEPH_CLI_REAL, AT(radius_um), "10", 0.001, 1000},
    {"effective-variance", 0, "V", "Effective variance of the radii", NEPH_CLI_REAL, AT(variance),
     "0.1", NEPH_DROPLETS_VARIANCE_MIN, NEPH_DROPLETS_VARIANCE_MAX},
    {"distribution", 0, "NAME",
     "Distribution of the radii: gamma (of Hansen and Travis) or log-normal", NEPH_CLI_WORD,
     AT(sizes), "gamma"},
    {"wavelength", 0, "NM[,NM]", "Wavelengths in nm", NEPH_CLI_NUMBERS, AT(wavelengths_nm), "550",
     .maximum = NEPH_PHASE_CURVES_MAX},
    {"index", 0, "N,K", "Refractive index n + i k (default: water of 20 degrees, 300 to 1000 nm)",
     NEPH_CLI_NUMBERS, AT(index), .maximum = 2},
    {"water", 0, "G", "Liquid water content in g/m3: prints extinction, number and visibility, too",
     NEPH_CLI_REAL, AT(water_g_per_m3), .minimum = 1e-6, .maximum = 1e3},
    {"plot", 0, "FILE", "The phase function as an SVG, beside Henyey-Greenstein", NEPH_CLI_FILE,
     AT(plot)},
    {.name = "csv", .help = "The phase function: an angle a line, a column for each wavelength"},
    {.name = "json"},
    {.name = "quiet", .help = "Accepted; this verb prints only results"},
    {.name = NULL},
};
#undef AT

static const struct neph_cli_syntax syntax = {
    .options = options,
    .doc =
        "Extinction, albedo, asymmetry and phase function of droplets, by Mie theory over a "
        "distribution of radii.\v"
        "Extinction is per geometric cross section, and per gram of liquid water. With --water "
        "visibility is by Koschmieder, for contrasts of 2 and 5 %. Deirmendjian's cloud C.1 is "
        "--effective-radius 6 --effective-variance 0.1111. Methods and sources are in truth/mie.h, "
        "truth/droplets.h and truth/water.h.\n\n"
        "Examples:\n"
        "  neph droplets --effective-radius 10 --water 0.3\n"
        "  neph droplets --effective-radius 6 --effective-variance 0.1111 --wavelength 700 --index "
        "1.33,0\n"
        "  neph droplets --wavelength 610,550,465 --csv phase.csv --plot phase.svg",
};

/* Angles in degrees: dense in the diffraction peak, and from the fogbow to the glory. */
static const struct {
    double from, to, step;
} ranges[] = {{0.0, 5.0, 0.05}, {5.0, 130.0, 0.5}, {130.0, 180.0, 0.1}};
enum { RANGES = sizeof(ranges) / sizeof(ranges[0]), ANGLES_MAX = 1000 };

struct result {
    double wavelength_nm;
    double complex index;
    struct neph_droplet_optics optics;
    double *phase_per_sr; /* NULL: not computed */
};

struct answer {
    struct neph_droplets_params params;
    int angle_count, count;
    double degrees[ANGLES_MAX], cosines[ANGLES_MAX];
    struct result results[NEPH_PHASE_CURVES_MAX];
};

static int list_angles(double *degrees, double *cosines)
{
    int count = 0;
    for (int r = 0; r < RANGES; r++) {
        const int steps = (int)lround((ranges[r].to - ranges[r].from) / ranges[r].step);
        for (int i = 0; i < steps + (r == RANGES - 1); i++, count++) {
            degrees[count] = ranges[r].from + i * ranges[r].step;
            cosines[count] = cos(degrees[count] * M_PI / 180.0);
        }
    }
    return count;
}

static enum neph_status find_sizes(const char *name, enum neph_droplet_sizes *sizes,
                                   struct neph_diag *diag)
{
    for (int i = 0; i < NEPH_DROPLETS_COUNT; i++)
        if (strcmp(name, size_names[i]) == 0) {
            *sizes = (enum neph_droplet_sizes)i;
            return NEPH_OK;
        }
    return neph_fail(diag, NEPH_ERR_USAGE, "there is no distribution '%s': gamma or log-normal",
                     name);
}

static enum neph_status find_index(const struct request *request, double wavelength_m,
                                   double complex *index, struct neph_diag *diag)
{
    const struct neph_cli_list *given = &request->index;
    if (given->count == 2) {
        *index = given->numbers[0] + I * given->numbers[1];
        return NEPH_OK;
    }
    if (given->count != 0)
        return neph_fail(diag, NEPH_ERR_USAGE, "--index takes n and k, such as 1.33,1e-5");
    const enum neph_status status = neph_water_index(wavelength_m, index, diag);
    if (status)
        neph_hint(diag, "--index N,K gives the index at other wavelengths");
    return status;
}

static enum neph_status compute(const struct request *request, struct answer *answer, int which,
                                struct neph_diag *diag)
{
    struct result *result = &answer->results[which];
    struct neph_droplets_params params = answer->params;
    result->wavelength_nm = request->wavelengths_nm.numbers[which];
    params.wavelength_m = 1e-9 * result->wavelength_nm;
    enum neph_status status = find_index(request, params.wavelength_m, &result->index, diag);
    params.index = result->index;
    params.angle_count = answer->angle_count;
    params.cosines = answer->cosines;
    result->phase_per_sr = calloc((size_t)answer->angle_count + 1, sizeof(double));
    if (!status && !result->phase_per_sr)
        status = neph_fail_memory(diag);
    return status ? status
                  : neph_droplets_compute(&params, &result->optics, result->phase_per_sr, diag);
}

/* ---- the answer ------------------------------------------------------------------------------ */

static void print_csv(const void *answer_, FILE *out)
{
    const struct answer *answer = answer_;
    fprintf(out, "angle_deg");
    for (int w = 0; w < answer->count; w++)
        fprintf(out, ",phase_per_sr_%gnm", answer->results[w].wavelength_nm);
    fputc('\n', out);
    for (int i = 0; i < answer->angle_count; i++) {
        fprintf(out, "%.2f", answer->degrees[i]);
        for (int w = 0; w < answer->count; w++)
            fprintf(out, ",%.9g", answer->results[w].phase_per_sr[i]);
        fputc('\n', out);
    }
}

static enum neph_status write_plot(const struct answer *answer, const char *path,
                                   struct neph_diag *diag)
{
    char title[128];
    struct neph_phase_plot plot = {.title = title,
                                   .angle_count = answer->angle_count,
                                   .curve_count = answer->count,
                                   .angles_deg = answer->degrees};
    neph_text_format(title, sizeof(title), "Droplets of effective radius %g um, variance %g (%s)",
                     1e6 * answer->params.effective_radius_m, answer->params.effective_variance,
                     size_names[answer->params.sizes]);
    for (int w = 0; w < answer->count; w++)
        plot.curves[w] = (struct neph_phase_curve){answer->results[w].wavelength_nm,
                                                   answer->results[w].optics.asymmetry,
                                                   answer->results[w].phase_per_sr};
    return neph_write_to_file(path, neph_phase_plot_print, &plot, diag);
}

struct in_air {
    double extinction_per_m, droplets_per_cm3, visibility_2_m, visibility_5_m;
};

static struct in_air mix(const struct neph_droplet_optics *optics, double water_g_per_m3)
{
    const double kg_per_m3 = 1e-3 * water_g_per_m3,
                 extinction = kg_per_m3 * optics->extinction_m2_per_kg;
    return (struct in_air){extinction, 1e-6 * kg_per_m3 * optics->droplets_per_kg,
                           -log(0.02) / extinction, -log(0.05) / extinction};
}

static json_t *list_json(const double *values, int count)
{
    json_t *list = json_array();
    for (int i = 0; i < count; i++)
        neph_json_add(&list, json_real(values[i]));
    return list;
}

static json_t *result_json(const struct answer *answer, const struct result *result,
                           double water_g_per_m3)
{
    const struct neph_droplet_optics *optics = &result->optics;
    json_t *json = json_pack(
        "{s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:o}", "wavelength_nm", result->wavelength_nm,
        "index_n", creal(result->index), "index_k", cimag(result->index), "extinction_efficiency",
        optics->extinction_efficiency, "extinction_m2_per_g", 1e-3 * optics->extinction_m2_per_kg,
        "albedo", optics->albedo, "asymmetry", optics->asymmetry, "phase_per_sr",
        list_json(result->phase_per_sr, answer->angle_count));
    if (isnan(water_g_per_m3))
        return json;
    const struct in_air air = mix(optics, water_g_per_m3);
    neph_json_set(&json, "extinction_per_m", json_real(air.extinction_per_m));
    neph_json_set(&json, "droplets_per_cm3", json_real(air.droplets_per_cm3));
    neph_json_set(&json, "visibility_2_percent_m", json_real(air.visibility_2_m));
    neph_json_set(&json, "visibility_5_percent_m", json_real(air.visibility_5_m));
    return json;
}

static enum neph_status print_json(const struct request *request, const struct answer *answer,
                                   struct neph_diag *diag)
{
    json_t *results = json_array();
    for (int w = 0; w < answer->count; w++)
        neph_json_add(&results, result_json(answer, &answer->results[w], request->water_g_per_m3));
    return neph_json_print(
        json_pack("{s:f, s:f, s:s, s:o, s:o, s:o}", "effective_radius_um",
                  1e6 * answer->params.effective_radius_m, "effective_variance",
                  answer->params.effective_variance, "sizes", size_names[answer->params.sizes],
                  "water_g_per_m3", neph_json_number(request->water_g_per_m3), "angles_deg",
                  list_json(answer->degrees, answer->angle_count), "results", results),
        diag);
}

static void print_text(const struct request *request, const struct answer *answer)
{
    printf("%-10s %-9s %-9s %-10s %-10s %-10s %s\n", "nm", "n", "k", "extinction", "m2/g", "albedo",
           "asymmetry");
    for (int w = 0; w < answer->count; w++) {
        const struct result *r = &answer->results[w];
        printf("%-10g %-9.6g %-9.3g %-10.4g %-10.4g %-10.7f %.4f\n", r->wavelength_nm,
               creal(r->index), cimag(r->index), r->optics.extinction_efficiency,
               1e-3 * r->optics.extinction_m2_per_kg, r->optics.albedo, r->optics.asymmetry);
    }
    for (int w = 0; w < answer->count && !isnan(request->water_g_per_m3); w++) {
        const struct in_air air = mix(&answer->results[w].optics, request->water_g_per_m3);
        printf("%g g/m3 at %g nm: extinction %.4g /m, %.4g droplets/cm3, visibility %.4g m (2 %%) "
               "or %.4g m (5 %%)\n",
               request->water_g_per_m3, answer->results[w].wavelength_nm, air.extinction_per_m,
               air.droplets_per_cm3, air.visibility_2_m, air.visibility_5_m);
    }
}

static enum neph_status tell(const struct request *request, const struct answer *answer,
                             struct neph_diag *diag)
{
    const char *csv = request->shared.csv;
    enum neph_status status = csv ? neph_write_to_file(csv, print_csv, answer, diag) : NEPH_OK;
    if (!status && request->plot)
        status = write_plot(answer, request->plot, diag);
    if (!status && request->shared.json)
        return print_json(request, answer, diag);
    if (!status)
        print_text(request, answer);
    return status;
}

static enum neph_status run(const struct request *request, struct answer *answer,
                            struct neph_diag *diag)
{
    answer->params = (struct neph_droplets_params){
        .effective_radius_m = 1e-6 * request->radius_um,
        .effective_variance = request->variance,
        .density_kg_per_m3 = NEPH_WATER_DENSITY_KG_PER_M3};
    enum neph_status status = find_sizes(request->sizes, &answer->params.sizes, diag);
    if (!status && (request->shared.csv || request->plot || request->shared.json))
        answer->angle_count = list_angles(answer->degrees, answer->cosines);
    for (int w = 0; w < request->wavelengths_nm.count && !status; w++) {
        answer->count++;
        status = compute(request, answer, w, diag);
    }
    return status ? status : tell(request, answer, diag);
}

enum neph_status neph_cli_droplets(int argc, char **argv, struct neph_diag *diag)
{
    struct request request = {0};
    neph_cli_parse(&syntax, argc, argv, &request);
    struct answer *answer = calloc(1, sizeof(*answer));
    enum neph_status status = answer ? neph_cli_split_lists(&syntax, &request, diag)
                                     : neph_fail_memory(diag);
    if (!status)
        status = run(&request, answer, diag);
    for (int w = 0; answer && w < answer->count; w++)
        free(answer->results[w].phase_per_sr);
    free(answer);
    neph_cli_free_lists(&syntax, &request);
    return status;
}
