/* SPDX-License-Identifier: MIT
 *
 * Frames of a moving camera: each is compared with the previous frame, reprojected by exact motion
 * vectors (layer motion of the reference, or else of the test). This is the warping error of Lai et
 * al., but with the difference to the reference instead of an absolute value, which would reward
 * blur.
 *
 * Classes of each pixel, in each frame but the first:
 * - in the frame: its previous position (moved.h) is inside the previous frame;
 * - seen before: and the previous frame has its depth, within the tolerance, at that position (1 /
 *   Z interpolated bilinearly, exact for planes) or at one of the four pixels around it;
 * - disoccluded: in the frame and not seen before;
 * - valid: the depth agrees at that position, and there is no depth step within 1 px of the pixel
 *   or at the four pixels around the position.
 *
 * Residuals x_t - (x_t-1 reprojected, bilinear) are computed for valid pixels. The change of test -
 * reference since the previous frame, at the same pixel, is computed for disoccluded pixels and for
 * pixels seen before. The number of frames since disocclusion moves with the point.
 */
#include "metrics/extractors/extractors.h"

#include "base/threads.h"
#include "metrics/extractors/display_luma.h"
#include "metrics/extractors/moved.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

static const char never_valid[] =
    "no pixel of the mask can be followed from one frame to the next (or there is only one frame)";
static const char never_disoccluded[] = "no pixel of the mask is disoccluded in these frames";
static const char never_seen_before[] =
    "no pixel of the mask was seen before (or there is only one frame)";
static const char one_frame[] = "there is only one frame";

enum map { SHOWN, TEST, REFERENCE, COVERAGE, DISOCCLUDED, FRESH, REST, MAP_COUNT };

static const struct neph_map maps[MAP_COUNT] = {
    [SHOWN] = {"motion_residual", "1", 1, true, 0.1, never_valid},
    [TEST] = {NULL, "1", 1, false, 0.0, never_valid},
    [REFERENCE] = {NULL, "1", 1, false, 0.0, never_valid},
    [COVERAGE] = {"motion_coverage", "1", 1, false, 1.0, one_frame},
    [DISOCCLUDED] = {NULL, "1", 1, false, 0.0, one_frame},
    [FRESH] = {NULL, "1", 1, false, 0.0, never_disoccluded},
    [REST] = {NULL, "1", 1, false, 0.0, never_seen_before},
};

enum { AGE_COUNT = 33, AGE_UNKNOWN = 255 };

static const double recovered_share = 0.1;

enum { RECOVERY = AGE_COUNT }; /* index of a scalar; lower ones are ages */

static const struct neph_metric metrics[] = {
    {"motion_residual_excess", "1", -1, 1, NEPH_POOL_ROOT_MEAN_LESS, 0, TEST, REFERENCE,
     "rms of the test against its frame before, moved, less the same of the reference"},
    {"motion_residual_test", "1", 0, 1, NEPH_POOL_ROOT_MEAN, 0, TEST, 0,
     "rms of the test against its frame before, moved"},
    {"motion_residual_reference", "1", 0, 1, NEPH_POOL_ROOT_MEAN, 0, REFERENCE, 0,
     "rms of the reference against its frame before, moved"},
    {"motion_coverage", "1", 0, 1, NEPH_POOL_MEAN, 0, COVERAGE, 0,
     "share of pixels and frames that the residuals are taken of"},
    {"disoccluded_share", "1", 0, 1, NEPH_POOL_MEAN, 0, DISOCCLUDED, 0,
     "share of pixels and frames that were hidden in the frame before"},
    {"residual_change_disoccluded", "1", 0, 2, NEPH_POOL_ROOT_MEAN, 0, FRESH, 0,
     "rms of the change of test - reference where the frame before was hidden"},
    {"residual_change_elsewhere", "1", 0, 2, NEPH_POOL_ROOT_MEAN, 0, REST, 0,
     "rms of the change of test - reference where the frame before shows the same"},
    {"disoccluded_residual_0", "1", 0, 1, NEPH_POOL_SCALAR, 0, 0, 0,
     "rms of test - reference in the frame of a disocclusion"},
    {"disoccluded_residual_1", "1", 0, 1, NEPH_POOL_SCALAR, 0, 1, 0,
     "rms of test - reference 1 frame after a disocclusion"},
    {"disoccluded_residual_2", "1", 0, 1, NEPH_POOL_SCALAR, 0, 2, 0,
     "rms of test - reference 2 frames after a disocclusion"},
    {"disoccluded_residual_4", "1", 0, 1, NEPH_POOL_SCALAR, 0, 4, 0,
     "rms of test - reference 4 frames after a disocclusion"},
    {"disoccluded_residual_8", "1", 0, 1, NEPH_POOL_SCALAR, 0, 8, 0,
     "rms of test - reference 8 frames after a disocclusion"},
    {"disoccluded_residual_16", "1", 0, 1, NEPH_POOL_SCALAR, 0, 16, 0,
     "rms of test - reference 16 frames after a disocclusion"},
    {"disoccluded_recovery", "frame", 0, AGE_COUNT, NEPH_POOL_SCALAR, 0, RECOVERY, 0,
     "frames from a disocclusion until that rms stays below 10 % of its start (looked for: 32)"},
    {.name = NULL},
};

