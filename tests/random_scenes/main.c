/* SPDX-License-Identifier: MIT
 *
 * Compares exact, oracle, tracer and march on random scenes. Each disagreement is reduced to a
 * simpler scene and stored as a scene file.
 *
 *   random_scenes --seed 36 --count 200
 *   random_scenes --seed 36 --count 2000 --processes 16 --seconds 3600
 *   random_scenes --scene build/release/random_scenes/random_36_17.yaml  a stored scene
 *   random_scenes --seed 36 --first 17 --print                           as YAML, on stdout
 *
 * Exit codes: 0 all engines agree; 1 some do not; 64 the command line is wrong; 70 the program
 * could not continue.
 */
#include "tests/random_scenes/compare.h"
#include "tests/random_scenes/recipe.h"

#include "base/clock.h"
#include "base/files.h"
#include "base/interrupt.h"
#include "base/text.h"
#include "harness/engines/vulkan_device.h"
#include "renderer/vulkan.h"
#include "scenes/media.h"
#include "scenes/mesh_file.h"
#include "scenes/motion.h"

#include <argp.h>
#include <errno.h>
#include <math.h>
#include <sched.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { ATTEMPTS_MAX = 64, SHRINK_TURNS_MAX = 120 };

struct options {
    uint64_t seed;
    int first, count, processes;
    double seconds;     /* limit of the comparison; +inf: none */
    const char *folder; /* for stored scenes */
    const char *scene;  /* a file to compare in place of random scenes */
    const char *still;  /* the same without wind; NULL: `scene` itself */
    int frame;          /* of `scene` */
    unsigned engines;
    bool prints, is_quiet, is_kept_whole;
    bool has_meshes; /* the program that reads them is there */
};

/* ---- scenes from recipes --------------------------------------------------------------------- */

/* The static copy of a scene at a frame, with the loaded scene that it borrows from. */
struct moment {
    struct neph_scene *loaded, *scene;
};

static void close_moment(struct moment *moment)
{
    neph_scene_destroy(moment->scene);
    neph_scene_destroy(moment->loaded);
    *moment = (struct moment){NULL, NULL};
}

static enum neph_status open_moment(const char *path, int frame, struct moment *moment,
                                    struct neph_diag *diag)
{
    *moment = (struct moment){NULL, NULL};
    enum neph_status status = neph_scene_load(path, &moment->loaded, diag);
    if (!status)
        status = neph_scene_at(moment->loaded, frame, &moment->scene, diag);
    if (!status)
        status = neph_scene_hash(moment->scene, diag);
    return status;
}

static enum neph_status finish_file(FILE *file, const char *path, struct neph_diag *diag)
{
    return file && !fclose(file) ? NEPH_OK
                                 : neph_fail(diag, NEPH_ERR_IO, "cannot write '%s': %s",
                                             path ? path : "", strerror(errno));
}

static char *name_mesh(const char *folder, const char *name, int mesh)
{
    return neph_format("%s/%s_%d.obj", folder, name, mesh);
}

static enum neph_status write_meshes(const struct recipe *recipe, const char *folder,
                                     const char *name, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < recipe->mesh_count && !status; i++) {
        char *path = name_mesh(folder, name, i);
        FILE *file = path ? fopen(path, "we") : NULL;
        if (file)
            recipe_write_mesh(&recipe->meshes[i], "", file);
        status = finish_file(file, path, diag);
        free(path);
    }
    return status;
}

static void remove_meshes(const struct recipe *recipe, const char *folder, const char *name)
{
    for (int i = 0; i < recipe->mesh_count; i++) {
        char *path = name_mesh(folder, name, i);
        if (path)
            unlink(path);
        free(path);
    }
}

