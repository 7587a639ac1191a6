/* SPDX-License-Identifier: MIT */
#include "harness/study/fog_study_output.h"

#include "base/written.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

/* Steps below it are roundings. */
static const double least_jump = 1e-9;

#define AT(member) offsetof(struct neph_fog_row, member)

/* The numbers of a row, for spreadsheets and programs. */
static const struct {
    const char *name;
    size_t at;
} numbers[] = {
    {"transmittance_bias", AT(transmittance_bias)},
    {"transmittance_worst", AT(transmittance_worst)},
    {"radiance_bias", AT(radiance_bias)},
    {"radiance_rms", AT(radiance_rms)},
    {"fog_light", AT(fog_light)},
    {"all_light", AT(all_light)},
    {"fog_light_alone", AT(fog_light_alone)},
    {"all_light_alone", AT(all_light_alone)},
    {"transmittance_jump", AT(transmittance_jump)},
    {"transmittance_jump_m", AT(transmittance_jump_m)},
    {"light_jump", AT(light_jump)},
    {"light_jump_m", AT(light_jump_m)},
    {"lobe_over_sun", AT(lobe_over_sun)},
};
enum { NUMBER_COUNT = sizeof(numbers) / sizeof(numbers[0]) };

static double number_of(const struct neph_fog_row *row, int index)
{
    return *(const double *)((const char *)row + numbers[index].at);
}

/* ---- for people ------------------------------------------------------------------------------ */

static void print_percent(double part, FILE *out)
{
    fprintf(out, " %+.1f |", 100.0 * part);
}

static void print_jump(double jump, double at_m, FILE *out)
{
    if (isnan(jump))
        fprintf(out, " |");
    else if (jump < least_jump)
        fprintf(out, " - |");
    else
        fprintf(out, " %.2g at %.4g m |", jump, at_m);
}

static void print_row(const struct neph_fog_row *row, FILE *out)
{
    fprintf(out, "| %s | %s | %+.4f | %.4f |", neph_fog_model_words[row->model], row->name,
            row->transmittance_bias, row->transmittance_worst);
    print_percent(row->radiance_bias, out);
    print_percent(row->radiance_rms, out);
    print_percent(row->fog_light, out);
    print_percent(row->fog_light_alone, out);
    print_percent(row->all_light_alone, out);
    print_jump(row->transmittance_jump, row->transmittance_jump_m, out);
    print_jump(row->light_jump, row->light_jump_m, out);
    if (isnan(row->lobe_over_sun))
        fprintf(out, " - |\n");
    else
        fprintf(out, " %.3f |\n", row->lobe_over_sun);
}

static void print_study(const void *what, FILE *out)
{
    const struct neph_fog_study *study = what;
    const struct neph_fog_study_params *params = study->params;
    fprintf(out,
            "neph %s, %s: the controls of its fog_look, each alone, against engine exact; %dx%d "
            "pixels and %d\ndirections over the sphere around the camera. Exact has a mean "
            "radiance of %.4g W/m2/sr in the picture; over the\nsphere %.4g, of which the fog's "
            "own light is %.4g.\n\n",
            NEPH_VERSION, params->scene->name, params->width_px, params->height_px,
            params->directions, study->exact_radiance, study->exact_all_light,
            study->exact_fog_light);
    fprintf(out,
            "| model | controls | transmittance: bias | worst | radiance: bias, %% | rms, %% | "
            "fog's light over the sphere, %% | by the control alone | all light by it | jump of "
            "transmittance | jump of light, W/m2/sr | lobe over sun |\n"
            "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: "
            "|\n");
    for (int i = 0; i < study->row_count; i++)
        print_row(&study->rows[i], out);
}

/* ---- results --------------------------------------------------------------------------------- */

static void print_csv(const void *what, FILE *out)
{
    const struct neph_fog_study *study = what;
    fprintf(out, "scene,model,controls");
    for (int n = 0; n < NUMBER_COUNT; n++)
        fprintf(out, ",%s", numbers[n].name);
    fprintf(out, "\r\n");
    for (int i = 0; i < study->row_count; i++) {
        const struct neph_fog_row *row = &study->rows[i];
        fprintf(out, "%s,%s,\"%s\"", study->params->scene->name, neph_fog_model_words[row->model],
                row->name);
        for (int n = 0; n < NUMBER_COUNT; n++)
            if (isnan(number_of(row, n)))
                fprintf(out, ",");
            else
                fprintf(out, ",%.9g", number_of(row, n));
        fprintf(out, "\r\n");
    }
}

enum neph_status neph_fog_study_text(const struct neph_fog_study *study, char **text,
                                     struct neph_diag *diag)
{
    return neph_written(print_study, study, text, diag);
}

enum neph_status neph_fog_study_csv(const struct neph_fog_study *study, char **text,
                                    struct neph_diag *diag)
{
    return neph_written(print_csv, study, text, diag);
}

static json_t *row_json(const struct neph_fog_row *row)
{
    json_t *made = json_pack("{s:s, s:s}", "model", neph_fog_model_words[row->model], "controls",
                             row->name);
    for (int n = 0; n < NUMBER_COUNT; n++)
        neph_json_set(&made, numbers[n].name, neph_json_number(number_of(row, n)));
    return made;
}

json_t *neph_fog_study_json(const struct neph_fog_study *study)
{
    const struct neph_fog_study_params *params = study->params;
    json_t *rows = json_array();
    for (int i = 0; i < study->row_count; i++)
        neph_json_add(&rows, row_json(&study->rows[i]));
    return json_pack("{s:s, s:s, s:s, s:[i, i], s:i, s:f, s:f, s:f, s:o}", "format",
                     "neph-fog-study-1", "version", NEPH_VERSION, "scene", params->scene->name,
                     "size_px", params->width_px, params->height_px, "directions",
                     params->directions, "exact_radiance", study->exact_radiance, "exact_fog_light",
                     study->exact_fog_light, "exact_all_light", study->exact_all_light, "rows",
                     rows);
}