enum { SIGNAL, DEPTH_TOLERANCE, EDGE_RATIO };

static const char *const signals[] = {"luma", "luminance", NULL};

static const struct neph_option options[] = {
    {"signal", NEPH_OPTION_CHOICE, 0, 0, 0, signals,
     "compared signal: luma of the encoded display value, or its luminance; both 0..1"},
    {"depth_tolerance", NEPH_OPTION_REAL, 0.02, 0, 1, NULL,
     "relative depth difference up to which a pixel counts as seen before"},
    {"edge_ratio", NEPH_OPTION_REAL, 1.1, 1, 100, NULL,
     "farther / nearer of 4-neighbours above which depth has a step"},
    {.name = NULL},
};

/* The planes of a stored frame: the signal. `flags`: depth step to a 4-neighbour; `age`: frames
 * since disocclusion, at most 254. */
enum { OF_TEST, OF_REFERENCE };

struct pixel {
    double test, reference; /* sums of squares */
    double fresh, rest;
    uint32_t valid, fresh_count, rest_count;
};

/* One per row, so that the sums do not depend on the threads. */
struct ages {
    double squares[AGE_COUNT], counts[AGE_COUNT];
};

struct state {
    int width_px, height_px;
    int frame_count;
    double gain; /* display value of the radiance 1 */
    bool luminance;
    double depth_tolerance, edge_ratio;
    struct neph_kept frames[2];
    struct pixel *pixels;
    struct ages *rows;
    struct ages totals; /* after the last frame */
};

/* ---- set-up
 * ------------------------------------------------------------------------------------ */

static enum neph_status init(void *state_, const struct neph_frame_pair *first,
                             const struct neph_settings *settings, struct neph_diag *diag)
{
    struct state *state = state_;
    const size_t pixel_count = (size_t)first->width_px * (size_t)first->height_px;
    *state = (struct state){.width_px = first->width_px,
                            .height_px = first->height_px,
                            .gain = exp2(first->viewing->exposure_ev),
                            .luminance = settings->values[SIGNAL] > 0.0,
                            .depth_tolerance = settings->values[DEPTH_TOLERANCE],
                            .edge_ratio = settings->values[EDGE_RATIO]};
    state->pixels = neph_arena_zeroed(first->memory, pixel_count, sizeof(*state->pixels));
    state->rows = neph_arena_zeroed(first->memory, (size_t)first->height_px, sizeof(*state->rows));
    const enum neph_status status = neph_kept_init(state->frames, pixel_count, first->memory, diag);
    for (int k = 0; k < 2 && !status; k++)
        memset(state->frames[k].age, AGE_UNKNOWN, pixel_count);
    return status;
}

/* ---- a frame --------------------------------------------------------------------------------- */

struct work {
    struct state *state;
    const struct neph_frame_pair *pair;
    struct neph_moved moved;
    struct neph_kept *now, *before;
};

static void look_row(int row, void *context)
{
    const struct work *work = context;
    const struct state *state = work->state;
    const size_t width = (size_t)state->width_px, first = (size_t)row * width;
    const float *planes[2][3];
    for (int c = 0; c < 3; c++) {
        planes[0][c] = work->pair->reference[c] + first;
        planes[1][c] = work->pair->test[c] + first;
    }
    /* Luma and luminance are computed together; the unused one goes into the depth plane, which is
     * overwritten below. */
    double *signals_of[2] = {work->now->planes[OF_REFERENCE] + first,
                             work->now->planes[OF_TEST] + first};
    double *other = work->now->nearness_per_m + first;
    for (int k = 0; k < 2; k++)
        neph_display_luma(planes[k], width, state->gain, state->luminance ? other : signals_of[k],
                          state->luminance ? signals_of[k] : other);
    for (size_t i = first; i < first + width; i++)
        work->now->nearness_per_m[i] = neph_moved_nearness_per_m(&work->moved, i);
}

