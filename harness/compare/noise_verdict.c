/* SPDX-License-Identifier: MIT */
#include "harness/compare/noise_verdict.h"

#include "base/doubt.h"

#include <math.h>
#include <string.h>

_Static_assert(NEPH_Z_KIND_COUNT == 5, "a new test");

static const char *const kind_names[NEPH_Z_KIND_COUNT] = {
    [NEPH_Z_MEAN] = "mean",   [NEPH_Z_TILES] = "chi_squared", [NEPH_Z_TILE] = "tile",
    [NEPH_Z_PIXEL] = "pixel", [NEPH_Z_BLOB] = "blob",
};

/* Neighbours of independent pixels correlate by chance less than this. */
static const double correlation_noted = 0.1;

/* ---- tests ----------------------------------------------------------------------------------- */

static enum neph_status check_seeds(const struct neph_z_plane *plane, struct neph_diag *diag)
{
    if (2 * plane->identical <= plane->noisy)
        return NEPH_OK;
    neph_fail(
        diag, NEPH_ERR_INPUT,
        "%zu of %zu pixels with noise are equal bit for bit: both renders have the same random "
        "numbers, so their difference says nothing about noise",
        plane->identical, plane->noisy);
    neph_hint(diag, "render one of them with another seed");
    return NEPH_ERR_INPUT;
}

enum neph_status neph_noise_judge(const struct neph_noisy_render *reference,
                                  const struct neph_noisy_render *test, float *scores,
                                  struct neph_noise_verdict *verdict, struct neph_diag *diag)
{
    *verdict = (struct neph_noise_verdict){.reference = reference, .test = test};
    const bool is_grey = reference->is_grey && test->is_grey;
    verdict->plane_count = is_grey || reference->is_xyz != test->is_xyz ? 1 : test->plane_count;
    enum neph_status status = NEPH_OK;
    for (int p = 0; p < verdict->plane_count && !status; p++) {
        verdict->names[p] = test->names[p];
        status = neph_z_test(&reference->planes[p], &test->planes[p], test->width_px,
                             test->height_px, NEPH_NOISE_SEED, p == 0 ? scores : NULL,
                             &verdict->planes[p], diag);
    }
    if (!status)
        status = check_seeds(&verdict->planes[0], diag);
    verdict->p = neph_z_combine(verdict->planes, verdict->plane_count);
    verdict->is_bias = verdict->p <= NEPH_Z_LEVEL;
    return status;
}

/* ---- text ------------------------------------------------------------------------------------ */

/* The test with the smallest adjusted p; of equal ones the first, so rather the mean. */
static int find_evidence(const struct neph_noise_verdict *verdict, int *plane)
{
    int kind = 0;
    *plane = 0;
    for (int p = 0; p < verdict->plane_count; p++)
        for (int k = 0; k < NEPH_Z_KIND_COUNT; k++)
            if (verdict->planes[p].tests[k].adjusted <
                verdict->planes[*plane].tests[kind].adjusted) {
                *plane = p;
                kind = k;
            }
    return kind;
}

static size_t count_contrary(const struct neph_noise_verdict *verdict)
{
    size_t most = 0;
    for (int p = 0; p < verdict->plane_count; p++)
        most = verdict->planes[p].contrary > most ? verdict->planes[p].contrary : most;
    return most;
}

enum { SHARE_ROOM = 32 };

/* A part of the reference's mean in per cent; of a black reference the value itself. */
static const char *write_share(const struct neph_z_plane *plane, double value,
                               char text[SHARE_ROOM])
{
    const bool is_black = !(plane->reference_mean > 0.0);
    snprintf(text, SHARE_ROOM, is_black ? "%.3g" : "%.3g %%",
             is_black ? value : 100.0 * value / plane->reference_mean);
    return text;
}

static void describe_mean(const struct neph_z_plane *plane, char *text, size_t size)
{
    char bias[SHARE_ROOM], low[SHARE_ROOM], high[SHARE_ROOM];
    snprintf(text, size, "its mean is %s %s (95 %%: %s to %s)",
             write_share(plane, fabs(plane->bias), bias), plane->bias > 0.0 ? "higher" : "lower",
             write_share(plane, plane->bias - plane->bias_half_width, low),
             write_share(plane, plane->bias + plane->bias_half_width, high));
}

