/* SPDX-License-Identifier: MIT
 *
 * `neph compare REFERENCE.exr TEST.exr`.
 */
#include "harness/cli.h"

#include "base/exr.h"
#include "harness/measure.h"
#include "metrics/validity.h"

#include <argp.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { KEY_JSON = 1, KEY_MASK, KEY_FAIL_ABOVE, LIMITS_MAX = 16 };

struct request {
    const char *reference, *test, *mask;
    const char *limits[LIMITS_MAX];
    int limit_count;
    bool json;
};

static const struct argp_option options[] = {
    {"mask", KEY_MASK, "NAME", 0, "Only this mask: all, sky, solid, medium, depth_edge", 0},
    {"fail-above", KEY_FAIL_ABOVE, "QUANTITY:METRIC=LIMIT", 0,
     "Exit with 1 when |value| over the whole image is above the limit, such as "
     "radiance:rel_rmse=0.01; may be given several times",
     0},
    {"json", KEY_JSON, NULL, 0, "Results as JSON on stdout", 0},
    {0},
};

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct request *request = state->input;
    switch (key) {
    case KEY_JSON:
        request->json = true;
        return 0;
    case KEY_MASK:
        request->mask = argument;
        return 0;
    case KEY_FAIL_ABOVE:
        if (request->limit_count == LIMITS_MAX)
            argp_error(state, "more than %d limits", LIMITS_MAX);
        request->limits[request->limit_count++] = argument;
        return 0;
    case ARGP_KEY_ARG:
        if (!request->reference)
            request->reference = argument;
        else if (!request->test)
            request->test = argument;
        else
            argp_error(state, "two images, not '%s' as well", argument);
        return 0;
    case ARGP_KEY_END:
        if (!request->test)
            argp_error(state, "two images are needed: REFERENCE.exr TEST.exr");
        return 0;
    }
    return ARGP_ERR_UNKNOWN;
}

static const struct argp argp = {
    .options = options,
    .parser = parse,
    .args_doc = "REFERENCE.exr TEST.exr",
    .doc = "Measure the error of TEST against REFERENCE on linear data.\v"
           "Non-finite or negative values in either image are an error before anything else. The "
           "sign is test - reference.\n\n"
           "Examples:\n"
           "  neph compare exact.exr march.exr\n"
           "  neph compare exact.exr march.exr --json --mask depth_edge\n"
           "  neph compare old.exr new.exr --fail-above transmittance:max_abs=1e-5",
};

static enum neph_status read_valid(const char *path, struct neph_image **image,
                                   struct neph_diag *diag)
{
    struct neph_validity validity = {0};
    enum neph_status status = neph_exr_read(path, image, diag);
    if (!status)
        status = neph_validity_count(*image, &validity, diag);
    if (!status)
        status = neph_validity_gate(&validity, 0, diag);
    if (status == NEPH_ERR_GATE && diag)
        neph_locate(diag, path, 0, 0);
    neph_validity_finish(&validity);
    return status;
}

static void print_table(const json_t *list, const char *mask)
{
    printf("%-14s %-11s %-13s %14s  %-22s %8s  %s\n", "quantity", "mask", "metric", "value",
           "95 % interval", "pixels", "unit");
    for (size_t i = 0; i < json_array_size(list); i++) {
        const json_t *item = json_array_get(list, i);
        const char *name = json_string_value(json_object_get(item, "mask"));
        if (mask && strcmp(mask, name) != 0)
            continue;
        const json_t *value = json_object_get(item, "value");
        const json_t *interval = json_object_get(item, "interval");
        char number[32] = "undefined", bounds[48] = "-";
        if (json_is_number(value))
            snprintf(number, sizeof(number), "%.6e", json_number_value(value));
        if (json_is_array(interval))
            snprintf(bounds, sizeof(bounds), "%.2e..%.2e",
                     json_number_value(json_array_get(interval, 0)),
                     json_number_value(json_array_get(interval, 1)));
        printf("%-14s %-11s %-13s %14s  %-22s %8lld  %s\n",
               json_string_value(json_object_get(item, "quantity")), name,
               json_string_value(json_object_get(item, "metric")), number, bounds,
               (long long)json_integer_value(json_object_get(item, "pixel_count")),
               json_string_value(json_object_get(item, "unit")));
    }
}

/* "radiance:rel_rmse=0.01" against the measurements. */
static enum neph_status check_limit(const json_t *list, const char *text, struct neph_diag *diag)
{
    char quantity[32], metric[32], rest[64], *end;
    if (sscanf(text, "%31[^:]:%31[^=]=%63s", quantity, metric, rest) != 3)
        return neph_fail(diag, NEPH_ERR_USAGE, "limit '%s' is not QUANTITY:METRIC=LIMIT", text);
    const double limit = strtod(rest, &end);
    if (*end || !isfinite(limit) || limit < 0.0)
        return neph_fail(diag, NEPH_ERR_USAGE, "limit '%s' is not a finite number >= 0", rest);
    const json_t *value = json_object_get(neph_measurement_find(list, quantity, metric, "all"),
                                          "value");
    if (!json_is_number(value))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "%s of %s is not defined for these images",
                         metric, quantity);
    if (fabs(json_number_value(value)) > limit)
        return neph_fail(diag, NEPH_ERR_GATE, "%s of %s is %.6g, above the limit %g", metric,
                         quantity, json_number_value(value), limit);
    return NEPH_OK;
}

enum neph_status neph_cli_compare(int argc, char **argv, struct neph_diag *diag)
{
    struct request request = {0};
    argp_parse(&argp, argc, argv, 0, NULL, &request);
    struct neph_image *reference = NULL, *test = NULL;
    const struct neph_viewing viewing = NEPH_VIEWING_DEFAULTS;
    json_t *list = json_array();
    enum neph_status status = read_valid(request.reference, &reference, diag);
    if (!status)
        status = read_valid(request.test, &test, diag);
    if (!status)
        status = neph_measure(reference, test, NULL, &viewing, list, diag);
    if (!status && json_array_size(list) == 0)
        status = neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                           "the two images share none of: R G B, volume.*, transmittance.*, Z");
    if (!status && request.json)
        neph_cli_print_json(json_incref(list));
    else if (!status)
        print_table(list, request.mask);
    for (int i = 0; i < request.limit_count && !status; i++)
        status = check_limit(list, request.limits[i], diag);
    json_decref(list);
    neph_image_destroy(reference);
    neph_image_destroy(test);
    return status;
}