static void mark_row(int row, void *context)
{
    const struct work *work = context;
    const int width = work->state->width_px, height = work->state->height_px;
    const double *nearness_per_m = work->now->nearness_per_m + (size_t)row * (size_t)width;
    const double ratio = work->state->edge_ratio;
    for (int x = 0; x < width; x++) {
        const double here = nearness_per_m[x];
        const double others[4] = {nearness_per_m[x > 0 ? x - 1 : x],
                                  nearness_per_m[x + 1 < width ? x + 1 : x],
                                  nearness_per_m[row > 0 ? x - width : x],
                                  nearness_per_m[row + 1 < height ? x + width : x]};
        bool steps = false;
        for (int k = 0; k < 4; k++)
            steps |= fmax(here, others[k]) > ratio * fmin(here, others[k]);
        work->now->flags[(size_t)row * (size_t)width + (size_t)x] = steps;
    }
}

static bool any_step(const struct neph_place *place, const uint8_t *step)
{
    return step[place->taps[0]] || step[place->taps[1]] || step[place->taps[2]] ||
           step[place->taps[3]];
}

static bool step_within_1_px(const struct state *state, const uint8_t *step, int x, int y)
{
    for (int j = y > 0 ? y - 1 : y; j <= y + 1 && j < state->height_px; j++)
        for (int i = x > 0 ? x - 1 : x; i <= x + 1 && i < state->width_px; i++)
            if (step[(size_t)j * (size_t)state->width_px + (size_t)i])
                return true;
    return false;
}

static void add_residuals(const struct work *work, const struct neph_place *place, size_t i)
{
    struct pixel *pixel = &work->state->pixels[i];
    const double test = work->now->planes[OF_TEST][i] -
                        neph_place_value(place, work->before->planes[OF_TEST]);
    const double reference = work->now->planes[OF_REFERENCE][i] -
                             neph_place_value(place, work->before->planes[OF_REFERENCE]);
    pixel->test += test * test;
    pixel->reference += reference * reference;
    pixel->valid++;
}

static void add_change(const struct work *work, bool fresh, size_t i)
{
    struct pixel *pixel = &work->state->pixels[i];
    const double now = work->now->planes[OF_TEST][i] - work->now->planes[OF_REFERENCE][i];
    const double change = now - (work->before->planes[OF_TEST][i] -
                                 work->before->planes[OF_REFERENCE][i]);
    *(fresh ? &pixel->fresh : &pixel->rest) += change * change;
    *(fresh ? &pixel->fresh_count : &pixel->rest_count) += 1;
}

static uint8_t one_older(uint8_t age)
{
    return age >= AGE_UNKNOWN - 1 ? age : (uint8_t)(age + 1);
}

static void compare_pixel(const struct work *work, int x, int y, struct ages *ages)
{
    const struct state *state = work->state;
    const size_t i = (size_t)y * (size_t)state->width_px + (size_t)x;
    struct neph_place place;
    uint8_t *age = &work->now->age[i];
    *age = AGE_UNKNOWN;
    if (!neph_place_find(&work->moved, state->width_px, state->height_px, x, y, &place))
        return;
    const double wanted_per_m = neph_moved_nearness_before_per_m(&work->moved, i,
                                                                 work->now->nearness_per_m[i]);
    const double *nearness_per_m = work->before->nearness_per_m;
    const double tolerance = state->depth_tolerance;
    const bool there = neph_place_agrees(&place, nearness_per_m, wanted_per_m, tolerance);
    const bool seen = neph_place_was_seen(&place, nearness_per_m, wanted_per_m, tolerance);
    if (there && !any_step(&place, work->before->flags) &&
        !step_within_1_px(state, work->now->flags, x, y))
        add_residuals(work, &place, i);
    add_change(work, !seen, i);
    *age = seen ? one_older(work->before->age[place.nearest]) : 0;
    if (*age < AGE_COUNT) {
        const double residual = work->now->planes[OF_TEST][i] - work->now->planes[OF_REFERENCE][i];
        ages->squares[*age] += residual * residual;
        ages->counts[*age] += 1.0;
    }
}

static void compare_row(int row, void *context)
{
    const struct work *work = context;
    for (int x = 0; x < work->state->width_px; x++)
        compare_pixel(work, x, row, &work->state->rows[row]);
}