/* The scene's file, and those of its meshes. */
static enum neph_status write_recipe(const struct recipe *recipe, const char *folder,
                                     const char *name, const char *note, char **path,
                                     struct neph_diag *diag)
{
    char *file_path = neph_format("%s/%s.yaml", folder, name);
    FILE *file = file_path ? fopen(file_path, "we") : NULL;
    if (file)
        recipe_write(recipe, name, note, file);
    enum neph_status status = finish_file(file, file_path, diag);
    if (!status)
        status = write_meshes(recipe, folder, name, diag);
    if (status)
        free(file_path);
    else
        *path = file_path;
    return status;
}

/* Loads the recipe through a file, as a user's scene is loaded. */
static enum neph_status load_recipe(const struct recipe *recipe, const char *folder,
                                    struct moment *moment, struct neph_diag *diag)
{
    char name[64], *path = NULL;
    snprintf(name, sizeof(name), "try_%d", (int)getpid());
    enum neph_status status = write_recipe(recipe, folder, name, "", &path, diag);
    if (!status) {
        status = open_moment(path, recipe->frame, moment, diag);
        unlink(path);
        remove_meshes(recipe, folder, name);
    }
    free(path);
    return status;
}

/* A light on a pixel's ray must not be inside a medium: its radiance would be infinite. */
static bool has_infinite_light(const struct neph_scene *scene)
{
    const struct neph_camera camera = neph_scene_camera(scene, 0.0);
    for (int l = 0; l < scene->light_count; l++) {
        const struct neph_vec3 at_m = scene->lights[l].position_m;
        bool is_in_medium = false;
        for (int m = 0; m < scene->medium_count; m++)
            is_in_medium |= neph_medium_extinction_per_m(&scene->media[m], at_m) > 0.0;
        for (int i = 0; i < COMPARE_PIXELS && is_in_medium; i++) {
            const struct neph_pixel_ray ray = neph_camera_ray(&camera, RECIPE_WIDTH_PX,
                                                              RECIPE_HEIGHT_PX, i % RECIPE_WIDTH_PX,
                                                              i / RECIPE_WIDTH_PX);
            const struct neph_vec3 way_m = neph_vec3_sub(at_m, ray.origin_m);
            const double t_m = fmax(0.0, neph_vec3_dot(way_m, ray.direction));
            const struct neph_vec3 off_m = neph_vec3_sub(way_m,
                                                         neph_vec3_scale(ray.direction, t_m));
            if (neph_vec3_length(off_m) < 1e-9 * (1.0 + neph_vec3_length(way_m)))
                return true;
        }
    }
    return false;
}

/* Both scenes of a recipe: with its wind, and with the media displaced by the wind. */
static enum neph_status open_both(const struct recipe *recipe, const char *folder,
                                  struct moment *written, struct moment *still,
                                  struct neph_diag *diag)
{
    const struct recipe without = recipe_without_wind(recipe);
    *still = (struct moment){NULL, NULL};
    enum neph_status status = load_recipe(recipe, folder, written, diag);
    if (!status)
        status = load_recipe(&without, folder, still, diag);
    if (!status && has_infinite_light(written->scene))
        status = neph_fail(diag, NEPH_ERR_INPUT, "a light is on a ray and in a medium");
    if (status) {
        close_moment(written);
        close_moment(still);
    }
    return status;
}

/* Draws until the loader accepts the recipe. */
static enum neph_status draw_scene(const struct options *options, int index, struct recipe *recipe,
                                   struct moment *written, struct moment *still,
                                   struct neph_diag *diag)
{
    enum neph_status status = NEPH_ERR_INPUT;
    for (int attempt = 0; attempt < ATTEMPTS_MAX && status == NEPH_ERR_INPUT; attempt++) {
        *recipe = recipe_draw(options->seed, index, attempt);
        if (!options->has_meshes)
            recipe->mesh_count = 0;
        status = open_both(recipe, options->folder, written, still, diag);
    }
    return status;
}

/* ---- run ------------------------------------------------------------------------------------- */

/* Scenes with a light on or next to the ray of a pixel, and all others. */
enum family { FAMILY_ANY, FAMILY_NEAR_LIGHTS, FAMILIES };

