/* SPDX-License-Identifier: MIT
 *
 * Blue noise has the ranks that void and cluster defines, spectra that white noise cannot have, and
 * a cache that never gives anything else. Needs no Vulkan.
 *
 * Spectra are in units of white noise of the same histogram: the periodogram of N independent
 * values, divided by their variance, has mean 1 and, by the central limit theorem, exponential
 * values, independent but for P(-k) = P(k). A mean of M independent ones is Gamma(M) / M.
 */
#include "tests/base/scratch.h"

#include "renderer/blue_noise.h"

#include <sys/stat.h>

enum { SIDE_PX = 32, FRAMES = 8, FULL_SIDE_PX = 64, FULL_FRAMES = 32, PIXELS_MAX = 64 * 64 };

/* Low frequencies are those below a quarter of Nyquist's: 48 of a 32x32 slice, 24 of them
 * independent. White noise passes with the probability that Gamma(24) < 2.4, which is 2e-16. */
static const double low_power_max = 0.1;

/* Means over all pixels of the periodogram at one frequency have the standard deviation
 * 1 / sqrt(32 * 32) = 3 %: white noise is 16 of them away. */
static const double low_frame_power_max = 0.5;

static const struct neph_blue_noise_request spatial = {SIDE_PX, SIDE_PX, 1, 7};
static const struct neph_blue_noise_request spatiotemporal = {SIDE_PX, SIDE_PX, FRAMES, 7};

static struct neph_blue_noise *make(const struct neph_blue_noise_request *request)
{
    struct neph_blue_noise *noise = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_blue_noise_create(request, &noise, &diag), &diag);
    return noise;
}

static int wrap(int value, int period)
{
    const int rest = value % period;
    return rest < 0 ? rest + period : rest;
}

/* In 0 .. 1 without the ends; pixels and frames go on without end, by repetition. */
static double value_at(const struct neph_blue_noise *noise, int x_px, int y_px, uint32_t frame)
{
    const int width = noise->request.width_px, height = noise->request.height_px;
    const int slice = (int)(frame % (uint32_t)noise->request.frame_count);
    const int x = wrap(x_px, width), y = wrap(y_px, height);
    return (noise->ranks[(slice * height + y) * width + x] + 0.5) / (width * height);
}

static size_t rank_bytes(const struct neph_blue_noise *noise)
{
    return sizeof(*noise->ranks) * (size_t)noise->request.width_px *
           (size_t)noise->request.height_px * (size_t)noise->request.frame_count;
}

/* ---- ranks ----------------------------------------------------------------------------------- */

static void assert_each_rank_once(const struct neph_blue_noise *noise)
{
    const int count = noise->request.width_px * noise->request.height_px;
    for (int frame = 0; frame < noise->request.frame_count; frame++) {
        int seen[PIXELS_MAX] = {0};
        for (int i = 0; i < count; i++) {
            const int rank = noise->ranks[frame * count + i];
            neph_assert_in_range(rank, 0, count - 1);
            assert_int_equal(seen[rank]++, 0);
        }
    }
}

static void test_every_slice_has_every_rank_once(void **state)
{
    static const struct neph_blue_noise_request requests[] = {
        {32, 32, 1, 7}, {32, 32, 8, 7}, {1, 1, 1, 0},
        {1, 1, 5, 0},   {2, 1, 3, 1},   {16, 1, 1, 2},
        {1, 16, 4, 3},  {13, 7, 5, 4},  {7, 13, 1, ~UINT64_C(0)},
    };
    for (size_t i = 0; i < sizeof(requests) / sizeof(requests[0]); i++) {
        struct neph_blue_noise *noise = make(&requests[i]);
        assert_each_rank_once(noise);
        neph_blue_noise_destroy(noise);
    }
}

static double torus_distance(int a, int b, int period)
{
    const int there = abs(a - b);
    return fmin(there, period - there);
}

/* The energy of pixel `at` from the pixels of ranks below `end`, itself left out, in doubles and
 * from the definition. */
