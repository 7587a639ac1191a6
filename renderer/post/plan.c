/* SPDX-License-Identifier: MIT */
#include "renderer/post/plan.h"

#include "base/files.h"
#include "scenes/fields.h"

#include <stdlib.h>
#include <string.h>

/* Does not compile with a new type: this file then needs a change. */
_Static_assert(NEPH_FIELD_TYPE_COUNT == 11, "a new kind");
_Static_assert(NEPH_OPTION_KIND_COUNT == 3, "a new kind");

#define PLAN(member) offsetof(struct neph_post_plan, member)
#define ENTRY(member) offsetof(struct neph_post_entry, member)
#define BOX(member) offsetof(struct neph_post_box, member)
#define VOLUME(member) offsetof(struct neph_post_volume, member)

enum { TEXT_MAX = 200, DEPTH_MAX = 5 };

/* --- settings -------------------------------------------------------------------------------- */

/* The options of the chain as keys; each is read to its own variable. */
struct setting_places {
    double numbers[POST_SETTING_COUNT];
    int wholes[POST_SETTING_COUNT];
};

static void make_fields(struct neph_field fields[POST_SETTING_COUNT + 1])
{
    static const enum neph_field_type types[] = {[NEPH_OPTION_INTEGER] = NEPH_WHOLE,
                                                 [NEPH_OPTION_REAL] = NEPH_NUMBER,
                                                 [NEPH_OPTION_CHOICE] = NEPH_WORD};
    memset(fields, 0, (POST_SETTING_COUNT + 1) * sizeof(*fields));
    for (size_t i = 0; i < POST_SETTING_COUNT; i++) {
        const struct neph_option *option = &neph_post_options[i];
        const bool is_real = option->kind == NEPH_OPTION_REAL;
        fields[i] = (struct neph_field){
            .key = option->name,
            .type = types[option->kind],
            .at = is_real ? offsetof(struct setting_places, numbers) + i * sizeof(double)
                          : offsetof(struct setting_places, wholes) + i * sizeof(int),
            .unit = "",
            .minimum = option->minimum,
            .maximum = option->maximum,
            .note = option->help,
            .standard = "as it was",
            .words = option->choices,
        };
    }
}

static enum neph_status read_changes(struct neph_reader *reader, const yaml_node_t *node,
                                     const struct neph_record *record, void *target)
{
    struct neph_post_changes *changes = target;
    struct neph_field fields[POST_SETTING_COUNT + 1];
    struct setting_places places = {{0}, {0}};
    (void)record;
    make_fields(fields);
    const enum neph_status status = neph_read_fields(reader, node, fields, &places);
    for (int i = 0; i < POST_SETTING_COUNT && !status; i++) {
        changes->is_given[i] = neph_reader_has(reader, node, fields[i].key);
        changes->values[i] = fields[i].type == NEPH_NUMBER ? places.numbers[i] : places.wholes[i];
    }
    return status;
}

static const struct neph_field no_fields[] = {{0}};
static const struct neph_record changes_record = {
    .size = sizeof(struct neph_post_changes), .fields = no_fields, .read = read_changes};

/* --- volumes --------------------------------------------------------------------------------- */

static const struct neph_field box_fields[] = {
    {"minimum_m", NEPH_THREE, BOX(minimum_m), "m", -NEPH_FAR_M, NEPH_FAR_M, .note = "its corners"},
    {"maximum_m", NEPH_THREE, BOX(maximum_m), "m", -NEPH_FAR_M, NEPH_FAR_M, .note = "its corners"},
    {0},
};

static enum neph_status read_box(struct neph_reader *reader, const yaml_node_t *node,
                                 const struct neph_record *record, void *target)
{
    struct neph_post_box *box = target;
    const enum neph_status status = neph_read_fields(reader, node, record->fields, target);
    const struct neph_vec3 low = box->minimum_m, high = box->maximum_m;
    if (status)
        return status;
    box->present = true;
    return low.x > high.x || low.y > high.y || low.z > high.z
               ? neph_refuse(reader, "maximum_m", "a side of the box is below its minimum_m")
               : NEPH_OK;
}

static const struct neph_record box_record = {
    .size = sizeof(struct neph_post_box), .fields = box_fields, .read = read_box};

static const struct neph_field volume_fields[] = {
    {"name", NEPH_TEXT, VOLUME(name), .least = 1, .most = TEXT_MAX},
    {"priority", NEPH_NUMBER, VOLUME(priority), "", -1e6, 1e6,
     .note = "volumes of higher priority are applied later", .standard = "0"},
    {"weight", NEPH_NUMBER, VOLUME(weight), "", 0, 1,
     .note = "interpolation weight of the volume's numbers inside it", .standard = "1"},
    {"blend_radius_m", NEPH_NUMBER, VOLUME(blend_radius_m), "m", 0, NEPH_FAR_M,
     .note = "outside the weight falls to 0 over this distance", .standard = "0"},
    {"box", NEPH_RECORD, VOLUME(box), .record = &box_record, .note = "left out: everywhere",
     .standard = "everywhere"},
    {"settings", NEPH_RECORD, VOLUME(changes), .record = &changes_record,
     .note = "of `neph post --list`; choices are replaced at any weight above 0"},
    {0},
};

static const struct neph_record volume_record = {.size = sizeof(struct neph_post_volume),
                                                 .fields = volume_fields};