/* The results of scenes. Processes send it through a pipe. */
struct tally {
    struct compare_scores scores[FAMILIES][PAIR_COUNT];
    struct compare_march marched;
    int scenes, disagreements;
    int left; /* begun, and unfinished when the time ended */
    int covered[COMPARE_ENGINES];
    double seconds[COMPARE_ENGINES];
    int stages[COMPARE_STAGES + 1]; /* scenes that needed this number of stages */
};

struct run {
    const struct options *options;
    struct neph_vulkan *vulkan;
    struct tally tally;
    atomic_int *next; /* index of the next scene, shared by all processes */
    double start_s;
};

static enum neph_status compare_recipe(struct run *run, const struct moment *written,
                                       const struct moment *still, uint64_t seed, unsigned engines,
                                       struct compare_scores *scores, struct compare_result *result,
                                       struct neph_diag *diag)
{
    const struct compare_request request = {.written = written->scene,
                                            .still = still->scene,
                                            .vulkan = run->vulkan,
                                            .seed = seed,
                                            .engines = engines};
    return compare_scene(&request, scores, scores ? &run->tally.marched : NULL, result, diag);
}

/* Whether the same two engines still disagree about a simpler recipe. */
static bool still_disagrees(struct run *run, const struct recipe *recipe,
                            const struct compare_finding *finding, uint64_t seed,
                            struct compare_finding *found)
{
    struct moment written, still;
    struct neph_diag diag = {0};
    if (open_both(recipe, run->options->folder, &written, &still, &diag))
        return false;
    struct compare_result result;
    const unsigned engines = 1u << finding->test | 1u << finding->truth;
    /* march is compared with exact, or with oracle if exact does not support the scene. */
    const bool is_done = !compare_recipe(run, &written, &still, seed, engines, NULL, &result,
                                         &diag);
    close_moment(&written);
    close_moment(&still);
    for (int i = 0; is_done && i < result.finding_count; i++)
        if (result.findings[i].test == finding->test &&
            result.findings[i].truth == finding->truth) {
            *found = result.findings[i];
            return true;
        }
    return false;
}

/* Greedy: applies each change that preserves the disagreement, until none does. */
static struct recipe shrink(struct run *run, const struct recipe *recipe,
                            struct compare_finding *finding)
{
    struct recipe smallest = *recipe;
    bool goes_on = true;
    int turns = 0;
    while (goes_on && turns < SHRINK_TURNS_MAX) {
        goes_on = false;
        for (int c = 0; c < recipe_change_count() && turns < SHRINK_TURNS_MAX; c++) {
            struct recipe simpler = smallest;
            if (!recipe_simplify(&simpler, c))
                continue;
            turns++;
            if (still_disagrees(run, &simpler, finding, recipe->seed + (uint64_t)turns, finding)) {
                smallest = simpler;
                goes_on = true;
            }
        }
    }
    return smallest;
}

static void keep(struct run *run, const struct recipe *recipe, const char *suffix,
                 const struct compare_finding *finding)
{
    char name[64], *path = NULL, *still_path = NULL, *note = NULL;
    struct neph_diag diag = {0};
    snprintf(name, sizeof(name), "random_%llu_%d%s", (unsigned long long)recipe->seed,
             recipe->index, suffix);
    const struct recipe without = recipe_without_wind(recipe);
    char still[80];
    snprintf(still, sizeof(still), "%s_still", name);
    enum neph_status status = NEPH_OK;
    if (recipe->has_wind)
        status = write_recipe(&without, run->options->folder, still, "", &still_path, &diag);
    note = neph_format("# %s and %s disagree: %s\n"
                       "# Again: random_scenes --seed %llu --frame %d%s%s --scene THIS_FILE\n",
                       compare_engine_names[finding->test], compare_engine_names[finding->truth],
                       finding->what, (unsigned long long)recipe->seed, recipe->frame,
                       still_path ? " --still " : "", still_path ? still_path : "");
    if (!status && note)
        status = write_recipe(recipe, run->options->folder, name, note, &path, &diag);
    if (status)
        fprintf(stderr, "%s\n", diag.message);
    else
        printf("  kept: %s\n", path);
    free(note);
    free(path);
    free(still_path);
}