static void describe_bias(const struct neph_z_plane *plane, int kind, char *text, size_t size)
{
    const struct neph_z_blob *blob = &plane->blob;
    const double statistic = plane->tests[kind].statistic;
    switch ((enum neph_z_kind)kind) {
    case NEPH_Z_MEAN:
        describe_mean(plane, text, size);
        break;
    case NEPH_Z_TILES:
        snprintf(text, size, "the chi-squared of %d tiles of %d px is %.4g", plane->tile_count,
                 plane->tile_px, statistic);
        break;
    case NEPH_Z_TILE:
        snprintf(text, size, "the tile of %d px at (%d, %d) is %.1f standard errors off",
                 plane->tile_px, plane->tile_corner_px[0], plane->tile_corner_px[1], statistic);
        break;
    case NEPH_Z_PIXEL:
        snprintf(text, size, "pixel (%d, %d) is %.1f standard errors off", plane->pixel_px[0],
                 plane->pixel_px[1], statistic);
        break;
    case NEPH_Z_BLOB:
        snprintf(text, size,
                 "%zu connected pixels in (%d, %d)..(%d, %d) are %.1f standard errors off",
                 blob->pixels, blob->box_px[0], blob->box_px[1], blob->box_px[2], blob->box_px[3],
                 blob->mean_z);
        break;
    case NEPH_Z_KIND_COUNT:
        break;
    }
}

static void describe_power(const struct neph_z_plane *plane, char *text, size_t size)
{
    char mean[64] = "", share[SHARE_ROOM], tile[SHARE_ROOM], pixel[SHARE_ROOM];
    if (isfinite(plane->least_mean))
        snprintf(mean, sizeof(mean), "of %s in the mean, ",
                 write_share(plane, plane->least_mean, share));
    snprintf(text, size,
             "a bias %sof %s of the mean in a tile of %d px or %s in a pixel would be found with "
             "%g %%",
             mean, write_share(plane, plane->least_tile, tile), plane->tile_px,
             write_share(plane, plane->least_pixel, pixel), 100.0 * NEPH_Z_POWER);
}

/* Append to the sentence that an error bar is not to be trusted. */
static void add_doubt(const struct neph_noise_verdict *verdict, char *text, size_t size)
{
    const size_t length = strlen(text);
    char doubt[NEPH_DOUBT_ROOM];
    neph_doubt_describe(fmax(verdict->reference->doubt, verdict->test->doubt), doubt,
                        sizeof(doubt));
    if (doubt[0])
        snprintf(text + length, size - length, "; %s", doubt);
}

void neph_noise_sentence(const struct neph_noise_verdict *verdict, char *text, size_t size)
{
    int p;
    const int kind = find_evidence(verdict, &p);
    const size_t contrary = count_contrary(verdict);
    char part[256];
    if (contrary > 0) {
        snprintf(text, size, "bias: %zu pixels that have no noise in either render differ",
                 contrary);
    } else if (verdict->is_bias) {
        describe_bias(&verdict->planes[p], kind, part, sizeof(part));
        snprintf(text, size, "bias: more than noise, p = %.2g: %s of the test: %s", verdict->p,
                 verdict->names[p], part);
    } else if (verdict->planes[0].noisy == 0) {
        snprintf(text, size, "equal: neither render has noise");
    } else {
        describe_power(&verdict->planes[0], part, sizeof(part));
        snprintf(text, size, "noise: no bias found, p = %.2g; %s", verdict->p, part);
    }
    add_doubt(verdict, text, size);
}

static void print_plane(const struct neph_z_plane *plane, const char *name, FILE *out)
{
    fprintf(out, "%s: test - reference %+.4e, 95 %% %+.4e..%+.4e, reference %.4e\n", name,
            plane->bias, plane->bias - plane->bias_half_width, plane->bias + plane->bias_half_width,
            plane->reference_mean);
    for (int k = 0; k < NEPH_Z_KIND_COUNT; k++) {
        char text[256];
        const struct neph_z_result *result = &plane->tests[k];
        if (isnan(result->statistic))
            continue;
        describe_bias(plane, k, text, sizeof(text));
        fprintf(out, "  %-12s p %.2g, adjusted %.2g: %s\n", kind_names[k], result->p,
                result->adjusted, text);
    }
}

static void print_notes(const struct neph_noise_verdict *verdict, FILE *out)
{
    const struct neph_z_plane *plane = &verdict->planes[0];
    fprintf(out,
            "beyond 2, 3, 4 standard errors: %zu, %zu, %zu of %zu pixels; normal noise: %.0f, "
            "%.1f, %.2f; rejected by Holm: %zu\n",
            plane->beyond[0], plane->beyond[1], plane->beyond[2], plane->noisy, plane->expected[0],
            plane->expected[1], plane->expected[2], plane->rejected);
    fprintf(out, "noise of the reference from %s of %d file%s, of the test from %s of %d\n",
            neph_noise_source_name(verdict->reference->source), verdict->reference->file_count,
            verdict->reference->file_count > 1 ? "s" : "",
            neph_noise_source_name(verdict->test->source), verdict->test->file_count);
    if (plane->few_carriers)
        fprintf(out,
                "the mean is not tested: fewer than eight pixels carry its noise; more samples "
                "are needed\n");
    if (plane->neighbour_correlation > correlation_noted)
        fprintf(out,
                "neighbours correlate by %.2f: a bias, or a pixel filter wider than a pixel, "
                "with which p is too small; repeats of both renders measure it\n",
                plane->neighbour_correlation);
}

