/* SPDX-License-Identifier: MIT */
#include "tests/random_scenes/compare.h"

#include "base/clock.h"
#include "base/image.h"
#include "metrics/significance.h"
#include "renderer/march.h"
#include "renderer/tracer.h"
#include "scenes/media.h"
#include "tests/random_scenes/recipe.h"
#include "truth/oracle.h"
#include "truth/transport.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const compare_engine_names[COMPARE_ENGINES] = {"exact", "oracle", "tracer", "march"};

static const struct {
    enum compare_engine test, truth;
} pairs[PAIR_COUNT] = {
    [PAIR_ORACLE_EXACT] = {COMPARE_ORACLE, COMPARE_EXACT},
    [PAIR_TRACER_EXACT] = {COMPARE_TRACER, COMPARE_EXACT},
    [PAIR_TRACER_ORACLE] = {COMPARE_TRACER, COMPARE_ORACLE},
    [PAIR_MARCH_EXACT] = {COMPARE_MARCH, COMPARE_EXACT},
    [PAIR_MARCH_ORACLE] = {COMPARE_MARCH, COMPARE_ORACLE},
};

/* Paths of a pixel in one batch, by stage. */
static const int oracle_samples[COMPARE_STAGES] = {192, 1536, 12288};
static const int tracer_samples[COMPARE_STAGES] = {192, 1536, 12288};
/* Nodes of the tracer's table of sunlight: its own default is for frames of many pixels. */
enum { SUN_NODES = 4096 };
/* Steps of a ray, by level. None is nearly a multiple of another: steps of a 64th and of an eighth
 * of a ray would meet a face near its beginning at the same position, with the same error. */
enum { LEVELS = 5 };
static const int march_steps[LEVELS] = {61, 409, 2753, 18521, 62743};

/* The relative accuracy of float32 for a radiance that is a sum of products (test_tracer.c). Noise
 * above 10 times this adds at most 1 / 100 to the variance of z-scores. */
static const double rounding = 2e-6, noisy = 10.0;
/* Closed forms in float32, for pixels without noise: chosen as 100 times `rounding`, for optical
 * depths of a few dozen at distances a thousand times the size of the media. */
static const double float_tolerance = 2e-4;
/* A pixel's variance is known when its relative error is below this: 50 degrees of freedom. */
static const double unsure_most = 0.2;
/* A scene has about 24 pixels for each of three pairs: one scene in about a hundred is rendered
 * again without need. */
static const double suspicious_p = 1e-4;
/* Light that a fraction 7 / n of paths finds is missed by all n paths once in e^7 = 1100 pixels,
 * and their scatter does not show it: light of this fraction of the brightest in the scene is no
 * disagreement. */
static const double unseen_paths = 7.0;
/* 2,000 scenes of 75 tests each give one false alarm in a thousand nights at this level. */
static const double certain_p = 1e-8;

/* ---- readings -------------------------------------------------------------------------------- */

struct reading {
    bool is_there, is_noisy;
    double mean[3][COMPARE_PIXELS], variance[3][COMPARE_PIXELS];
    double unsure[3][COMPARE_PIXELS];
    double through[3][COMPARE_PIXELS];
};

struct comparison {
    const struct compare_request *request;
    struct compare_result *result;
    struct reading readings[COMPARE_ENGINES];
    bool is_cloudy; /* no closed form of the transmittance */
};

static void add_finding(struct comparison *comparison, enum compare_engine test,
                        enum compare_engine truth, const char *what)
{
    struct compare_result *result = comparison->result;
    if (result->finding_count >= PAIR_COUNT + COMPARE_ENGINES)
        return;
    struct compare_finding *finding = &result->findings[result->finding_count++];
    *finding = (struct compare_finding){true, test, truth, ""};
    snprintf(finding->what, sizeof(finding->what), "%s", what);
}

static bool takes_part(const struct comparison *comparison, enum compare_engine engine)
{
    return comparison->request->engines >> engine & 1u;
}

/* An engine that does not support the scene reports it and is skipped; any other missing frame is a
 * finding. */
