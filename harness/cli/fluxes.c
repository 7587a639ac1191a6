/* SPDX-License-Identifier: MIT
 *
 * `neph fluxes SCENE`: sunlight through the columns of a scene.
 */
#include "harness/cli/cli.h"

#include "base/exr.h"
#include "base/image.h"
#include "base/text.h"
#include "base/written.h"
#include "harness/cli/fluxes_plot.h"
#include "harness/data.h"
#include "harness/physics/fluxes.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>

struct request {
    struct neph_cli_shared shared;
    struct neph_cli_size columns;
    int samples, seed;
    double bottom_m, top_m;
    const char *exr, *plot;
};

#define AT(member) .at = offsetof(struct request, member)
static const struct neph_cli_option options[] = {
    {"columns", 0, "NXxNZ", "Columns along x and z (default: 1x1)", NEPH_CLI_SIZE, AT(columns)},
    {.name = "engine",
     .help = "oracle: photons from the sun, in double precision on the CPU; tracer: paths to the "
             "sun, on the Vulkan device",
     .otherwise = "oracle"},
    {"samples", 0, NULL,
     "Photons of each column, and an eighth as many paths of each radiance; of the tracer: paths "
     "of "
     "each flux",
     NEPH_CLI_INTEGER, AT(samples), "20000", NEPH_FLUX_PATHS_MIN, NEPH_FLUX_PATHS_MAX},
    {"seed", 0, NULL, "Seed of all that is random", NEPH_CLI_INTEGER, AT(seed), "1", 0, INT_MAX},
    {"bottom", 0, "M",
     "Height of the lower level in m, of transmittance (default: the lowest point of media)",
     NEPH_CLI_REAL, AT(bottom_m)},
    {"top", 0, "M",
     "Height of the upper level in m, of reflectance (default: the highest point of media)",
     NEPH_CLI_REAL, AT(top_m)},
    {"exr", 0, "FILE", "An EXR with a pixel for each column, a layer for each flux and error",
     NEPH_CLI_FILE, AT(exr)},
    {"plot", 0, "FILE", "An SVG of the fluxes over x, with their errors", NEPH_CLI_FILE, AT(plot)},
    {.name = "csv", .help = "A line for each column"},
    {.name = "json"},
    {.name = "quiet"},
    {.name = NULL},
};
#undef AT

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &neph_cli_one_scene,
    .doc =
        "Fluxes of sunlight through the columns of a scene, with standard errors: reflectance, "
        "transmittance (diffuse and direct), absorptance, net horizontal flux, and the radiance "
        "straight up and down.\v"
        "All are parts of the sunlight on a level plane; radiance is multiplied by pi. Light of "
        "all "
        "orders counts, other light than the sun's does not. The domain is one period of grids "
        "that "
        "repeat without end (repeat 0), else the box around the media, whose sides are open: light "
        "enters and leaves there. A ground is a box of the scene below all media, Lambertian with "
        "its albedo; without one the ground is black. The horizontal flux is 1 - reflected - "
        "(transmitted - upward) - absorbed, where upward is the light of the ground; each is "
        "counted "
        "by itself, so in a repeating domain the mean of the horizontal flux tests the others: it "
        "is 0. `doubt` is the relative variance of the squared standard error: above 0.1 the error "
        "is not to be trusted. Methods and sources are in truth/fluxes.h.\n\n"
        "Examples:\n"
        "  neph fluxes step_cloud --columns 32x1 --plot fluxes.svg\n"
        "  neph fluxes cumulus --columns 64x64 --samples 100 --exr fluxes.exr --csv fluxes.csv\n"
        "  neph fluxes step_cloud -e tracer --json",
};

struct answer {
    const struct request *request;
    const struct neph_scene *scene;
    struct neph_fluxes fluxes;
};

static const char *const suffixes[3] = {"_r", "_g", "_b"};

static const char *channel_suffix(const struct neph_fluxes *fluxes, int channel)
{
    return fluxes->channel_count == 1 ? "" : suffixes[channel];
}

/* ---- forms ----------------------------------------------------------------------------------- */

