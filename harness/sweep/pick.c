/* SPDX-License-Identifier: MIT
 *
 * `neph pick`: successive halving over frame sizes, then variants of the choice.
 */
#include "harness/sweep/pick.h"

#include "base/files.h"
#include "harness/data.h"
#include "harness/engines/engines.h"
#include "harness/engines/vulkan_device.h"
#include "harness/sweep/candidates.h"
#include "harness/sweep/output.h"
#include "harness/sweep/point.h"
#include "harness/sweep/sweep.h"
#include "renderer/sky/split.h"
#include "scenes/motion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Fails to compile when a kind is added, as add_kept() compares orders of scattering. */
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");

/* Frame sizes, the last one is the full size. Small frames may exceed the request by a factor
 * `slack`, as edges and thin objects weigh more in them. */
static const struct {
    int part;
    double slack;
} sizes[] = {{4, 3.0}, {2, 1.5}, {1, 1.0}};
enum { SIZES = sizeof(sizes) / sizeof(sizes[0]), FULL = SIZES - 1 };

enum { LEAST_WIDTH_PX = 64, LEAST_HEIGHT_PX = 36, SAMPLES_MAX = 16384 };

struct entry {
    bool is_there;
    struct neph_pick_point point; /* measured at the largest size so far */
};

struct work {
    const struct neph_pick_params *params;
    struct neph_store *store;
    struct neph_scene *scene;
    struct neph_sweep_plan plan;
    struct entry *entries; /* [series * NEPH_SWEEP_VALUES_MAX + place], NEPH_SWEEP_POINTS_MAX */
    struct neph_pick *pick;
    bool with_floors;
};

/* --- measuring ------------------------------------------------------------------------------ */

static struct neph_pick_point make_pick_point(const struct work *work,
                                              const struct neph_sweep_point *point)
{
    const struct neph_job *job = &point->job;
    struct neph_pick_point made = {
        .configuration = {.engine = job->engine,
                          .settings = job->shot.settings,
                          .rescatters = job->shot.scene->scattering != work->scene->scattering,
                          .scattering = job->shot.scene->scattering},
        .error = point->numbers[NEPH_SWEEP_ERROR].value,
        .flicker = point->numbers[NEPH_SWEEP_FLICKER].value,
        .error_floor = point->floors[NEPH_SWEEP_ERROR],
        .flicker_floor = point->floors[NEPH_SWEEP_FLICKER],
        .evaluations = point->evaluations,
        .time = point->time,
        .is_closed = job->engine->rung == NEPH_LEVEL_EXACT,
    };
    snprintf(made.name, sizeof(made.name), "%.40s%s%.20s", point->series->name,
             point->label[0] ? ", " : "", point->label);
    if (!neph_sweep_is_sequence(point)) /* frames without a history are all equal */
        made.flicker = 0.0;
    if (made.is_closed)
        made.evaluations = 0.0;
    return made;
}

/* Doubles the truth's samples until its noise is below a quarter of the requested error. */
static void raise_truth_samples(struct work *work, double floor)
{
    const double wanted = 0.25 * work->params->error;
    int *samples = &work->plan.truth_samples;
    for (; floor > wanted && *samples < SAMPLES_MAX; floor /= sqrt(2.0))
        *samples *= 2;
}

/* A side of the reduced frame: at least `least_px`, below which flicker and tiles are not
 * meaningful, and at most the full side. */
static int side_px(int full_px, int part, int least_px)
{
    const int side = full_px / part;
    return side >= least_px ? side : full_px < least_px ? full_px : least_px;
}

static enum neph_status measure(struct work *work, const bool *wanted, int size, bool is_timed,
                                int jobs, struct neph_diag *diag)
{
    const struct neph_pick_params *params = work->params;
    const struct neph_sweep_params asked = {.plan = &work->plan,
                                            .scene = params->scene,
                                            .time_limit_s = params->time_limit_s,
                                            .seed = params->seed,
                                            .jobs = jobs,
                                            .device = params->device,
                                            .quiet = params->quiet,
                                            .untimed = !is_timed,
                                            .with_floors = work->with_floors,
                                            .times = params->times,
                                            .wanted = wanted};
    struct neph_sweep sweep = {.plan = NULL};
    work->plan.width_px = side_px(params->width_px, sizes[size].part, LEAST_WIDTH_PX);
    work->plan.height_px = side_px(params->height_px, sizes[size].part, LEAST_HEIGHT_PX);
    const enum neph_status status = neph_sweep_run(&asked, work->store, &sweep, diag);
    for (int i = 0; i < sweep.point_count && !status; i++) {
        const struct neph_sweep_point *point = &sweep.points[i];
        const long series = point->series - work->plan.series;
        struct entry *entry = &work->entries[series * NEPH_SWEEP_VALUES_MAX + point->place];
        entry->is_there = !point->missing[0];
        entry->point = make_pick_point(work, point);
        work->pick->measured += entry->is_there;
    }
    if (!status) {
        raise_truth_samples(work, sweep.floor);
        work->pick->truth = sweep.truth;
        work->pick->floor = sweep.floor;
        if (neph_sweep_device(&sweep)[0])
            snprintf(work->pick->device, sizeof(work->pick->device), "%s",
                     neph_sweep_device(&sweep));
    }
    neph_sweep_finish(&sweep);
    return status;
}