static void set_aside(struct comparison *comparison, enum compare_engine engine,
                      enum neph_status status, const char *reason)
{
    snprintf(comparison->result->refusals[engine], sizeof(comparison->result->refusals[engine]),
             "%s", reason);
    if (status == NEPH_ERR_UNSUPPORTED)
        return;
    char what[400];
    snprintf(what, sizeof(what), "%s fails: %s: %.300s", compare_engine_names[engine],
             neph_status_name(status), reason);
    add_finding(comparison, engine, engine, what);
}

/* The first invalid value of a frame; NULL: none. */
static const char *find_bad_value(const struct neph_image *frame, int *pixel, double *value)
{
    for (int c = 0; c < frame->channel_count; c++)
        for (int i = 0; i < COMPARE_PIXELS; i++) {
            const float sample = frame->channels[c].samples[i];
            const bool may_be_infinite = strcmp(frame->channels[c].name, "Z") == 0 ||
                                         strcmp(frame->channels[c].name, "volume.distance") == 0;
            if (sample >= 0.0f && (isfinite(sample) || may_be_infinite))
                continue;
            *pixel = i;
            *value = (double)sample;
            return frame->channels[c].name;
        }
    return NULL;
}

static bool check_values(struct comparison *comparison, enum compare_engine engine,
                         const struct neph_image *frame)
{
    int pixel;
    double value;
    const char *channel = find_bad_value(frame, &pixel, &value);
    if (!channel)
        return true;
    char what[400];
    snprintf(what, sizeof(what), "%s gives %s = %g in pixel (%d, %d)", compare_engine_names[engine],
             channel, value, pixel % RECIPE_WIDTH_PX, pixel / RECIPE_WIDTH_PX);
    add_finding(comparison, engine, engine, what);
    return false;
}

/* ---- exact ----------------------------------------------------------------------------------- */

static void put_rgb(double to[3][COMPARE_PIXELS], int pixel, struct neph_rgb value)
{
    to[0][pixel] = value.r;
    to[1][pixel] = value.g;
    to[2][pixel] = value.b;
}

static bool is_good(struct neph_rgb c)
{
    return c.r >= 0.0 && c.g >= 0.0 && c.b >= 0.0 && isfinite(c.r) && isfinite(c.g) &&
           isfinite(c.b);
}

static void read_exact(struct comparison *comparison)
{
    const struct neph_scene *scene = comparison->request->still;
    struct reading *reading = &comparison->readings[COMPARE_EXACT];
    char reason[200];
    if (!neph_transport_is_exact(scene, reason, sizeof(reason))) {
        set_aside(comparison, COMPARE_EXACT, NEPH_ERR_UNSUPPORTED, reason);
        return;
    }
    const double start_s = neph_wall_s();
    const struct neph_camera camera = neph_scene_camera(scene, 0.0);
    for (int i = 0; i < COMPARE_PIXELS; i++) {
        const struct neph_pixel_ray ray = neph_camera_ray(
            &camera, RECIPE_WIDTH_PX, RECIPE_HEIGHT_PX, i % RECIPE_WIDTH_PX, i / RECIPE_WIDTH_PX);
        const struct neph_ray_light light = neph_transport_ray(scene, ray.origin_m, ray.direction);
        put_rgb(reading->mean, i, light.radiance);
        put_rgb(reading->through, i, light.transmittance);
        if (is_good(light.radiance) && is_good(light.transmittance))
            continue;
        char what[200];
        snprintf(what, sizeof(what), "exact gives %g %g %g in pixel (%d, %d)", light.radiance.r,
                 light.radiance.g, light.radiance.b, i % RECIPE_WIDTH_PX, i / RECIPE_WIDTH_PX);
        add_finding(comparison, COMPARE_EXACT, COMPARE_EXACT, what);
        return;
    }
    reading->is_there = true;
    comparison->result->seconds[COMPARE_EXACT] += neph_wall_s() - start_s;
}

/* ---- engines with noise ---------------------------------------------------------------------- */

struct batches {
    double sum[3][COMPARE_PIXELS];
    double variance_sum[3][COMPARE_PIXELS], variance_squares[3][COMPARE_PIXELS];
    double through[3][COMPARE_PIXELS];
};