static void print_csv(const void *answer_, FILE *out)
{
    const struct answer *answer = answer_;
    const struct neph_fluxes *fluxes = &answer->fluxes;
    const struct neph_flux_domain *domain = &fluxes->domain;
    const struct neph_bounds *box = &domain->box;
    fputs("column_x,column_z,x_m,z_m", out);
    for (int flux = 0; flux < NEPH_FLUX_COUNT; flux++)
        for (int c = 0; c < fluxes->channel_count; c++)
            fprintf(out, ",%s%s,%s_error%s", neph_flux_names[flux], channel_suffix(fluxes, c),
                    neph_flux_names[flux], channel_suffix(fluxes, c));
    fputc('\n', out);
    for (int column = 0; column < domain->columns_x * domain->columns_z; column++) {
        const int x = column % domain->columns_x, z = column / domain->columns_x;
        fprintf(out, "%d,%d,%.9g,%.9g", x, z,
                box->min_m.x + (box->max_m.x - box->min_m.x) * (x + 0.5) / domain->columns_x,
                box->min_m.z + (box->max_m.z - box->min_m.z) * (z + 0.5) / domain->columns_z);
        for (int flux = 0; flux < NEPH_FLUX_COUNT; flux++)
            for (int c = 0; c < fluxes->channel_count; c++) {
                const struct neph_flux_estimate own = neph_flux_of_column(
                    fluxes, (enum neph_flux)flux, column, c);
                fprintf(out, ",%.7g,%.3g", own.mean, own.standard_error);
            }
        fputc('\n', out);
    }
}

static enum neph_status fill_map(const struct neph_fluxes *fluxes, enum neph_flux flux,
                                 struct neph_image *image, struct neph_diag *diag)
{
    float *means[3], *errors[3];
    char layer[64];
    snprintf(layer, sizeof(layer), "%s_error", neph_flux_names[flux]);
    enum neph_status status = neph_image_add_rgb(image, neph_flux_names[flux], means, diag);
    if (!status)
        status = neph_image_add_rgb(image, layer, errors, diag);
    for (int c = 0; c < 3 && !status; c++)
        for (size_t column = 0; column < neph_image_pixel_count(image); column++) {
            const struct neph_flux_estimate own = neph_flux_of_column(fluxes, flux, (int)column,
                                                                      c % fluxes->channel_count);
            means[c][column] = (float)own.mean;
            errors[c][column] = (float)own.standard_error;
        }
    return status;
}

/* Row 0 has the columns with the smallest z: north is up for a view from above. */
static enum neph_status write_map(const struct neph_fluxes *fluxes, const char *path,
                                  struct neph_diag *diag)
{
    struct neph_image *image = NULL;
    enum neph_status status = neph_image_create(fluxes->domain.columns_x, fluxes->domain.columns_z,
                                                &image, diag);
    for (int flux = 0; flux < NEPH_FLUX_COUNT && !status; flux++)
        status = fill_map(fluxes, (enum neph_flux)flux, image, diag);
    if (!status)
        status = neph_exr_write(path, image, diag);
    neph_image_destroy(image);
    return status;
}

static enum neph_status write_plot(const struct answer *answer, const char *path,
                                   struct neph_diag *diag)
{
    char title[256];
    const struct neph_fluxes_plot plot = {title, &answer->fluxes};
    neph_text_format(title, sizeof(title), "Fluxes of %s, %d paths of each column by %s",
                     answer->scene->name, answer->fluxes.paths, answer->request->shared.engine);
    return neph_write_to_file(path, neph_fluxes_plot_print, &plot, diag);
}

static json_t *domain_json(const struct neph_flux_domain *domain)
{
    const struct neph_vec3 low = domain->box.min_m, high = domain->box.max_m;
    return json_pack("{s:[f,f,f], s:[f,f,f], s:i, s:i, s:b, s:b}", "min_m", low.x, low.y, low.z,
                     "max_m", high.x, high.y, high.z, "columns_x", domain->columns_x, "columns_z",
                     domain->columns_z, "repeats_x", !domain->is_open_x, "repeats_z",
                     !domain->is_open_z);
}

/* Lists over the channels: of the domain, and of lists over the columns. */
static json_t *flux_json(const struct neph_fluxes *fluxes, enum neph_flux flux)
{
    const int columns = fluxes->domain.columns_x * fluxes->domain.columns_z;
    json_t *mean = json_array(), *error = json_array(), *doubt = json_array(),
           *doubtful = json_array(), *means = json_array(), *errors = json_array();
    for (int c = 0; c < fluxes->channel_count; c++) {
        const struct neph_flux_estimate whole = neph_flux_of_domain(fluxes, flux, c);
        json_t *own_means = json_array(), *own_errors = json_array();
        for (int column = 0; column < columns; column++) {
            const struct neph_flux_estimate own = neph_flux_of_column(fluxes, flux, column, c);
            neph_json_add(&own_means, json_real(own.mean));
            neph_json_add(&own_errors, json_real(own.standard_error));
        }
        neph_json_add(&mean, json_real(whole.mean));
        neph_json_add(&error, json_real(whole.standard_error));
        neph_json_add(&doubt, json_real(whole.doubt));
        neph_json_add(&doubtful, json_integer(neph_flux_doubtful_columns(fluxes, flux, c)));
        neph_json_add(&means, own_means);
        neph_json_add(&errors, own_errors);
    }
    return json_pack("{s:o, s:o, s:o, s:o, s:o, s:o}", "mean", mean, "standard_error", error,
                     "doubt", doubt, "doubtful_columns", doubtful, "columns", means,
                     "column_errors", errors);
}