static enum neph_status measure_one(struct work *work, int index, int size, struct neph_diag *diag)
{
    bool wanted[NEPH_SWEEP_POINTS_MAX] = {false};
    wanted[index] = true;
    work->with_floors = size == FULL;
    const enum neph_status status = measure(
        work, wanted, size, size == FULL && isfinite(work->params->time_s), 1, diag);
    work->with_floors = false;
    return status;
}

/* --- judging -------------------------------------------------------------------------------- */

static double ratio(double value, double most)
{
    return isnan(most) ? 0.0 : isnan(value) ? INFINITY : value / most;
}

/* Largest ratio of a value to its limit; 1: exactly within. */
static double compute_excess_ratio(const struct neph_pick_params *params,
                                   const struct neph_pick_point *point)
{
    const double time = isnan(point->time.median) ? 0.0 : ratio(point->time.median, params->time_s);
    return fmax(time,
                fmax(ratio(point->error, params->error), ratio(point->flicker, params->flicker)));
}

/* Density evaluations; not counted ones sort last. */
static double count_evaluations(const struct neph_pick_point *point)
{
    return isnan(point->evaluations) ? INFINITY : point->evaluations;
}

/* The cheapest remaining entry; the first one among equals; -1: none. */
static int cheapest(const struct work *work, const bool *is_left)
{
    int best = -1;
    for (int i = 0; i < work->plan.series_count * NEPH_SWEEP_VALUES_MAX; i++)
        if (is_left[i] && (best < 0 || count_evaluations(&work->entries[i].point) <
                                           count_evaluations(&work->entries[best].point)))
            best = i;
    return best;
}

static int nearest(const struct work *work)
{
    int best = -1;
    for (int i = 0; i < work->plan.series_count * NEPH_SWEEP_VALUES_MAX; i++)
        if (work->entries[i].is_there &&
            (best < 0 || compute_excess_ratio(work->params, &work->entries[i].point) <
                             compute_excess_ratio(work->params, &work->entries[best].point)))
            best = i;
    return best;
}

/* --- the search ----------------------------------------------------------------------------- */

/* Measures an entry at the larger sizes; `*passes`: it stays within the limits. */
static enum neph_status measure_larger_sizes(struct work *work, int index, bool *passes,
                                             struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    *passes = true;
    for (int size = 1; size < SIZES && *passes && !status; size++) {
        status = measure_one(work, index, size, diag);
        *passes = !status && work->entries[index].is_there &&
                  compute_excess_ratio(work->params, &work->entries[index].point) <=
                      sizes[size].slack;
    }
    return status;
}

/* Tries the entries of one sort (closed forms or not), cheapest first. `*chosen` is the last one
 * tried. */
static enum neph_status search_candidates(struct work *work, bool closed, int *chosen,
                                          struct neph_diag *diag)
{
    bool is_left[NEPH_SWEEP_POINTS_MAX] = {false};
    int count = 0;
    for (int s = 0; s < work->plan.series_count; s++)
        for (int i = 0; i < neph_sweep_value_count(&work->plan.series[s]); i++) {
            const bool is_wanted = closed == (strcmp(work->plan.series[s].engine, "exact") == 0);
            is_left[s * NEPH_SWEEP_VALUES_MAX + i] = is_wanted;
            count += is_wanted;
        }
    enum neph_status status = count > 0 ? measure(work, is_left, 0, false, work->params->jobs, diag)
                                        : NEPH_OK;
    for (int i = 0; i < work->plan.series_count * NEPH_SWEEP_VALUES_MAX && !status; i++) {
        work->pick->candidate_total += is_left[i];
        is_left[i] &= work->entries[i].is_there &&
                      compute_excess_ratio(work->params, &work->entries[i].point) <= sizes[0].slack;
    }
    for (int index = 0; !status && !work->pick->found; is_left[index] = false) {
        index = cheapest(work, is_left);
        if (index < 0)
            break;
        status = measure_larger_sizes(work, index, &work->pick->found, diag);
        *chosen = index;
    }
    return status;
}

