/* SPDX-License-Identifier: MIT
 *
 * `neph engines`: lists the engines, their settings, presets and passes.
 */
#include "harness/cli/cli.h"

#include "harness/engines/engines.h"
#include "harness/engines/vulkan_device.h"

#include <stdio.h>
#include <string.h>

static const struct neph_cli_option options[] = {
    {.name = "blender"},
    {.name = "json"},
    {.name = "quiet", .help = "Accepted; this verb prints only results"},
    {.name = NULL},
};

static json_t *passes_json(const struct neph_engine *engine)
{
    json_t *list = json_array();
    struct neph_engine_pass pass;
    for (int i = 0; engine->describe_pass && engine->describe_pass(i, &pass); i++)
        neph_json_add(&list, json_pack("{s:s, s:s, s:s, s:s, s:s, s:s, s:s}", "name", pass.name,
                                       "note", pass.note, "resolution", pass.resolution,
                                       "condition", pass.condition, "reads", pass.reads, "writes",
                                       pass.writes, "hands_on", pass.hands_on));
    return list;
}

static void print_passes(const struct neph_engine *engine)
{
    struct neph_engine_pass pass;
    if (engine->describe_pass)
        printf("    passes of a frame\n");
    for (int i = 0; engine->describe_pass && engine->describe_pass(i, &pass); i++) {
        const char *const rows[][2] = {
            {"reads", pass.reads}, {"writes", pass.writes}, {"hands on", pass.hands_on}};
        printf("      %-15s %s\n%22s%s resolution%s%s\n", pass.name, pass.note, "", pass.resolution,
               pass.condition[0] ? ", where " : "", pass.condition);
        for (size_t r = 0; r < sizeof(rows) / sizeof(rows[0]); r++)
            if (rows[r][1][0])
                printf("%22s%-8s %s\n", "", rows[r][0], rows[r][1]);
    }
}

static json_t *engine_json(const struct neph_engine *engine, const struct neph_engine_info *info)
{
    return json_pack(
        "{s:s, s:s, s:s, s:s?, s:b, s:b, s:s, s:s, s:s, s:s, s:s, s:s, s:o, s:o, s:o, s:o}", "name",
        engine->name, "summary", engine->summary, "rung", neph_rung_name(engine->rung), "bias",
        engine->bias, "available", info->available, "broken", info->broken, "version",
        info->version, "device", info->device, "missing", info->missing, "install_line",
        info->install_line, "can", info->can, "warning", info->warning, "options",
        neph_cli_options_json(engine->options), "presets", neph_cli_presets_json(engine->presets),
        "passes", passes_json(engine), "display_stages",
        engine->describe_pass ? neph_cli_post_stages_json() : json_array());
}

static void print_engine(const struct neph_engine *engine, const struct neph_engine_info *info)
{
    printf("%s (%s): %s\n    %s%s\n", engine->name, neph_rung_name(engine->rung), engine->summary,
           info->available ? info->version
           : info->broken  ? "broken: "
                           : "missing: ",
           info->available ? "" : info->missing);
    if (info->can[0])
        printf("    can do: %s\n", info->can);
    if (info->warning[0])
        printf("    warning: %s\n", info->warning);
    if (engine->bias)
        printf("    known bias: %s\n", engine->bias);
    neph_cli_print_options(engine->options);
    if (engine->presets)
        printf("    presets, given by --preset, each the defaults with\n");
    neph_cli_print_presets(engine->presets, 6);
    print_passes(engine);
    if (!engine->describe_pass)
        return;
    printf("    post-processing from a frame to the display, by display.chain of a scene or "
           "--chain FILE: the enabled stages; the last one writes the image\n");
    neph_cli_post_print_stages("      ");
}

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &neph_cli_one_name_or_none,
    .doc = "List the engines with their level in the reference hierarchy, version and settings.\v"
           "Examples:\n"
           "  neph engines\n"
           "  neph engines march --json",
};

enum neph_status neph_cli_engines(int argc, char **argv, struct neph_diag *diag)
{
    struct neph_cli_shared request = {0};
    neph_cli_parse(&syntax, argc, argv, &request);
    const char *only = request.operand_count > 0 ? request.operands[0] : NULL;
    if (only && !neph_engine_find(only))
        return neph_fail(diag, NEPH_ERR_USAGE, "there is no engine '%s'; `neph engines` lists them",
                         only);
    struct neph_shared_device device = {.open = NULL};
    json_t *list = json_array();
    int count;
    const struct neph_engine *const *engines = neph_engines_and_guests(&count);
    for (int i = 0; i < count; i++) {
        struct neph_engine_info info;
        if (only && strcmp(only, engines[i]->name) != 0)
            continue;
        neph_engine_probe(engines[i], &device, &info);
        if (request.json)
            neph_json_add(&list, engine_json(engines[i], &info));
        else
            print_engine(engines[i], &info);
    }
    neph_shared_device_close(&device);
    return neph_cli_give_json(list, request.json, diag);
}
