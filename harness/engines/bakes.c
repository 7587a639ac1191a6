/* SPDX-License-Identifier: MIT */
#include "harness/engines/bakes.h"

#include "base/files.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* "64 x 40 x 64 nodes, 4 x 3 x 5 nodes (the medium's own)"; for the caller to free. */
static char *describe_grids(const struct neph_bake *bakes, int count)
{
    char *text = strdup("");
    for (int i = 0; i < count && text; i++) {
        const int *size = bakes[i].grid->size;
        char *longer = neph_format("%s%s%d x %d x %d nodes%s", text, i > 0 ? ", " : "", size[0],
                                   size[1], size[2], bakes[i].is_copy ? " (the medium's own)" : "");
        free(text);
        text = longer;
    }
    return text;
}

/* The worst of each; of the bias, which has a sign, the one that is farthest from 0. */
static struct neph_bake_error worst_of(const struct neph_bake *bakes, int count)
{
    struct neph_bake_error worst = bakes[0].error;
    for (int i = 1; i < count; i++) {
        const struct neph_bake_error *e = &bakes[i].error;
        worst.extinction_rms_relative = fmax(worst.extinction_rms_relative,
                                             e->extinction_rms_relative);
        worst.extinction_max_relative = fmax(worst.extinction_max_relative,
                                             e->extinction_max_relative);
        worst.optical_depth_rms = fmax(worst.optical_depth_rms, e->optical_depth_rms);
        worst.optical_depth_max = fmax(worst.optical_depth_max, e->optical_depth_max);
        worst.transmittance_max = fmax(worst.transmittance_max, e->transmittance_max);
        if (fabs(e->optical_depth_mean) > fabs(worst.optical_depth_mean))
            worst.optical_depth_mean = e->optical_depth_mean;
    }
    return worst;
}

json_t *neph_bakes_json(const struct neph_bake *bakes, int count)
{
    char *grids = describe_grids(bakes, count);
    const struct neph_bake_error worst = worst_of(bakes, count);
    json_t *json = json_pack(
        "{s:s*, s:f, s:f, s:f, s:f, s:f, s:f}", "grid", grids, "extinction_rms_relative",
        worst.extinction_rms_relative, "extinction_max_relative", worst.extinction_max_relative,
        "optical_depth_rms", worst.optical_depth_rms, "optical_depth_max", worst.optical_depth_max,
        "optical_depth_mean", worst.optical_depth_mean, "transmittance_max",
        worst.transmittance_max);
    free(grids);
    return json;
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

json_t *neph_bakes_of_frame(const struct neph_image *frame)
{
    const char *text = neph_image_attribute(frame, NEPH_BAKES_ATTRIBUTE);
    json_t *json = text ? json_loads(text, 0, NULL) : NULL;
    return json ? json : json_null();
}