static void print_media(const struct recipe *recipe)
{
    for (int i = 0; i < recipe->medium_count; i++)
        printf("%s%s", i > 0 ? " + " : "", recipe_form_name(recipe->media[i].form));
    static const char *const words[] = {"none", "single", "multiple"};
    printf("; %s%s; %d lights, %d solids, %d meshes%s%s", words[recipe->scattering],
           recipe->environment_light ? " with environment" : "", recipe->light_count,
           recipe->solid_count, recipe->mesh_count, recipe->has_wind ? ", wind" : "",
           recipe->orthographic_height_m > 0.0 ? ", orthographic" : "");
}

static void report(struct run *run, const struct recipe *recipe, struct compare_result *result)
{
    for (int i = 0; i < result->finding_count; i++) {
        struct compare_finding finding = result->findings[i];
        run->tally.disagreements++;
        printf("scene %d disagrees (", recipe->index);
        print_media(recipe);
        printf(")\n  %s and %s: %s\n", compare_engine_names[finding.test],
               compare_engine_names[finding.truth], finding.what);
        fflush(stdout); /* reduction takes a while */
        char suffix[40];
        snprintf(suffix, sizeof(suffix), "_%s_%s", compare_engine_names[finding.test],
                 compare_engine_names[finding.truth]);
        const struct recipe smallest = run->options->is_kept_whole ? *recipe
                                                                   : shrink(run, recipe, &finding);
        printf("  smallest: ");
        print_media(&smallest);
        printf("\n  %s\n", finding.what);
        keep(run, &smallest, suffix, &finding);
    }
    fflush(stdout);
}

static enum neph_status run_scene(struct run *run, int index, struct neph_diag *diag)
{
    struct recipe recipe;
    struct moment written, still;
    struct compare_result result;
    enum neph_status status = draw_scene(run->options, index, &recipe, &written, &still, diag);
    if (status == NEPH_ERR_INPUT) {
        printf("scene %d: no attempt is a scene: %s\n", index, diag->message);
        return NEPH_OK;
    }
    if (status)
        return status;
    const double start_s = neph_wall_s();
    status = compare_recipe(
        run, &written, &still, run->options->seed + (uint64_t)index, run->options->engines,
        run->tally.scores[recipe.has_near_light ? FAMILY_NEAR_LIGHTS : FAMILY_ANY], &result, diag);
    close_moment(&written);
    close_moment(&still);
    if (status)
        return status;
    run->tally.scenes++;
    run->tally.stages[result.stages]++;
    for (int e = 0; e < COMPARE_ENGINES; e++) {
        run->tally.covered[e] += result.refusals[e][0] == '\0';
        run->tally.seconds[e] += result.seconds[e];
    }
    if (!run->options->is_quiet) {
        printf("%5d %5.1f s (", index, neph_wall_s() - start_s);
        for (int e = 0; e < COMPARE_ENGINES; e++)
            printf("%s%.1f", e > 0 ? " " : "", result.seconds[e]);
        printf("), %d stages: ", result.stages);
        print_media(&recipe);
        printf("\n");
        fflush(stdout);
    }
    report(run, &recipe, &result);
    return NEPH_OK;
}

/* ---- results --------------------------------------------------------------------------------- */

/* The allowed deviation from 1 of the variance of this number of z-scores: 0.1 plus four of its own
 * standard errors. */
static double variance_slack(long count)
{
    return 0.1 + 4.0 * sqrt(2.0 / (double)count);
}

/* Prints one line of the table; returns whether its variance is as expected. */
static bool print_score_line(const char *name, const struct compare_scores *scores)
{
    const double n = fmax(1.0, (double)scores->count), variance = scores->square_sum / n;
    printf("%-18s %8ld %+8.3f %9.3f %9.3f %8ld %9.3f %6ld\n", name, scores->count, scores->sum / n,
           variance, scores->expected_sum / n, scores->unsure,
           scores->unsure_square_sum / fmax(1.0, (double)scores->unsure), scores->rare);
    return scores->count == 0 || fabs(variance - 1.0) <= variance_slack(scores->count);
}

