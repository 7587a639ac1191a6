/* SPDX-License-Identifier: MIT */
#include "harness/sweep/pick.h"

#include "base/files.h"
#include "harness/data.h"
#include "harness/engines/vulkan_device.h"
#include "harness/sweep/ladder.h"
#include "harness/sweep/output.h"
#include "harness/sweep/point.h"
#include "harness/sweep/sweep.h"
#include "renderer/sky/split.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");

/* Sizes in which configurations are looked at, the last being the full one: what passes in a small
 * picture may be worse than asked by `slack`, as edges and thin things weigh more there. */
static const struct {
    int part;
    double slack;
} sizes[] = {{4, 3.0}, {2, 1.5}, {1, 1.0}};
enum { SIZES = sizeof(sizes) / sizeof(sizes[0]), FULL = SIZES - 1 };

enum { LEAST_WIDTH_PX = 64, LEAST_HEIGHT_PX = 36, SAMPLES_MAX = 16384 };

struct entry {
    bool is_there;
    struct neph_pick_point point; /* as of the largest size that it was looked at in */
};

struct work {
    const struct neph_pick_params *params;
    struct neph_store *store;
    struct neph_scene *scene;
    struct neph_sweep_plan plan;
    struct entry *entries; /* [series * NEPH_SWEEP_VALUES_MAX + place], NEPH_SWEEP_POINTS_MAX */
    struct neph_pick *pick;
};

/* --- measuring ------------------------------------------------------------------------------ */

static struct neph_pick_point point_of(const struct work *work,
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
        .evaluations = point->evaluations,
        .time = point->time,
        .is_closed = job->engine->rung == NEPH_RUNG_EXACT,
    };
    snprintf(made.name, sizeof(made.name), "%.40s%s%.20s", point->series->name,
             point->label[0] ? ", " : "", point->label);
    if (!neph_sweep_is_sequence(point)) /* one picture is as the next */
        made.flicker = 0.0;
    if (made.is_closed)
        made.evaluations = 0.0;
    return made;
}

/* What is asked for in parts of the truth's noise: a quarter of the error. */
static void ask_for_samples(struct work *work, double floor)
{
    const double wanted = 0.25 * work->params->error;
    int *samples = &work->plan.truth_samples;
    for (; floor > wanted && *samples < SAMPLES_MAX; floor /= sqrt(2.0))
        *samples *= 2;
}

/* At least a size at which flicker and tiles mean something, and never more than the full one. */
static int side_px(int full_px, int part, int least_px)
{
    const int side = full_px / part;
    return side >= least_px ? side : full_px < least_px ? full_px : least_px;
}

