/* SPDX-License-Identifier: MIT
 *
 * Separates shifted edges from wrong ones. The image is cut into blocks of 8x8 px. Each block is
 * compared with the test shifted by -1, 0 or 1 px in x and y, and keeps the shift with the smallest
 * sum of squared differences (no shift unless it is smaller). A block shifts as a whole, because a
 * single pixel finds a similar one among nine neighbours by chance. The test's border pixels are
 * repeated outwards.
 */
#include "base/threads.h"
#include "metrics/extractors/extractors.h"
#include "metrics/vector_math.h"

#include <math.h>
#include <stddef.h>
#include <stdint.h>

enum {
    BLOCK = 8,
    MOVE_COUNT = 9,
    STRETCH = 16 * BLOCK, /* pixels of a row of blocks that are processed together */
};

enum { MAP_AS_IS, MAP_MOVED, MAP_COUNT };

struct move {
    int dx, dy;
};

/* The first of equal sums wins, so zero comes first, and short shifts before long ones. */
static const struct move moves[MOVE_COUNT] = {{0, 0},   {-1, 0}, {1, 0},  {0, -1}, {0, 1},
                                              {-1, -1}, {1, -1}, {-1, 1}, {1, 1}};

struct state {
    struct neph_frame_pair pair;
    int columns;   /* of blocks */
    uint8_t *best; /* index into `moves` for each block */
};

static enum neph_status init(void *opaque, const struct neph_frame_pair *first,
                             const struct neph_settings *settings, struct neph_diag *diag)
{
    (void)settings;
    struct state *state = opaque;
    state->columns = (first->width_px + BLOCK - 1) / BLOCK;
    int rows = (first->height_px + BLOCK - 1) / BLOCK;
    state->best = neph_arena_zeroed(first->memory, (size_t)state->columns * (size_t)rows,
                                    sizeof(*state->best));
    return neph_arena_check(first->memory, diag);
}

/* ---- choice of the shift
 * ----------------------------------------------------------------------- */

static int clamped(int position, int size)
{
    return position < 0 ? 0 : position >= size ? size - 1 : position;
}

/* Several blocks of a row, with the surrounding pixels that shifts need. Single precision is
 * enough, because it only ranks the shifts. */
struct stretch {
    int first_x, width_px;
    const float *reference[BLOCK]; /* rows, from first_x on; NaN outside the image adds nothing */
    const float *test[BLOCK + 2];  /* rows, from one pixel further up and left */
    float reference_copy[BLOCK][BLOCK], test_copy[BLOCK + 2][BLOCK + 2]; /* see copy_block() */
    float nothing[STRETCH];
};

/* The border blocks are processed separately, so that the rows between them can be read in
 * place. */
static int stretch_width(int image_width_px, int first_x)
{
    const int inner_px = (image_width_px - 1) / BLOCK * BLOCK - first_x;
    if (first_x == 0 || inner_px <= 0)
        return BLOCK;
    return inner_px < STRETCH ? inner_px : STRETCH;
}

/* Copy a border block, with rows extended beyond the image. The rows of `stretch` are complete
 * here. */
static void copy_block(int image_width_px, struct stretch *stretch)
{
    const int first_x = stretch->first_x;
    for (int y = 0; y < BLOCK; y++) {
        for (int x = 0; x < BLOCK; x++)
            stretch->reference_copy[y][x] = first_x + x < image_width_px
                                                ? stretch->reference[y][first_x + x]
                                                : NAN;
        stretch->reference[y] = stretch->reference_copy[y];
    }
    for (int y = 0; y < BLOCK + 2; y++) {
        for (int x = 0; x < BLOCK + 2; x++)
            stretch->test_copy[y][x] = stretch->test[y][clamped(first_x + x - 1, image_width_px)];
        stretch->test[y] = stretch->test_copy[y];
    }
}