static double energy_of(const struct neph_blue_noise *noise, int at, int end)
{
    const int width = noise->request.width_px, height = noise->request.height_px;
    double sum = 0.0;
    for (int i = 0; i < width * height; i++) {
        const double dx = torus_distance(i % width, at % width, width);
        const double dy = torus_distance(i / width, at / width, height);
        if (noise->ranks[i] < end && i != at)
            sum += exp(-(dx * dx + dy * dy) /
                       (2.0 * NEPH_BLUE_NOISE_SIGMA_PX * NEPH_BLUE_NOISE_SIGMA_PX));
    }
    return sum;
}

/* The random bits that decide between equal energies, and the rounding of the kernel. */
static const double tie = 0x1p-44 + 1024 * 0x1p-56;

/* Void and cluster, replayed without its shortcuts: after the first pattern each rank is the
 * largest void of what lies below it, and within that pattern the tightest cluster of what is left.
 */
static void test_ranks_are_voids_and_clusters(void **state)
{
    static const struct neph_blue_noise_request request = {20, 12, 1, 3};
    struct neph_blue_noise *noise = make(&request);
    enum { COUNT = 20 * 12, FIRST_COUNT = COUNT / 10 };
    for (int rank = 0; rank < COUNT; rank++) {
        double chosen = 0.0, least = INFINITY, most = 0.0;
        for (int i = 0; i < COUNT; i++) {
            const bool is_filling = rank >= FIRST_COUNT;
            const double energy = energy_of(noise, i, is_filling ? rank : rank + 1);
            if (noise->ranks[i] == rank)
                chosen = energy;
            if (noise->ranks[i] >= rank)
                least = fmin(least, energy);
            if (noise->ranks[i] <= rank)
                most = fmax(most, energy);
        }
        if (rank >= FIRST_COUNT)
            assert_true(chosen <= least + tie);
        else
            assert_true(chosen >= most - tie);
    }
    neph_blue_noise_destroy(noise);
}

/* Variance of the mean of 3x3 pixels around a column, and around the row of the same number. */
static double window_variance(const struct neph_blue_noise *noise, int column)
{
    double sum = 0.0;
    for (int i = 0; i < FRAMES * SIDE_PX; i++) {
        double across = 0.0, down = 0.0;
        for (int k = 0; k < 9; k++) {
            const int near = column - 1 + k % 3, along = i % SIDE_PX + k / 3;
            const uint32_t frame = (uint32_t)(i / SIDE_PX);
            across += (value_at(noise, near, along, frame) - 0.5) / 9.0;
            down += (value_at(noise, along, near, frame) - 0.5) / 9.0;
        }
        sum += across * across + down * down;
    }
    return sum / (2 * FRAMES * SIDE_PX);
}

/* Neighbours repel each other, round the torus too: the mean of 3x3 pixels varies far less than
 * 1/108, that of white noise. Of the 512 windows about a column 512 / 3 are independent, so that
 * the variance is known to sqrt(2 / 170) = 11 %: half of 1/108 is 4.6 standard deviations away. */
static void test_neighbours_repel_across_the_seam(void **state)
{
    struct neph_blue_noise *noise = make(&spatiotemporal);
    for (int column = 0; column < SIDE_PX; column++) /* 0 and 31 see the seam */
        assert_true(window_variance(noise, column) < 0.5 / 108.0);
    neph_blue_noise_destroy(noise);
}

static void test_the_seed_decides(void **state)
{
    struct neph_blue_noise *first = make(&spatiotemporal), *same = make(&spatiotemporal);
    struct neph_blue_noise_request request = spatiotemporal;
    request.seed++;
    struct neph_blue_noise *other = make(&request);
    assert_memory_equal(first->ranks, same->ranks, rank_bytes(first));
    int equal_count = 0;
    for (int i = 0; i < SIDE_PX * SIDE_PX; i++)
        equal_count += first->ranks[i] == other->ranks[i];
    neph_assert_in_range(equal_count, 0, 10); /* Poisson of mean 1: more than 10 in 1e-8 of seeds */
    neph_blue_noise_destroy(first);
    neph_blue_noise_destroy(same);
    neph_blue_noise_destroy(other);
}

static void test_sizes_out_of_range_are_refused(void **state)
{
    static const struct neph_blue_noise_request requests[] = {
        {0, 8, 1, 0}, {8, -1, 1, 0}, {8, 8, 0, 0}, {257, 8, 1, 0}, {8, 257, 1, 0}, {8, 8, 257, 0},
    };
    for (size_t i = 0; i < sizeof(requests) / sizeof(requests[0]); i++) {
        struct neph_blue_noise *noise = NULL;
        assert_int_equal(neph_blue_noise_create(&requests[i], &noise, NULL), NEPH_ERR_INTERNAL);
        assert_null(noise);
    }
}