static bool print_scores(const struct run *run)
{
    static const char *const names[] = {"oracle - exact", "tracer - exact", "tracer - oracle"};
    struct compare_scores all = {.count = 0}, near = {.count = 0};
    printf("%-18s %8s %8s %9s %9s %8s %9s %6s\n", "z-scores", "pixels", "mean", "variance",
           "expected", "unsure", "variance", "rare");
    bool is_right = true;
    for (int p = 0; p <= PAIR_TRACER_ORACLE; p++) {
        struct compare_scores pair = run->tally.scores[FAMILY_ANY][p];
        compare_add_scores(&near, &run->tally.scores[FAMILY_NEAR_LIGHTS][p]);
        compare_add_scores(&pair, &run->tally.scores[FAMILY_NEAR_LIGHTS][p]);
        is_right &= print_score_line(names[p], &pair);
        compare_add_scores(&all, &pair);
    }
    is_right &= print_score_line("lights near rays", &near);
    is_right &= print_score_line("all", &all);
    if (all.count > 0)
        printf("the variance may be 1 +- %.2f: %s\n", variance_slack(all.count),
               is_right ? "it is" : "it is not");
    return is_right;
}

static bool print_summary(const struct run *run)
{
    printf("seed %llu, %d scenes from %d on: %d compared, %d left, %d disagreements\n",
           (unsigned long long)run->options->seed, run->tally.scenes + run->tally.left,
           run->options->first, run->tally.scenes, run->tally.left, run->tally.disagreements);
    for (int e = 0; e < COMPARE_ENGINES; e++)
        printf("  %-7s %5d scenes %8.1f s\n", compare_engine_names[e], run->tally.covered[e],
               run->tally.seconds[e]);
    printf("  rendered again with more samples: %d once, %d twice\n", run->tally.stages[2],
           run->tally.stages[3]);
    printf(
        "  march: %ld scenes, %ld at once within rounding, largest step bias %.1f %%; %ld pixels "
        "next to a light left out\n",
        run->tally.marched.count, run->tally.marched.rounding,
        100.0 * run->tally.marched.largest_bias, run->tally.marched.left_out);
    return print_scores(run);
}

/* ---- processes ------------------------------------------------------------------------------- */

/* Interrupts the current scene of this process when the time is up. */
static bool start_timer(const struct run *run)
{
    const double left_s = run->options->seconds - (neph_wall_s() - run->start_s);
    if (!isfinite(left_s))
        return true;
    const double whole_s = floor(fmax(0.0, left_s));
    const struct itimerspec time = {
        .it_value = {(time_t)whole_s, 1 + (long)(fmax(0.0, left_s - whole_s) * 999999998.0)}};
    struct sigevent event = {.sigev_notify = SIGEV_SIGNAL, .sigev_signo = SIGTERM};
    timer_t timer;
    neph_interrupt_install();
    return !timer_create(CLOCK_MONOTONIC, &event, &timer) && !timer_settime(timer, 0, &time, NULL);
}

/* Takes scenes from the shared counter until none are left, or the time is up. An unfinished scene
 * is dropped. */
static enum neph_status run_some(struct run *run, struct neph_diag *diag)
{
    const struct options *options = run->options;
    if (!start_timer(run))
        return neph_fail(diag, NEPH_ERR_ENGINE, "no timer: %s", strerror(errno));
    const bool needs_device = options->engines >> COMPARE_TRACER != 0;
    enum neph_status status = needs_device ? neph_vulkan_open(&run->vulkan, diag) : NEPH_OK;
    while (!status && neph_wall_s() - run->start_s <= options->seconds && !neph_interrupted()) {
        const int turn = atomic_fetch_add(run->next, 1);
        if (turn >= options->count)
            break;
        status = run_scene(run, options->first + turn, diag);
        if (status != NEPH_ERR_INTERRUPTED)
            continue;
        printf("scene %d: left, since the time is up\n", options->first + turn);
        fflush(stdout);
        run->tally.left++;
        status = NEPH_OK;
    }
    neph_vulkan_destroy(run->vulkan);
    run->vulkan = NULL;
    return status;
}