/* --- passes ---------------------------------------------------------------------------------- */

static const struct neph_field entry_fields[] = {
    {"pass", NEPH_WORD, ENTRY(pass), .words = neph_post_pass_names},
    {"on", NEPH_FLAG, ENTRY(is_on), .note = "`false`: off, regardless of its settings",
     .standard = "`true`"},
    {0},
};

static enum neph_status read_entry(struct neph_reader *reader, const yaml_node_t *node,
                                   const struct neph_record *record, void *target)
{
    struct neph_post_entry *entry = target;
    const enum neph_status status = neph_read_fields(reader, node, record->fields, target);
    if (!status && !neph_reader_has(reader, node, "on"))
        entry->is_on = true;
    return status;
}

static const struct neph_record entry_record = {
    .size = sizeof(struct neph_post_entry), .fields = entry_fields, .read = read_entry};

static enum neph_status check_entries(const struct neph_reader *reader, struct neph_post_plan *plan)
{
    struct neph_post_order all = {.count = plan->entry_count};
    int at;
    for (int i = 0; i < plan->entry_count; i++) {
        all.passes[i] = plan->entries[i].pass;
        if (plan->entries[i].is_on)
            plan->order.passes[plan->order.count++] = plan->entries[i].pass;
    }
    if (plan->entry_count == 0)
        plan->order = neph_post_usual_order();
    const char *fault = neph_post_order_fault(&all, &at);
    return fault ? neph_refuse(reader, neph_at("passes[%d]", at).text, "%s cannot come here: %s",
                               neph_post_pass_names[all.passes[at]], fault)
                 : NEPH_OK;
}

/* --- the file -------------------------------------------------------------------------------- */

static const struct neph_field plan_fields[] = {
    {"title", NEPH_TEXT, PLAN(title), .least = 1, .most = TEXT_MAX, .standard = "none"},
    {"preset", NEPH_TEXT, PLAN(preset), .note = "one of `neph post --list`", .least = 1,
     .most = TEXT_MAX, .standard = "off"},
    {"settings", NEPH_RECORD, PLAN(changes), .record = &changes_record,
     .note = "of `neph post --list`, on top of the preset", .standard = "none"},
    {"passes", NEPH_ENTRIES, PLAN(entries), .least = 1, .most = NEPH_POST_PASS_COUNT,
     .count_at = PLAN(entry_count), .record = &entry_record,
     .note = "in order; the last enabled one writes the image; passes not listed are off",
     .standard = "all, in the usual order"},
    {"volumes", NEPH_LIST, PLAN(volumes), .least = 1, .most = NEPH_POST_VOLUMES_MAX,
     .count_at = PLAN(volume_count), .record = &volume_record, .standard = "none"},
    {0},
};

static enum neph_status check_preset(const struct neph_reader *reader,
                                     const struct neph_post_plan *plan)
{
    struct neph_settings settings;
    struct neph_diag why = {.line = 0};
    if (!plan->preset || !neph_options_preset(neph_post_options, "the picture chain",
                                              neph_post_presets, plan->preset, &settings, &why))
        return NEPH_OK;
    neph_refuse(reader, "preset", "%s", why.message);
    neph_hint(reader->diag, "%s", why.hint);
    return NEPH_ERR_INPUT;
}

static enum neph_status check_plan(struct neph_reader *reader, enum neph_status so_far, void *plan)
{
    if (so_far)
        return so_far;
    const enum neph_status status = check_preset(reader, plan);
    return status ? status : check_entries(reader, plan);
}

static enum neph_status read_text(const char *path, const char *text, size_t size,
                                  struct neph_post_plan *plan, struct neph_diag *diag)
{
    struct neph_document document;
    enum neph_status status = neph_document_init(&document, path, text, size, DEPTH_MAX, diag);
    if (status)
        return status;
    status = neph_read_document(&document, &plan->arena, plan_fields, check_plan, plan, diag);
    neph_document_finish(&document);
    return status;
}

enum neph_status neph_post_plan_load(const char *path, struct neph_post_plan *plan,
                                     struct neph_diag *diag)
{
    char *text = NULL;
    size_t size = 0;
    *plan = (struct neph_post_plan){.title = NULL};
    enum neph_status status = neph_file_read(path, NEPH_DOCUMENT_MAX_BYTES, &text, &size, diag);
    if (!status)
        status = read_text(path, text, size, plan, diag);
    if (status)
        neph_post_plan_finish(plan);
    free(text);
    return status;
}

void neph_post_plan_finish(struct neph_post_plan *plan)
{
    neph_arena_finish(&plan->arena);
    *plan = (struct neph_post_plan){.title = NULL};
}

struct neph_settings neph_post_plan_settings(const struct neph_post_plan *plan)
{
    struct neph_settings settings = neph_options_default(neph_post_options);
    if (plan->preset) /* checked when the plan was read */
        neph_options_preset(neph_post_options, "the picture chain", neph_post_presets, plan->preset,
                            &settings, NULL);
    neph_post_change(&plan->changes, &settings);
    return settings;
}

bool neph_post_plan_wants_camera(const struct neph_post_plan *plan)
{
    for (int i = 0; i < plan->volume_count; i++)
        if (plan->volumes[i].box.present)
            return true;
    return false;
}

void neph_post_plan_print_keys(FILE *file)
{
    neph_fields_print(plan_fields, "", file);
}