static enum neph_status measure(struct work *work, const bool *wanted, int size, bool is_timed,
                                struct neph_diag *diag)
{
    const struct neph_pick_params *params = work->params;
    const struct neph_sweep_params asked = {.plan = &work->plan,
                                            .scene = params->scene,
                                            .time_limit_s = params->time_limit_s,
                                            .seed = params->seed,
                                            .jobs = params->jobs,
                                            .device = params->device,
                                            .quiet = params->quiet,
                                            .untimed = !is_timed,
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
        entry->point = point_of(work, point);
        work->pick->measured += entry->is_there;
    }
    if (!status) {
        ask_for_samples(work, sweep.floor);
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
    return measure(work, wanted, size, size == FULL && isfinite(work->params->time_s), diag);
}

/* --- judging -------------------------------------------------------------------------------- */

static double ratio(double value, double most)
{
    return isnan(most) ? 0.0 : isnan(value) ? INFINITY : value / most;
}

/* How far from good enough: 1 is just so. */
static double farness(const struct neph_pick_params *params, const struct neph_pick_point *point)
{
    const double time = isnan(point->time.median) ? 0.0 : ratio(point->time.median, params->time_s);
    return fmax(time,
                fmax(ratio(point->error, params->error), ratio(point->flicker, params->flicker)));
}

/* Evaluations, which are counted; what is not counted comes last. */
static double cost(const struct neph_pick_point *point)
{
    return isnan(point->evaluations) ? INFINITY : point->evaluations;
}

/* The entry of least cost that is left, by the order of the ladder among equals; -1: none. */
static int cheapest(const struct work *work, const bool *is_left)
{
    int best = -1;
    for (int i = 0; i < work->plan.series_count * NEPH_SWEEP_VALUES_MAX; i++)
        if (is_left[i] &&
            (best < 0 || cost(&work->entries[i].point) < cost(&work->entries[best].point)))
            best = i;
    return best;
}

static int nearest(const struct work *work)
{
    int best = -1;
    for (int i = 0; i < work->plan.series_count * NEPH_SWEEP_VALUES_MAX; i++)
        if (work->entries[i].is_there &&
            (best < 0 || farness(work->params, &work->entries[i].point) <
                             farness(work->params, &work->entries[best].point)))
            best = i;
    return best;
}

/* --- the ladder ----------------------------------------------------------------------------- */

/* Through the larger sizes; `*passes` at the end of them. */
static enum neph_status climb(struct work *work, int index, bool *passes, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    *passes = true;
    for (int size = 1; size < SIZES && *passes && !status; size++) {
        status = measure_one(work, index, size, diag);
        *passes = !status && work->entries[index].is_there &&
                  farness(work->params, &work->entries[index].point) <= sizes[size].slack;
    }
    return status;
}

/* From the cheapest up, of the series of one sort; `*chosen` is the last that was climbed with. */
static enum neph_status walk(struct work *work, bool closed, int *chosen, struct neph_diag *diag)
{
    bool is_left[NEPH_SWEEP_POINTS_MAX] = {false};
    int count = 0;
    for (int s = 0; s < work->plan.series_count; s++)
        for (int i = 0; i < neph_sweep_value_count(&work->plan.series[s]); i++) {
            const bool is_wanted = closed == (strcmp(work->plan.series[s].engine, "exact") == 0);
            is_left[s * NEPH_SWEEP_VALUES_MAX + i] = is_wanted;
            count += is_wanted;
        }
    enum neph_status status = count > 0 ? measure(work, is_left, 0, false, diag) : NEPH_OK;
    for (int i = 0; i < work->plan.series_count * NEPH_SWEEP_VALUES_MAX && !status; i++) {
        work->pick->looked_at += is_left[i];
        is_left[i] &= work->entries[i].is_there &&
                      farness(work->params, &work->entries[i].point) <= sizes[0].slack;
    }
    for (int index = 0; !status && !work->pick->found; is_left[index] = false) {
        index = cheapest(work, is_left);
        if (index < 0)
            break;
        status = climb(work, index, &work->pick->found, diag);
        *chosen = index;
    }
    return status;
}

static enum neph_status start(struct work *work, bool late, struct neph_diag *diag)
{
    neph_sweep_plan_finish(&work->plan);
    memset(work->entries, 0, NEPH_SWEEP_POINTS_MAX * sizeof(*work->entries));
    return neph_ladder_plan(work->scene, late, work->params->width_px, work->params->height_px,
                            &work->plan, diag);
}

/* --- what is left out ----------------------------------------------------------------------- */

/* The choice with something more, as one series more. */
static enum neph_status add_variant(struct work *work, const char *what, const char *because,
                                    const char *engine, const char *preset, const char *held,
                                    const char *steps, int scattering, struct neph_diag *diag)
{
    struct neph_pick *pick = work->pick;
    if (pick->left_out_count == NEPH_PICK_LEFT_OUT_MAX)
        return NEPH_OK;
    struct neph_pick_left_out *left = &pick->left_out[pick->left_out_count++];
    snprintf(left->what, sizeof(left->what), "%s", what);
    left->because = because;
    const bool is_sequence = strcmp(engine, "realtime") == 0 || !pick->is_still;
    return neph_ladder_add(&work->plan, what, engine, preset, held, steps, scattering, is_sequence,
                           diag);
}

/* What was added last is something that the choice has. */
static void mark_kept(struct work *work)
{
    work->pick->left_out[work->pick->left_out_count - 1].is_kept = true;
}

static const struct neph_ladder_light *light_of(const struct neph_sweep_series *series)
{
    const char *name = strchr(series->name, ','); /* "ours, octaves" */
    const struct neph_ladder_light *light = neph_ladder_lights;
    while (light->name && strcmp(light->name, name + 2) != 0)
        light++;
    return light;
}

static bool has_air(const struct neph_sweep_series *chosen)
{
    return strncmp(strchr(chosen->name, ',') - strlen("+air"), "+air", strlen("+air")) == 0;
}

/* Lights that have more than the choice's, at the same pipeline and steps. */
static enum neph_status add_lights(struct work *work, const struct neph_sweep_series *chosen,
                                   const char *steps, struct neph_diag *diag)
{
    const bool is_realtime = strcmp(chosen->engine, "realtime") == 0;
    enum neph_status status = NEPH_OK;
    for (const struct neph_ladder_light *light = light_of(chosen) + 1; light->name && !status;
         light++) {
        if (light->scattering > (int)work->scene->scattering || light->is_late)
            continue;
        char *held = neph_ladder_held(work->scene, light, true, has_air(chosen));
        status = held
                     ? add_variant(work, light->name, NULL, is_realtime ? "realtime" : light->march,
                                   is_realtime ? chosen->preset : NULL, is_realtime ? held : NULL,
                                   steps, light->scattering, diag)
                     : neph_fail_memory(diag);
        free(held);
    }
    return status;
}

static const struct neph_ladder_light *light_named(const char *name)
{
    const struct neph_ladder_light *light = neph_ladder_lights;
    while (strcmp(light->name, name) != 0)
        light++;
    return light;
}

/* What the choice has and could do without: orders of scattering, every pixel's ray. */
static enum neph_status add_kept(struct work *work, const struct neph_sweep_series *chosen,
                                 const char *steps, struct neph_diag *diag)
{
    const bool is_realtime = strcmp(chosen->engine, "realtime") == 0;
    const struct neph_ladder_light *light = light_of(chosen), *once = light_named("scattered once");
    char *single = neph_ladder_held(work->scene, once, true, is_realtime && has_air(chosen));
    char *held = neph_ladder_held(work->scene, light, true, false);
    enum neph_status status = held && single ? NEPH_OK : neph_fail_memory(diag);
    if (!status && light->scattering > once->scattering) {
        status = add_variant(work, "light scattered more than once", NULL,
                             is_realtime ? "realtime" : once->march,
                             is_realtime ? chosen->preset : NULL, is_realtime ? single : NULL,
                             steps, once->scattering, diag);
        mark_kept(work);
    }
    if (!status && !is_realtime) {
        status = add_variant(work, "every pixel's ray in every frame", NULL, "realtime",
                             neph_ladder_pipelines[0].preset, held, steps, chosen->scattering,
                             diag);
        mark_kept(work);
    }
    free(held);
    free(single);
    return status;
}

static enum neph_status add_steps(struct work *work, const struct neph_sweep_series *chosen,
                                  const char *steps, struct neph_diag *diag)
{
    char more[16], what[48];
    snprintf(more, sizeof(more), "%d", 2 * atoi(steps));
    snprintf(what, sizeof(what), "more steps: %s", more);
    return add_variant(work, what, NULL, chosen->engine, chosen->preset, chosen->held, more,
                       chosen->scattering, diag);
}

/* Why parts for motion are left out; NULL: all are there. */
static const char *what_rests(const struct work *work)
{
    const bool camera = neph_ladder_moves(work->scene, NEPH_LADDER_CAMERA);
    const bool wind = neph_ladder_moves(work->scene, NEPH_LADDER_WIND);
    if (work->pick->is_still)
        return "nothing moves";
    if (!camera)
        return wind ? "the camera rests" : "the camera rests, and there is no wind";
    return wind ? NULL : "there is no wind";
}

/* The pipeline has a planet's air by tables alone; beside it the march has it so, too. */
static const char *air_of_march(const struct neph_scene *scene)
{
    struct neph_sky_split split;
    char reason[256];
    return neph_sky_split(scene, &split, reason, sizeof(reason)) ? "sky=tables" : NULL;
}

/* What a shortcut saves, and the parts of it for motion. */
static enum neph_status add_pipeline(struct work *work, const struct neph_sweep_series *chosen,
                                     const char *steps, struct neph_diag *diag)
{
    const struct neph_ladder_light *light = light_of(chosen);
    enum neph_status status = add_variant(work, "a ray for every pixel, every frame", NULL,
                                          light->march, NULL, air_of_march(work->scene), steps,
                                          chosen->scattering, diag);
    const char *at_rest = what_rests(work);
    char *held = neph_ladder_held(work->scene, light, false, has_air(chosen));
    if (!status && !held)
        status = neph_fail_memory(diag);
    if (!status && at_rest)
        status = add_variant(work, "parts that only motion needs", at_rest, "realtime",
                             chosen->preset, held, steps, chosen->scattering, diag);
    free(held);
    return status;
}

/* `settings` without one of them. */
static char *settings_without(const char *settings, const char *one)
{
    const char *found = strstr(settings, one);
    const size_t before = found ? (size_t)(found - settings) : strlen(settings);
    return neph_format("%.*s%s", (int)before, settings, found ? found + strlen(one) : "");
}

/* A part of the air: what it buys where the choice has it, else what it would. A scene that does
 * not need it is asked, too. */
static enum neph_status add_air(struct work *work, const struct neph_sweep_series *chosen,
                                const struct neph_ladder_air *part, const char *steps,
                                struct neph_diag *diag)
{
    const struct neph_ladder_light *light = light_of(chosen);
    const bool needed = part->is_needed(work->scene), is_there = strstr(chosen->held, part->on);
    if (light->scattering == NEPH_SCATTERING_NONE ||
        (needed && !is_there && !neph_ladder_takes(part, work->scene, light)))
        return NEPH_OK;
    char *held = is_there ? settings_without(chosen->held, part->on)
                          : neph_format("%s %s", chosen->held, part->on);
    const enum neph_status status =
        held ? add_variant(work, part->name, needed ? NULL : part->absent, "realtime",
                           chosen->preset, held, steps, chosen->scattering, diag)
             : neph_fail_memory(diag);
    if (!status && is_there)
        mark_kept(work);
    free(held);
    return status;
}

/* Engine sky stands alone: no march has what it renders. */
static enum neph_status add_march_beside(struct work *work, const char *engine, const char *steps,
                                         struct neph_diag *diag)
{
    return strcmp(engine, "sky") == 0 ? NEPH_OK
                                      : add_variant(work, "a ray march of 32 steps", NULL, "march",
                                                    NULL, NULL, steps, -1, diag);
}

static bool is_by_itself(const char *engine)
{
    for (int i = 0; neph_ladder_narrow[i]; i++)
        if (strcmp(neph_ladder_narrow[i], engine) == 0)
            return true;
    return strcmp(engine, "command") == 0;
}

static enum neph_status add_variants(struct work *work, int chosen, struct neph_diag *diag)
{
    /* A copy: the list of series grows. */
    const struct neph_sweep_series series = work->plan.series[chosen / NEPH_SWEEP_VALUES_MAX];
    char label[NEPH_SWEEP_LABEL_SIZE];
    neph_sweep_value(&series, chosen % NEPH_SWEEP_VALUES_MAX, label);
    const char *steps = label[0] ? strchr(label, '=') + 1 : "32";
    enum neph_status status = NEPH_OK;
    if (is_by_itself(series.engine))
        return add_march_beside(work, series.engine, steps, diag);
    if (strcmp(series.engine, "exact") == 0)
        return add_variant(work, "a ray march of 32 steps", "the closed form has no steps",
                           light_of(&series)->march, NULL, NULL, steps, series.scattering, diag);
    const bool is_realtime = strcmp(series.engine, "realtime") == 0;
    if (is_realtime)
        status = add_pipeline(work, &series, steps, diag);
    for (const struct neph_ladder_air *part = neph_ladder_air_parts;
         is_realtime && part->name && !status; part++)
        status = add_air(work, &series, part, steps, diag);
    if (!status)
        status = add_kept(work, &series, steps, diag);
    if (!status)
        status = add_steps(work, &series, steps, diag);
    return status ? status : add_lights(work, &series, steps, diag);
}

static enum neph_status weigh_what_is_left_out(struct work *work, int chosen,
                                               struct neph_diag *diag)
{
    bool wanted[NEPH_SWEEP_POINTS_MAX] = {false};
    const int first = work->plan.series_count;
    enum neph_status status = add_variants(work, chosen, diag);
    for (int s = first; s < work->plan.series_count; s++)
        wanted[s * NEPH_SWEEP_VALUES_MAX] = true;
    if (!status && work->plan.series_count > first)
        status = measure(work, wanted, FULL, isfinite(work->params->time_s), diag);
    for (int i = 0; i < work->pick->left_out_count && !status; i++)
        work->pick->left_out[i].with = work->entries[(first + i) * NEPH_SWEEP_VALUES_MAX].point;
    return status;
}

/* --- the whole ------------------------------------------------------------------------------ */

static enum neph_status choose(struct work *work, struct neph_diag *diag)
{
    int chosen = -1;
    enum neph_status status = NEPH_OK;
    for (int late = 0; late < 2 && !work->pick->found && !status; late++) {
        if (late && work->scene->scattering != NEPH_SCATTERING_MULTIPLE)
            break;
        status = start(work, late, diag);
        if (!status)
            status = walk(work, true, &chosen, diag);
        if (!status && !work->pick->found)
            status = walk(work, false, &chosen, diag);
        const int best = status || work->pick->found ? chosen : nearest(work);
        if (!status && best >= 0 && !work->pick->found)
            status = measure_one(work, best, FULL, diag);
        if (status || best < 0)
            continue;
        const struct neph_pick_point *point = &work->entries[best].point;
        if (work->pick->found || !work->pick->chosen.name[0] ||
            farness(work->params, point) < farness(work->params, &work->pick->chosen))
            work->pick->chosen = *point;
    }
    return status || !work->pick->found ? status : weigh_what_is_left_out(work, chosen, diag);
}

/* Why there is no picture at all: mostly there is no driver. */
static enum neph_status blame_device(const struct neph_pick_params *params, struct neph_diag *diag)
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
    if (!status) {
        pick->is_still = neph_ladder_is_still(work.scene);
        status = choose(&work, diag);
    }
    if (!status && pick->measured == 0)
        status = blame_device(params, diag);
    neph_sweep_plan_finish(&work.plan);
    neph_scene_destroy(work.scene);
    free(work.entries);
    return status;
}

