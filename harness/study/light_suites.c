/* SPDX-License-Identifier: MIT */
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

/* The next digit of an index whose digits count through the lists. */
static double take(const double *list, int count, int *index)
{
    const int digit = *index % at_least_one(count);
    *index /= at_least_one(count);
    return count > 0 ? list[digit] : NAN;
}

struct neph_relight neph_light_sweep_at(const struct neph_light_sweep *sweep, int index)
{
    struct neph_relight light = {NAN, NAN, NAN, NAN, NAN, 0.0};
    light.density = take(sweep->density, sweep->density_count, &index);
    light.albedo = take(sweep->albedo, sweep->albedo_count, &index);
    light.g = take(sweep->g, sweep->g_count, &index);
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

static enum neph_status refuse(const char *key, struct neph_diag *diag)
{
    return neph_fail(diag, NEPH_ERR_INPUT, "%s is no list of at most %d %s", key,
                     NEPH_LIGHT_SWEEP_MAX, strcmp(key, "suns_deg") == 0 ? "pairs" : "numbers");
}

static enum neph_status read_list(const json_t *numbers, const char *key,
                                  double list[NEPH_LIGHT_SWEEP_MAX], int *count,
                                  struct neph_diag *diag)
{
    const json_t *values = json_object_get(numbers, key);
    *count = (int)json_array_size(values);
    if (*count > NEPH_LIGHT_SWEEP_MAX || (values && !json_is_array(values)))
        return refuse(key, diag);
    for (int i = 0; i < *count; i++) {
        const json_t *value = json_array_get(values, (size_t)i);
        if (!json_is_number(value))
            return refuse(key, diag);
        list[i] = json_number_value(value);
    }
    return NEPH_OK;
}

static enum neph_status read_suns(const json_t *numbers, struct neph_light_sweep *sweep,
                                  struct neph_diag *diag)
{
    const json_t *suns = json_object_get(numbers, "suns_deg");
    sweep->sun_count = (int)json_array_size(suns);
    if (sweep->sun_count > NEPH_LIGHT_SWEEP_MAX || (suns && !json_is_array(suns)))
        return refuse("suns_deg", diag);
    for (int i = 0; i < sweep->sun_count; i++) {
        const json_t *sun = json_array_get(suns, (size_t)i);
        const json_t *elevation = json_array_get(sun, 0), *azimuth = json_array_get(sun, 1);
        if (json_array_size(sun) != 2 || !json_is_number(elevation) || !json_is_number(azimuth))
            return refuse("suns_deg", diag);
        sweep->suns_deg[i][0] = json_number_value(elevation);
        sweep->suns_deg[i][1] = json_number_value(azimuth);
    }
    return NEPH_OK;
}

static enum neph_status read_sweep(const json_t *numbers, struct neph_light_sweep *sweep,
                                   struct neph_diag *diag)
{
    enum neph_status status = read_suns(numbers, sweep, diag);
    if (!status)
        status = read_list(numbers, "g", sweep->g, &sweep->g_count, diag);
    if (!status)
        status = read_list(numbers, "albedo", sweep->albedo, &sweep->albedo_count, diag);
    if (!status)
        status = read_list(numbers, "density", sweep->density, &sweep->density_count, diag);
    return status;
}

static enum neph_status read_sweeps(const json_t *list, struct neph_light_entry *made,
                                    struct neph_diag *diag)
{
    const size_t count = json_array_size(list);
    enum neph_status status = NEPH_OK;
    if (count < 1 || count > NEPH_LIGHT_SWEEPS_MAX)
        status = neph_fail(diag, NEPH_ERR_INPUT, "sweeps is no list of 1 to %d",
                           NEPH_LIGHT_SWEEPS_MAX);
    for (; made->sweep_count < (int)count && !status; made->sweep_count++)
        status = read_sweep(json_array_get(list, (size_t)made->sweep_count),
                            &made->sweeps[made->sweep_count], diag);
    return status;
}

static enum neph_status read_entry(const json_t *entry, struct neph_light_entry *made,
                                   struct neph_diag *diag)
{
    const char *scene = neph_json_text(entry, "scene");
    made->may_be_absent = true;
    made->scene = neph_suite_scene(entry);
    if (!made->scene)
        return neph_fail_memory(diag);
    const enum neph_status status = read_sweeps(json_object_get(entry, "sweeps"), made, diag);
    if (status)
        neph_prefix(diag, "%s: ", scene);
    return status;
}

enum neph_status neph_light_suite_find(const char *name, struct neph_light_entry **entries,
                                       int *count, struct neph_diag *diag)
{
    json_t *list = NULL;
    enum neph_status status = neph_suite_find("scenes/studies/light.json", "neph-light-suites-1",
                                              name, &list, diag);
    const int made_count = (int)json_array_size(list);
    struct neph_light_entry *made = calloc((size_t)made_count + 1, sizeof(*made));
    if (!status && !made)
        status = neph_fail_memory(diag);
    for (int i = 0; i < made_count && !status; i++)
        status = read_entry(json_array_get(list, (size_t)i), &made[i], diag);
    json_decref(list);
    if (status) {
        neph_light_entries_free(made, made ? made_count : 0);
        return status;
    }
    *entries = made;
    *count = made_count;
    return NEPH_OK;
}

void neph_light_entries_free(struct neph_light_entry *entries, int count)
{
    for (int i = 0; i < count; i++)
        free(entries[i].scene);
    free(entries);
}
