/* SPDX-License-Identifier: MIT
 *
 * An entry of `media`: one of the forms of the kinds, and the keys common to all.
 */
#include "scenes/bake.h"
#include "scenes/hash_text.h"
#include "scenes/load.h"
#include "scenes/load_extinction.h"
#include "scenes/load_phase.h"
#include "scenes/media.h"
#include "scenes/medium_bounds.h"
#include "scenes/medium_kind.h"
#include "scenes/phase_table.h"
#include "scenes/solids.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#define AT(member) offsetof(struct neph_medium, member)
#define BOUNDS(member) offsetof(struct neph_bounds, member)

enum {
    FORMS_MAX = NEPH_MEDIUM_FORMS * NEPH_MEDIUM_KIND_COUNT,
    FIELDS_MAX = 48 /* of a form, with the common ones */
};

/* The default is the first. */
static const char *const axis_words[] = {"y", "x", "z", NULL};
static const int axes[] = {1, 0, 2};

/* The keys of every medium. The order of the rows is the order in the hash. */
static const struct neph_field common_fields[] = {
    {"extinction_color", NEPH_THREE, AT(extinction_color), "", 0, 1e3,
     .note = "extinction per channel, in parts of extinction_per_m", .standard = "[1, 1, 1]"},
    {"albedo", NEPH_THREE, AT(albedo), "", 0, 1, .note = "an albedo above 1 would create energy"},
    {"emission_w_per_m2_sr", NEPH_THREE, AT(emission_w_per_m2_sr), "W/m2/sr", 0, 1e6,
     .note = "radiance of the medium as a black body, opaque and without scattering: it emits (1 - "
             "albedo) * extinction * emission per metre, always visible, scattered with `multiple`",
     .standard = "[0, 0, 0]", .hashing = NEPH_HASHED_IF_SET},
    {"phase", NEPH_WORD, AT(phase.kind), .words = neph_phase_words, .standard = "`isotropic`"},
    {"asymmetry_g", NEPH_NUMBER, AT(phase.g), "", -0.999, 0.999,
     .note = "beyond 0.999 the phase function is a spike that Cycles clamps",
     .standard = "needed by phases with an asymmetry", .hash_name = "g"},
    {"second_asymmetry_g", NEPH_NUMBER, AT(phase.second_g), "", -0.999, 0.999,
     .note = "of the second lobe", .standard = "needed by `double_henyey_greenstein`",
     .hashing = NEPH_HASHED_IF_SET},
    {"first_share", NEPH_NUMBER, AT(phase.first_share), "", 0, 1,
     .note = "of the light: in the lobe of asymmetry_g",
     .standard = "needed by `double_henyey_greenstein`", .hashing = NEPH_HASHED_IF_SET},
    {"draine_alpha", NEPH_NUMBER, AT(phase.draine_alpha), "", 0, 1000,
     .note = "0 is Henyey-Greenstein, 1 Cornette-Shanks", .standard = "needed by `draine`",
     .hashing = NEPH_HASHED_IF_SET},
    {"droplet_diameter_um", NEPH_NUMBER, AT(phase.droplet_diameter_um), "um", 5, 50,
     .note = "the approximation was fitted to these", .standard = "needed by `jendersie_deon`",
     .hashing = NEPH_HASHED_IF_SET},
    {"phase_table", NEPH_TEXT, offsetof(struct neph_written_medium, phase_table),
     .note = "a file of scattering angles in degrees and values, one or three (red, green, blue), "
             "such as `neph droplets --csv` prints; a path as `file` of a volume",
     .standard = "needed by `table`", .least = 1, .most = 4096, .hashing = NEPH_HASHED_AS_MADE},
    {"voxels", NEPH_WHOLE, offsetof(struct neph_written_medium, voxels), "nodes",
     NEPH_BAKE_RESOLUTION_MIN, NEPH_GRID_SIDE_MAX,
     .note = "along the longest side of the grid that replaces the medium",
     .standard = "the medium itself", .hashing = NEPH_HASHED_AS_MADE},
    {"bounds_turn_deg", NEPH_NUMBER, offsetof(struct neph_written_medium, bounds_turn_deg), "deg",
     -180, 180,
     .note = "the bounds are turned about their middle, right-handed; the density is not",
     .standard = "0", .hashing = NEPH_HASHED_AS_MADE},
    {"bounds_turn_axis", NEPH_WORD, offsetof(struct neph_written_medium, bounds_turn_axis),
     .words = axis_words, .note = "of that turn", .standard = "y", .hashing = NEPH_HASHED_AS_MADE},
    {0},
};

