/* SPDX-License-Identifier: MIT */
#include "harness/experiments/phase_engines.h"

#include "base/exr.h"
#include "harness/engines/engines.h"
#include "harness/engines/program.h"
#include "harness/run/seed.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* COSINES: of the doubling, at Chebyshev points, between which light of higher orders is
 * interpolated. Against 48 points the mean of the aureole changes by 2e-3, of others by 5e-4. */
enum { VIEWS = 2, COSINES = 24 };

const struct neph_angle_range neph_angle_ranges[NEPH_ANGLE_RANGES] = {
    {0, 10, "aureole"}, {10, 60, "forward"},    {60, 120, "side"},
    {120, 150, "bow"},  {150, 176, "backward"}, {176, 181, "glory"},
};

static const double fov_deg = 110.0;
static const double lowest_cosine = 0.12; /* to the vertical: of the directions compared */

struct neph_phase_frames {
    struct neph_phase_cloud cloud;
    int width_px, height_px;
    double cosines[COSINES];
    struct neph_slab *slab;
    struct neph_stage *stages[VIEWS];
    double *truth[VIEWS]; /* radiance of each pixel [W m^-2 sr^-1]; NaN: not compared */
    signed char *ranges[VIEWS];
};

/* ---- the truth ------------------------------------------------------------------------------- */

/* Light scattered once, over the irradiance [1/sr], in closed form. */
static double scatter_once_per_sr(const struct neph_phase_cloud *cloud, double cosine,
                                  double scattering_cosine, bool is_above)
{
    const double sun = sin(cloud->sun_elevation_deg * NEPH_RAD_PER_DEG),
                 depth = cloud->optical_depth;
    const double per_sr = cloud->albedo * neph_phase_per_sr(&cloud->droplets, scattering_cosine);
    if (is_above)
        return -per_sr * sun / (sun + cosine) * expm1(-depth * (1.0 / sun + 1.0 / cosine));
    const double slant = depth * (1.0 / cosine - 1.0 / sun);
    return per_sr * depth / cosine * exp(-depth / sun) *
           (fabs(slant) < 1e-9 ? 1.0 : -expm1(-slant) / slant);
}

static double scattering_cosine(const struct neph_phase_cloud *cloud, double cosine,
                                double azimuth_rad, bool is_above)
{
    const double sun = sin(cloud->sun_elevation_deg * NEPH_RAD_PER_DEG);
    return (is_above ? -1.0 : 1.0) * cosine * sun +
           sqrt((1.0 - cosine * cosine) * (1.0 - sun * sun)) * cos(azimuth_rad);
}

/* Light of all orders: of the first in closed form, of the others interpolated between cosines as
 * in stage.c. */
static double truth_per_sr(const struct neph_phase_frames *frames, double cosine,
                           double azimuth_rad, bool is_above)
{
    const struct neph_phase_cloud *cloud = &frames->cloud;
    double sum = 0.0, weights = 0.0;
    for (int i = 0; i < COSINES; i++) {
        const double at = frames->cosines[i];
        const double all = is_above ? neph_slab_reflected_per_sr(frames->slab, i, azimuth_rad)
                                    : neph_slab_transmitted_per_sr(frames->slab, i, azimuth_rad);
        const double once = scatter_once_per_sr(
            cloud, at, scattering_cosine(cloud, at, azimuth_rad, is_above), is_above);
        const double off = cosine - at, end = i == 0 || i == COSINES - 1 ? 0.5 : 1.0;
        const double weight = (i % 2 ? -end : end) / (off == 0.0 ? 1e-300 : off);
        sum += weight * (all - once);
        weights += weight;
    }
    return sum / weights +
           scatter_once_per_sr(cloud, cosine,
                               scattering_cosine(cloud, cosine, azimuth_rad, is_above), is_above);
}

static int find_range(double angle_deg)
{
    int range = 0;
    while (range < NEPH_ANGLE_RANGES - 1 && angle_deg >= neph_angle_ranges[range].to_deg)
        range++;
    return range;
}

