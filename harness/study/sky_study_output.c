/* SPDX-License-Identifier: MIT */
#include "harness/study/sky_study.h"

#include "base/written.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool neph_sky_is_held(const struct neph_sky_cell *cell)
{
    return cell->sun_deg >= NEPH_SKY_LOWEST_SUN_DEG;
}

bool neph_sky_is_good(const struct neph_sky_gap *gap)
{
    return gap->mean <= NEPH_SKY_MEAN_WANTED && gap->worst <= NEPH_SKY_WORST_WANTED;
}

/* ---- tables ---------------------------------------------------------------------------------- */

static void print_gap(const struct neph_sky_cell *cell, const struct neph_sky_gap *gap, FILE *out)
{
    fprintf(out, "| %g | %g |", cell->sun_deg, cell->altitude_m / 1000.0);
    if (gap->because[0]) {
        fprintf(out, " - | - | - | - | - | - | cannot: %s |\n", gap->because);
        return;
    }
    if (isnan(gap->mean)) {
        fprintf(out, " - | - | - | - | - | - | no light |\n");
        return;
    }
    fprintf(out, " %.2f | %.1f | %+.0f, %.0f | %.1f | %+.2f | %.2f | %s |\n", 100.0 * gap->mean,
            100.0 * gap->worst, gap->worst_elevation_deg, gap->worst_azimuth_deg,
            100.0 * gap->worst_noise, 100.0 * gap->bias, 100.0 * cell->noise,
            neph_sky_is_good(gap)    ? "holds"
            : neph_sky_is_held(cell) ? "**fails**"
                                     : "no limit");
}

static void print_model(const struct neph_sky_study *study, int model, FILE *out)
{
    double seconds = 0.0;
    fprintf(out,
            "\n**%s**\n\n`%s`\n\n"
            "| sun [degrees] | altitude [km] | mean [%%] | worst [%%] | at elevation, azimuth | "
            "noise there [%%] | bias [%%] | noise, mean [%%] | |\n"
            "| ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | --- |\n",
            study->params->models[model], study->settings[model]);
    for (int i = 0; i < study->cell_count; i++) {
        print_gap(&study->cells[i], &study->cells[i].gaps[model], out);
        seconds += study->cells[i].gaps[model].render_s;
    }
    fprintf(out, "\n%.3g s a picture, tables included.\n",
            seconds / (2.0 * fmax(1.0, study->cell_count)));
}

static void print_study(const void *what, FILE *out)
{
    const struct neph_sky_study *study = what;
    const struct neph_sky_study_params *params = study->params;
    fprintf(out,
            "neph %s, %s of %s on %s: %d samples, %dx%d, directions of %dx%d pixels.\n"
            "A direction is off by the sum over channels of abs(model - truth) over the sum of the "
            "truth; means over directions by\ntheir solid angles; noise is what the truth is off "
            "by itself. Wanted from %g degrees on: mean <= %g %%, worst <= %g %%.\n",
            NEPH_VERSION, params->scene->name, params->truth, study->device, params->samples,
            params->width_px, params->height_px, params->tile_px, params->tile_px,
            NEPH_SKY_LOWEST_SUN_DEG, 100.0 * NEPH_SKY_MEAN_WANTED, 100.0 * NEPH_SKY_WORST_WANTED);
    for (int model = 0; model < params->model_count; model++)
        print_model(study, model, out);
}

enum neph_status neph_sky_study_text(const struct neph_sky_study *study, char **text,
                                     struct neph_diag *diag)
{
    return neph_written(print_study, study, text, diag);
}

/* ---- JSON ------------------------------------------------------------------------------------ */

static json_t *gap_json(const struct neph_sky_gap *gap)
{
    if (gap->because[0])
        return json_pack("{s:s}", "cannot", gap->because);
    return json_pack(
        "{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:b}", "mean", neph_json_number(gap->mean), "worst",
        neph_json_number(gap->worst), "bias", neph_json_number(gap->bias), "worst_elevation_deg",
        neph_json_number(gap->worst_elevation_deg), "worst_azimuth_deg",
        neph_json_number(gap->worst_azimuth_deg), "worst_noise", neph_json_number(gap->worst_noise),
        "render_s", neph_json_number(gap->render_s), "good", neph_sky_is_good(gap));
}

json_t *neph_sky_study_json(const struct neph_sky_study *study)
{
    json_t *cells = json_array();
    for (int i = 0; i < study->cell_count; i++) {
        const struct neph_sky_cell *cell = &study->cells[i];
        json_t *models = json_object();
        for (int m = 0; m < study->params->model_count; m++)
            neph_json_set(&models, study->params->models[m], gap_json(&cell->gaps[m]));
        neph_json_add(&cells,
                      json_pack("{s:f, s:f, s:i, s:o, s:b, s:o}", "sun_deg", cell->sun_deg,
                                "altitude_m", cell->altitude_m, "directions", cell->direction_count,
                                "noise", neph_json_number(cell->noise), "held",
                                neph_sky_is_held(cell), "models", models));
    }
    return json_pack("{s:s, s:s, s:s, s:o}", "scene", study->params->scene->name, "truth",
                     study->params->truth, "device", study->device, "cells", cells);
}