static void find_rows(const struct neph_frame_pair *pair, int plane, int first_y,
                      struct stretch *stretch)
{
    const size_t width = (size_t)pair->width_px;
    for (int y = 0; y < BLOCK; y++)
        stretch->reference[y] = pair->reference[plane] +
                                (size_t)clamped(first_y + y, pair->height_px) * width;
    for (int y = 0; y < BLOCK + 2; y++)
        stretch->test[y] = pair->test[plane] +
                           (size_t)clamped(first_y + y - 1, pair->height_px) * width;
    const int first_x = stretch->first_x;
    if (first_x == 0 || first_x + stretch->width_px + 1 > pair->width_px) {
        copy_block(pair->width_px, stretch);
    } else {
        for (int y = 0; y < BLOCK; y++)
            stretch->reference[y] += first_x;
        for (int y = 0; y < BLOCK + 2; y++)
            stretch->test[y] += first_x - 1;
    }
    for (int y = pair->height_px - first_y; y < BLOCK; y++)
        stretch->reference[y] = stretch->nothing;
}

/* Add the squared differences of each column of 8 px. */
NEPH_VECTOR static void add_squares(const struct stretch *stretch, struct move move,
                                    float *restrict sums)
{
    const float *reference[BLOCK], *test[BLOCK];
    for (int y = 0; y < BLOCK; y++) {
        reference[y] = stretch->reference[y];
        test[y] = stretch->test[y + 1 + move.dy] + 1 + move.dx;
    }
    const int count = stretch->width_px;
    for (int x = 0; x < count; x++) {
        float sum = 0.0f;
        for (int y = 0; y < BLOCK; y++) {
            const float d = test[y][x] - reference[y][x];
            sum += d == d ? d * d : 0.0f;
        }
        sums[x] += sum;
    }
}

static void vote_stretch(struct state *state, int row, struct stretch *stretch)
{
    float sums[MOVE_COUNT][STRETCH] = {{0.0f}};
    for (int plane = 0; plane < state->pair.plane_count; plane++) {
        find_rows(&state->pair, plane, row * BLOCK, stretch);
        for (int m = 0; m < MOVE_COUNT; m++)
            add_squares(stretch, moves[m], sums[m]);
    }
    for (int block = 0; block < stretch->width_px / BLOCK; block++) {
        const int column = stretch->first_x / BLOCK + block;
        float least = INFINITY;
        uint8_t best = 0;
        for (uint8_t m = 0; m < MOVE_COUNT; m++) {
            const float *s = &sums[m][block * BLOCK];
            float sum = ((s[0] + s[4]) + (s[1] + s[5])) + ((s[2] + s[6]) + (s[3] + s[7]));
            if (sum < least) {
                least = sum;
                best = m;
            }
        }
        state->best[(size_t)row * (size_t)state->columns + (size_t)column] = best;
    }
}

static void vote_row(int row, void *context)
{
    struct state *state = context;
    struct stretch stretch = {.first_x = 0};
    for (int x = 0; x < STRETCH; x++)
        stretch.nothing[x] = NAN;
    while (stretch.first_x < state->pair.width_px) {
        stretch.width_px = stretch_width(state->pair.width_px, stretch.first_x);
        vote_stretch(state, row, &stretch);
        stretch.first_x += stretch.width_px;
    }
}

static enum neph_status extract(void *opaque, const struct neph_frame_pair *pair,
                                struct neph_diag *diag)
{
    struct state *state = opaque;
    state->pair = *pair;
    return neph_parallel_rows((pair->height_px + BLOCK - 1) / BLOCK, vote_row, state, diag);
}

/* ---- the maps -------------------------------------------------------------------------------- */

/* Positions in the rows of three planes. */
struct rgb {
    const float *plane[3];
};

static struct rgb row_of(const float *const planes[3], size_t first)
{
    return (struct rgb){{planes[0] + first, planes[1] + first, planes[2] + first}};
}