static enum neph_status extract(void *state_, const struct neph_frame_pair *pair,
                                struct neph_diag *diag)
{
    struct state *state = state_;
    struct work work = {.state = state,
                        .pair = pair,
                        .now = &state->frames[state->frame_count % 2],
                        .before = &state->frames[(state->frame_count + 1) % 2]};
    enum neph_status status = neph_moved_find(pair, &work.moved, diag);
    if (!status)
        status = neph_parallel_rows(state->height_px, look_row, &work, diag);
    if (!status)
        status = neph_parallel_rows(state->height_px, mark_row, &work, diag);
    if (!status && state->frame_count > 0)
        status = neph_parallel_rows(state->height_px, compare_row, &work, diag);
    state->frame_count++;
    return status;
}

/* ---- the numbers ----------------------------------------------------------------------------- */

static enum neph_status flush(void *state_, struct neph_diag *diag)
{
    (void)diag;
    struct state *state = state_;
    for (int y = 0; y < state->height_px; y++) {
        for (int age = 0; age < AGE_COUNT; age++) {
            state->totals.squares[age] += state->rows[y].squares[age];
            state->totals.counts[age] += state->rows[y].counts[age];
        }
    }
    return NEPH_OK;
}

static double mean_of(double sum, double count)
{
    return count > 0.0 ? sum / count : (double)NAN;
}

static double value_of(const struct state *state, int map, const struct pixel *pixel)
{
    const double pairs = state->frame_count - 1;
    switch (map) {
    case SHOWN:
        return sqrt(mean_of(pixel->test, pixel->valid)) -
               sqrt(mean_of(pixel->reference, pixel->valid));
    case TEST:
        return mean_of(pixel->test, pixel->valid);
    case REFERENCE:
        return mean_of(pixel->reference, pixel->valid);
    case COVERAGE:
        return mean_of(pixel->valid, pairs);
    case DISOCCLUDED:
        return mean_of(pixel->fresh_count, pairs);
    case FRESH:
        return mean_of(pixel->fresh, pixel->fresh_count);
    default:
        return mean_of(pixel->rest, pixel->rest_count);
    }
}

static void rows(const void *state_, int map, int first_row, int row_count, double *const values[3])
{
    const struct state *state = state_;
    const size_t width = (size_t)state->width_px, first = (size_t)first_row * width;
    for (size_t i = 0; i < (size_t)row_count * width; i++)
        values[0][i] = value_of(state, map, &state->pixels[first + i]);
}

static double rms_of_age(const struct state *state, int age)
{
    return sqrt(mean_of(state->totals.squares[age], state->totals.counts[age]));
}

/* The last time at which the residual falls to the share; log-linear between frames. */
static const char *recovery(const struct state *state, double *frames)
{
    const double limit = recovered_share * rms_of_age(state, 0);
    double found = -1.0;
    if (!(limit > 0.0))
        return "there is no error in disoccluded pixels, or there are none";
    for (int age = 1; age < AGE_COUNT && state->totals.counts[age] > 0.0; age++) {
        const double before = rms_of_age(state, age - 1), now = rms_of_age(state, age);
        if (now > limit)
            found = -1.0;
        else if (before > limit)
            found = age - 1 + log(before / limit) / (log(before) - log(now));
    }
    if (found < 0.0)
        return "the error has not come down to 10 % of its start within 32 frames";
    *frames = found;
    return NULL;
}

static const char *scalar(const void *state_, int which, double *value)
{
    const struct state *state = state_;
    if (which == RECOVERY)
        return recovery(state, value);
    if (!(state->totals.counts[which] > 0.0))
        return "no pixel has been disoccluded for so long";
    *value = rms_of_age(state, which);
    return NULL;
}

const struct neph_extractor neph_extractor_motion = {
    .name = "motion",
    .help = "frames against the frame before, moved by exact motion vectors; disocclusions",
    .source = "warping error of Lai et al., Learning Blind Video Temporal Consistency, ECCV 2018, "
              "with exact motion and as a difference to the reference's own",
    .details = "motion.x, motion.y: position of the visible point in the frame before minus its\n"
               "position now [px], x to the right, y down; with Z, both of the reference, or else\n"
               "of the test; motion.depth, if it exists, is the point's depth in the frame before\n"
               "residuals are measured where the depth agrees and no depth step is near\n"
               "an rms is over the mean squares of pixels, each over its own frames",
    .quantities = NEPH_RADIANCE | NEPH_VOLUME,
    .temporal = true,
    .options = options,
    .metrics = metrics,
    .maps = maps,
    .map_count = MAP_COUNT,
    .state_size = sizeof(struct state),
    .obstacle = neph_moved_obstacle,
    .bound = neph_bound_is_white,
    .init = init,
    .extract = extract,
    .flush = flush,
    .rows = rows,
    .scalar = scalar,
};
