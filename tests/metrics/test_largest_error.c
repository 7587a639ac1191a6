/* SPDX-License-Identifier: MIT
 *
 * The place of the largest error: by hand, and against a search over all samples.
 */
#include "tests/neph_test.h"

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

#include "tests/main.h"
