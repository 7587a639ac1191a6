/* SPDX-License-Identifier: MIT
 *
 * The shipped blue-noise masks: each slice has every rank once, the spectra are blue, and a seed
 * shifts the masks on their torus. Needs no Vulkan.
 *
 * Spectra are in units of white noise with the same histogram. The periodogram of N independent
 * values over their variance has mean 1; by the central limit theorem its values are exponential,
 * and independent except for P(-k) = P(k). The mean of M independent values is Gamma(M) / M.
 */
#include "tests/base/scratch.h"

#include "base/png.h"
#include "renderer/blue_noise.h"

enum {
    SIDE = NEPH_BLUE_NOISE_SIDE_PX,
    PIXELS = NEPH_BLUE_NOISE_PIXELS,
    FRAMES = NEPH_BLUE_NOISE_FRAMES,
    SLICES = NEPH_BLUE_NOISE_SLICES,
    COUNT_ALL = NEPH_BLUE_NOISE_COUNT,
};

static const char path[] = NEPH_SOURCE_DIR "/renderer/blue_noise.png";

/* Low frequencies: below a quarter of Nyquist's, 192 in a slice, 96 of them independent. White
 * noise passes with the probability of Gamma(96) < 9.6, which is below 1e-50. */
static const double low_power_max = 0.1;

/* The mean over all pixels of the periodogram at one frequency has the standard deviation 1 / 64,
 * so white noise exceeds this limit by 32 of them. */
static const double low_frame_power_max = 0.5;

static uint32_t *load(uint32_t seed)
{
    uint32_t *ranks = calloc(COUNT_ALL, sizeof(*ranks));
    struct neph_diag diag = {0};
    neph_assert_ok(neph_blue_noise_load(path, seed, ranks, &diag), &diag);
    return ranks;
}

static double mask_value(uint32_t rank)
{
    return (rank + 0.5) / PIXELS - 0.5;
}

static uint32_t *white_noise(uint64_t seed)
{
    uint32_t *ranks = calloc(COUNT_ALL, sizeof(*ranks));
    for (int i = 0; i < COUNT_ALL; i++)
        ranks[i] = (uint32_t)(neph_test_random(&seed) % PIXELS);
    return ranks;
}

/* ---- spectra --------------------------------------------------------------------------------- */

/* Power at (kx, ky) cycles per side. */
static double power_at(const uint32_t *slice, int kx, int ky, const double cosines[SIDE])
{
    double re = 0.0, im = 0.0;
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++) {
            const unsigned phase = (unsigned)(kx * x + ky * y);
            re += mask_value(slice[y * SIDE + x]) * cosines[phase % SIDE];
            im += mask_value(slice[y * SIDE + x]) * cosines[(phase + SIDE / 4) % SIDE];
        }
    return 12.0 * (re * re + im * im) / PIXELS;
}

/* Mean power of the ring low <= |k| < high, without 0: the radially averaged spectrum. */
static double ring_power(const uint32_t *slice, double low, double high)
{
    double sum = 0.0, cosines[SIDE];
    int count = 0;
    for (int i = 0; i < SIDE; i++)
        cosines[i] = cos(2.0 * M_PI * i / SIDE);
    for (int ky = -SIDE / 2; ky < SIDE / 2; ky++)
        for (int kx = 0; kx < SIDE / 2; kx++) { /* the other half is its mirror image */
            const double radius = hypot(kx, ky);
            if (radius < low || radius >= high || radius == 0.0 || (kx == 0 && ky < 0))
                continue;
            sum += power_at(slice, kx, ky, cosines);
            count++;
        }
    return sum / count;
}

static double low_power(const uint32_t *slice)
{
    return ring_power(slice, 0.0, SIDE / 8.0);
}

/* Power at k cycles in 32 frames, averaged over the pixels. */
static double frame_power(const uint32_t *stack, int k)
{
    double sum = 0.0, cosines[FRAMES];
    for (int i = 0; i < FRAMES; i++)
        cosines[i] = cos(2.0 * M_PI * i / FRAMES);
    for (int pixel = 0; pixel < PIXELS; pixel++) {
        double re = 0.0, im = 0.0;
        for (int frame = 0; frame < FRAMES; frame++) {
            re += mask_value(stack[frame * PIXELS + pixel]) * cosines[k * frame % FRAMES];
            im += mask_value(stack[frame * PIXELS + pixel]) *
                  cosines[(k * frame + FRAMES / 4) % FRAMES];
        }
        sum += 12.0 * (re * re + im * im) / FRAMES;
    }
    return sum / PIXELS;
}

static void test_every_slice_is_blue(void **state)
{
    OWNED(memory) uint32_t *ranks = load(0);
    double worst = 0.0;
    for (int slice = 0; slice < SLICES; slice++)
        worst = fmax(worst, low_power(ranks + slice * PIXELS));
    print_message("power at low frequencies %.2g of white noise's\n", worst);
    assert_true(worst < low_power_max);
    /* The mean over all frequencies equals white noise's, so high frequencies exceed it. */
    assert_true(ring_power(ranks, SIDE / 4.0, SIDE) > 1.0);
}

