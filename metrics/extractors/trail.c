/* SPDX-License-Identifier: MIT
 *
 * The trail behind a moving card: the remaining part of the card at pixels that it has left. The
 * reference gives the card's pixels in channel mask.card.
 *
 * A pixel is uncovered if the card covered it in the previous frame, but not in this one; this
 * frame has the age 1. At a speed of v px/frame the age a is a v px behind the card. Y is the
 * luminance of linear data, Y_card the reference in the pixel's last covered frame. Over all pixels
 * and frames of an age
 *
 *   energy = sum (test - reference)^2 / sum (Y_card - reference)^2
 *
 * is 1 if the card stays fully visible, and (1 - alpha)^(2 a) for an exponential average with the
 * weight alpha that had settled on the card.
 */
#include "metrics/extractors/extractors.h"

#include "base/threads.h"

#include <math.h>
#include <stdint.h>

enum { AGE_MAX = 16 };

static const char never_uncovered[] = "the card uncovers no pixel of the mask";

enum map { TRAIL, TRAIL_SQUARES, MAP_COUNT };

static const struct neph_map maps[MAP_COUNT] = {
    [TRAIL] = {"trail", NULL, 1, false, 0.1, never_uncovered},
    [TRAIL_SQUARES] = {NULL, NULL, 1, false, 0.0, never_uncovered},
};

static const struct neph_metric metrics[] = {
    {"trail_rms", NULL, 0, INFINITY, NEPH_POOL_ROOT_MEAN, 0, TRAIL_SQUARES, 0,
     "rms of the luminance of test - reference in the 16 frames since a pixel was uncovered"},
    {"trail_energy_1", "1", 0, INFINITY, NEPH_POOL_SCALAR, 0, 1, 0,
     "energy of test - reference in the 1st frame since uncovered, 1: the card is still there"},
    {"trail_energy_2", "1", 0, INFINITY, NEPH_POOL_SCALAR, 0, 2, 0,
     "energy in the 2nd frame since uncovered"},
    {"trail_energy_4", "1", 0, INFINITY, NEPH_POOL_SCALAR, 0, 4, 0,
     "energy in the 4th frame since uncovered"},
    {"trail_energy_8", "1", 0, INFINITY, NEPH_POOL_SCALAR, 0, 8, 0,
     "energy in the 8th frame since uncovered"},
    {"trail_energy_16", "1", 0, INFINITY, NEPH_POOL_SCALAR, 0, 16, 0,
     "energy in the 16th frame since uncovered"},
    {.name = NULL},
};

static const struct neph_option options[] = {{.name = NULL}};

struct pixel {
    double card;    /* reference luminance when last covered */
    double squares; /* sum of (test - reference)^2 over the ages 1..16 */
    uint32_t count;
    uint8_t covered; /* in the last frame */
    uint8_t age;     /* 0: covered, or never covered; stays at 17 */
};

/* One per row, so that the sums do not depend on the threads. */
struct energies {
    double squares[AGE_MAX + 1], steps[AGE_MAX + 1];
};

struct state {
    int width_px, height_px;
    struct pixel *pixels;
    struct energies *rows;
    struct energies totals; /* after the last frame */
};

static const char *obstacle(const struct neph_frame_pair *first,
                            const struct neph_settings *settings)
{
    (void)settings;
    return neph_image_channel(first->reference_image, "mask.card")
               ? NULL
               : "the reference has no channel 'mask.card' that says where the moving card is";
}

static enum neph_status init(void *state_, const struct neph_frame_pair *first,
                             const struct neph_settings *settings, struct neph_diag *diag)
{
    (void)settings;
    struct state *state = state_;
    const size_t pixel_count = (size_t)first->width_px * (size_t)first->height_px;
    state->width_px = first->width_px;
    state->height_px = first->height_px;
    state->pixels = neph_arena_zeroed(first->memory, pixel_count, sizeof(*state->pixels));
    state->rows = neph_arena_zeroed(first->memory, (size_t)first->height_px, sizeof(*state->rows));
    return neph_arena_check(first->memory, diag);
}