static bool add_batch(struct batches *batches, const struct neph_image *frame)
{
    float *radiance[3], *variance[3], *through[3];
    if (!neph_image_rgb(frame, NULL, radiance) || !neph_image_rgb(frame, "variance", variance) ||
        !neph_image_rgb(frame, "transmittance", through))
        return false;
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < COMPARE_PIXELS; i++) {
            const double spread = (double)variance[c][i];
            batches->sum[c][i] += (double)radiance[c][i];
            batches->variance_sum[c][i] += spread;
            batches->variance_squares[c][i] += spread * spread;
            batches->through[c][i] = (double)through[c][i];
        }
    return true;
}

static void finish_batches(const struct batches *batches, struct reading *reading)
{
    const double n = COMPARE_BATCHES;
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < COMPARE_PIXELS; i++) {
            const double mean = batches->variance_sum[c][i] / n;
            const double scatter = fmax(0.0, batches->variance_squares[c][i] / n - mean * mean) *
                                   n / (n - 1.0);
            reading->mean[c][i] = batches->sum[c][i] / n;
            reading->variance[c][i] = mean / n;
            reading->unsure[c][i] = mean > 0.0 ? sqrt(scatter / n) / mean : 0.0;
            reading->through[c][i] = batches->through[c][i];
        }
    reading->is_there = reading->is_noisy = true;
}

static enum neph_status render_oracle(const struct compare_request *request, uint64_t seed,
                                      int samples, struct neph_image **frame,
                                      struct neph_diag *diag)
{
    const struct neph_oracle_params params = {.width_px = RECIPE_WIDTH_PX,
                                              .height_px = RECIPE_HEIGHT_PX,
                                              .seed = seed,
                                              .samples = samples,
                                              .time_limit_s = INFINITY};
    return neph_oracle_render(request->still, &params, frame, NULL, diag);
}

static enum neph_status render_tracer(const struct compare_request *request, uint64_t seed,
                                      int samples, struct neph_image **frame,
                                      struct neph_diag *diag)
{
    const struct neph_tracer_params params = {.width_px = RECIPE_WIDTH_PX,
                                              .height_px = RECIPE_HEIGHT_PX,
                                              .seed = seed,
                                              .sun_nodes = SUN_NODES,
                                              .samples = samples,
                                              .time_limit_s = INFINITY};
    return neph_tracer_render(request->vulkan, request->written, &params, frame, NULL, diag);
}

typedef enum neph_status render_batch(const struct compare_request *request, uint64_t seed,
                                      int samples, struct neph_image **frame,
                                      struct neph_diag *diag);

/* False: it is skipped, and the result has the reason. */
static enum neph_status read_noisy(struct comparison *comparison, enum compare_engine engine,
                                   render_batch *render, int samples, int stage,
                                   struct neph_diag *diag)
{
    struct batches batches = {.sum = {{0.0}}};
    const double start_s = neph_wall_s();
    for (int b = 0; b < COMPARE_BATCHES; b++) {
        struct neph_image *frame = NULL;
        struct neph_diag said = {0};
        const uint64_t seed = comparison->request->seed * 1000003u +
                              (uint64_t)(100 * engine + 10 * stage + b);
        const enum neph_status status = render(comparison->request, seed, samples, &frame, &said);
        if (status == NEPH_ERR_INTERRUPTED || status == NEPH_ERR_MEMORY) {
            *diag = said;
            return status;
        }
        const bool is_read = !status && check_values(comparison, engine, frame) &&
                             add_batch(&batches, frame);
        neph_image_destroy(frame);
        if (status)
            set_aside(comparison, engine, status, said.message);
        if (!is_read)
            return NEPH_OK;
    }
    finish_batches(&batches, &comparison->readings[engine]);
    comparison->result->seconds[engine] += neph_wall_s() - start_s;
    return NEPH_OK;
}

/* ---- probabilities --------------------------------------------------------------------------- */

/* The difference of two readings in a pixel. */
struct difference {
    double value, error; /* standard error; 0: neither has significant noise */
    double dof;
    double size; /* the larger of both readings */
    bool is_sure;
    bool is_seen;    /* too large to be light that the paths have missed */
    bool has_missed; /* all paths of a tracer had the same value: their scatter is no estimate */
};