static enum neph_status start(struct work *work, bool late, struct neph_diag *diag)
{
    neph_sweep_plan_finish(&work->plan);
    memset(work->entries, 0, NEPH_SWEEP_POINTS_MAX * sizeof(*work->entries));
    const enum neph_status status = neph_candidate_plan(work->scene, late, work->params->width_px,
                                                        work->params->height_px, &work->plan, diag);
    if (!status)
        neph_candidate_filter(&work->params->filter, &work->plan);
    return status;
}

/* --- variants of the choice ----------------------------------------------------------------- */

/* The choice, from which the variants are derived. */
struct chosen {
    struct neph_sweep_series series;
    const struct neph_candidate_lighting *light; /* NULL for an engine of one kind of scene */
    const char *steps;
    bool is_realtime, has_air;
};

/* Adds a variant as a series: the choice with a further part, or without one of its parts. */
static enum neph_status add_variant(struct work *work, const char *because, bool is_kept,
                                    struct neph_sweep_series series, const char *steps,
                                    struct neph_diag *diag)
{
    struct neph_pick *pick = work->pick;
    struct neph_pick_variant *left = &pick->left_out[pick->left_out_count];
    if (!neph_candidate_filter_has_engine(&work->params->filter, series.engine))
        return NEPH_OK;
    if (pick->left_out_count++ == NEPH_PICK_VARIANTS_MAX)
        return neph_fail(diag, NEPH_ERR_INTERNAL, "more than %d variants", pick->left_out_count);
    snprintf(left->what, sizeof(left->what), "%s", series.name);
    left->because = because;
    left->is_kept = is_kept;
    series.flicker = strcmp(series.engine, "realtime") == 0 || !pick->is_still;
    return neph_candidate_add_series(&work->plan, &series, steps, diag);
}

/* Adds the same pipeline with another lighting model. */
static enum neph_status add_light(struct work *work, const struct chosen *chosen, const char *what,
                                  const struct neph_candidate_lighting *light, bool is_kept,
                                  struct neph_diag *diag)
{
    char held[NEPH_CANDIDATE_SETTINGS_SIZE];
    neph_candidate_settings(work->scene, light, true, chosen->is_realtime && chosen->has_air, held);
    const struct neph_sweep_series series = {
        .name = what,
        .engine = chosen->is_realtime ? "realtime" : light->march,
        .preset = chosen->is_realtime ? chosen->series.preset : NULL,
        .held = chosen->is_realtime ? held : NULL,
        .scattering = light->scattering};
    return add_variant(work, NULL, is_kept, series, chosen->steps, diag);
}

/* Adds the lighting models that model more light, with the same pipeline and steps. */
static enum neph_status add_lights(struct work *work, const struct chosen *chosen,
                                   struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (const struct neph_candidate_lighting *light = chosen->light + 1; light->name && !status;
         light++)
        if (light->scattering <= (int)work->scene->scattering && !light->is_late)
            status = add_light(work, chosen, light->name, light, false, diag);
    return status;
}

static const struct neph_candidate_lighting *find_lighting(const char *name)
{
    const struct neph_candidate_lighting *light = neph_candidate_lightings;
    while (light->name && strcmp(light->name, name) != 0)
        light++;
    return light;
}

/* Adds variants without a part of the choice: orders of scattering, a ray for every pixel. */
static enum neph_status add_kept(struct work *work, const struct chosen *chosen,
                                 struct neph_diag *diag)
{
    const struct neph_candidate_lighting *once = find_lighting("scattered once");
    char held[NEPH_CANDIDATE_SETTINGS_SIZE];
    enum neph_status status = NEPH_OK;
    if (chosen->light->scattering > once->scattering)
        status = add_light(work, chosen, "light scattered more than once", once, true, diag);
    if (status || chosen->is_realtime)
        return status;
    neph_candidate_settings(work->scene, chosen->light, true, false, held);
    const struct neph_sweep_series series = {.name = "every pixel's ray in every frame",
                                             .engine = "realtime",
                                             .preset = neph_candidate_preset(0),
                                             .held = held,
                                             .scattering = chosen->series.scattering};
    return add_variant(work, NULL, true, series, chosen->steps, diag);
}

static enum neph_status add_steps(struct work *work, const struct chosen *chosen,
                                  struct neph_diag *diag)
{
    struct neph_sweep_series series = chosen->series;
    char more[16], what[48];
    snprintf(more, sizeof(more), "%d", 2 * atoi(chosen->steps));
    snprintf(what, sizeof(what), "more steps: %s", more);
    series.name = what;
    return add_variant(work, NULL, false, series, more, diag);
}