static void fill_view(struct neph_phase_frames *frames, int view)
{
    const struct neph_camera camera = neph_scene_camera(&frames->stages[view]->scene, 0.0);
    for (int i = 0; i < frames->width_px * frames->height_px; i++) {
        const struct neph_vec3 ray = neph_camera_ray(&camera, frames->width_px, frames->height_px,
                                                     i % frames->width_px, i / frames->width_px)
                                         .direction;
        const bool is_above = view == 1;
        const double cosine = is_above ? -ray.y : ray.y;
        frames->truth[view][i] = NAN;
        frames->ranges[view][i] = -1;
        if (cosine < lowest_cosine)
            continue;
        /* The sun is at +x; light to the camera travels along -ray. */
        const double azimuth_rad = atan2(ray.z, ray.x);
        const double angle = acos(fmax(
            -1.0, fmin(1.0, scattering_cosine(&frames->cloud, cosine, azimuth_rad, is_above))));
        frames->ranges[view][i] = (signed char)find_range(angle / NEPH_RAD_PER_DEG);
        frames->truth[view][i] = NEPH_STAGE_IRRADIANCE_W_PER_M2 *
                                 truth_per_sr(frames, cosine, azimuth_rad, is_above);
    }
}

static enum neph_status solve(struct neph_phase_frames *frames, struct neph_diag *diag)
{
    const struct neph_phase_cloud *cloud = &frames->cloud;
    for (int i = 0; i < COSINES; i++)
        frames->cosines[i] = 0.5 * (1.0 + lowest_cosine) +
                             0.5 * (1.0 - lowest_cosine) * cos(M_PI * i / (COSINES - 1));
    return neph_slab_create(
        &(struct neph_slab_params){.optical_depth = cloud->optical_depth,
                                   .albedo = cloud->albedo,
                                   .phase = cloud->droplets,
                                   .sun_cosine = sin(cloud->sun_elevation_deg * NEPH_RAD_PER_DEG),
                                   .view_count = COSINES,
                                   .view_cosines = frames->cosines,
                                   .node_count = cloud->node_count,
                                   .with_any_peak = true},
        &frames->slab, diag);
}

/* A stage whose own reference costs nothing: it is not used. */
static enum neph_status create_stage(const struct neph_phase_frames *frames, int view,
                                     const struct neph_phase *phase, struct neph_stage **stage,
                                     struct neph_diag *diag)
{
    const double sun_rad = frames->cloud.sun_elevation_deg * NEPH_RAD_PER_DEG;
    const struct neph_stage_params params = {
        .name = "phase_study",
        .medium = NEPH_STAGE_SLAB,
        .truth = NEPH_STAGE_TRUTH_HALF_SPACE,
        .optical_depth = frames->cloud.optical_depth,
        .albedo = frames->cloud.albedo,
        .phase = *phase,
        .sun_cosine = sin(sun_rad),
        .view_azimuth_rad = view == 1 ? M_PI : 0.0,
        .view_elevation_rad = view == 1 ? -sun_rad : sun_rad,
        .vertical_fov_rad = fov_deg * NEPH_RAD_PER_DEG,
        .aspect = (double)frames->width_px / frames->height_px,
    };
    return neph_stage_create(&params, stage, diag);
}

enum neph_status neph_phase_frames_create(const struct neph_phase_cloud *cloud, int width_px,
                                          int height_px, struct neph_phase_frames **frames,
                                          struct neph_diag *diag)
{
    struct neph_phase_frames *made = calloc(1, sizeof(*made));
    if (!made)
        return neph_fail_memory(diag);
    *made = (struct neph_phase_frames){
        .cloud = *cloud, .width_px = width_px, .height_px = height_px};
    const size_t pixels = (size_t)width_px * (size_t)height_px;
    enum neph_status status = solve(made, diag);
    for (int view = 0; view < VIEWS && !status; view++) {
        made->truth[view] = calloc(pixels, sizeof(double));
        made->ranges[view] = calloc(pixels, 1);
        status = made->truth[view] && made->ranges[view] ? NEPH_OK : neph_fail_memory(diag);
        if (!status)
            status = create_stage(made, view, &cloud->droplets, &made->stages[view], diag);
        if (!status)
            fill_view(made, view);
    }
    if (status)
        neph_phase_frames_destroy(made);
    else
        *frames = made;
    return status;
}

void neph_phase_frames_destroy(struct neph_phase_frames *frames)
{
    for (int view = 0; frames && view < VIEWS; view++) {
        neph_stage_destroy(frames->stages[view]);
        free(frames->truth[view]);
        free(frames->ranges[view]);
    }
    if (frames)
        neph_slab_destroy(frames->slab);
    free(frames);
}

/* ---- engines --------------------------------------------------------------------------------- */