struct work {
    struct state *state;
    const struct neph_frame_pair *pair;
    const float *card;
};

static void follow_pixel(struct pixel *pixel, double reference, double test,
                         struct energies *energies)
{
    const int age = pixel->covered ? 1 : pixel->age + (pixel->age > 0 && pixel->age <= AGE_MAX);
    pixel->covered = 0;
    pixel->age = (uint8_t)age;
    if (age < 1 || age > AGE_MAX)
        return;
    const double square = (test - reference) * (test - reference);
    pixel->squares += square;
    pixel->count++;
    energies->squares[age] += square;
    energies->steps[age] += (pixel->card - reference) * (pixel->card - reference);
}

static void follow_row(int row, void *context)
{
    const struct work *work = context;
    const size_t width = (size_t)work->state->width_px, first = (size_t)row * width;
    for (size_t i = first; i < first + width; i++) {
        struct pixel *pixel = &work->state->pixels[i];
        const double reference = neph_luminance_at(work->pair->reference, i);
        if (work->card[i] > 0.5f) {
            pixel->card = reference;
            pixel->covered = 1;
            pixel->age = 0;
        } else {
            follow_pixel(pixel, reference, neph_luminance_at(work->pair->test, i),
                         &work->state->rows[row]);
        }
    }
}

static enum neph_status extract(void *state_, const struct neph_frame_pair *pair,
                                struct neph_diag *diag)
{
    struct state *state = state_;
    struct work work = {state, pair, neph_image_channel(pair->reference_image, "mask.card")};
    if (!work.card)
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "frame %d of the reference has no channel 'mask.card', the first one has",
                         pair->frame);
    return neph_parallel_rows(state->height_px, follow_row, &work, diag);
}

static enum neph_status flush(void *state_, struct neph_diag *diag)
{
    (void)diag;
    struct state *state = state_;
    for (int y = 0; y < state->height_px; y++) {
        for (int age = 1; age <= AGE_MAX; age++) {
            state->totals.squares[age] += state->rows[y].squares[age];
            state->totals.steps[age] += state->rows[y].steps[age];
        }
    }
    return NEPH_OK;
}

static void rows(const void *state_, int map, int first_row, int row_count, double *const values[3])
{
    const struct state *state = state_;
    const size_t width = (size_t)state->width_px, first = (size_t)first_row * width;
    for (size_t i = 0; i < (size_t)row_count * width; i++) {
        const struct pixel *pixel = &state->pixels[first + i];
        const double mean = pixel->count > 0 ? pixel->squares / pixel->count : (double)NAN;
        values[0][i] = map == TRAIL ? sqrt(mean) : mean;
    }
}

static const char *scalar(const void *state_, int which, double *value)
{
    const struct state *state = state_;
    if (!(state->totals.steps[which] > 0.0))
        return "no pixel has been uncovered for so long, or card and background are equal";
    *value = state->totals.squares[which] / state->totals.steps[which];
    return NULL;
}

const struct neph_extractor neph_extractor_trail = {
    .name = "trail",
    .help = "remaining trail behind a moving card, by frames since it left",
    .source = "ghosting as energy behind a moving object; see Yang, Liu, Salvi, A Survey of "
              "Temporal Antialiasing Techniques, Computer Graphics Forum 39, 2020",
    .details =
        "mask.card of the reference: where the card is; energy: sum (test - reference)^2 /\n"
        "sum (card - reference)^2 of linear luminance, card: the reference when last covered",
    .quantities = NEPH_RADIANCE | NEPH_VOLUME,
    .temporal = true,
    .options = options,
    .metrics = metrics,
    .maps = maps,
    .map_count = MAP_COUNT,
    .state_size = sizeof(struct state),
    .obstacle = obstacle,
    .init = init,
    .extract = extract,
    .flush = flush,
    .rows = rows,
    .scalar = scalar,
};
