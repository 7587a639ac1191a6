/* SPDX-License-Identifier: MIT
 *
 * Ghosts behind moving edges: the remaining part of an occluder's colour after a disocclusion.
 *
 * A pixel is disoccluded if its point was inside the previous frame, but hidden (moved.h). This
 * frame has the age 1; the age moves with the point. Y is the luminance of linear data, Y_front the
 * reference luminance of the occluder, in the frame before age 1. Over the pixels of an age
 *
 *   residual = sum (test - reference) (Y_front - reference) / sum (Y_front - reference)^2
 *
 * is 1 if the occluder is completely visible, 0 if it is not, and below 0 if the test overshoots.
 * An exponential average with weight alpha that had settled on the occluder has (1 - alpha)^age. A
 * pixel has a ghost if |test - reference| > |Y_front - reference| / 10.
 */
#include "metrics/extractors/extractors.h"

#include "base/threads.h"
#include "metrics/extractors/moved.h"
#include "metrics/extractors/visible_step.h"

#include <math.h>
#include <stdint.h>

/* The number of ages with a metric, and the last age with counted ghosts. */
enum { AGE_COUNT = 4, AGE_LAST = 32 };

static const int ages[AGE_COUNT] = {1, 4, 8, 16};
static const double ghost_share = 0.1;

/* Four maps for each age, by index; then maps over all ages. */
enum age_map { PRODUCT, SQUARE, GHOSTS, TOLD, MAPS_PER_AGE };
enum map { AREA = MAPS_PER_AGE * AGE_COUNT, FRAMES, DISOCCLUSIONS, MAP_COUNT };

static const char never[] = "no pixel of the mask is disoccluded for so long with an occluder that "
                            "differs by 1/255 of display luma";
static const char one_frame[] = "there is only one frame";

/* Four maps for each age. */
/* clang-format off */
#define MAPS_OF_AGE \
    {NULL, "1", 1, true, 0.0, never, 0}, {NULL, "1", 1, false, 0.0, never, 0}, \
    {NULL, "1", 1, false, 0.0, never, 0}, {NULL, "1", 1, false, 0.0, never, 0}
static const struct neph_map maps[MAP_COUNT] = {
    MAPS_OF_AGE, MAPS_OF_AGE, MAPS_OF_AGE, MAPS_OF_AGE,
    {"edge_ghost", "1", 1, false, 0.1, one_frame, 0},
    {NULL, "frame", 1, false, 0.0, never, 0},
    {NULL, "1", 1, false, 0.0, never, 0},
};

#define METRICS_OF_AGE(n, k) \
    {"edge_ghost_residual_" n, "1", -INFINITY, INFINITY, NEPH_POOL_MEAN_OVER, 0, \
     k * MAPS_PER_AGE + PRODUCT, k * MAPS_PER_AGE + SQUARE, \
     "signed remaining part of the occluder in frame " n " since a pixel is disoccluded"}, \
    {"edge_ghost_share_" n, "1", 0, 1, NEPH_POOL_MEAN_OVER, 0, \
     k * MAPS_PER_AGE + GHOSTS, k * MAPS_PER_AGE + TOLD, \
     "share of pixels with more than 10 % of the front left in frame " n " since disoccluded"}
static const struct neph_metric metrics[] = {
    METRICS_OF_AGE("1", 0),
    METRICS_OF_AGE("4", 1),
    METRICS_OF_AGE("8", 2),
    METRICS_OF_AGE("16", 3),
    {"edge_ghost_area", "1", 0, 1, NEPH_POOL_MEAN, 0, AREA, 0,
     "share of all pixels and frames with more than 10 % of the front left, 32 frames long"},
    {"edge_ghost_frames", "frame", 0, AGE_LAST, NEPH_POOL_MEAN_OVER, 0, FRAMES, DISOCCLUSIONS,
     "frames, of 32, with more than 10 % of the occluder left, per disoccluded pixel; pixels "
     "that are hidden again or have a ghost at the end count with their frames so far"},
    {.name = NULL},
};
/* clang-format on */

enum { DEPTH_TOLERANCE };

static const struct neph_option options[] = {
    {"depth_tolerance", NEPH_OPTION_REAL, 0.02, 0, 1, NULL,
     "relative depth difference up to which a pixel counts as seen before"},
    {.name = NULL},
};

/* The planes of a stored frame: Y of the reference, and Y of the pixel's occluder. The age is 0
 * without a disocclusion in the last AGE_LAST frames. */
enum { REFERENCE, FRONT };

/* Sums at one age. */
struct age_sums {
    double product, square;
    uint32_t ghosts, told;
};

struct pixel {
    struct age_sums ages[AGE_COUNT];
    uint32_t ghost_frames, disocclusions;
};

struct state {
    int width_px, height_px;
    int frame_count;
    double gain; /* display value of the radiance 1 */
    double depth_tolerance;
    struct neph_kept frames[2];
    struct pixel *pixels;
};

static enum neph_status init(void *state_, const struct neph_frame_pair *first,
                             const struct neph_settings *settings, struct neph_diag *diag)
{
    struct state *state = state_;
    const size_t pixel_count = (size_t)first->width_px * (size_t)first->height_px;
    *state = (struct state){.width_px = first->width_px,
                            .height_px = first->height_px,
                            .gain = exp2(first->viewing->exposure_ev),
                            .depth_tolerance = settings->values[DEPTH_TOLERANCE]};
    state->pixels = neph_arena_allocate(first->memory, pixel_count, sizeof(*state->pixels));
    return neph_kept_init(state->frames, pixel_count, first->memory, diag);
}