/* The reason why parts for motion are off; NULL: none is off. */
static const char *explain_missing_motion(const struct work *work)
{
    const bool camera = neph_candidate_has_motion(work->scene, NEPH_CANDIDATE_CAMERA);
    const bool wind = neph_candidate_has_motion(work->scene, NEPH_CANDIDATE_WIND);
    if (work->pick->is_still)
        return "nothing moves";
    if (!camera)
        return wind ? "the camera is static" : "the camera is static, and there is no wind";
    return wind ? NULL : "there is no wind";
}

/* `realtime` has a planet's atmosphere only from tables; the marcher is compared with the same. */
static const char *marcher_sky_setting(const struct neph_scene *scene)
{
    struct neph_sky_split split;
    char reason[256];
    return neph_sky_split(scene, &split, reason, sizeof(reason)) ? "sky=tables" : NULL;
}

/* Adds the marcher, which shows the shortcut's saving, and the parts for motion. */
static enum neph_status add_pipeline(struct work *work, const struct chosen *chosen,
                                     struct neph_diag *diag)
{
    const struct neph_sweep_series march = {.name = "a ray for every pixel, every frame",
                                            .engine = chosen->light->march,
                                            .held = marcher_sky_setting(work->scene),
                                            .scattering = chosen->series.scattering};
    const char *at_rest = explain_missing_motion(work);
    struct neph_sweep_series moving = chosen->series;
    char held[NEPH_CANDIDATE_SETTINGS_SIZE];
    enum neph_status status = add_variant(work, NULL, false, march, chosen->steps, diag);
    neph_candidate_settings(work->scene, chosen->light, false, chosen->has_air, held);
    moving.name = "parts that only motion needs";
    moving.held = held;
    if (!status && at_rest)
        status = add_variant(work, at_rest, false, moving, chosen->steps, diag);
    return status;
}

/* Adds a variant with or without a part of the air, even when the scene does not need the part. */
static enum neph_status add_air(struct work *work, const struct chosen *chosen,
                                const struct neph_candidate_air_part *part, struct neph_diag *diag)
{
    struct neph_sweep_series series = chosen->series;
    const char *own = series.held ? series.held : "", *found = strstr(own, part->on);
    const bool needed = part->is_needed(work->scene);
    const size_t before = found ? (size_t)(found - own) : strlen(own);
    char held[NEPH_CANDIDATE_SETTINGS_SIZE];
    if (chosen->light->scattering == NEPH_SCATTERING_NONE ||
        (needed && !found && !neph_candidate_needs_part(part, work->scene, chosen->light)))
        return NEPH_OK;
    snprintf(held, sizeof(held), "%.*s%s%s", (int)before, own, found ? "" : " ",
             found ? found + strlen(part->on) : part->on);
    series.name = part->name;
    series.held = held;
    return add_variant(work, needed ? NULL : part->absent, found != NULL, series, chosen->steps,
                       diag);
}

static bool is_engine_without_variants(const char *engine)
{
    for (int i = 0; neph_candidate_special_engines[i]; i++)
        if (strcmp(neph_candidate_special_engines[i], engine) == 0)
            return true;
    return strcmp(engine, "command") == 0;
}

/* Adds a marcher beside an engine without variants. */
static enum neph_status add_march(struct work *work, const char *because, const char *engine,
                                  const char *steps, int scattering, struct neph_diag *diag)
{
    const struct neph_sweep_series series = {
        .name = "a ray march of 32 steps", .engine = engine, .scattering = scattering};
    return add_variant(work, because, false, series, steps, diag);
}

