/* SPDX-License-Identifier: MIT
 *
 * The place of the largest error and the histogram of errors: by hand, and against a search over
 * all samples.
 */
#include "tests/neph_test.h"

#include "metrics/error_histogram.h"
#include "metrics/largest_error.h"

enum { W = 37, H = 11, SEED = 20261130 };

struct pair {
    struct neph_image *images[2]; /* reference, test */
    float *planes[2][3];
};

static struct pair create_pair(void)
{
    struct pair pair = {.images = {NULL}};
    for (int i = 0; i < 2; i++) {
        neph_assert_ok(neph_image_create(W, H, &pair.images[i], NULL), NULL);
        neph_assert_ok(neph_image_add_rgb(pair.images[i], NULL, pair.planes[i], NULL), NULL);
    }
    return pair;
}

static void destroy_pair(struct pair *pair)
{
    neph_image_destroy(pair->images[0]);
    neph_image_destroy(pair->images[1]);
}

static void add(struct neph_largest_error *largest, const struct pair *pair, int frame)
{
    neph_largest_error_add(largest, pair->images[0], pair->images[1], frame);
}

static void test_by_hand(void **state)
{
    struct pair pair = create_pair();
    struct neph_largest_error largest = {false};
    add(&largest, &pair, 0);
    assert_false(largest.is_known); /* equal images */
    pair.planes[0][1][3 * W + 5] = 2.0f;
    pair.planes[1][1][3 * W + 5] = 1.5f;
    pair.planes[1][2][7 * W + 36] = 0.5f; /* as large, later */
    add(&largest, &pair, 4);
    assert_true(largest.is_known && largest.channel == 'G' && largest.frame == 4);
    assert_true(largest.x_px == 5 && largest.y_px == 3);
    assert_true(largest.reference == 2.0 && largest.test == 1.5);
    add(&largest, &pair, 5);
    assert_int_equal(largest.frame, 4); /* the first frame with it */
    pair.planes[1][2][7 * W + 36] = 0.75f;
    add(&largest, &pair, 6);
    assert_true(largest.channel == 'B' && largest.frame == 6 && largest.x_px == 36);
    destroy_pair(&pair);
}

static void test_against_a_search(void **state)
{
    uint64_t random = SEED;
    for (int round = 0; round < 50; round++) {
        struct pair pair = create_pair();
        struct neph_largest_error largest = {false};
        double most = 0.0;
        for (int c = 0; c < 3; c++)
            for (int i = 0; i < W * H; i++) {
                const double r = neph_test_uniform(&random, 0.0, 1e3);
                pair.planes[0][c][i] = (float)r;
                pair.planes[1][c][i] = (float)(r + neph_test_uniform(&random, -1e-3, 1e-3));
                most = fmax(most,
                            fabs((double)pair.planes[1][c][i] - (double)pair.planes[0][c][i]));
            }
        add(&largest, &pair, 0);
        const int place = largest.y_px * W + largest.x_px;
        const int c = largest.channel == 'R' ? 0 : largest.channel == 'G' ? 1 : 2;
        if (fabs(largest.test - largest.reference) != most ||
            largest.test != (double)pair.planes[1][c][place])
            fail_msg("seed %d, round %d: %g, expected %g", SEED, round,
                     fabs(largest.test - largest.reference), most);
        destroy_pair(&pair);
    }
}

static void assert_count(const struct neph_error_histogram *histogram, int first, int last,
                         uint64_t expected)
{
    assert_int_equal(neph_histogram_count(histogram, first, last), expected);
}

static void test_histogram_by_hand(void **state)
{
    static const float tests[] = {0.25f, 0.8f, 1.0f, 1.00005f, 1.5f, 11.0f, 100.0f, -9.5f};
    enum { SAMPLES = 3 * W * H, EDGES = NEPH_HISTOGRAM_EDGES };
    struct pair pair = create_pair();
    struct neph_error_histogram histogram = {.count = 0};
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < W * H; i++)
            pair.planes[0][c][i] = pair.planes[1][c][i] = 1.0f;
    for (size_t i = 0; i < sizeof(tests) / sizeof(tests[0]); i++)
        pair.planes[1][1][i] = tests[i];
    pair.planes[1][2][4] = INFINITY;
    pair.planes[0][2][5] = NAN;
    /* The mean is NaN with it: a floor of 0. */
    neph_assert_ok(neph_histogram_add(&histogram, pair.images[0], pair.images[1], NULL), NULL);
    assert_int_equal(histogram.count, SAMPLES - 2);
    assert_int_equal(histogram.not_finite, 2);
    assert_true(neph_histogram_edge(0) == -10.0 && neph_histogram_edge(10) == -1e-4);
    assert_true(neph_histogram_edge(11) == 1e-4 && neph_histogram_edge(EDGES - 1) == 10.0);
    assert_count(&histogram, -1, 0, 1);            /* -10.5 */
    assert_count(&histogram, 2, 3, 1);             /* -0.75 */
    assert_count(&histogram, 2, 4, 2);             /* and -0.2 */
    assert_count(&histogram, 10, 11, SAMPLES - 8); /* equal, and 5e-5 */
    assert_count(&histogram, 18, 19, 1);           /* 0.5 */
    assert_count(&histogram, EDGES - 1, EDGES, 2); /* 10, an edge, and 99 */
    assert_count(&histogram, -1, EDGES, SAMPLES - 2);
    destroy_pair(&pair);
}

static void test_histogram_against_a_search(void **state)
{
    enum { EDGES = NEPH_HISTOGRAM_EDGES };
    uint64_t random = SEED, expected[EDGES + 1] = {0};
    struct neph_error_histogram histogram = {.count = 0};
    struct pair pair = create_pair();
    double luminance = 0.0;
    for (int i = 0; i < W * H; i++)
        for (int c = 0; c < 3; c++) {
            const double r = fmax(0.0, neph_test_uniform(&random, -0.2, 1.0));
            const double e = pow(10.0, neph_test_uniform(&random, -6.0, 2.0));
            pair.planes[0][c][i] = (float)r;
            pair.planes[1][c][i] = (float)(r * (1.0 + (i % 2 ? e : -e)));
            luminance += (double[]){0.2126, 0.7152, 0.0722}[c] * (double)(float)r / (W * H);
        }
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < W * H; i++) {
            const double r = (double)pair.planes[0][c][i];
            const double e = ((double)pair.planes[1][c][i] - r) / fmax(r, 1e-4 * luminance);
            int bin = 0;
            while (bin < EDGES && e >= neph_histogram_edge(bin))
                bin++;
            expected[bin]++;
        }
    for (int frame = 0; frame < 2; frame++)
        neph_assert_ok(neph_histogram_add(&histogram, pair.images[0], pair.images[1], NULL), NULL);
    for (int bin = 0; bin <= EDGES; bin++)
        assert_count(&histogram, bin - 1, bin, 2 * expected[bin]);
    destroy_pair(&pair);
}

#include "tests/main.h"
