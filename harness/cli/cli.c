/* SPDX-License-Identifier: MIT */
#include "harness/cli/cli.h"

#include "base/files.h"
#include "base/path.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_OPTION_KIND_COUNT == 3, "a new kind");

static const char scratch_prefix[] = ".neph-scratch-";

enum neph_status neph_cli_open_folder(const char *output, struct neph_diag *diag)
{
    const enum neph_status status = neph_dir_create(output, diag);
    if (!status)
        neph_scratch_sweep(output, scratch_prefix);
    return status;
}

enum neph_status neph_cli_open_store(const char *output, struct neph_store **store,
                                     struct neph_diag *diag)
{
    const struct neph_path folder = neph_path_in(output, "store");
    if (neph_path_is_dir(folder.text))
        return neph_store_open(folder.text, store, diag);
    neph_fail(diag, NEPH_ERR_NOT_FOUND, "there is no store in '%s'", output);
    neph_hint(diag, "-o names the folder that was given to the other verbs");
    return NEPH_ERR_NOT_FOUND;
}

enum neph_status neph_cli_begin_scratch(const char *output, struct neph_scratch **scratch,
                                        struct neph_diag *diag)
{
    return neph_scratch_create(output, scratch_prefix, scratch, diag);
}

void neph_cli_end_scratch(struct neph_scratch *scratch, enum neph_status status,
                          struct neph_diag *diag)
{
    if (!scratch || (status != NEPH_ERR_ENGINE && status != NEPH_ERR_TIMEOUT)) {
        if (scratch && status)
            neph_move_paths(diag, neph_scratch_path(scratch), NULL);
        neph_scratch_destroy(scratch);
        return;
    }
    const struct neph_path path = neph_path_format("%s", neph_scratch_path(scratch));
    if (neph_scratch_keep(scratch) && diag && !diag->hint[0])
        neph_hint(diag, "its logs are in %s", path.text);
}

void neph_cli_print_folder(const char *verb, const char *folder)
{
    fprintf(stderr, "neph %s: results are in %s\n", verb, folder);
}

void neph_cli_check_colours(const char *ocio, const char *space, bool convert,
                            const struct argp_state *state)
{
    if (ocio && !convert)
        argp_error(state, "--ocio has colour spaces for --convert");
    if (space && !ocio)
        argp_error(state, "--space is a name in a config: --ocio FILE");
}

json_t *neph_cli_options_json(const struct neph_option *options)
{
    json_t *list = json_array();
    for (const struct neph_option *o = options; o->name; o++) {
        json_t *item = json_pack("{s:s, s:s}", "name", o->name, "help", o->help);
        if (o->kind == NEPH_OPTION_CHOICE) {
            json_t *choices = json_array();
            for (int i = 0; o->choices[i]; i++)
                neph_json_add(&choices, json_string(o->choices[i]));
            neph_json_set(&item, "choices", choices);
            neph_json_set(&item, "default", json_string(o->choices[(int)o->default_value]));
        } else {
            neph_json_set(&item, "default",
                          isnan(o->default_value) ? json_string("auto")
                                                  : json_real(o->default_value));
            neph_json_set(&item, "minimum", json_real(o->minimum));
            neph_json_set(&item, "maximum", json_real(o->maximum));
        }
        neph_json_add(&list, item);
    }
    return list;
}

void neph_cli_print_options(const struct neph_option *options)
{
    int width = 14;
    for (const struct neph_option *o = options; o->name; o++)
        width = (int)strlen(o->name) > width ? (int)strlen(o->name) : width;
    for (const struct neph_option *o = options; o->name; o++) {
        printf("    %-*s %s\n", width, o->name, o->help);
        if (o->kind == NEPH_OPTION_CHOICE) {
            printf("    %-*s one of:", width, "");
            for (int i = 0; o->choices[i]; i++)
                printf(" %s%s", o->choices[i], i == (int)o->default_value ? " (default)" : "");
            printf("\n");
        } else {
            printf("    %-*s %g..%g, default ", width, "", o->minimum, o->maximum);
            printf(isnan(o->default_value) ? "auto\n" : "%g\n", o->default_value);
        }
    }
}

json_t *neph_cli_presets_json(const struct neph_preset *presets)
{
    json_t *list = json_array();
    for (const struct neph_preset *p = presets; p && p->name; p++)
        neph_json_add(&list, json_pack("{s:s, s:s, s:s}", "name", p->name, "summary", p->summary,
                                       "settings", p->assignments));
    return list;
}

void neph_cli_print_presets(const struct neph_preset *presets, int indent)
{
    enum { COLUMN = 15 }; /* of the texts to the right of the names */
    for (const struct neph_preset *p = presets; p && p->name; p++)
        printf("%*s%-*s %s\n%*s%s\n", indent, "", COLUMN - 1 - indent, p->name, p->summary, COLUMN,
               "", p->assignments[0] ? p->assignments : "(nothing else)");
}

enum neph_status neph_cli_print_json(json_t *json, bool wanted, struct neph_diag *diag)
{
    if (wanted)
        return neph_json_print(json, diag);
    json_decref(json);
    return NEPH_OK;
}