void neph_noise_print(const struct neph_noise_verdict *verdict, bool is_brief, bool all, FILE *out)
{
    char text[768];
    neph_noise_sentence(verdict, text, sizeof(text));
    fprintf(out, "%s\n", text);
    for (int p = 0; p < (all ? verdict->plane_count : 1) && !is_brief; p++)
        print_plane(&verdict->planes[p], verdict->names[p], out);
    if (!is_brief)
        print_notes(verdict, out);
}

/* ---- JSON ------------------------------------------------------------------------------------ */

static json_t *pair_json(const int px[2])
{
    return json_pack("[i, i]", px[0], px[1]);
}

static json_t *tests_json(const struct neph_z_plane *plane)
{
    json_t *tests = json_object();
    for (int k = 0; k < NEPH_Z_KIND_COUNT; k++) {
        const struct neph_z_result *result = &plane->tests[k];
        json_t *test = json_pack("{s:o, s:f, s:f}", "statistic",
                                 neph_json_number(result->statistic), "p", result->p, "adjusted_p",
                                 result->adjusted);
        if (k == NEPH_Z_PIXEL || k == NEPH_Z_TILE)
            neph_json_set(&test, "at_px",
                          pair_json(k == NEPH_Z_PIXEL ? plane->pixel_px : plane->tile_corner_px));
        neph_json_set(&tests, kind_names[k], test);
    }
    return tests;
}

static json_t *beyond_json(const struct neph_z_plane *plane)
{
    json_t *list = json_array();
    for (int k = 0; k < NEPH_Z_BEYOND_COUNT; k++)
        neph_json_add(&list,
                      json_pack("{s:i, s:I, s:f}", "errors", 2 + k, "count",
                                (json_int_t)plane->beyond[k], "expected", plane->expected[k]));
    return list;
}

static json_t *blob_json(const struct neph_z_blob *blob)
{
    return blob->pixels == 0
               ? json_null()
               : json_pack("{s:I, s:f, s:o, s:o, s:i}", "pixels", (json_int_t)blob->pixels,
                           "mean_z", blob->mean_z, "first_px", pair_json(blob->box_px), "last_px",
                           pair_json(blob->box_px + 2), "draws", blob->draws);
}

static json_t *plane_json(const struct neph_z_plane *plane, const char *name)
{
    json_t *made = json_pack(
        "{s:s, s:f, s:f, s:f, s:f, s:o, s:o, s:o, s:o, s:o, s:o}", "plane", name, "reference_mean",
        plane->reference_mean, "bias", plane->bias, "low", plane->bias - plane->bias_half_width,
        "high", plane->bias + plane->bias_half_width, "least_bias",
        neph_json_number(plane->least_mean), "least_tile_bias", neph_json_number(plane->least_tile),
        "least_pixel_bias", neph_json_number(plane->least_pixel), "tests", tests_json(plane),
        "beyond", beyond_json(plane), "blob", blob_json(&plane->blob));
    const struct {
        const char *key;
        size_t count;
    } counts[] = {
        {"noisy_pixels", plane->noisy},       {"rejected_pixels", plane->rejected},
        {"contrary_pixels", plane->contrary}, {"unjudged_pixels", plane->unjudged},
        {"tile_px", (size_t)plane->tile_px},  {"tiles", (size_t)plane->tile_count},
    };
    for (size_t i = 0; i < sizeof(counts) / sizeof(counts[0]); i++)
        neph_json_set(&made, counts[i].key, json_integer((json_int_t)counts[i].count));
    neph_json_set(&made, "mean_tested", json_boolean(!plane->few_carriers));
    neph_json_set(&made, "neighbour_correlation", json_real(plane->neighbour_correlation));
    return made;
}

static json_t *render_json(const struct neph_noisy_render *render)
{
    return json_pack("{s:i, s:s, s:o}", "files", render->file_count, "source",
                     neph_noise_source_name(render->source), "doubt",
                     neph_json_number(render->doubt));
}

json_t *neph_noise_json(const struct neph_noise_verdict *verdict)
{
    char text[768];
    json_t *planes = json_array();
    neph_noise_sentence(verdict, text, sizeof(text));
    for (int p = 0; p < verdict->plane_count; p++)
        neph_json_add(&planes, plane_json(&verdict->planes[p], verdict->names[p]));
    return json_pack("{s:s, s:s, s:s, s:f, s:f, s:f, s:i, s:o, s:o, s:o}", "version", NEPH_VERSION,
                     "verdict", verdict->is_bias ? "bias" : "noise", "sentence", text, "p",
                     verdict->p, "level", NEPH_Z_LEVEL, "power", NEPH_Z_POWER, "seed",
                     NEPH_NOISE_SEED, "reference", render_json(verdict->reference), "test",
                     render_json(verdict->test), "planes", planes);
}