/* ---- spectra --------------------------------------------------------------------------------- */

/* Stacks of values, so that white noise takes the same tests. */
struct stack {
    int side, frames;
    double *values;
};

static struct stack stack_of(const struct neph_blue_noise *noise)
{
    const struct neph_blue_noise_request *request = &noise->request;
    struct stack stack = {request->width_px, request->frame_count, NULL};
    assert_int_equal(request->width_px, request->height_px);
    stack.values = calloc((size_t)stack.side * (size_t)stack.side * (size_t)stack.frames,
                          sizeof(double));
    double *value = stack.values;
    for (int frame = 0; frame < stack.frames; frame++)
        for (int y = 0; y < stack.side; y++)
            for (int x = 0; x < stack.side; x++)
                *value++ = value_at(noise, x, y, (uint32_t)frame);
    return stack;
}

static struct stack white_stack(int side, int frames, uint64_t seed)
{
    const size_t count = (size_t)side * (size_t)side * (size_t)frames;
    struct stack stack = {side, frames, calloc(count, sizeof(double))};
    for (size_t i = 0; i < count; i++)
        stack.values[i] = neph_test_uniform(&seed, 0.0, 1.0);
    return stack;
}

/* Power at (kx, ky) cycles per side. */
static double power_at(const double *slice, int side, int kx, int ky)
{
    double re = 0.0, im = 0.0, cosines[64], sines[64];
    for (int i = 0; i < side; i++) {
        cosines[i] = cos(2.0 * M_PI * i / side);
        sines[i] = sin(2.0 * M_PI * i / side);
    }
    for (int y = 0; y < side; y++)
        for (int x = 0; x < side; x++) {
            const int phase = (kx * x + ky * y + 64 * side * side) % side;
            re += (slice[y * side + x] - 0.5) * cosines[phase];
            im += (slice[y * side + x] - 0.5) * sines[phase];
        }
    return 12.0 * (re * re + im * im) / (side * side);
}

/* Mean power of the ring low <= |k| < high, without 0: the radially averaged spectrum. */
static double ring_power(const double *slice, int side, double low, double high)
{
    double sum = 0.0;
    int count = 0;
    for (int ky = -side / 2; ky < side / 2; ky++)
        for (int kx = 0; kx < side / 2; kx++) { /* the other half is its mirror image */
            const double radius = hypot(kx, ky);
            if (radius < low || radius >= high || radius == 0.0 || (kx == 0 && ky < 0))
                continue;
            sum += power_at(slice, side, kx, ky);
            count++;
        }
    return sum / count;
}

static double worst_low_power(const struct stack *stack)
{
    double worst = 0.0;
    for (int frame = 0; frame < stack->frames; frame++)
        worst = fmax(worst, ring_power(stack->values + frame * stack->side * stack->side,
                                       stack->side, 0.0, stack->side / 8.0));
    return worst;
}

/* Power at k cycles per stack of the values of a pixel in time, averaged over the pixels. */
static double frame_power(const struct stack *stack, int k)
{
    const int pixel_count = stack->side * stack->side;
    double sum = 0.0;
    for (int pixel = 0; pixel < pixel_count; pixel++) {
        double re = 0.0, im = 0.0;
        for (int frame = 0; frame < stack->frames; frame++) {
            const double value = stack->values[frame * pixel_count + pixel] - 0.5;
            re += value * cos(2.0 * M_PI * k * frame / stack->frames);
            im += value * sin(2.0 * M_PI * k * frame / stack->frames);
        }
        sum += 12.0 * (re * re + im * im) / stack->frames;
    }
    return sum / pixel_count;
}

/* Frequencies up to a quarter of Nyquist's; 0 is among them. */
static double worst_low_frame_power(const struct stack *stack)
{
    double worst = 0.0;
    for (int k = 0; 8 * k <= stack->frames; k++)
        worst = fmax(worst, frame_power(stack, k));
    return worst;
}

