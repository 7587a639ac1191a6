/* SPDX-License-Identifier: MIT
 *
 * The gates of a scene: their keys in its file. To add a field, add a member in scenes/gates.h and
 * a row here.
 */
#include "scenes/gates.h"
#include "scenes/load.h"
#include "scenes/words.h"

#include <stddef.h>

#define GATE(member) offsetof(struct neph_gate, member)

const struct neph_gates *neph_scene_gates(const struct neph_scene *scene)
{
    static const struct neph_gates none = {.count = 0};
    return scene->gates ? scene->gates : &none;
}

static const char *const mask_words[] = {"all", "sky", "solid", "medium", "depth_edge", NULL};

static const struct neph_field gate_fields[] = {
    {"engine", NEPH_TEXT, GATE(engine), .least = 1, .most = 64},
    {"quantity", NEPH_WORD, GATE(quantity), .words = neph_gate_quantity_words},
    {"metric", NEPH_TEXT, GATE(metric), .least = 1, .most = 64,
     .note = "one that `neph metrics` lists for single frames"},
    {"mask", NEPH_TEXT, GATE(mask), .words = mask_words, .standard = "`all`"},
    {"maximum", NEPH_NUMBER, GATE(maximum), "", 0, 1e9, .note = "of the absolute value"},
    {"reason", NEPH_TEXT, GATE(reason), .least = 1, .most = 1000},
    {0},
};

static enum neph_status read_gate(struct neph_reader *reader, const yaml_node_t *node,
                                  const struct neph_record *record, void *target)
{
    struct neph_gate *gate = target;
    char quote[NEPH_QUOTE_SIZE];
    const enum neph_status status = neph_read_fields(reader, node, record->fields, target);
    if (status)
        return status;
    if (!neph_is_identifier(gate->engine))
        return neph_refuse(reader, "engine", "'%s' is not the name of an engine",
                           neph_document_quote(gate->engine, quote));
    if (neph_has_control(gate->reason, "\n"))
        return neph_refuse(reader, "reason", "control characters in the text");
    gate->line = (int)node->start_mark.line + 1;
    if (!gate->mask)
        gate->mask = mask_words[0];
    return NEPH_OK;
}

const struct neph_record neph_gate_record = {
    .size = sizeof(struct neph_gate), .fields = gate_fields, .read = read_gate};

/* --- In the finished scene --- */

enum neph_status neph_finish_gates(struct neph_reader *reader, struct neph_written_scene *written)
{
    const struct neph_gates *gates = &written->gates;
    enum neph_status status = NEPH_OK;
    char why[128], quote[NEPH_QUOTE_SIZE];
    for (int g = 0; g < gates->count && written->check; g++) {
        if (written->check(gates->list[g].metric, why, sizeof(why)))
            continue;
        neph_refuse(reader, neph_at("gates[%d].metric", g).text, "'%s' %s",
                    neph_document_quote(gates->list[g].metric, quote), why);
        neph_hint(reader->diag, "`neph metrics` lists them");
        status = neph_also(reader, status, NEPH_ERR_INPUT);
    }
    return status;
}