/* A process on a processor of its own: `file` gets its tally on success. */
static void run_process(struct run *run, int number, int file)
{
    cpu_set_t processors, one;
    CPU_ZERO(&one);
    if (!sched_getaffinity(0, sizeof(processors), &processors)) {
        int left = number % CPU_COUNT(&processors);
        for (int i = 0; i < CPU_SETSIZE; i++)
            if (CPU_ISSET(i, &processors) && left-- == 0)
                CPU_SET(i, &one);
        sched_setaffinity(0, sizeof(one), &one);
    }
    struct neph_diag diag = {0};
    const enum neph_status status = run_some(run, &diag);
    if (status)
        fprintf(stderr, "random_scenes: process %d: %s\n", number, diag.message);
    else if (write(file, &run->tally, sizeof(run->tally)) != sizeof(run->tally))
        fprintf(stderr, "random_scenes: process %d: no tally: %s\n", number, strerror(errno));
    fflush(stdout);
    _exit(status ? 70 : 0);
}

static void add_tally(struct tally *sum, const struct tally *part)
{
    for (int i = 0; i < FAMILIES * PAIR_COUNT; i++)
        compare_add_scores(&sum->scores[i / PAIR_COUNT][i % PAIR_COUNT],
                           &part->scores[i / PAIR_COUNT][i % PAIR_COUNT]);
    sum->marched.count += part->marched.count;
    sum->marched.rounding += part->marched.rounding;
    sum->marched.left_out += part->marched.left_out;
    sum->marched.largest_bias = fmax(sum->marched.largest_bias, part->marched.largest_bias);
    sum->scenes += part->scenes;
    sum->left += part->left;
    sum->disagreements += part->disagreements;
    for (int e = 0; e < COMPARE_ENGINES; e++) {
        sum->covered[e] += part->covered[e];
        sum->seconds[e] += part->seconds[e];
    }
    for (int i = 0; i <= COMPARE_STAGES; i++)
        sum->stages[i] += part->stages[i];
}

/* Starts all processes, and adds their results. A process that dies is an error: its scenes were
 * not compared. */
static enum neph_status run_processes(struct run *run, struct neph_diag *diag)
{
    const int count = run->options->processes;
    int ends[2], sent = 0;
    if (pipe(ends))
        return neph_fail(diag, NEPH_ERR_IO, "no pipe: %s", strerror(errno));
    for (int i = 0; i < count; i++) {
        const pid_t child = fork();
        if (child == 0)
            run_process(run, i, ends[1]);
        if (child < 0)
            fprintf(stderr, "random_scenes: process %d: %s\n", i, strerror(errno));
    }
    close(ends[1]);
    struct tally part;
    while (read(ends[0], &part, sizeof(part)) == sizeof(part)) {
        add_tally(&run->tally, &part);
        sent++;
    }
    close(ends[0]);
    while (wait(NULL) > 0)
        ;
    return sent == count ? NEPH_OK
                         : neph_fail(diag, NEPH_ERR_ENGINE, "%d of %d processes did not finish",
                                     count - sent, count);
}

static enum neph_status run_all(struct run *run, struct neph_diag *diag)
{
    const struct options *options = run->options;
    run->next = mmap(NULL, sizeof(*run->next), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS,
                     -1, 0);
    if (run->next == MAP_FAILED)
        return neph_fail_memory(diag);
    atomic_init(run->next, 0);
    printf("random scenes of seed %llu, %d from %d on\n", (unsigned long long)options->seed,
           options->count, options->first);
    fflush(stdout);
    const enum neph_status status = options->processes > 1 ? run_processes(run, diag)
                                                           : run_some(run, diag);
    munmap(run->next, sizeof(*run->next));
    return status;
}