static struct difference difference_at(const struct reading *test, const struct reading *truth,
                                       int channel, int pixel)
{
    const double a = test->variance[channel][pixel], b = truth->variance[channel][pixel];
    const double mean_a = test->mean[channel][pixel], mean_b = truth->mean[channel][pixel];
    struct difference made = {.value = mean_a - mean_b, .size = fmax(mean_a, mean_b)};
    made.error = sqrt(a + b);
    made.has_missed = (a == 0.0 && test->is_noisy) || (b == 0.0 && truth->is_noisy);
    if (made.error <= noisy * rounding * made.size) {
        made.error = 0.0;
        return made;
    }
    const double unsure =
        hypot(a * test->unsure[channel][pixel], b * truth->unsure[channel][pixel]) / (a + b);
    /* The batches are too few to show that a variance is known exactly. */
    made.dof = fmin(2.0 / fmax(unsure * unsure, 1e-12), 1e4);
    made.is_sure = unsure <= unsure_most;
    if (made.has_missed) {
        made.dof = 1.0;
        made.is_sure = false;
    }
    return made;
}

struct suspect {
    double p;           /* the smallest */
    int pixel, channel; /* pixel -1: the sum over all */
    struct difference difference;
};

static void suspect_if(struct suspect *suspect, double p, int pixel, int channel,
                       struct difference difference)
{
    /* A difference that may be missed light causes more paths, but no finding. */
    const double weight = difference.is_seen ? p : fmax(p, 0.1 * suspicious_p);
    if (weight < suspect->p && (difference.is_seen || p < suspicious_p))
        *suspect = (struct suspect){weight, pixel, channel, difference};
}

static void score(struct compare_scores *scores, const struct difference *difference)
{
    if (difference->error == 0.0) {
        scores->without_noise++;
        return;
    }
    const double z = difference->value / difference->error;
    const bool is_rare = !difference->is_seen && neph_student_p(z, difference->dof) < suspicious_p;
    scores->rare += is_rare;
    if (is_rare)
        return;
    if (!difference->is_sure) {
        scores->unsure++;
        scores->unsure_square_sum += z * z;
        return;
    }
    scores->count++;
    scores->sum += z;
    scores->square_sum += z * z;
    scores->expected_sum += difference->dof / (difference->dof - 2.0);
}

void compare_add_scores(struct compare_scores *sum, const struct compare_scores *part)
{
    sum->count += part->count;
    sum->sum += part->sum;
    sum->square_sum += part->square_sum;
    sum->expected_sum += part->expected_sum;
    sum->unsure += part->unsure;
    sum->unsure_square_sum += part->unsure_square_sum;
    sum->rare += part->rare;
    sum->without_noise += part->without_noise;
}

static double largest_of(struct neph_rgb c)
{
    return fmax(c.r, fmax(c.g, c.b));
}

/* The brightest radiance of a scene [W m^-2 sr^-1]: of its pixels, of its media's emission, and of
 * the background where it lights the media. */
static double find_peak(const struct neph_scene *scene, const struct reading *a,
                        const struct reading *b)
{
    double peak = 0.0;
    for (int i = 0; i < 3 * COMPARE_PIXELS; i++)
        peak = fmax(peak, fmax(a->mean[i % 3][i / 3], b->mean[i % 3][i / 3]));
    for (int m = 0; m < scene->medium_count; m++)
        peak = fmax(peak, largest_of(scene->media[m].emission_w_per_m2_sr));
    return scene->environment_light ? fmax(peak, largest_of(scene->background_w_per_m2_sr)) : peak;
}

/* The largest value of a phase function [1/sr], limited to 1: its peak is narrow. */
static double phase_peak_per_sr(const struct neph_scene *scene)
{
    double peak = 0.0;
    for (int m = 0; m < scene->medium_count; m++)
        peak = fmax(peak, fmax(neph_phase_per_sr(&scene->media[m].phase, 1.0),
                               neph_phase_per_sr(&scene->media[m].phase, -1.0)));
    return fmin(peak, 1.0);
}