/* --- output --------------------------------------------------------------------------------- */

static void print_numbers(const struct neph_pick_point *point, FILE *out)
{
    fprintf(out, "error %.3g, flicker %.3g, ", point->error, point->flicker);
    if (point->is_closed)
        fprintf(out, "no marched samples");
    else if (isnan(point->evaluations))
        fprintf(out, "evaluations not counted");
    else
        fprintf(out, "%.3g evaluations/px", point->evaluations);
    if (!isnan(point->time.median))
        fprintf(out, ", %.3g ms", 1e3 * point->time.median);
}

static void print_asked(const struct neph_pick_params *params, FILE *out)
{
    const char *comma = "";
    const struct {
        const char *what;
        double most;
    } asked[] = {
        {"error", params->error}, {"flicker", params->flicker}, {"ms", 1e3 * params->time_s}};
    for (size_t i = 0; i < sizeof(asked) / sizeof(asked[0]); i++)
        if (!isnan(asked[i].most)) {
            fprintf(out, "%s%s %.3g", comma, asked[i].what, asked[i].most);
            comma = ", ";
        }
}

static void print_variants(const struct neph_pick *pick, bool kept, const char *title, FILE *out)
{
    for (int i = 0; i < pick->left_out_count; i++) {
        const struct neph_pick_left_out *left = &pick->left_out[i];
        if (left->is_kept != kept)
            continue;
        if (title)
            fprintf(out, "\n%s:\n", title);
        title = NULL; /* once */
        fprintf(out, "  %-34s ", left->what);
        if (isnan(left->with.error))
            fprintf(out, "cannot be rendered with this light");
        else
            print_numbers(&left->with, out);
        fprintf(out, "%s%s%s\n", left->because ? " (" : "", left->because ? left->because : "",
                left->because ? ")" : "");
    }
}

