/* SPDX-License-Identifier: MIT
 *
 * Reads the suites of light studies and enumerates their sweeps.
 */
#include "harness/study/light_suites.h"

#include "harness/data.h"
#include "harness/study/suites.h"

#include <stdlib.h>
#include <string.h>

/* ---- sweeps ---------------------------------------------------------------------------------- */

static int at_least_one(int count)
{
    return count > 0 ? count : 1;
}

int neph_light_sweep_count(const struct neph_light_sweep *sweep)
{
    return at_least_one(sweep->sun_count) * at_least_one(sweep->g_count) *
           at_least_one(sweep->albedo_count) * at_least_one(sweep->density_count);
}

/* Takes the next digit of a mixed-radix index: one digit for each list. */
static double take_list_digit(const double *list, int count, int *index)
{
    const int digit = *index % at_least_one(count);
    *index /= at_least_one(count);
    return count > 0 ? list[digit] : NAN;
}

struct neph_relight neph_light_sweep_at(const struct neph_light_sweep *sweep, int index)
{
    struct neph_relight light = {NAN, NAN, NAN, NAN, NAN, 0.0};
    light.density = take_list_digit(sweep->density, sweep->density_count, &index);
    light.albedo = take_list_digit(sweep->albedo, sweep->albedo_count, &index);
    light.g = take_list_digit(sweep->g, sweep->g_count, &index);
    if (sweep->sun_count > 0) {
        light.sun_elevation_rad = sweep->suns_deg[index][0] * NEPH_RAD_PER_DEG;
        light.sun_azimuth_rad = sweep->suns_deg[index][1] * NEPH_RAD_PER_DEG;
    }
    return light;
}

int neph_light_entry_count(const struct neph_light_entry *entry)
{
    int count = 0;
    for (int i = 0; i < entry->sweep_count; i++)
        count += neph_light_sweep_count(&entry->sweeps[i]);
    return count;
}

struct neph_relight neph_light_entry_at(const struct neph_light_entry *entry, int index)
{
    const struct neph_light_sweep *sweep = entry->sweeps;
    for (; index >= neph_light_sweep_count(sweep); sweep++)
        index -= neph_light_sweep_count(sweep);
    return neph_light_sweep_at(sweep, index);
}

/* ---- suites ---------------------------------------------------------------------------------- */

/* Reads the list at `key`; each item has `each` numbers. */
static enum neph_status read_list(const json_t *sweep, const char *key, int each, double *numbers,
                                  int *count, struct neph_diag *diag)
{
    const json_t *items = json_object_get(sweep, key);
    *count = (int)json_array_size(items);
    bool is_fit = *count <= NEPH_LIGHT_SWEEP_MAX && (!items || json_is_array(items));
    for (int i = 0; i < each * *count && is_fit; i++) {
        const json_t *item = json_array_get(items, (size_t)(i / each));
        const json_t *number = each > 1 ? json_array_get(item, (size_t)(i % each)) : item;
        is_fit = json_is_number(number) && (each == 1 || (int)json_array_size(item) == each);
        numbers[i] = json_number_value(number);
    }
    return is_fit ? NEPH_OK
                  : neph_fail(diag, NEPH_ERR_INPUT, "%s is not a list of at most %d %s", key,
                              NEPH_LIGHT_SWEEP_MAX, each > 1 ? "pairs" : "numbers");
}

static enum neph_status read_sweep(const json_t *json, struct neph_light_sweep *sweep,
                                   struct neph_diag *diag)
{
    enum neph_status status = read_list(json, "suns_deg", 2, sweep->suns_deg[0], &sweep->sun_count,
                                        diag);
    if (!status)
        status = read_list(json, "g", 1, sweep->g, &sweep->g_count, diag);
    if (!status)
        status = read_list(json, "albedo", 1, sweep->albedo, &sweep->albedo_count, diag);
    if (!status)
        status = read_list(json, "density", 1, sweep->density, &sweep->density_count, diag);
    return status;
}

static enum neph_status read_entry(const json_t *json, struct neph_arena *arena,
                                   struct neph_light_entry *entry, struct neph_diag *diag)
{
    const json_t *sweeps = json_object_get(json, "sweeps");
    const int count = (int)json_array_size(sweeps);
    enum neph_status status = NEPH_OK;
    entry->scene = neph_suite_scene(json, arena);
    entry->may_be_absent = true;
    if (count < 1 || count > NEPH_LIGHT_SWEEPS_MAX)
        status = neph_fail(diag, NEPH_ERR_INPUT, "sweeps is not a list of 1 to %d",
                           NEPH_LIGHT_SWEEPS_MAX);
    for (int i = 0; i < count && !status; i++, entry->sweep_count++)
        status = read_sweep(json_array_get(sweeps, (size_t)i), &entry->sweeps[i], diag);
    if (status)
        neph_prefix(diag, "%s: ", neph_json_text(json, "scene"));
    return status;
}

enum neph_status neph_light_suite_find(const char *name, struct neph_arena *arena,
                                       struct neph_light_entry **entries, int *count,
                                       struct neph_diag *diag)
{
    json_t *list = NULL;
    enum neph_status status = neph_suite_find("scenes/studies/light.json", "neph-light-suites-1",
                                              name, false, &list, diag);
    if (status)
        return status;
    const size_t made_count = json_array_size(list);
    struct neph_light_entry *made = neph_arena_allocate(arena, made_count + 1, sizeof(*made));
    for (size_t i = 0; made && i < made_count && !status; i++)
        status = read_entry(json_array_get(list, i), arena, &made[i], diag);
    json_decref(list);
    if (!status)
        status = neph_arena_check(arena, diag);
    if (!status) {
        *entries = made;
        *count = (int)made_count;
    }
    return status;
}