static const struct neph_field bounds_fields[] = {
    {"min_m", NEPH_THREE, BOUNDS(min_m), "m", -NEPH_FAR_M, NEPH_FAR_M,
     .note = "a corner of the box"},
    {"max_m", NEPH_THREE, BOUNDS(max_m), "m", -NEPH_FAR_M, NEPH_FAR_M,
     .note = "a corner of the box"},
    {0},
};
/* All media have bounds: hash_medium() writes them. */
static void hash_bounds(const void *target, FILE *text)
{
    (void)target;
    (void)text;
}

const struct neph_record neph_bounds_record = {
    .size = sizeof(struct neph_bounds), .fields = bounds_fields, .hash = hash_bounds};

static const struct neph_field planet_bounds_fields[] = {
    {"min_m", NEPH_THREE, BOUNDS(min_m), "m", -NEPH_PLANET_M, NEPH_PLANET_M,
     .note = "a corner of the box"},
    {"max_m", NEPH_THREE, BOUNDS(max_m), "m", -NEPH_PLANET_M, NEPH_PLANET_M,
     .note = "a corner of the box"},
    {0},
};
const struct neph_record neph_planet_bounds_record = {
    .size = sizeof(struct neph_bounds), .fields = planet_bounds_fields, .hash = hash_bounds};

/* --- One form --- */

/* A form as a key of an entry. */
struct choice {
    struct neph_record record;
    enum neph_medium_kind kind;
    const struct neph_medium_form *form;
};

static const struct neph_bounds everywhere = {{-INFINITY, -INFINITY, -INFINITY},
                                              {INFINITY, INFINITY, INFINITY}};

static void gather_fields(const struct neph_field *own, struct neph_field fields[FIELDS_MAX])
{
    const int count = neph_gather_fields(own, offsetof(struct neph_written_medium, density),
                                         fields);
    memcpy(&fields[count], common_fields, sizeof(common_fields));
}

enum neph_status neph_check_extent(const struct neph_reader *reader, const char *owner,
                                   const struct neph_bounds *bounds)
{
    const double *low_m = &bounds->min_m.x, *high_m = &bounds->max_m.x;
    enum neph_status status = NEPH_OK;
    for (int axis = 0; axis < 3; axis++) {
        const struct neph_path path = neph_format_path("%s%smax_m[%d]", owner, *owner ? "." : "",
                                                       axis);
        if (!(high_m[axis] > low_m[axis]))
            status = neph_keep_error(reader, status,
                                     neph_refuse(reader, path.text, "%g m is not above min_m, %g m",
                                                 high_m[axis], low_m[axis]));
    }
    return status;
}

static enum neph_status check_optics(const struct neph_reader *reader,
                                     const struct neph_medium *medium)
{
    const struct neph_rgb color = medium->extinction_color;
    if (color.r + color.g + color.b == 0.0)
        return neph_refuse(reader, "extinction_color",
                           "a medium without extinction in any channel; leave it out instead");
    return NEPH_OK;
}

/* Replaces the medium by its voxels, for all engines. */
static enum neph_status make_voxels(struct neph_medium *medium, int nodes, struct neph_diag *diag)
{
    const struct neph_bounds box = neph_medium_support(medium);
    struct neph_bake bake;
    const enum neph_status status = neph_medium_sample(medium, &box, nodes, &bake, diag);
    if (status)
        return status;
    const struct neph_medium voxels = neph_medium_from_bake(medium, &bake);
    neph_medium_finish(medium);
    *medium = voxels; /* now owns the grid */
    return NEPH_OK;
}