static void assert_blue(const char *what, const struct stack *stack)
{
    const double low = worst_low_power(stack);
    print_message("%s: power at low frequencies %.2g of white noise's", what, low);
    if (stack->frames > 1)
        print_message(", in time %.2g", worst_low_frame_power(stack));
    print_message("\n");
    assert_true(low < low_power_max);
    if (stack->frames > 1)
        assert_true(worst_low_frame_power(stack) < low_frame_power_max);
}

static void test_spatial_noise_is_blue(void **state)
{
    struct neph_blue_noise *noise = make(&spatial);
    struct stack stack = stack_of(noise);
    assert_blue("32x32", &stack);
    /* What low frequencies lack, high ones have: the mean over all is that of white noise. */
    assert_true(ring_power(stack.values, SIDE_PX, SIDE_PX / 4.0, SIDE_PX) > 1.0);
    free(stack.values);
    neph_blue_noise_destroy(noise);
}

static void test_spatiotemporal_noise_is_blue_twice(void **state)
{
    struct neph_blue_noise *noise = make(&spatiotemporal);
    struct stack stack = stack_of(noise);
    assert_blue("32x32x8", &stack);
    free(stack.values);
    neph_blue_noise_destroy(noise);
}

static void test_white_noise_fails(void **state)
{
    struct stack stack = white_stack(SIDE_PX, FRAMES, 11);
    for (int frame = 0; frame < FRAMES; frame++)
        assert_true(ring_power(stack.values + frame * SIDE_PX * SIDE_PX, SIDE_PX, 0.0,
                               SIDE_PX / 8.0) > low_power_max);
    assert_true(frame_power(&stack, 1) > low_frame_power_max);
    /* All ring: Gamma of some 500 values, within 5 standard deviations of 1. */
    neph_assert_close(ring_power(stack.values, SIDE_PX, 0.0, SIDE_PX), 1.0, 0.0, 5 / sqrt(500.0));
    free(stack.values);
}

/* Spatial masks of many seeds, one after the other, are white in time. */
static void test_unrelated_slices_fail_in_time(void **state)
{
    enum { COUNT = SIDE_PX * SIDE_PX };
    struct stack stack = white_stack(SIDE_PX, FRAMES, 1);
    for (int frame = 0; frame < FRAMES; frame++) {
        struct neph_blue_noise_request request = spatial;
        request.seed = 100 + (uint64_t)frame;
        struct neph_blue_noise *noise = make(&request);
        struct stack slice = stack_of(noise);
        memcpy(stack.values + frame * COUNT, slice.values, COUNT * sizeof(double));
        free(slice.values);
        neph_blue_noise_destroy(noise);
    }
    assert_true(worst_low_power(&stack) < low_power_max);
    assert_true(frame_power(&stack, 1) > low_frame_power_max);
    free(stack.values);
}

/* ---- the cache ------------------------------------------------------------------------------- */

static struct neph_blue_noise *load(const struct neph_blue_noise_request *request,
                                    const char *folder)
{
    struct neph_blue_noise *noise = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_blue_noise_load(request, folder, &noise, &diag), &diag);
    return noise;
}

static void read_whole(const char *path, char **data, size_t *size)
{
    struct neph_diag diag = {0};
    neph_assert_ok(neph_file_read(path, 1 << 20, data, size, &diag), &diag);
}

/* Loading gives the right ranks and leaves the right file, whatever lay there. */
static void assert_mended(const struct neph_blue_noise_request *request, const char *folder,
                          const char *path, const struct neph_blue_noise *right,
                          const char *right_file, size_t right_size)
{
    struct neph_blue_noise *noise = load(request, folder);
    assert_memory_equal(noise->ranks, right->ranks, rank_bytes(right));
    neph_blue_noise_destroy(noise);
    char *data;
    size_t size;
    read_whole(path, &data, &size);
    assert_int_equal(size, right_size);
    assert_memory_equal(data, right_file, right_size);
    free(data);
}

