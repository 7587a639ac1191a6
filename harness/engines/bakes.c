/* SPDX-License-Identifier: MIT */
#include "harness/engines/bakes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The reported errors; of a signed error, the value with the largest magnitude is the worst. */
static const struct {
    const char *key;
    size_t offset;
} errors[] = {
    {"extinction_rms_relative", offsetof(struct neph_bake_error, extinction_rms_relative)},
    {"extinction_max_relative", offsetof(struct neph_bake_error, extinction_max_relative)},
    {"optical_depth_rms", offsetof(struct neph_bake_error, optical_depth_rms)},
    {"optical_depth_max", offsetof(struct neph_bake_error, optical_depth_max)},
    {"optical_depth_mean", offsetof(struct neph_bake_error, optical_depth_mean)},
    {"transmittance_max", offsetof(struct neph_bake_error, transmittance_max)},
};
enum { ERRORS = sizeof(errors) / sizeof(errors[0]) };

static double *error_at(struct neph_bake_error *error, int which)
{
    return (double *)(void *)((char *)error + errors[which].offset);
}

/* Format the grid sizes, "64 x 40 x 64 nodes, 4 x 3 x 5 nodes (the medium's own)", and find the
 * worst value of each error. */
static struct neph_bakes_summary summarize(const struct neph_bake *bakes, int count)
{
    struct neph_bakes_summary summary = {.grid = ""};
    size_t used = 0;
    for (int i = 0; i < count; i++) {
        const int *size = bakes[i].grid->size;
        struct neph_bake_error error = bakes[i].error;
        if (used < sizeof(summary.grid))
            used += (size_t)snprintf(summary.grid + used, sizeof(summary.grid) - used,
                                     "%s%d x %d x %d nodes%s", i > 0 ? ", " : "", size[0], size[1],
                                     size[2], bakes[i].is_copy ? " (the medium's own)" : "");
        for (int e = 0; e < ERRORS; e++)
            if (fabs(*error_at(&error, e)) > fabs(*error_at(&summary.worst, e)))
                *error_at(&summary.worst, e) = *error_at(&error, e);
    }
    return summary;
}

json_t *neph_bakes_summary_json(const struct neph_bakes_summary *summary)
{
    struct neph_bake_error worst = summary->worst;
    json_t *json = json_pack("{s:s}", "grid", summary->grid);
    for (int e = 0; e < ERRORS; e++)
        neph_json_set(&json, errors[e].key, json_real(*error_at(&worst, e)));
    return json;
}

json_t *neph_bakes_json(const struct neph_bake *bakes, int count)
{
    const struct neph_bakes_summary summary = summarize(bakes, count);
    return neph_bakes_summary_json(&summary);
}

enum neph_status neph_bakes_label(const struct neph_bake *bakes, int count,
                                  struct neph_image *frame, struct neph_diag *diag)
{
    if (count == 0)
        return NEPH_OK;
    json_t *json = neph_bakes_json(bakes, count);
    char *text = json_dumps(json, JSON_COMPACT);
    enum neph_status status = text ? neph_image_set_attribute(frame, NEPH_BAKES_ATTRIBUTE, diag,
                                                              "%s", text)
                                   : neph_fail_memory(diag);
    free(text);
    json_decref(json);
    return status;
}

bool neph_bakes_from_frame(const struct neph_image *frame, struct neph_bakes_summary *summary)
{
    const char *text = neph_image_attribute(frame, NEPH_BAKES_ATTRIBUTE);
    json_t *json = text ? json_loads(text, 0, NULL) : NULL;
    if (!json)
        return false;
    *summary = (struct neph_bakes_summary){.grid = ""};
    snprintf(summary->grid, sizeof(summary->grid), "%s", neph_json_text(json, "grid"));
    for (int e = 0; e < ERRORS; e++)
        *error_at(&summary->worst, e) = json_number_value(json_object_get(json, errors[e].key));
    json_decref(json);
    return true;
}