/* ---- a frame --------------------------------------------------------------------------------- */

struct work {
    struct state *state;
    const struct neph_frame_pair *pair;
    struct neph_moved moved;
    struct neph_kept *now, *before;
};

static void start_ghost_row(int row, void *context)
{
    const struct work *work = context;
    const size_t width = (size_t)work->state->width_px, first = (size_t)row * width;
    for (size_t i = first; i < first + width; i++) {
        work->now->planes[REFERENCE][i] = neph_luminance_at(work->pair->reference, i);
        work->now->nearness_per_m[i] = neph_moved_nearness_per_m(&work->moved, i);
    }
}

/* Update the pixel's age, and the luminance of its occluder. */
static void follow_age(const struct work *work, int x, int y, size_t i)
{
    const struct state *state = work->state;
    const struct neph_kept *before = work->before;
    struct neph_place place;
    work->now->age[i] = 0;
    if (!neph_place_find(&work->moved, state->width_px, state->height_px, x, y, &place))
        return;
    const double wanted_per_m = neph_moved_nearness_before_per_m(&work->moved, i,
                                                                 work->now->nearness_per_m[i]);
    if (!neph_place_was_visible(&place, before->nearness_per_m, wanted_per_m,
                                state->depth_tolerance)) {
        work->now->age[i] = 1;
        work->now->planes[FRONT][i] = neph_place_value(&place, before->planes[REFERENCE]);
        return;
    }
    const int age = before->age[place.nearest];
    work->now->age[i] = (uint8_t)(age > 0 && age < AGE_LAST ? age + 1 : 0);
    work->now->planes[FRONT][i] = before->planes[FRONT][place.nearest];
}

static void add_pixel(const struct work *work, size_t i)
{
    struct pixel *pixel = &work->state->pixels[i];
    const double reference = work->now->planes[REFERENCE][i], front = work->now->planes[FRONT][i];
    const double residual = neph_luminance_at(work->pair->test, i) - reference;
    const double hidden = front - reference;
    const int age = work->now->age[i];
    if (age == 0 || !neph_is_visible_step(front, reference, work->state->gain))
        return;
    const bool is_ghost = fabs(residual) > ghost_share * fabs(hidden);
    pixel->ghost_frames += is_ghost;
    pixel->disocclusions += age == 1;
    for (int k = 0; k < AGE_COUNT; k++) {
        struct age_sums *sums = &pixel->ages[k];
        if (ages[k] != age)
            continue;
        sums->product += residual * hidden;
        sums->square += hidden * hidden;
        sums->ghosts += is_ghost;
        sums->told++;
    }
}

static void follow_row(int row, void *context)
{
    const struct work *work = context;
    for (int x = 0; x < work->state->width_px; x++) {
        const size_t i = (size_t)row * (size_t)work->state->width_px + (size_t)x;
        follow_age(work, x, row, i);
        add_pixel(work, i);
    }
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
        status = neph_parallel_rows(state->height_px, start_ghost_row, &work, diag);
    if (!status && state->frame_count > 0)
        status = neph_parallel_rows(state->height_px, follow_row, &work, diag);
    state->frame_count++;
    return status;
}

/* ---- the numbers ----------------------------------------------------------------------------- */

static double compute_age_value(const struct age_sums *sums, int map)
{
    const double values[MAPS_PER_AGE] = {
        [PRODUCT] = sums->product,
        [SQUARE] = sums->square,
        [GHOSTS] = sums->ghosts,
        [TOLD] = sums->told,
    };
    return sums->told > 0 ? values[map] : (double)NAN;
}

static double compute_ghost_value(const struct state *state, int map, const struct pixel *pixel)
{
    if (map < AREA)
        return compute_age_value(&pixel->ages[map / MAPS_PER_AGE], map % MAPS_PER_AGE);
    if (map == AREA)
        return state->frame_count > 1 ? (double)pixel->ghost_frames / (state->frame_count - 1)
                                      : (double)NAN;
    if (pixel->disocclusions == 0)
        return NAN;
    return map == FRAMES ? pixel->ghost_frames : pixel->disocclusions;
}

static void rows(const void *state_, int map, int first_row, int row_count, double *const values[3])
{
    const struct state *state = state_;
    const size_t width = (size_t)state->width_px, first = (size_t)first_row * width;
    for (size_t i = 0; i < (size_t)row_count * width; i++)
        values[0][i] = compute_ghost_value(state, map, &state->pixels[first + i]);
}

const struct neph_extractor neph_extractor_ghost = {
    .name = "ghost",
    .help = "ghosts of occluders behind moving edges, by frames since disocclusion",
    .source =
        "ghosting as the residual of the occluder's colour; see Yang, Liu, Salvi, A Survey of "
        "Temporal Antialiasing Techniques, Computer Graphics Forum 39, 2020",
    .details = "motion.x, motion.y: position of the visible point in the frame before minus its\n"
               "position now [px], x to the right, y down; with Z, both of the reference, or else\n"
               "of the test; motion.depth, if it exists, is the point's depth in the frame before\n"
               "residual: of test - reference along (front - reference), linear luminance; front\n"
               "is the reference where the pixel was hidden, in the last frame that hid it\n"
               "fronts that differ by less than 1/255 of display luma are left out",
    .quantities = NEPH_RADIANCE | NEPH_VOLUME,
    .temporal = true,
    .options = options,
    .metrics = metrics,
    .maps = maps,
    .map_count = MAP_COUNT,
    .state_size = sizeof(struct state),
    .obstacle = neph_moved_obstacle,
    .init = init,
    .extract = extract,
    .rows = rows,
};
