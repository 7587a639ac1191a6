/* SPDX-License-Identifier: MIT */
#include "harness/cli/post_list.h"

#include <stdio.h>

static const char *size_of(const struct neph_post_stage *stage)
{
    static const char *const sizes[] = {
        [NEPH_POST_MAKES_PICTURE] = "the size that it gets",
        [NEPH_POST_MAKES_LARGER] = "the display's size",
        [NEPH_POST_MAKES_TABLE] = "a table",
        [NEPH_POST_MAKES_HISTOGRAM] = "a histogram",
        [NEPH_POST_MAKES_EXPOSURE] = "an exposure",
        [NEPH_POST_MAKES_PYRAMID] = "a pyramid of pictures",
        [NEPH_POST_MAKES_BLOOM] = "the size that it gets",
    };
    return sizes[stage->makes];
}

json_t *neph_cli_post_stages_json(void)
{
    json_t *stages = json_array();
    for (const struct neph_post_stage *s = neph_post_stages; s->name; s++)
        neph_json_add(&stages,
                      json_pack("{s:s, s:s, s:s, s:s, s:s}", "name", s->name, "pass",
                                neph_post_pass_names[s->pass], "note", s->note, "setting",
                                neph_post_options[s->settings[1]].name, "makes", size_of(s)));
    return stages;
}

void neph_cli_post_print_stages(const char *indent)
{
    for (const struct neph_post_stage *s = neph_post_stages; s->name; s++)
        printf("%s%-17s %s; on with %s\n", indent, s->name, s->note,
               neph_post_options[s->settings[1]].name);
}

static json_t *list_json(void)
{
    json_t *presets = json_array();
    for (const struct neph_preset *p = neph_post_presets; p->name; p++)
        neph_json_add(&presets, json_pack("{s:s, s:s, s:s}", "name", p->name, "summary", p->summary,
                                          "settings", p->assignments));
    return json_pack("{s:o, s:o, s:o}", "stages", neph_cli_post_stages_json(), "settings",
                     neph_cli_options_json(neph_post_options), "presets", presets);
}

static json_t *weights_json(const struct neph_post_plan *plan)
{
    json_t *volumes = json_array();
    for (int i = 0; i < plan->volume_count; i++)
        neph_json_add(&volumes,
                      json_pack("{s:o, s:f, s:f, s:f}", "name",
                                neph_json_cleaned(plan->volumes[i].name), "priority",
                                plan->volumes[i].priority, "weight", plan->volumes[i].weight,
                                "blend_radius_m", plan->volumes[i].blend_radius_m));
    return volumes;
}

/* The stages of a chain that are on, as it stands in its file. */
static enum neph_status list_chain(const struct neph_post_plan *plan, bool as_json,
                                   struct neph_diag *diag)
{
    const struct neph_settings settings = neph_post_plan_settings(plan);
    const struct neph_post_stage *stages[NEPH_POST_STAGES_MAX];
    const int count = neph_post_sequence(&plan->order, &settings, stages);
    json_t *names = json_array();
    for (int i = 0; i < count; i++)
        neph_json_add(&names, json_string(stages[i]->name));
    if (as_json)
        return neph_json_print(
            json_pack("{s:o, s:o}", "stages", names, "volumes", weights_json(plan)), diag);
    json_decref(names);
    printf("stages that are on, in their order\n");
    for (int i = 0; i < count; i++)
        printf("    %-17s %s\n", stages[i]->name, stages[i]->note);
    for (int i = 0; i < plan->volume_count; i++)
        printf("volume %s: priority %g, weight %g, %s\n", plan->volumes[i].name,
               plan->volumes[i].priority, plan->volumes[i].weight,
               plan->volumes[i].box.present ? "in its box" : "everywhere");
    return NEPH_OK;
}

enum neph_status neph_cli_post_list(const struct neph_post_plan *plan, bool as_json,
                                    struct neph_diag *diag)
{
    if (plan)
        return list_chain(plan, as_json, diag);
    if (as_json)
        return neph_json_print(list_json(), diag);
    printf("stages, in their order\n");
    neph_cli_post_print_stages("    ");
    printf("settings\n");
    neph_cli_print_options(neph_post_options);
    printf("presets, each the defaults with\n");
    for (const struct neph_preset *p = neph_post_presets; p->name; p++)
        printf("    %-10s %s\n               %s\n", p->name, p->summary,
               p->assignments[0] ? p->assignments : "(nothing else)");
    return NEPH_OK;
}
