/* SPDX-License-Identifier: MIT */
#include "scenes/volume_format.h"

#include "scenes/file_units.h"

#include <stdlib.h>
#include <string.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_UNIT_KIND_COUNT == 7, "a new kind");
_Static_assert(NEPH_DENSITY_UNIT_COUNT == 6, "a new unit");

enum neph_status neph_volume_check_size(const struct neph_volume_request *request,
                                        const int size[3], struct neph_diag *diag)
{
    const double nodes = (double)size[0] * size[1] * size[2];
    if (nodes * sizeof(float) <= (double)request->memory_limit_bytes)
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_INPUT,
              "%d x %d x %d nodes need %.0f MiB of memory, and the limit is %.0f MiB", size[0],
              size[1], size[2], nodes * sizeof(float) / 0x1p20,
              (double)request->memory_limit_bytes / 0x1p20);
    neph_hint(diag, "resample the volume to fewer nodes, or read a part of it: index_box");
    return NEPH_ERR_INPUT;
}

enum neph_status neph_volume_create_grid(const struct neph_volume_request *request,
                                         const struct neph_axis_turn *turn,
                                         const struct neph_block *block,
                                         struct neph_turned_block *turned, struct neph_grid **grid,
                                         struct neph_diag *diag)
{
    enum neph_status status = neph_volume_check_size(request, block->size, diag);
    if (status)
        return status;
    const struct neph_axis_turn *up = request->is_z_up ? &neph_axis_turn_z_up
                                                       : &neph_axis_turn_none;
    const struct neph_axis_turn whole = neph_axis_turn_join(turn, up);
    struct neph_block placed = *block;
    placed.origin = neph_axis_turn_point(up, block->origin);
    *turned = neph_axis_turn_block(&whole, &placed);
    return neph_grid_create(turned->block.size, turned->block.origin, turned->block.spacing, grid,
                            diag);
}

enum neph_status neph_volume_make_grid(const struct neph_volume_request *request, const int size[3],
                                       const double first[3], const double spacing[3],
                                       const float *values, const char note[NEPH_GRID_NOTE_SIZE],
                                       struct neph_grid **grid, struct neph_diag *diag)
{
    const struct neph_block block = {{size[0], size[1], size[2]},
                                     {first[0], first[1], first[2]},
                                     {spacing[0], spacing[1], spacing[2]}};
    struct neph_turned_block turned;
    const enum neph_status status = neph_volume_create_grid(request, &neph_axis_turn_none, &block,
                                                            &turned, grid, diag);
    if (status)
        return status;
    for (int k = 0; k < size[2]; k++)
        for (int j = 0; j < size[1]; j++) {
            float *row = (*grid)->values + turned.first + j * turned.step[1] + k * turned.step[2];
            for (int i = 0; i < size[0]; i++)
                row[i * turned.step[0]] = *values++;
        }
    memcpy((*grid)->note, note, NEPH_GRID_NOTE_SIZE);
    return NEPH_OK;
}

enum neph_status neph_volume_find_box(const struct neph_volume_request *request, const int size[3],
                                      struct neph_volume_box *box, struct neph_diag *diag)
{
    *box = (struct neph_volume_box){{0, 0, 0}, {size[0] - 1, size[1] - 1, size[2] - 1}};
    if (!request->index_box)
        return NEPH_OK;
    *box = *request->index_box;
    for (int axis = 0; axis < 3; axis++)
        if (box->first[axis] < 0 || box->last[axis] >= size[axis]) {
            neph_fail(diag, NEPH_ERR_INPUT, "index_box reaches from %d to %d along %c",
                      box->first[axis], box->last[axis], "xyz"[axis]);
            neph_hint(diag, "its nodes have the indices 0 to %d there", size[axis] - 1);
            return NEPH_ERR_INPUT;
        }
    return NEPH_OK;
}

/* ---- units of values ------------------------------------------------------------------------- */