/* The approximate contribution of one path from the sun and from point lights, as seen across the
 * view. */
static double source_peak(const struct neph_scene *scene)
{
    const struct neph_camera_key *key = &scene->camera_keys[0];
    const struct neph_vec3 view_m = neph_vec3_sub(key->look_at_m, key->position_m);
    double sum = scene->sun.present ? largest_of(scene->sun.irradiance_w_per_m2) : 0.0;
    for (int l = 0; l < scene->light_count; l++)
        sum += largest_of(scene->lights[l].intensity_w_per_sr) / neph_vec3_dot(view_m, view_m);
    return scene->scattering == NEPH_SCATTERING_NONE ? 0.0 : sum * phase_peak_per_sr(scene);
}

/* Light that this number of paths may have missed; and where all paths had the same value. */
struct unseen {
    double by_some, by_all;
};

static struct unseen find_unseen(const struct neph_scene *scene, const struct reading *a,
                                 const struct reading *b, int stage)
{
    const double part = unseen_paths / (COMPARE_BATCHES * oracle_samples[stage]);
    const double peak = find_peak(scene, a, b);
    return (struct unseen){part * peak, part * fmax(peak, source_peak(scene))};
}

/* One channel of each pixel is tested, in turn, as channels share their paths. */
static struct suspect find_suspect(const struct reading *test, const struct reading *truth,
                                   struct unseen unseen, struct compare_scores *scores)
{
    struct suspect suspect = {.p = 1.0};
    struct difference sum = {.dof = 1e4};
    double variance = 0.0, unsure = 0.0;
    for (int i = 0; i < COMPARE_PIXELS; i++) {
        const int channel = (i + i / RECIPE_WIDTH_PX) % 3;
        struct difference found = difference_at(test, truth, channel, i);
        sum.size += found.size;
        const double allowed = float_tolerance * found.size;
        found.is_seen = fabs(found.value) >
                        allowed + (found.has_missed ? unseen.by_all : unseen.by_some);
        score(scores, &found);
        if (found.error == 0.0) {
            const double p = fabs(found.value) > allowed ? 0.0 : 1.0;
            suspect_if(&suspect, p, i, channel, found);
            continue;
        }
        const double square = found.error * found.error;
        sum.value += found.value;
        variance += square;
        unsure += square * square * 2.0 / found.dof;
        suspect_if(&suspect, neph_student_p(found.value / found.error, found.dof), i, channel,
                   found);
    }
    if (variance > 0.0) {
        sum.error = hypot(sqrt(variance), rounding * sum.size);
        sum.dof = fmin(2.0 * variance * variance / fmax(unsure, 1e-300), 1e4);
        sum.is_seen = fabs(sum.value) >
                      float_tolerance * sum.size + unseen.by_some * COMPARE_PIXELS;
        suspect_if(&suspect, neph_student_p(sum.value / sum.error, sum.dof), -1, 0, sum);
    }
    return suspect;
}

static void describe(const struct comparison *comparison, enum compare_pair pair,
                     const struct suspect *suspect, int stage, char what[400])
{
    const enum compare_engine test = pairs[pair].test, truth = pairs[pair].truth;
    const struct difference *difference = &suspect->difference;
    char place[60] = "the sum over the pixels";
    double a = difference->value, b = 0.0;
    if (suspect->pixel >= 0) {
        snprintf(place, sizeof(place), "pixel (%d, %d), channel %c",
                 suspect->pixel % RECIPE_WIDTH_PX, suspect->pixel / RECIPE_WIDTH_PX,
                 "RGB"[suspect->channel]);
        a = comparison->readings[test].mean[suspect->channel][suspect->pixel];
        b = comparison->readings[truth].mean[suspect->channel][suspect->pixel];
    }
    snprintf(what, 400,
             "%s: %s %.7g, %s %.7g, difference %+.3g (%+.3g %%), standard error %.2g, z %.1f, "
             "%.0f degrees of freedom, p %.1e, stage %d",
             place, compare_engine_names[test], a, compare_engine_names[truth], b,
             difference->value, 100.0 * difference->value / fmax(difference->size, 1e-300),
             difference->error, difference->error > 0.0 ? difference->value / difference->error : 0,
             difference->dof, suspect->p, stage);
}