static enum neph_status add_variants(struct work *work, int index, struct neph_diag *diag)
{
    /* a copy, as the list of series is reallocated */
    struct chosen chosen = {.series = work->plan.series[index / NEPH_SWEEP_VALUES_MAX]};
    const char *engine = chosen.series.engine, *comma = strchr(chosen.series.name, ',');
    char label[NEPH_SWEEP_LABEL_SIZE];
    neph_sweep_value(&chosen.series, index % NEPH_SWEEP_VALUES_MAX, label);
    chosen.steps = label[0] ? strchr(label, '=') + 1 : "32";
    if (strcmp(engine, "sky") == 0) /* no marcher renders the same model */
        return NEPH_OK;
    if (is_engine_without_variants(engine))
        return add_march(work, NULL, "march", chosen.steps, -1, diag);
    chosen.light = find_lighting(comma + 2); /* "ours+air, octaves" */
    chosen.has_air = strncmp(comma - strlen("+air"), "+air", strlen("+air")) == 0;
    chosen.is_realtime = strcmp(engine, "realtime") == 0;
    if (strcmp(engine, "exact") == 0)
        return add_march(work, "the closed form has no steps", chosen.light->march, chosen.steps,
                         chosen.series.scattering, diag);
    enum neph_status status = NEPH_OK;
    if (chosen.is_realtime)
        status = add_pipeline(work, &chosen, diag);
    for (const struct neph_candidate_air_part *part = neph_candidate_air_parts;
         chosen.is_realtime && part->name && !status; part++)
        status = add_air(work, &chosen, part, diag);
    if (!status)
        status = add_kept(work, &chosen, diag);
    if (!status)
        status = add_steps(work, &chosen, diag);
    return status ? status : add_lights(work, &chosen, diag);
}

static enum neph_status measure_variants(struct work *work, int chosen, struct neph_diag *diag)
{
    bool wanted[NEPH_SWEEP_POINTS_MAX] = {false};
    const int first = work->plan.series_count;
    enum neph_status status = add_variants(work, chosen, diag);
    for (int s = first; s < work->plan.series_count; s++)
        wanted[s * NEPH_SWEEP_VALUES_MAX] = true;
    if (!status && work->plan.series_count > first)
        status = measure(work, wanted, FULL, isfinite(work->params->time_s), work->params->jobs,
                         diag);
    for (int i = 0; i < work->pick->left_out_count && !status; i++)
        work->pick->left_out[i].with = work->entries[(first + i) * NEPH_SWEEP_VALUES_MAX].point;
    return status;
}

/* --- the whole search ----------------------------------------------------------------------- */

static enum neph_status choose(struct work *work, struct neph_diag *diag)
{
    int chosen = -1;
    enum neph_status status = NEPH_OK;
    for (int late = 0; late < 2 && !work->pick->found && !status; late++) {
        if (late && work->scene->scattering != NEPH_SCATTERING_MULTIPLE)
            break;
        status = start(work, late, diag);
        if (!status)
            status = search_candidates(work, true, &chosen, diag);
        if (!status && !work->pick->found)
            status = search_candidates(work, false, &chosen, diag);
        const int best = status || work->pick->found ? chosen : nearest(work);
        if (!status && best >= 0 && !work->pick->found)
            status = measure_one(work, best, FULL, diag);
        if (status || best < 0)
            continue;
        const struct neph_pick_point *point = &work->entries[best].point;
        if (work->pick->found || !work->pick->chosen.name[0] ||
            compute_excess_ratio(work->params, point) <
                compute_excess_ratio(work->params, &work->pick->chosen))
            work->pick->chosen = *point;
    }
    return status || !work->pick->found ? status : measure_variants(work, chosen, diag);
}

/* The error when no candidate rendered a frame; usually there is no driver. */
static enum neph_status explain_no_frames(const struct neph_pick_params *params,
                                          struct neph_diag *diag)
{
    struct neph_open_device *device = NULL;
    const enum neph_status status = neph_device_acquire(params->device, &device, diag);
    neph_device_release(device);
    return status ? status
                  : neph_fail(diag, NEPH_ERR_ENGINE, "no configuration of '%s' could be rendered",
                              params->scene);
}

enum neph_status neph_pick_run(const struct neph_pick_params *params, struct neph_store *store,
                               struct neph_pick *pick, struct neph_diag *diag)
{
    struct work work = {.params = params, .store = store, .pick = pick};
    *pick = (struct neph_pick){.truth = ""};
    work.entries = calloc(NEPH_SWEEP_POINTS_MAX, sizeof(*work.entries));
    enum neph_status status = work.entries ? neph_data_load_scene(params->scene, &work.scene, diag)
                                           : neph_fail_memory(diag);
    if (!status)
        status = neph_candidate_filter_check(&params->filter, work.scene, diag);
    const bool marches = neph_candidate_filter_has_engine(&params->filter, "march") ||
                         neph_candidate_filter_has_engine(&params->filter, "realtime");
    if (!status && marches) /* any candidate may be measured at full size */
        status = neph_engine_check_size(neph_engine_find("march"), params->width_px,
                                        params->height_px, diag);
    if (!status) {
        pick->is_still = neph_scene_is_static(work.scene);
        status = choose(&work, diag);
    }
    if (!status && pick->measured == 0)
        status = explain_no_frames(params, diag);
    neph_sweep_plan_finish(&work.plan);
    neph_scene_destroy(work.scene);
    free(work.entries);
    return status;
}