void neph_pick_print(const struct neph_pick_params *params, const struct neph_pick *pick, FILE *out)
{
    fprintf(out, "asked: ");
    print_asked(params, out);
    fprintf(out, ", at %d x %d; truth: %s, noise %.2g\n", params->width_px, params->height_px,
            pick->truth, pick->floor);
    fprintf(out, pick->found ? "%s: " : "none is good enough; best is %s: ", pick->chosen.name);
    print_numbers(&pick->chosen, out);
    fprintf(out, "\n");
    print_variants(pick, false, "left out, and what comes of it with each", out);
    print_variants(pick, true, "kept, and what would come of it without", out);
    fprintf(out, "\n%d configurations looked at, %d pictures or sequences of them measured; %s\n",
            pick->looked_at, pick->measured, pick->device);
    if (!isnan(params->error) && pick->floor > 0.5 * params->error)
        fprintf(out, "the truth's noise is more than half of the error that was asked for: what "
                     "is said of errors is not certain\n");
}

static json_t *point_json(const struct neph_pick_point *point)
{
    json_t *json = neph_configuration_json(&point->configuration);
    neph_json_set(&json, "name", json_string(point->name));
    neph_json_set(&json, "error", neph_json_number(point->error));
    neph_json_set(&json, "flicker", neph_json_number(point->flicker));
    neph_json_set(&json, "evaluations", neph_json_number(point->evaluations));
    neph_json_set(&json, "seconds", neph_json_number(point->time.median));
    return json;
}