/* ---- transmittance --------------------------------------------------------------------------- */

/* Transmittances without noise, of all engines, against the first available one. */
static void check_through(struct comparison *comparison)
{
    int first = 0;
    while (first < COMPARE_ENGINES && !comparison->readings[first].is_there)
        first++;
    for (int e = first + 1; e < COMPARE_ENGINES && !comparison->is_cloudy; e++)
        for (int i = 0; i < COMPARE_PIXELS && comparison->readings[e].is_there; i++) {
            const int c = i % 3;
            const double a = comparison->readings[e].through[c][i];
            const double b = comparison->readings[first].through[c][i];
            if (fabs(a - b) <= float_tolerance)
                continue;
            char what[300];
            snprintf(what, sizeof(what),
                     "transmittance of pixel (%d, %d), channel %c: %s %.7g, %s %.7g",
                     i % RECIPE_WIDTH_PX, i / RECIPE_WIDTH_PX, "RGB"[c], compare_engine_names[e], a,
                     compare_engine_names[first], b);
            add_finding(comparison, (enum compare_engine)e, (enum compare_engine)first, what);
            break;
        }
}

/* ---- march ----------------------------------------------------------------------------------- */

static enum neph_status march_once(struct comparison *comparison, int steps,
                                   struct reading *reading, struct neph_diag *diag)
{
    const struct compare_request *request = comparison->request;
    const struct neph_march_params params = {.width_px = RECIPE_WIDTH_PX,
                                             .height_px = RECIPE_HEIGHT_PX,
                                             .steps = steps,
                                             .sun_steps = steps};
    struct neph_march *march = NULL;
    struct neph_image *image = NULL;
    const double start_s = neph_wall_s();
    enum neph_status status = neph_march_create(request->vulkan, request->written, &params, &march,
                                                diag);
    if (!status)
        status = neph_march_frame(march, request->written, 0.0, NULL, &image, NULL, diag);
    float *radiance[3], *through[3];
    reading->is_there = !status && check_values(comparison, COMPARE_MARCH, image) &&
                        neph_image_rgb(image, NULL, radiance) &&
                        neph_image_rgb(image, "transmittance", through);
    for (int c = 0; c < 3 && reading->is_there; c++)
        for (int i = 0; i < COMPARE_PIXELS; i++) {
            reading->mean[c][i] = (double)radiance[c][i];
            reading->through[c][i] = (double)through[c][i];
        }
    neph_image_destroy(image);
    neph_march_destroy(march);
    comparison->result->seconds[COMPARE_MARCH] += neph_wall_s() - start_s;
    return status;
}

/* The known relative error of a march next to a light; +inf: the pixel is skipped.
 *
 * - float32 has positions on a ray at the distance d to about 2e-7 d. Light that a medium scatters
 *   next to a light is proportional to 1 / h, where h is the light's distance from the ray: its
 *   relative error is 2e-7 d / h. Both ends of a difference have it.
 * - A step that passes a light is divided into a few equal angles, and the phase function is
 *   evaluated once in each (march_lamps.glsl). This bias only falls when steps are shorter than h;
 *   no number of steps here is large enough if h is below a thousandth of the view. */
static double light_tolerance(const struct neph_scene *scene, int pixel)
{
    const struct neph_camera camera = neph_scene_camera(scene, 0.0);
    const struct neph_pixel_ray ray = neph_camera_ray(&camera, RECIPE_WIDTH_PX, RECIPE_HEIGHT_PX,
                                                      pixel % RECIPE_WIDTH_PX,
                                                      pixel / RECIPE_WIDTH_PX);
    const struct neph_camera_key *key = &scene->camera_keys[0];
    const double view_m = neph_vec3_length(neph_vec3_sub(key->look_at_m, key->position_m));
    double sum = 0.0;
    for (int l = 0; l < scene->light_count; l++) {
        const struct neph_vec3 way_m = neph_vec3_sub(scene->lights[l].position_m, ray.origin_m);
        const double t_m = fmax(0.0, neph_vec3_dot(way_m, ray.direction));
        const double off_m = neph_vec3_length(
            neph_vec3_sub(way_m, neph_vec3_scale(ray.direction, t_m)));
        if (off_m < 1e-3 * view_m)
            return INFINITY;
        sum += 4e-7 * neph_vec3_length(way_m) / off_m;
    }
    return sum;
}