NEPH_VECTOR static void mean_squares(const struct rgb *from, const struct rgb *to, size_t count,
                                     double *restrict mean)
{
    const float *fr = from->plane[0], *fg = from->plane[1], *fb = from->plane[2];
    const float *tr = to->plane[0], *tg = to->plane[1], *tb = to->plane[2];
    for (size_t i = 0; i < count; i++) {
        const double r = (double)tr[i] - (double)fr[i], g = (double)tg[i] - (double)fg[i],
                     b = (double)tb[i] - (double)fb[i];
        mean[i] = (r * r + g * g + b * b) * (1.0 / 3.0);
    }
}

/* Compare pixels first_x .. first_x + count - 1 of row y with the test's pixels `step_px` further
 * right in row `test_y`. */
static void compare(const struct neph_frame_pair *pair, int first_x, int count, int y, int test_y,
                    int step_px, double *row)
{
    const size_t width = (size_t)pair->width_px, x = (size_t)first_x;
    const struct rgb from = row_of(pair->reference, (size_t)y * width + x);
    const struct rgb to = row_of(pair->test, (size_t)test_y * width + x + (size_t)step_px);
    mean_squares(&from, &to, (size_t)count, row + x);
}

/* Compare pixels first_x .. end_x - 1 of a row under one shift. */
static void compare_moved(const struct neph_frame_pair *pair, int first_x, int end_x, int y,
                          struct move move, double *row)
{
    const int test_y = clamped(y + move.dy, pair->height_px);
    if (first_x + move.dx < 0) {
        compare(pair, first_x, 1, y, test_y, 0, row);
        first_x++;
    }
    if (end_x + move.dx > pair->width_px) {
        end_x--;
        compare(pair, end_x, 1, y, test_y, 0, row);
    }
    if (first_x < end_x)
        compare(pair, first_x, end_x - first_x, y, test_y, move.dx, row);
}

static void moved_row(const struct state *state, int y, double *row)
{
    const struct neph_frame_pair *pair = &state->pair;
    const uint8_t *best = state->best + (size_t)(y / BLOCK) * (size_t)state->columns;
    int column = 0;
    while (column < state->columns) {
        int next = column + 1;
        while (next < state->columns && best[next] == best[column])
            next++;
        const int end_x = next < state->columns ? next * BLOCK : pair->width_px;
        compare_moved(pair, column * BLOCK, end_x, y, moves[best[column]], row);
        column = next;
    }
}

static void rows(const void *opaque, int map, int first_row, int row_count, double *const values[3])
{
    const struct state *state = opaque;
    const struct neph_frame_pair *pair = &state->pair;
    for (int y = first_row; y < first_row + row_count; y++) {
        double *row = values[0] + (size_t)(y - first_row) * (size_t)pair->width_px;
        if (map == MAP_MOVED)
            moved_row(state, y, row);
        else
            compare(pair, 0, pair->width_px, y, y, 0, row);
    }
}

static const struct neph_option options[] = {{.name = NULL}};

static const struct neph_metric metrics[] = {
    {"rmse_shift1", NULL, 0.0, INFINITY, NEPH_POOL_ROOT_MEAN, 0.0, MAP_MOVED, 0,
     "rmse with each block of 8x8 px moved by up to 1 px to where it fits best"},
    {"shift_gain", "1", 0.0, INFINITY, NEPH_POOL_ROOT_MEAN_OVER, 0.0, MAP_MOVED, MAP_AS_IS,
     "rmse_shift1 / rmse: near 0 the image is 1 px off, near 1 it is wrong"},
    {.name = NULL},
};

static const struct neph_map maps[] = {
    [MAP_AS_IS] = {.name = NULL, .unit = "unit^2", .plane_count = 1},
    [MAP_MOVED] = {.name = NULL, .unit = "unit^2", .plane_count = 1},
};

const struct neph_extractor neph_extractor_shift = {
    .name = "shift",
    .help =
        "error that remains when blocks may shift by a pixel: separates shifted from wrong edges",
    .source = "least squares over the nine moves of each block, as in exhaustive block matching",
    .quantities = NEPH_LINEAR_RGB,
    .options = options,
    .metrics = metrics,
    .maps = maps,
    .map_count = MAP_COUNT,
    .state_size = sizeof(struct state),
    .init = init,
    .extract = extract,
    .rows = rows,
};