static enum neph_status print_json(const struct answer *answer, struct neph_diag *diag)
{
    const struct neph_fluxes *fluxes = &answer->fluxes;
    json_t *list = json_object();
    for (int flux = 0; flux < NEPH_FLUX_COUNT; flux++)
        neph_json_set(&list, neph_flux_names[flux], flux_json(fluxes, (enum neph_flux)flux));
    return neph_json_print(
        json_pack("{s:s, s:s, s:i, s:i, s:f, s:f, s:i, s:o, s:o}", "scene", answer->scene->name,
                  "engine", answer->request->shared.engine, "paths", fluxes->paths, "seed",
                  answer->request->seed, "seconds", fluxes->wall_s, "sun_cosine",
                  answer->scene->sun.direction.y, "channels", fluxes->channel_count, "domain",
                  domain_json(&fluxes->domain), "fluxes", list),
        diag);
}

static void print_text(const struct answer *answer)
{
    const struct neph_fluxes *fluxes = &answer->fluxes;
    const struct neph_bounds *box = &fluxes->domain.box;
    const int columns = fluxes->domain.columns_x * fluxes->domain.columns_z;
    printf(
        "%s: %d x %d columns of %g x %g m, from %g to %g m; sun %.4g degrees from the zenith; %d "
        "paths of each by %s, %.1f s\n",
        answer->scene->name, fluxes->domain.columns_x, fluxes->domain.columns_z,
        (box->max_m.x - box->min_m.x) / fluxes->domain.columns_x,
        (box->max_m.z - box->min_m.z) / fluxes->domain.columns_z, box->min_m.y, box->max_m.y,
        acos(answer->scene->sun.direction.y) * 180.0 / M_PI, fluxes->paths,
        answer->request->shared.engine, fluxes->wall_s);
    printf("%-15s %9s %9s %9s  %s\n", "", "mean", "+-", "doubt", "doubtful columns");
    for (int flux = 0; flux < NEPH_FLUX_COUNT; flux++)
        for (int c = 0; c < fluxes->channel_count; c++) {
            const struct neph_flux_estimate mean = neph_flux_of_domain(fluxes, (enum neph_flux)flux,
                                                                       c);
            char name[32];
            snprintf(name, sizeof(name), "%s%s", neph_flux_names[flux], channel_suffix(fluxes, c));
            printf("%-15s %9.5f %9.5f %9.2g  %d of %d\n", name, mean.mean, mean.standard_error,
                   mean.doubt, neph_flux_doubtful_columns(fluxes, (enum neph_flux)flux, c),
                   columns);
        }
}

static enum neph_status tell(const struct answer *answer, struct neph_diag *diag)
{
    const struct request *request = answer->request;
    enum neph_status status = NEPH_OK;
    neph_fluxes_warn(answer->scene->name, &answer->fluxes);
    if (request->shared.csv)
        status = neph_write_to_file(request->shared.csv, print_csv, answer, diag);
    if (!status && request->exr)
        status = write_map(&answer->fluxes, request->exr, diag);
    if (!status && request->plot)
        status = write_plot(answer, request->plot, diag);
    if (!status && request->shared.json)
        return print_json(answer, diag);
    if (!status)
        print_text(answer);
    return status;
}

enum neph_status neph_cli_fluxes(int argc, char **argv, struct neph_diag *diag)
{
    struct request request = {0};
    neph_cli_parse(&syntax, argc, argv, &request);
    struct neph_shared_device device = {.open = NULL};
    struct neph_scene *scene = NULL;
    struct answer answer = {.request = &request};
    enum neph_status status = neph_data_load_scene(request.shared.operands[0], &scene, diag);
    answer.scene = scene;
    if (!status) {
        const bool is_one = request.columns.width_px == 0;
        const struct neph_fluxes_job job = {
            .engine = request.shared.engine,
            .what = scene->name,
            .params = {.columns_x = is_one ? 1 : request.columns.width_px,
                       .columns_z = is_one ? 1 : request.columns.height_px,
                       .bottom_m = request.bottom_m,
                       .top_m = request.top_m,
                       .paths = request.samples,
                       .seed = (uint64_t)request.seed},
            .device = &device,
            .quiet = request.shared.quiet};
        status = neph_fluxes_measure(&job, scene, &answer.fluxes, diag);
    }
    if (!status)
        status = tell(&answer, diag);
    neph_fluxes_finish(&answer.fluxes);
    neph_shared_device_close(&device);
    neph_scene_destroy(scene);
    return status;
}
