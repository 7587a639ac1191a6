/* SPDX-License-Identifier: MIT */
#include "scenes/load_phase.h"

#include "scenes/phase_table.h"
#include "scenes/resolve_path.h"

static const struct {
    const char *key;
    enum neph_phase_parameter parameter;
} parameters[] = {
    {"asymmetry_g", NEPH_PHASE_PARAMETER_G},
    {"second_asymmetry_g", NEPH_PHASE_PARAMETER_LOBES},
    {"first_share", NEPH_PHASE_PARAMETER_LOBES},
    {"draine_alpha", NEPH_PHASE_PARAMETER_ALPHA},
    {"droplet_diameter_um", NEPH_PHASE_PARAMETER_DIAMETER},
    {"phase_table", NEPH_PHASE_PARAMETER_TABLE},
};

/* The kinds with a parameter: "draine, cornette_shanks". */
static void list_kinds(enum neph_phase_parameter parameter, char *text, size_t size)
{
    size_t used = 0;
    for (int kind = 0; kind < NEPH_PHASE_KIND_COUNT && used < size; kind++)
        if (neph_phase_has((enum neph_phase_kind)kind, parameter))
            used += (size_t)snprintf(text + used, size - used, "%s%s", used ? ", " : "",
                                     neph_phase_words[kind]);
}

static enum neph_status check_parameters(const struct neph_reader *reader, const yaml_node_t *node,
                                         const struct neph_phase *phase)
{
    for (size_t i = 0; i < sizeof(parameters) / sizeof(parameters[0]); i++) {
        const char *key = parameters[i].key;
        const bool has = neph_reader_has(reader, node, key);
        const bool wants = neph_phase_has(phase->kind, parameters[i].parameter);
        char kinds[256] = "";
        list_kinds(parameters[i].parameter, kinds, sizeof(kinds));
        if (wants && !has)
            return neph_refuse(reader, "phase", "%s needs the key %s",
                               neph_phase_words[phase->kind], key);
        if (!wants && has)
            return neph_refuse(reader, key, "phase: %s does not have this; it is for %s",
                               neph_phase_words[phase->kind], kinds);
    }
    if (neph_phase_has(phase->kind, NEPH_PHASE_PARAMETER_LOBES) && phase->g < 0.0)
        return neph_refuse(reader, "asymmetry_g",
                           "%g: the first lobe is the forward one, the second may be backward",
                           phase->g);
    return NEPH_OK;
}

static enum neph_status read_table(struct neph_reader *reader, struct neph_written_medium *written)
{
    const char *path = NULL;
    enum neph_status status = neph_resolve_path(reader, written->phase_table, "/path/to/the/table",
                                                &path);
    if (!status)
        status = neph_phase_table_read(path, reader->arena, &written->medium.phase.table,
                                       reader->diag);
    return status;
}

enum neph_status neph_finish_phase(struct neph_reader *reader, const yaml_node_t *node,
                                   struct neph_written_medium *written)
{
    if (!neph_were_keys_read(reader, "phase asymmetry_g second_asymmetry_g first_share "
                                     "draine_alpha droplet_diameter_um phase_table"))
        return NEPH_OK;
    const enum neph_status status = check_parameters(reader, node, &written->medium.phase);
    return status || !written->phase_table ? status : read_table(reader, written);
}