/* The largest deviation from the truth, relative to the tolerance for rounding and noise. */
static struct suspect march_suspect(const struct neph_scene *scene, const struct reading *march,
                                    const struct reading *truth)
{
    const double unseen = truth->is_noisy ? find_unseen(scene, march, truth, 0).by_all : 0.0;
    /* A march omits light from behind e^-16 of an infinite fog (renderer/march.h). */
    const double cut = exp(-16.0) * fmax(find_peak(scene, march, truth), source_peak(scene));
    struct suspect worst = {.p = 1.0, .pixel = -1};
    double most = 1.0;
    double largest = 0.0;
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < COMPARE_PIXELS; i++)
            largest = fmax(largest, truth->mean[c][i]);
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < COMPARE_PIXELS; i++) {
            struct difference found = difference_at(march, truth, c, i);
            const double relative = float_tolerance + light_tolerance(scene, i);
            const double allowed = relative * truth->mean[c][i] + 1e-6 * largest + cut + unseen +
                                   6.0 * sqrt(truth->variance[c][i]) *
                                       (1.0 + 5.0 * truth->unsure[c][i]);
            if (isfinite(relative) && !(fabs(found.value) <= most * allowed)) {
                most = fabs(found.value) / allowed;
                worst = (struct suspect){1.0 / most, i, c, found};
            }
        }
    return worst;
}

/* Whether the remaining difference is explained by the steps. A first-order bias is at most a
 * constant over the number of steps, and the largest constant of the coarser levels is known. Twice
 * this is allowed, as the position of a face within a step is random; a constant deviation exceeds
 * it. */
static bool is_step_bias(const double worst[LEVELS], int level)
{
    double constant = 0.0;
    for (int coarser = 0; coarser < level; coarser++)
        constant = fmax(constant, worst[coarser] * march_steps[coarser]);
    return level >= 2 && worst[level] <= 2.0 * constant / march_steps[level];
}

static enum neph_status compare_march_levels(struct comparison *comparison,
                                             enum compare_engine truth, struct compare_march *tally,
                                             struct neph_diag *diag)
{
    struct reading levels[2] = {{.is_there = false}};
    const struct reading *expected = &comparison->readings[truth];
    struct suspect suspect = {.p = 1.0};
    double worst[LEVELS] = {0.0}; /* deviations relative to the tolerance for rounding and noise */
    enum neph_status status = NEPH_OK;
    int level = 0;
    for (; level < LEVELS && !status; level++) {
        levels[0] = levels[1];
        memset(&levels[1], 0, sizeof(levels[1]));
        struct neph_diag said = {0};
        status = march_once(comparison, march_steps[level], &levels[1], &said);
        if (status == NEPH_ERR_INTERRUPTED || status == NEPH_ERR_MEMORY) {
            *diag = said;
            return status;
        }
        if (status)
            set_aside(comparison, COMPARE_MARCH, status, said.message);
        if (!levels[1].is_there)
            return NEPH_OK;
        suspect = march_suspect(comparison->request->written, &levels[1], expected);
        worst[level] = suspect.pixel < 0 ? 0.0 : 1.0 / suspect.p;
        if (suspect.pixel < 0 || is_step_bias(worst, level))
            break;
        if (tally && level == 0)
            tally->largest_bias = fmax(tally->largest_bias,
                                       fabs(suspect.difference.value) / suspect.difference.size);
    }
    comparison->readings[COMPARE_MARCH] = levels[1];
    if (tally) {
        for (int i = 0; i < COMPARE_PIXELS; i++)
            tally->left_out += !isfinite(light_tolerance(comparison->request->written, i));
        tally->count++;
        tally->rounding += level == 0;
    }
    if (level < LEVELS)
        return NEPH_OK;
    const int c = suspect.channel, i = suspect.pixel;
    char what[400];
    snprintf(what, sizeof(what),
             "pixel (%d, %d), channel %c: march %.7g with %d steps and %.7g with %d, %s %.7g +- "
             "%.2g, off by %+.3g %%",
             i % RECIPE_WIDTH_PX, i / RECIPE_WIDTH_PX, "RGB"[c], levels[0].mean[c][i],
             march_steps[LEVELS - 2], levels[1].mean[c][i], march_steps[LEVELS - 1],
             compare_engine_names[truth], expected->mean[c][i], sqrt(expected->variance[c][i]),
             100.0 * suspect.difference.value / fmax(suspect.difference.size, 1e-300));
    add_finding(comparison, COMPARE_MARCH, truth, what);
    return NEPH_OK;
}