json_t *neph_pick_json(const struct neph_pick_params *params, const struct neph_pick *pick)
{
    json_t *json = point_json(&pick->chosen), *left_out = json_array(), *kept = json_array();
    for (int i = 0; i < pick->left_out_count; i++) {
        const struct neph_pick_left_out *left = &pick->left_out[i];
        neph_json_add(left->is_kept ? &kept : &left_out,
                      json_pack("{s:s, s:s?, s:o}", "what", left->what, "because", left->because,
                                left->is_kept ? "without" : "with", point_json(&left->with)));
    }
    neph_json_set(&json, "found", json_boolean(pick->found));
    neph_json_set(&json, "scene", json_string(params->scene));
    neph_json_set(&json, "asked",
                  json_pack("{s:o, s:o, s:o}", "error", neph_json_number(params->error), "flicker",
                            neph_json_number(params->flicker), "seconds",
                            neph_json_number(params->time_s)));
    neph_json_set(&json, "width_px", json_integer(params->width_px));
    neph_json_set(&json, "height_px", json_integer(params->height_px));
    neph_json_set(&json, "truth", json_string(pick->truth));
    neph_json_set(&json, "truth_noise", neph_json_number(pick->floor));
    neph_json_set(&json, "device", json_string(pick->device));
    neph_json_set(&json, "left_out", left_out);
    neph_json_set(&json, "kept", kept);
    return json;
}