/* Frequencies up to a quarter of Nyquist's, including 0. */
static void test_pixels_are_blue_over_time(void **state)
{
    OWNED(memory) uint32_t *ranks = load(0);
    double worst = 0.0;
    for (int k = 0; 8 * k <= FRAMES; k++)
        worst = fmax(worst, frame_power(ranks + PIXELS, k));
    print_message("power at low frequencies in time %.2g of white noise's\n", worst);
    assert_true(worst < low_frame_power_max);
}

static void test_white_noise_is_neither(void **state)
{
    OWNED(memory) uint32_t *ranks = white_noise(11);
    assert_true(low_power(ranks) > low_power_max);
    assert_true(frame_power(ranks + PIXELS, 1) > low_frame_power_max);
}

/* ---- ranks and shifts ------------------------------------------------------------------------ */

static void test_every_slice_has_every_rank_once(void **state)
{
    OWNED(memory) uint32_t *ranks = load(7);
    for (int slice = 0; slice < SLICES; slice++) {
        int seen[PIXELS] = {0};
        for (int i = 0; i < PIXELS; i++) {
            neph_assert_in_range(ranks[slice * PIXELS + i], 0, PIXELS - 1);
            assert_int_equal(seen[ranks[slice * PIXELS + i]]++, 0);
        }
    }
}

/* pcg(seed) computed with Python integers, and the shifts in its bits. */
static void test_a_seed_shifts_the_file_on_its_torus(void **state)
{
    static const struct {
        uint32_t seed, x, y, frame;
    } known[] = {{0u, 34, 63, 18}, {1u, 60, 40, 14}, {12345u, 14, 52, 10}, {4294967295u, 2, 36, 4}};
    int width_px, height_px;
    OWNED(memory) uint16_t *rgb = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_png_read_rgb16(path, &width_px, &height_px, &rgb, &diag), &diag);
    assert_int_equal(width_px, SIDE);
    assert_int_equal(height_px, SLICES / 3 * SIDE);
    for (size_t k = 0; k < COUNT(known); k++) {
        OWNED(memory) uint32_t *ranks = load(known[k].seed);
        for (uint32_t i = 0; i < COUNT_ALL; i++) {
            const uint32_t x = (i + known[k].x) % SIDE, y = (i / SIDE + known[k].y) % SIDE;
            const uint32_t slice = i < PIXELS ? 0 : 1 + (i / PIXELS - 1 + known[k].frame) % FRAMES;
            const uint32_t pixel = slice / 3 * PIXELS + y * SIDE + x;
            assert_int_equal(ranks[i], rgb[3 * pixel + slice % 3] / 16);
        }
    }
}

/* One pair of seeds in 4096 has the same shift in x and y; these 16 seeds have 16 different shifts.
 * A slice and its shifted copy agree in 1 rank on average; by a Poisson law in more than 10 with
 * probability 1e-8. */
static void test_seeds_differ(void **state)
{
    enum { SEEDS = 16 };
    uint32_t *ranks[SEEDS];
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        ranks[seed] = load(seed);
        for (uint32_t other = 0; other < seed; other++) {
            int equal_count = 0;
            for (int i = 0; i < PIXELS; i++)
                equal_count += ranks[seed][i] == ranks[other][i];
            neph_assert_in_range(equal_count, 0, 10);
        }
    }
    uint32_t *again = load(3);
    assert_memory_equal(again, ranks[3], COUNT_ALL * sizeof(*again));
    free(again);
    for (int seed = 0; seed < SEEDS; seed++)
        free(ranks[seed]);
}

/* ---- the file -------------------------------------------------------------------------------- */

static void assert_refused(const char *name, enum neph_status expected)
{
    static uint32_t ranks[COUNT_ALL];
    struct neph_diag diag = {0};
    assert_int_equal(neph_blue_noise_load(name, 0, ranks, &diag), expected);
    assert_non_null(strstr(diag.message, name));
    assert_non_null(strstr(diag.hint, "NEPH_DATA_DIR"));
}

static void test_another_file_is_refused_by_name(void **state)
{
    char name[SCRATCH_PATH_MAX], *data = NULL;
    size_t size = 0;
    scratch_path(state, name, "noise.png");
    assert_refused(name, NEPH_ERR_NOT_FOUND);
    neph_assert_ok(neph_file_read(path, 1 << 20, &data, &size, NULL), NULL);
    scratch_write(name, data, size - 1);
    assert_refused(name, NEPH_ERR_INPUT);
    data[size / 2] ^= 1;
    scratch_write(name, data, size);
    assert_refused(name, NEPH_ERR_INPUT);
    scratch_write(name, data, 0);
    assert_refused(name, NEPH_ERR_INPUT);
    free(data);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_slice_is_blue),
        cmocka_unit_test(test_pixels_are_blue_over_time),
        cmocka_unit_test(test_white_noise_is_neither),
        cmocka_unit_test(test_every_slice_has_every_rank_once),
        cmocka_unit_test(test_a_seed_shifts_the_file_on_its_torus),
        cmocka_unit_test(test_seeds_differ),
        scratch_test(test_another_file_is_refused_by_name),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