enum neph_status neph_phase_engine_find(const char *words, struct neph_shared_device *device,
                                        struct neph_phase_engine *engine, struct neph_diag *diag)
{
    char *copy = strdup(words), *rest = copy;
    if (!copy)
        return neph_fail_memory(diag);
    const char *name = strsep(&rest, "+");
    struct neph_phase_engine made = {.words = words, .engine = neph_engine_find(name)};
    enum neph_status status = NEPH_OK;
    if (!made.engine) {
        status = neph_fail(diag, NEPH_ERR_USAGE, "--engine: there is no engine '%s'", name);
        neph_hint(diag, "`neph engines` lists them");
    } else {
        made.settings = neph_settings_default(made.engine);
    }
    while (rest && !status)
        status = neph_settings_set(made.engine, &made.settings, strsep(&rest, "+"), diag);
    free(copy);
    if (status)
        return status;
    neph_engine_probe(made.engine, device, &made.info);
    *engine = made;
    return NEPH_OK;
}

/* Without a store: in a folder that is removed. */
static enum neph_status render_apart(const struct neph_job *job, struct neph_image **frame,
                                     struct neph_diag *diag)
{
    struct neph_cost cost;
    struct neph_scratch *folder = NULL;
    struct neph_job placed = *job;
    enum neph_status status = neph_program_make_folder("neph-phase-", &folder, diag);
    if (!status) {
        placed.shot.scratch_directory = neph_scratch_path(folder);
        status = neph_job_render(&placed, frame, &cost, diag);
    }
    neph_scratch_destroy(folder);
    return status;
}

static enum neph_status render(const struct neph_job *job, struct neph_store *store,
                               struct neph_image **frame, struct neph_diag *diag)
{
    struct neph_job_result result = {.settings = NULL};
    enum neph_status status = neph_job_check(job, diag);
    if (status)
        return status;
    if (!store)
        return render_apart(job, frame, diag);
    status = neph_job_run(job, store, &result, diag);
    if (!status)
        status = neph_outcome_check(result.outcome, result.reason, diag);
    if (!status)
        status = neph_exr_read(result.frame_path, frame, diag);
    neph_job_result_finish(&result);
    return status;
}

/* Sums over the pixels of each range. */
struct sums {
    double light[NEPH_ANGLE_RANGES], squares[NEPH_ANGLE_RANGES]; /* over the seeds */
    double truth[NEPH_ANGLE_RANGES], rms[NEPH_ANGLE_RANGES];
    int count[NEPH_ANGLE_RANGES];
};

/* Add the mean frame of a view to `light`. */
static enum neph_status add_frame(const struct neph_phase_frames *frames, int view,
                                  const struct neph_image *frame, double *sum,
                                  double light[NEPH_ANGLE_RANGES], struct neph_diag *diag)
{
    float *rgb[3];
    if (!neph_image_rgb(frame, NULL, rgb))
        return neph_fail(diag, NEPH_ERR_ENGINE, "a frame without radiance");
    for (int i = 0; i < frames->width_px * frames->height_px; i++) {
        const int range = frames->ranges[view][i];
        sum[i] += rgb[1][i];
        if (range >= 0)
            light[range] += rgb[1][i];
    }
    return NEPH_OK;
}

static void add_pixels(const struct neph_phase_frames *frames, int view, const double *sum,
                       int seed_count, struct sums *sums)
{
    for (int i = 0; i < frames->width_px * frames->height_px; i++) {
        const int range = frames->ranges[view][i];
        if (range < 0)
            continue;
        const double truth = frames->truth[view][i];
        sums->truth[range] += truth;
        sums->rms[range] += pow(sum[i] / seed_count / truth - 1.0, 2.0);
        sums->count[range]++;
    }
}

static enum neph_status render_seeds(const struct neph_phase_engine *engine,
                                     const struct neph_phase_frames *frames,
                                     struct neph_stage *const stages[VIEWS], int seed_count,
                                     const struct neph_experiment_run *run, struct sums *sums,
                                     struct neph_diag *diag)
{
    const size_t pixels = (size_t)frames->width_px * (size_t)frames->height_px;
    double *means = calloc(VIEWS * pixels, sizeof(*means));
    enum neph_status status = means ? NEPH_OK : neph_fail_memory(diag);
    for (int seed = 1; seed <= seed_count && !status; seed++) {
        double light[NEPH_ANGLE_RANGES] = {0};
        for (int view = 0; view < VIEWS && !status; view++) {
            struct neph_image *frame = NULL;
            struct neph_job job = {.engine = engine->engine, .info = &engine->info};
            job.shot = (struct neph_shot){.scene = &stages[view]->scene,
                                          .settings = engine->settings,
                                          .width_px = frames->width_px,
                                          .height_px = frames->height_px,
                                          .layers = NEPH_LAYER_RADIANCE,
                                          .seed = neph_seed_for_scene(&stages[view]->scene, seed),
                                          .time_limit_s = NEPH_USER_ENGINE_LIMIT_S,
                                          .device = run->device};
            status = render(&job, run->store, &frame, diag);
            if (!status)
                status = add_frame(frames, view, frame, means + (size_t)view * pixels, light, diag);
            neph_image_destroy(frame);
        }
        for (int r = 0; r < NEPH_ANGLE_RANGES; r++) {
            sums->light[r] += light[r];
            sums->squares[r] += light[r] * light[r];
        }
    }
    for (int view = 0; view < VIEWS && !status; view++)
        add_pixels(frames, view, means + (size_t)view * pixels, seed_count, sums);
    free(means);
    return status;
}