/* The kind of unit that each density needs; UNKNOWN: any, because only proportions count. */
static const enum neph_unit_kind kinds[NEPH_DENSITY_UNIT_COUNT] = {
    [NEPH_DENSITY_EXTINCTION] = NEPH_UNIT_EXTINCTION,
    [NEPH_DENSITY_WATER] = NEPH_UNIT_WATER,
    [NEPH_DENSITY_DROPLETS] = NEPH_UNIT_NUMBER,
    [NEPH_DENSITY_VISIBILITY_2] = NEPH_UNIT_UNKNOWN,
    [NEPH_DENSITY_VISIBILITY_5] = NEPH_UNIT_UNKNOWN,
    [NEPH_DENSITY_OPTICAL_DEPTH] = NEPH_UNIT_UNKNOWN,
};

static const char *const kind_units[NEPH_UNIT_KIND_COUNT] = {
    [NEPH_UNIT_WATER] = "g/m3 or kg/m3",
    [NEPH_UNIT_NUMBER] = "1/cm3 or 1/m3",
    [NEPH_UNIT_EXTINCTION] = "1/m or 1/km",
};

static enum neph_status refuse_unit(const struct neph_volume_request *request, const char *name,
                                    const char *unit, enum neph_unit_kind kind,
                                    struct neph_diag *diag)
{
    const char *key = neph_density_unit_row(request->density)->key;
    neph_fail(diag, NEPH_ERR_INPUT, "variable '%s' has %s%.60s%s, and %s needs %s", name,
              *unit ? "the unit '" : "no unit", unit, *unit ? "'" : "", key,
              kind_units[kinds[request->density]]);
    if (kind == NEPH_UNIT_MIXING_RATIO)
        neph_hint(diag,
                  "it is a mixing ratio: multiply it by the density of air, such as with "
                  "ncap2 -s 'lwc=%s*rho' in.nc out.nc, and name that variable",
                  name);
    else
        neph_hint(diag, "value_unit is used in place of the unit of the file");
    return NEPH_ERR_INPUT;
}

enum neph_status neph_volume_find_unit(const struct neph_volume_request *request, const char *name,
                                       const char *unit, double *factor, struct neph_diag *diag)
{
    const char *used = request->value_unit ? request->value_unit : unit;
    const enum neph_unit_kind needed = request->density < NEPH_DENSITY_UNIT_COUNT
                                           ? kinds[request->density]
                                           : NEPH_UNIT_UNKNOWN;
    const enum neph_unit_kind kind = neph_unit_find(used, factor);
    if (needed == NEPH_UNIT_UNKNOWN)
        *factor = 1.0;
    else if (kind != needed && !(request->value_unit && kind == NEPH_UNIT_ONE))
        return refuse_unit(request, name, used, kind, diag);
    return NEPH_OK;
}

/* ---- levels ---------------------------------------------------------------------------------- */

enum neph_status neph_volume_make_even(const struct neph_volume_request *request,
                                       const struct neph_volume_levels *levels, int size[3],
                                       float **values, struct neph_even_levels *even,
                                       char note[NEPH_GRID_NOTE_SIZE], struct neph_diag *diag)
{
    const int axis = levels->axis;
    if (neph_are_levels_even(levels->levels, NEPH_GRID_SIDE_MAX, even))
        return NEPH_OK;
    size_t inner = 1, outer = 1;
    for (int other = 0; other < 3; other++)
        *(other < axis ? &inner : &outer) *= other == axis ? 1 : (size_t)size[other];
    size[axis] = even->count;
    const enum neph_status status = neph_volume_check_size(request, size, diag);
    if (status)
        return status;
    float *made = calloc(inner * (size_t)even->count * outer, sizeof(*made));
    if (!made)
        return neph_fail_memory(diag);
    const double change = neph_even_levels_resample(levels->levels, even, outer, inner, *values,
                                                    made);
    free(*values);
    *values = made;
    const size_t used = strlen(note);
    snprintf(note + used, NEPH_GRID_NOTE_SIZE - used,
             "%s%d uneven places along '%.40s' became %d, %.4g m apart: their sum times thickness "
             "changed by %.1e",
             used ? "; " : "", levels->levels.count, levels->name, even->count, even->spacing,
             change);
    return NEPH_OK;
}