static enum neph_status run_file(struct run *run, struct neph_diag *diag)
{
    const struct options *options = run->options;
    struct moment written = {NULL, NULL}, still = {NULL, NULL};
    struct compare_result result;
    enum neph_status status = neph_vulkan_open(&run->vulkan, diag);
    if (!status)
        status = open_moment(options->scene, options->frame, &written, diag);
    if (!status)
        status = open_moment(options->still ? options->still : options->scene, options->frame,
                             &still, diag);
    if (!status)
        status = compare_recipe(run, &written, &still, options->seed, options->engines,
                                run->tally.scores[FAMILY_ANY], &result, diag);
    for (int e = 0; e < COMPARE_ENGINES && !status; e++)
        if (result.refusals[e][0])
            printf("%s takes no part: %s\n", compare_engine_names[e], result.refusals[e]);
    for (int i = 0; !status && i < result.finding_count; i++)
        printf("%s and %s disagree: %s\n", compare_engine_names[result.findings[i].test],
               compare_engine_names[result.findings[i].truth], result.findings[i].what);
    if (!status)
        run->tally.disagreements = result.finding_count;
    run->tally.scenes = 1;
    close_moment(&written);
    close_moment(&still);
    neph_vulkan_destroy(run->vulkan);
    return status;
}

static enum neph_status print_recipe(const struct options *options, struct neph_diag *diag)
{
    struct recipe recipe;
    struct moment written, still;
    const enum neph_status status = draw_scene(options, options->first, &recipe, &written, &still,
                                               diag);
    if (status)
        return status;
    close_moment(&written);
    close_moment(&still);
    char name[64];
    snprintf(name, sizeof(name), "random_%llu_%d", (unsigned long long)recipe.seed, recipe.index);
    printf("# Frame %d\n", recipe.frame);
    for (int i = 0; i < recipe.mesh_count; i++) {
        printf("# %s_%d.obj:\n", name, i);
        recipe_write_mesh(&recipe.meshes[i], "#   ", stdout);
    }
    recipe_write(&recipe, name, "", stdout);
    return NEPH_OK;
}

/* ---- command line ---------------------------------------------------------------------------- */

enum {
    KEY_FIRST = 256,
    KEY_PROCESSES,
    KEY_SECONDS,
    KEY_FOLDER,
    KEY_SCENE,
    KEY_STILL,
    KEY_FRAME,
    KEY_ENGINES,
    KEY_PRINT,
    KEY_QUIET,
    KEY_WHOLE,
};

static const struct argp_option argp_options[] = {
    {"seed", 's', "N", 0, "of all scenes; `today`: the day", 0},
    {"first", KEY_FIRST, "N", 0, "index of the first scene (default 0)", 0},
    {"count", 'n', "N", 0, "scenes (default 20)", 0},
    {"processes", KEY_PROCESSES, "N", 0, "that share the scenes (default 1)", 0},
    {"seconds", KEY_SECONDS, "S", 0, "after so long, leave the scenes that are not done", 0},
    {"folder", KEY_FOLDER, "DIR", 0, "for scenes that disagree (default random_scenes)", 0},
    {"scene", KEY_SCENE, "FILE", 0, "compare this scene file", 0},
    {"still", KEY_STILL, "FILE", 0, "the same scene without wind", 0},
    {"frame", KEY_FRAME, "N", 0, "of the scene file", 0},
    {"engines", KEY_ENGINES, "LIST", 0, "parted by commas (default all)", 0},
    {"print", KEY_PRINT, NULL, 0, "print scene --first as YAML", 0},
    {"quiet", KEY_QUIET, NULL, 0, "no line for scenes that agree", 0},
    {"whole", KEY_WHOLE, NULL, 0, "keep scenes as they are drawn", 0},
    {0},
};

