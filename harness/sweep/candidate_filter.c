/* SPDX-License-Identifier: MIT
 *
 * Filters candidates by engine and name, and reports names that match nothing.
 */
#include "harness/sweep/candidate_filter.h"

#include <string.h>

/* Fails to compile when a kind is added, as plans with late lighting depend on the scattering. */
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");

/* True for `march` itself and engines like march_octaves. */
static bool is_engine(const char *engine, const char *name)
{
    const size_t length = strlen(name);
    return strncmp(engine, name, length) == 0 && (!engine[length] || engine[length] == '_');
}

/* True for a part ("ours" or "octaves" of "ours, octaves") and for the whole name. */
static bool is_named(const char *series, const char *name)
{
    const char *comma = strstr(series, ", ");
    const size_t length = comma ? (size_t)(comma - series) : strlen(series);
    return strcmp(series, name) == 0 ||
           (strlen(name) == length && strncmp(series, name, length) == 0) ||
           (comma && strcmp(comma + 2, name) == 0);
}

bool neph_candidate_filter_has_engine(const struct neph_candidate_filter *filter,
                                      const char *engine)
{
    for (int i = 0; i < filter->engine_count; i++)
        if (is_engine(engine, filter->engines[i]))
            return true;
    return filter->engine_count == 0;
}

static bool is_wanted(const struct neph_candidate_filter *filter,
                      const struct neph_sweep_series *series)
{
    bool wanted = filter->only_count == 0;
    for (int i = 0; i < filter->only_count; i++)
        wanted |= is_named(series->name, filter->only[i]);
    return wanted && neph_candidate_filter_has_engine(filter, series->engine);
}

void neph_candidate_filter(const struct neph_candidate_filter *filter, struct neph_sweep_plan *plan)
{
    int count = 0;
    for (int s = 0; s < plan->series_count; s++)
        if (is_wanted(filter, &plan->series[s]))
            plan->series[count++] = plan->series[s];
    plan->series_count = count;
}

/* ---- names without a match ------------------------------------------------------------------- */

enum { PLANS = 2 };

/* The first name that matches no series of the plans; NULL: all match. */
static const char *find_unmatched_name(const struct neph_sweep_plan plans[PLANS],
                                       const char *const *names, int count, bool of_engines)
{
    for (int i = 0; i < count; i++) {
        bool is_there = false;
        for (int p = 0; p < PLANS; p++)
            for (int s = 0; s < plans[p].series_count; s++) {
                const struct neph_sweep_series *series = &plans[p].series[s];
                is_there |= of_engines ? is_engine(series->engine, names[i])
                                       : is_named(series->name, names[i]);
            }
        if (!is_there)
            return names[i];
    }
    return NULL;
}

/* Lists the engines or names of the plans, each once. */
static void list_names(const struct neph_sweep_plan plans[PLANS], bool of_engines, char text[400])
{
    text[0] = '\0';
    for (int p = 0; p < PLANS; p++)
        for (int s = 0; s < plans[p].series_count; s++) {
            const struct neph_sweep_series *series = &plans[p].series[s];
            const char *name = of_engines ? series->engine : series->name;
            bool is_new = true;
            for (int q = 0; q <= p; q++)
                for (int k = 0; k < (q < p ? plans[q].series_count : s); k++) {
                    const struct neph_sweep_series *other = &plans[q].series[k];
                    is_new &= strcmp(of_engines ? other->engine : other->name, name) != 0;
                }
            const size_t used = strlen(text);
            if (is_new)
                snprintf(text + used, 400 - used, "%s%s", used ? (of_engines ? ", " : "; ") : "",
                         name);
        }
}

static enum neph_status refuse(const struct neph_sweep_plan plans[PLANS],
                               const struct neph_candidate_filter *filter,
                               const struct neph_scene *scene, struct neph_diag *diag)
{
    char names[400];
    const char *engine = find_unmatched_name(plans, filter->engines, filter->engine_count, true);
    const char *name = find_unmatched_name(plans, filter->only, filter->only_count, false);
    bool any = false;
    for (int p = 0; p < PLANS; p++)
        for (int s = 0; s < plans[p].series_count; s++)
            any |= is_wanted(filter, &plans[p].series[s]);
    if (!engine && !name && any)
        return NEPH_OK;
    list_names(plans, engine != NULL, names);
    if (engine)
        neph_fail(diag, NEPH_ERR_USAGE, "--engine '%s' has no configuration for scene %s", engine,
                  scene->name);
    else if (name)
        neph_fail(diag, NEPH_ERR_USAGE, "--only '%s' names no configuration for scene %s", name,
                  scene->name);
    else
        neph_fail(diag, NEPH_ERR_USAGE,
                  "no configuration has both an --engine and a name of --only");
    neph_hint(diag, "%s for this scene: %s", engine ? "engines" : "configurations", names);
    return NEPH_ERR_USAGE;
}

enum neph_status neph_candidate_filter_check(const struct neph_candidate_filter *filter,
                                             const struct neph_scene *scene, struct neph_diag *diag)
{
    struct neph_sweep_plan plans[PLANS] = {{.title = NULL}};
    enum neph_status status = NEPH_OK;
    for (int late = 0; late < PLANS && !status; late++)
        if (late == 0 || scene->scattering == NEPH_SCATTERING_MULTIPLE)
            status = neph_candidate_plan(scene, late, 16, 9, &plans[late], diag);
    if (!status)
        status = refuse(plans, filter, scene, diag);
    for (int p = 0; p < PLANS; p++)
        neph_sweep_plan_finish(&plans[p]);
    return status;
}