static enum neph_status turn_bounds(const struct neph_reader *reader,
                                    struct neph_written_medium *written)
{
    const double angle_rad = written->bounds_turn_deg * M_PI / 180.0;
    const struct neph_turn turn = {axes[written->bounds_turn_axis], cos(angle_rad), sin(angle_rad)};
    if (written->bounds_turn_deg == 0.0)
        return NEPH_OK;
    if (!isfinite(written->medium.bounds.min_m.x))
        return neph_refuse(reader, "bounds_turn_deg", "the medium has no bounds to turn");
    neph_medium_turn_bounds(&written->medium, &turn);
    return NEPH_OK;
}

/* neph_keep_error() for a check whose error may lack a position: it gets the position of the
 * medium. */
static enum neph_status keep_error_at(struct neph_reader *reader, const yaml_node_t *node,
                                      enum neph_status first, enum neph_status next)
{
    if (next && reader->diag->line == 0)
        neph_document_locate(reader->document, node, reader->diag);
    return neph_keep_error(reader, first, next);
}

/* The row of the extinction; NULL: the form has none. */
static const struct neph_field *find_extinction(const struct neph_field *fields)
{
    while (fields->key && strcmp(fields->key, "extinction_per_m"))
        fields++;
    return fields->key ? fields : NULL;
}

/* `form_status`: of the form's own finish, which completes the medium. */
static enum neph_status finish_density(const struct neph_reader *reader, const yaml_node_t *node,
                                       const struct neph_medium_form *form,
                                       struct neph_written_medium *written,
                                       enum neph_status form_status)
{
    const struct neph_field *field = find_extinction(form->fields);
    if (!field)
        return NEPH_OK;
    const enum neph_status status = neph_choose_density(reader, node, &written->density);
    written->medium.droplets[0] = written->density.radii;
    if (written->density.radius_in_voxels)
        written->medium.droplets[0].effective_radius_um = NAN;
    if (status || form_status)
        return status;
    double *extinction_per_m = (void *)((char *)written + field->at);
    return neph_apply_density(reader, "", &written->density, &written->medium, extinction_per_m);
}

static bool were_fields_read(const struct neph_reader *reader, const struct neph_field *fields)
{
    for (; fields->key; fields++)
        if (!neph_were_keys_read(reader, fields->key))
            return false;
    return true;
}

/* `status`: of the keys. Checks that depend on keys with errors are skipped. */
static enum neph_status finish(struct neph_reader *reader, const yaml_node_t *node,
                               const struct neph_medium_form *form,
                               struct neph_written_medium *written, enum neph_status status)
{
    struct neph_medium *medium = &written->medium;
    if (neph_were_keys_read(reader, "bounds"))
        status = neph_keep_error(reader, status,
                                 neph_check_extent(reader, "bounds", &medium->bounds));
    if (neph_were_keys_read(reader, "extinction_color"))
        status = neph_keep_error(reader, status, check_optics(reader, medium));
    status = keep_error_at(reader, node, status, neph_finish_phase(reader, node, written));
    if (form->finish && were_fields_read(reader, form->fields))
        status = keep_error_at(reader, node, status, form->finish(reader, node, written));
    if (neph_were_keys_read(reader, "bounds bounds_turn_deg bounds_turn_axis"))
        status = neph_keep_error(reader, status, turn_bounds(reader, written));
    status = neph_keep_error(reader, status, finish_density(reader, node, form, written, status));
    if (!status && written->voxels)
        status = keep_error_at(reader, node, status,
                               make_voxels(medium, written->voxels, reader->diag));
    return status;
}

static enum neph_status read_form(struct neph_reader *reader, const yaml_node_t *node,
                                  const struct neph_record *record, void *target)
{
    const struct choice *choice = (const struct choice *)record;
    struct neph_field fields[FIELDS_MAX];
    struct neph_medium *medium = target;
    gather_fields(choice->form->fields, fields);
    struct neph_written_medium *written = neph_arena_allocate(reader->arena, 1, record->size);
    if (!written)
        return neph_fail_memory(reader->diag);
    written->medium.kind = choice->kind;
    written->medium.bounds = everywhere;
    enum neph_status status = neph_read_fields(reader, node, fields, written);
    status = finish(reader, node, choice->form, written, status);
    neph_medium_finish(medium); /* another form in the same entry */
    *medium = written->medium;  /* also on errors: freed with the scene */
    return status;
}