static void test_a_damaged_cache_is_made_again(void **state)
{
    static const struct neph_blue_noise_request request = {4, 3, 2, 9};
    char folder[SCRATCH_PATH_MAX], *data = NULL;
    size_t size = 0;
    scratch_path(state, folder, "deep/er");
    struct neph_blue_noise *right = make(&request);
    char *path = neph_blue_noise_path(&request, folder);
    neph_blue_noise_destroy(load(&request, folder));
    read_whole(path, &data, &size);
    char *damaged = malloc(size + 1);
    for (size_t i = 0; i <= size; i++) { /* each byte wrong; each cut; one byte more */
        memcpy(damaged, data, size);
        damaged[i] = (char)(i < size ? data[i] ^ 0x10 : 'x');
        scratch_write(path, damaged, i < size ? size : size + 1);
        assert_mended(&request, folder, path, right, data, size);
        scratch_write(path, data, i < size ? i : 0);
        assert_mended(&request, folder, path, right, data, size);
    }
    free(damaged);
    free(data);
    free(path);
    neph_blue_noise_destroy(right);
}

/* A whole file of another request under this one's name. */
static void test_another_mask_is_not_taken(void **state)
{
    const struct scratch *scratch = *state;
    static const struct neph_blue_noise_request request = {6, 5, 2, 9}, other = {6, 5, 2, 10};
    char *path = neph_blue_noise_path(&request, scratch->folder);
    char *other_path = neph_blue_noise_path(&other, scratch->folder);
    struct neph_blue_noise *right = make(&request);
    neph_blue_noise_destroy(load(&other, scratch->folder));
    neph_assert_ok(neph_file_copy(other_path, path, NULL), NULL);
    struct neph_blue_noise *noise = load(&request, scratch->folder);
    assert_memory_equal(noise->ranks, right->ranks, rank_bytes(right));
    assert_int_equal(scratch_count(state), 2); /* no temporary file is left */
    neph_blue_noise_destroy(noise);
    neph_blue_noise_destroy(right);
    free(path);
    free(other_path);
}

static void test_a_folder_that_cannot_be_made_is_said(void **state)
{
    char folder[SCRATCH_PATH_MAX];
    struct neph_diag diag = {0};
    struct neph_blue_noise *noise = NULL;
    scratch_path(state, folder, "file");
    neph_assert_ok(neph_file_write(folder, "x", 1, NULL), NULL);
    assert_int_equal(
        neph_blue_noise_load(&(struct neph_blue_noise_request){4, 4, 1, 0}, folder, &noise, &diag),
        NEPH_ERR_IO);
    assert_null(noise);
    assert_true(diag.message[0] != '\0');
}

/* The mask of the renderer: made once, then read. The second load takes the file that is there: it
 * does not write another (its time of change stays). */
static void test_the_full_mask_comes_from_the_cache(void **state)
{
    const struct scratch *scratch = *state;
    static const struct neph_blue_noise_request request = {FULL_SIDE_PX, FULL_SIDE_PX, FULL_FRAMES,
                                                           0};
    char *path = neph_blue_noise_path(&request, scratch->folder);
    struct neph_blue_noise *noise = load(&request, scratch->folder);
    struct stat before, after;
    assert_int_equal(stat(path, &before), 0);
    struct neph_blue_noise *again = load(&request, scratch->folder);
    assert_int_equal(stat(path, &after), 0);
    assert_true(before.st_ino == after.st_ino);
    assert_memory_equal(noise->ranks, again->ranks, rank_bytes(noise));
    assert_each_rank_once(again);
    struct stack stack = stack_of(again);
    assert_blue("64x64x32", &stack);
    free(stack.values);
    free(path);
    neph_blue_noise_destroy(noise);
    neph_blue_noise_destroy(again);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_slice_has_every_rank_once),
        cmocka_unit_test(test_ranks_are_voids_and_clusters),
        cmocka_unit_test(test_neighbours_repel_across_the_seam),
        cmocka_unit_test(test_the_seed_decides),
        cmocka_unit_test(test_sizes_out_of_range_are_refused),
        cmocka_unit_test(test_spatial_noise_is_blue),
        cmocka_unit_test(test_spatiotemporal_noise_is_blue_twice),
        cmocka_unit_test(test_white_noise_fails),
        cmocka_unit_test(test_unrelated_slices_fail_in_time),
        scratch_test(test_a_damaged_cache_is_made_again),
        scratch_test(test_another_mask_is_not_taken),
        scratch_test(test_a_folder_that_cannot_be_made_is_said),
        scratch_test(test_the_full_mask_comes_from_the_cache),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