static void conclude(const struct sums *sums, int n,
                     struct neph_phase_difference found[NEPH_ANGLE_RANGES])
{
    for (int r = 0; r < NEPH_ANGLE_RANGES; r++) {
        const double mean = sums->light[r] / n;
        const double variance = n > 1 ? fmax(0.0, sums->squares[r] / n - mean * mean) / (n - 1)
                                      : NAN;
        if (sums->count[r] > 0)
            found[r] = (struct neph_phase_difference){
                mean / sums->truth[r] - 1.0, sqrt(variance) / sums->truth[r],
                sqrt(sums->rms[r] / sums->count[r]), sums->count[r]};
    }
}

static enum neph_status set_single(struct neph_stage *const stages[VIEWS], struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int view = 0; view < VIEWS && !status; view++) {
        stages[view]->scene.scattering = NEPH_SCATTERING_SINGLE;
        status = neph_scene_hash(&stages[view]->scene, diag);
    }
    return status;
}

/* Whether a failure is a fact about an engine, to be reported in the table. */
static bool is_reported(enum neph_status status)
{
    return status == NEPH_ERR_UNSUPPORTED || status == NEPH_ERR_UNAVAILABLE ||
           status == NEPH_ERR_ENGINE || status == NEPH_ERR_TIMEOUT;
}

static enum neph_status render_orders(const struct neph_phase_engine *engine,
                                      const struct neph_phase_frames *frames,
                                      struct neph_stage *const stages[VIEWS], int seed_count,
                                      const struct neph_experiment_run *run, struct sums *sums,
                                      char note[256], struct neph_diag *diag)
{
    enum neph_status status = render_seeds(engine, frames, stages, seed_count, run, sums, diag);
    if (status != NEPH_ERR_UNSUPPORTED)
        return status;
    struct neph_diag again = {0};
    *sums = (struct sums){{0}};
    status = set_single(stages, &again);
    if (!status)
        status = render_seeds(engine, frames, stages, seed_count, run, sums, &again);
    if (!status)
        snprintf(note, 256, "single scattering");
    else
        *diag = again;
    return status;
}

enum neph_status neph_phase_engine_measure(const struct neph_phase_engine *engine,
                                           const struct neph_phase_frames *frames,
                                           const struct neph_phase *phase, int seed_count,
                                           const struct neph_experiment_run *run,
                                           struct neph_phase_difference found[NEPH_ANGLE_RANGES],
                                           char note[256], struct neph_diag *diag)
{
    static const char cannot[] = "cannot: "; /* of neph_job_check() */
    struct neph_diag reason = {0};
    struct neph_stage *stages[VIEWS] = {NULL};
    struct sums sums = {{0}};
    const int seeds = engine->engine->stochastic ? seed_count : 1;
    enum neph_status status = NEPH_OK;
    note[0] = '\0';
    for (int r = 0; r < NEPH_ANGLE_RANGES; r++)
        found[r] = (struct neph_phase_difference){NAN, NAN, NAN, 0};
    for (int view = 0; view < VIEWS && !status; view++)
        status = create_stage(frames, view, phase, &stages[view], &reason);
    if (!status)
        status = render_orders(engine, frames, stages, seeds, run, &sums, note, &reason);
    if (!status)
        conclude(&sums, seeds, found);
    else if (is_reported(status))
        snprintf(note, 256, "not rendered: %.240s",
                 reason.message +
                     (strncmp(reason.message, cannot, strlen(cannot)) ? 0 : strlen(cannot)));
    else
        *diag = reason;
    for (int view = 0; view < VIEWS; view++)
        neph_stage_destroy(stages[view]);
    return is_reported(status) ? NEPH_OK : status;
}