/* ---- a scene --------------------------------------------------------------------------------- */

static enum neph_status read_stage(struct comparison *comparison, int stage, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    if (takes_part(comparison, COMPARE_ORACLE))
        status = read_noisy(comparison, COMPARE_ORACLE, render_oracle, oracle_samples[stage], stage,
                            diag);
    if (!status && takes_part(comparison, COMPARE_TRACER) && comparison->request->vulkan)
        status = read_noisy(comparison, COMPARE_TRACER, render_tracer, tracer_samples[stage], stage,
                            diag);
    return status;
}

/* The verdict of one stage: whether another is needed. Findings are added in the last stage or when
 * they are certain. */
static bool judge_stage(struct comparison *comparison, int stage, struct compare_scores *scores)
{
    bool needs_more = false;
    for (int p = 0; p <= PAIR_TRACER_ORACLE; p++) {
        const struct reading *test = &comparison->readings[pairs[p].test];
        const struct reading *truth = &comparison->readings[pairs[p].truth];
        if (!test->is_there || !truth->is_there)
            continue;
        const struct unseen unseen = find_unseen(comparison->request->still, test, truth, stage);
        const struct suspect suspect = find_suspect(test, truth, unseen, &scores[p]);
        if (suspect.p >= suspicious_p)
            continue;
        const bool is_certain = suspect.p < certain_p && stage > 0;
        needs_more |= !is_certain && stage + 1 < COMPARE_STAGES;
        if (!is_certain)
            continue;
        char what[400];
        describe(comparison, (enum compare_pair)p, &suspect, stage, what);
        add_finding(comparison, pairs[p].test, pairs[p].truth, what);
    }
    return needs_more && comparison->result->finding_count == 0;
}

enum neph_status compare_scene(const struct compare_request *request,
                               struct compare_scores scores[PAIR_COUNT],
                               struct compare_march *marched, struct compare_result *result,
                               struct neph_diag *diag)
{
    struct comparison *comparison = calloc(1, sizeof(*comparison));
    if (!comparison)
        return neph_fail_memory(diag);
    *result = (struct compare_result){.finding_count = 0};
    comparison->request = request;
    comparison->result = result;
    for (int i = 0; i < request->still->medium_count; i++)
        comparison->is_cloudy |= request->still->media[i].kind == NEPH_MEDIUM_HORIZON;
    enum neph_status status = NEPH_OK;
    if (takes_part(comparison, COMPARE_EXACT))
        read_exact(comparison);
    int stage = 0;
    bool needs_more = true;
    struct compare_scores last[PAIR_COUNT];
    for (; stage < COMPARE_STAGES && needs_more && !status; stage++) {
        memset(last, 0, sizeof(last));
        status = read_stage(comparison, stage, diag);
        if (!status)
            needs_more = judge_stage(comparison, stage, last);
    }
    for (int p = 0; p < PAIR_COUNT && scores && !status; p++)
        compare_add_scores(&scores[p], &last[p]);
    result->stages = stage;
    const enum compare_engine truth = comparison->readings[COMPARE_EXACT].is_there ? COMPARE_EXACT
                                                                                   : COMPARE_ORACLE;
    if (!status && takes_part(comparison, COMPARE_MARCH) && request->vulkan &&
        comparison->readings[truth].is_there)
        status = compare_march_levels(comparison, truth, marched, diag);
    if (!status)
        check_through(comparison);
    free(comparison);
    return status;
}