static unsigned parse_engines(const char *text, struct argp_state *state)
{
    unsigned engines = 0;
    char copy[80];
    snprintf(copy, sizeof(copy), "%s", text);
    for (char *rest = copy, *word = strsep(&rest, ","); word; word = strsep(&rest, ",")) {
        unsigned bit = 0;
        for (unsigned e = 0; e < COMPARE_ENGINES; e++)
            if (strcmp(word, compare_engine_names[e]) == 0)
                bit = 1u << e;
        if (!bit)
            argp_error(state, "there is no engine '%s'; there are exact, oracle, tracer, march",
                       word);
        engines |= bit;
    }
    return engines;
}

static double parse_number(const char *text, double low, double high, struct argp_state *state)
{
    char *end;
    const double value = strtod(text, &end);
    if (end == text || *end || !(value >= low && value <= high))
        argp_error(state, "'%s' must be a number from %g to %g", text, low, high);
    return value;
}

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct options *options = state->input;
    switch (key) {
    case 's':
        options->seed = strcmp(text, "today") == 0 ? (uint64_t)(time(NULL) / 86400)
                                                   : (uint64_t)parse_number(text, 0, 1e15, state);
        return 0;
    case KEY_FIRST:
        options->first = (int)parse_number(text, 0, 1e9, state);
        return 0;
    case 'n':
        options->count = (int)parse_number(text, 1, 1e9, state);
        return 0;
    case KEY_PROCESSES:
        options->processes = (int)parse_number(text, 1, 256, state);
        return 0;
    case KEY_SECONDS:
        options->seconds = parse_number(text, 0, 1e9, state);
        return 0;
    case KEY_FOLDER:
        options->folder = text;
        return 0;
    case KEY_SCENE:
        options->scene = text;
        return 0;
    case KEY_STILL:
        options->still = text;
        return 0;
    case KEY_FRAME:
        options->frame = (int)parse_number(text, 0, RECIPE_KEY_FRAME, state);
        return 0;
    case KEY_ENGINES:
        options->engines = parse_engines(text, state);
        return 0;
    case KEY_PRINT:
        options->prints = true;
        return 0;
    case KEY_QUIET:
        options->is_quiet = true;
        return 0;
    case KEY_WHOLE:
        options->is_kept_whole = true;
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static bool find_mesh_program(void)
{
    char *program = NULL;
    struct neph_diag diag = {0};
    const bool is_found = !neph_mesh_find_program(&program, &diag);
    free(program);
    if (!is_found)
        printf("without meshes: %s\n", diag.message);
    return is_found;
}

static enum neph_status make_folder(const char *folder, struct neph_diag *diag)
{
    if (mkdir(folder, 0777) && errno != EEXIST)
        return neph_fail(diag, NEPH_ERR_IO, "cannot make folder '%s': %s", folder, strerror(errno));
    return NEPH_OK;
}

int main(int argc, char **argv)
{
    const struct argp argp = {
        argp_options, parse, NULL, "Compare engines on random scenes, and shrink what disagrees.",
        NULL,         NULL,  NULL};
    struct options options = {.seed = 36,
                              .count = 20,
                              .processes = 1,
                              .seconds = INFINITY,
                              .folder = "random_scenes",
                              .engines = (1u << COMPARE_ENGINES) - 1u};
    argp_err_exit_status = 64;
    argp_parse(&argp, argc, argv, 0, NULL, &options);
    options.has_meshes = find_mesh_program();
    struct neph_diag diag = {0};
    struct run run = {.options = &options, .start_s = neph_wall_s()};
    bool is_right = true;
    enum neph_status status = make_folder(options.folder, &diag);
    if (!status && options.prints)
        status = print_recipe(&options, &diag);
    else if (!status) {
        status = options.scene ? run_file(&run, &diag) : run_all(&run, &diag);
        if (!status)
            is_right = print_summary(&run) || options.scene;
    }
    if (status) {
        fprintf(stderr, "random_scenes: %s\n", diag.message);
        return 70;
    }
    return run.tally.disagreements > 0 || !is_right;
}