/* --- An entry --- */

/* All forms of all kinds; ends with a row without key. */
static void list_choices(struct choice choices[FORMS_MAX], struct neph_field fields[FORMS_MAX + 1])
{
    int count = 0;
    for (int kind = 0; kind < NEPH_MEDIUM_KIND_COUNT; kind++)
        for (int i = 0; i < NEPH_MEDIUM_FORMS; i++) {
            const struct neph_medium_form *form = &neph_medium_row(kind)->forms[i];
            if (!form->key)
                continue;
            const size_t size = form->size ? form->size : sizeof(struct neph_written_medium);
            choices[count] = (struct choice){
                {.size = size, .fields = form->fields, .read = read_form}, kind, form};
            fields[count] = (struct neph_field){form->key, NEPH_RECORD, .standard = "",
                                                .record = &choices[count].record};
            count++;
        }
    fields[count] = (struct neph_field){0};
}

static enum neph_status read_medium(struct neph_reader *reader, const yaml_node_t *node,
                                    const struct neph_record *record, void *target)
{
    (void)record;
    struct choice choices[FORMS_MAX];
    struct neph_field fields[FORMS_MAX + 1];
    list_choices(choices, fields);
    return neph_read_choice(reader, node, fields, target, "a medium");
}

void neph_list_drifting_forms(char *text, size_t size)
{
    struct choice choices[FORMS_MAX];
    struct neph_field fields[FORMS_MAX + 1];
    size_t used = 0;
    list_choices(choices, fields);
    for (int i = 0; fields[i].key && used < size; i++)
        if (neph_medium_row(choices[i].kind)->drift)
            used += (size_t)snprintf(text + used, size - used, "%s, ", fields[i].key);
}

void neph_forms_print(FILE *file)
{
    struct choice choices[FORMS_MAX];
    struct neph_field fields[FORMS_MAX + 1];
    list_choices(choices, fields);
    for (int i = 0; fields[i].key; i++) {
        fprintf(file, "| `media[].%s` | | | %s |\n", fields[i].key, choices[i].form->note);
        neph_fields_print(choices[i].form->fields,
                          neph_format_path("media[].%s", fields[i].key).text, file);
    }
}

static void hash_medium(const void *target, FILE *text)
{
    const struct neph_medium *medium = target;
    const struct neph_medium_row *row = neph_medium_row(medium->kind);
    neph_put_number(text, "medium", medium->kind);
    neph_fields_hash(bounds_fields, &medium->bounds, text);
    if (neph_is_turned(&medium->turn)) {
        neph_fields_hash(bounds_fields, &medium->box, text);
        neph_put_number(text, "turn_axis", medium->turn.axis);
        neph_put_number(text, "turn_cosine", medium->turn.cosine);
        neph_put_number(text, "turn_sine", medium->turn.sine);
    }
    neph_fields_hash(common_fields, medium, text);
    if (medium->phase.table)
        neph_phase_table_hash(medium->phase.table, text);
    if (row->hash)
        row->hash(medium, text);
    else
        neph_fields_hash(row->forms[0].fields, medium, text);
}

/* For the table of keys: the common keys are part of the mapping of the kind. */
static const struct neph_record common_record = {.size = sizeof(struct neph_medium),
                                                 .fields = common_fields};

static const struct neph_field kind_fields[] = {
    {"KIND", NEPH_RECORD,
     .note = "a kind by its name, from the end of this table; each has these keys and its own",
     .record = &common_record},
    {"KIND", NEPH_RECORD, .standard = "",
     .note = "one of these densities may stand in place of extinction_per_m, also of a layer",
     .record = &neph_density_record},
    {0},
};

const struct neph_record neph_medium_record = {.size = sizeof(struct neph_medium),
                                               .fields = kind_fields,
                                               .read = read_medium,
                                               .hash = hash_medium};
