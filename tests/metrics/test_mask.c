/* SPDX-License-Identifier: MIT
 *
 * Masks on depth maps made by hand, and the depth edge against its literal definition.
 */
#include "tests/metrics/metrics_test.h"

enum { SIDE_MAX = 16 };

/* A depth map in letters: '.' sky, 'a' 1 m, 'b' 1.05 m, 'f' 100 m. */
static struct neph_image *depth_map(int width_px, int height_px, const char *letters)
{
    struct neph_image *image = create_image(width_px, height_px);
    float *depth_m = add_channel(image, "Z", NULL);
    for (size_t i = 0; i < neph_image_pixel_count(image); i++)
        depth_m[i] = letters[i] == 'a'   ? 1.0f
                     : letters[i] == 'b' ? 1.05f
                     : letters[i] == 'f' ? 100.0f
                                         : INFINITY;
    return image;
}

/* The mask in letters: '#' inside, '-' outside. */
static void assert_mask(const struct neph_image *image, const char *name, int radius_px,
                        const char *expected)
{
    struct neph_mask_options options = NEPH_MASK_DEFAULTS;
    options.edge_radius_px = radius_px;
    struct neph_mask *mask = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_mask_create(image, name, &options, &mask, &diag), &diag);
    char actual[SIDE_MAX * SIDE_MAX + 1] = "";
    size_t inside_count = 0;
    for (size_t i = 0; i < neph_image_pixel_count(image); i++) {
        actual[i] = mask->inside[i] ? '#' : '-';
        inside_count += mask->inside[i];
    }
    assert_string_equal(actual, expected);
    assert_int_equal(mask->pixel_count, inside_count);
    assert_string_equal(mask->name, name);
    assert_int_equal(mask->width_px, image->width_px);
    assert_int_equal(mask->height_px, image->height_px);
    neph_mask_destroy(mask);
}

static void test_table(void **state)
{
    const char *const names[] = {"all",         "sky",         "solid",         "medium",
                                 "depth_edge",  "non_edge",    "thin",          "edge_near_0",
                                 "edge_near_1", "edge_near_2", "edge_near_3_4", "edge_near_5_8",
                                 "edge_far_0",  "edge_far_1",  "edge_far_2",    "edge_far_3_4",
                                 "edge_far_5_8"};
    enum { COUNT = sizeof(names) / sizeof(names[0]) };
    assert_int_equal(neph_mask_kind_count(), COUNT);
    for (int i = 0; i < COUNT; i++) {
        assert_string_equal(neph_mask_kind_at(i)->name, names[i]);
        assert_ptr_equal(neph_mask_kind_find(names[i]), neph_mask_kind_at(i));
        assert_true(strlen(neph_mask_kind_at(i)->help) > 0);
        assert_int_equal(neph_mask_kind_at(i)->is_detail, strncmp(names[i], "edge_", 5) == 0);
    }
    assert_null(neph_mask_kind_at(-1));
    assert_null(neph_mask_kind_at(COUNT));
    assert_null(neph_mask_kind_find("skye"));
    neph_mask_destroy(NULL);
}

static void test_sky_and_solid_share_the_image(void **state)
{
    struct neph_image *image = depth_map(3, 2,
                                         ".a."
                                         "f.b");
    assert_mask(image, "all", 2, "######");
    assert_mask(image, "sky", 2, "#-#-#-");
    assert_mask(image, "solid", 2, "-#-#-#");
    neph_image_destroy(image);
}

static void test_solid_against_sky_is_an_edge_on_both_sides(void **state)
{
    struct neph_image *image = depth_map(7, 1, "fff....");
    assert_mask(image, "depth_edge", 0, "--##---");
    assert_mask(image, "depth_edge", 1, "-####--");
    assert_mask(image, "depth_edge", 2, "######-");
    assert_mask(image, "depth_edge", 4, "#######");
    neph_image_destroy(image);
}

static void test_flat_depth_has_no_edge(void **state)
{
    struct neph_image *image = depth_map(3, 3, "........."); /* sky to sky is no edge */
    assert_mask(image, "depth_edge", 2, "---------");
    neph_image_destroy(image);
    image = depth_map(3, 3, "abababaab"); /* 5 % is no edge */
    assert_mask(image, "depth_edge", 2, "---------");
    neph_image_destroy(image);
}

/* The limit of the ratio is 1.1, exclusive, and does not depend on the distance. */
static void test_ratio(void **state)
{
    for (float near_m = 1e-3f; near_m < 1e6f; near_m *= 7.0f) {
        struct neph_image *image = create_image(2, 1);
        float *depth_m = add_channel(image, "Z", (float[]){near_m, 1.0999f * near_m});
        assert_mask(image, "depth_edge", 0, "--");
        depth_m[1] = 1.1001f * near_m;
        assert_mask(image, "depth_edge", 0, "##");
        depth_m[0] = depth_m[1];
        depth_m[1] = near_m;
        assert_mask(image, "depth_edge", 0, "##");
        depth_m[1] = 0.0f; /* depth 0, at the lens */
        assert_mask(image, "depth_edge", 0, "##");
        depth_m[0] = 0.0f;
        assert_mask(image, "depth_edge", 0, "--");
        neph_image_destroy(image);
    }
}

static void test_thin_wires(void **state)
{
    /* A wire one pixel wide is completely edge, with the pixels that it partly hides. */
    struct neph_image *image = depth_map(9, 2,
                                         "ffffaffff"
                                         "ffffaffff");
    assert_mask(image, "depth_edge", 0, "---###------###---");
    assert_mask(image, "depth_edge", 2, "-#######--#######-");
    neph_image_destroy(image);

    image = depth_map(5, 5,
                      "....."
                      "....."
                      "aaaaa"
                      "....."
                      ".....");
    assert_mask(image, "depth_edge", 0, "-----###############-----");
    neph_image_destroy(image);

    /* One pixel: its four neighbours and no diagonal ones, then the square of the dilation. */
    image = depth_map(7, 7,
                      "......."
                      "......."
                      "......."
                      "...a..."
                      "......."
                      "......."
                      ".......");
    assert_mask(image, "depth_edge", 0,
                "-------"
                "-------"
                "---#---"
                "--###--"
                "---#---"
                "-------"
                "-------");
    assert_mask(image, "depth_edge", 1,
                "-------"
                "--###--"
                "-#####-"
                "-#####-"
                "-#####-"
                "--###--"
                "-------");
    neph_image_destroy(image);
}

static void test_smallest_images(void **state)
{
    for (int radius_px = 0; radius_px <= 4; radius_px++) {
        struct neph_image *image = depth_map(1, 1, "a");
        assert_mask(image, "depth_edge", radius_px, "-");
        assert_mask(image, "all", radius_px, "#");
        assert_mask(image, "solid", radius_px, "#");
        assert_mask(image, "sky", radius_px, "-");
        neph_image_destroy(image);
        image = depth_map(1, 3, "a.."); /* the dilation is clipped */
        assert_mask(image, "depth_edge", radius_px, radius_px == 0 ? "##-" : "###");
        neph_image_destroy(image);
    }
}

/* The definition, pixel by pixel, without optimisation. */
static bool is_edge_by_definition(const float *depth_m, int width_px, int height_px, int x, int y)
{
    static const int neighbours[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    double here = (double)depth_m[y * width_px + x];
    for (int n = 0; n < 4; n++) {
        int nx = x + neighbours[n][0], ny = y + neighbours[n][1];
        if (nx < 0 || ny < 0 || nx >= width_px || ny >= height_px)
            continue;
        double there = (double)depth_m[ny * width_px + nx];
        if (isinf(here) != isinf(there))
            return true;
        if (isfinite(here) && fmax(here, there) / fmin(here, there) > 1.1)
            return true;
    }
    return false;
}

static bool is_near_edge_by_definition(const float *depth_m, int width_px, int height_px, int x,
                                       int y, int radius_px)
{
    for (int dy = -radius_px; dy <= radius_px; dy++) {
        for (int dx = -radius_px; dx <= radius_px; dx++) {
            int ex = x + dx, ey = y + dy;
            if (ex >= 0 && ey >= 0 && ex < width_px && ey < height_px &&
                is_edge_by_definition(depth_m, width_px, height_px, ex, ey))
                return true;
        }
    }
    return false;
}

static void test_edge_is_its_definition(void **state)
{
    uint64_t random = test_seed(2718);
    static const int radii_px[] = {0, 1, 2, 4, 30};
    for (int round = 0; round < 300; round++) {
        int width_px = 1 + (int)(neph_test_random(&random) % 23);
        int height_px = 1 + (int)(neph_test_random(&random) % 19);
        struct neph_image *image = create_image(width_px, height_px);
        float *depth_m = add_channel(image, "Z", NULL);
        double change = neph_test_uniform(&random, 0.0, 0.3);
        for (size_t i = 0; i < neph_image_pixel_count(image); i++) {
            double kind = neph_test_uniform(&random, 0.0, 1.0);
            depth_m[i] = kind < change ? (kind < 0.5 * change ? INFINITY : 3.0f) : 10.0f;
        }
        struct neph_mask_options options = NEPH_MASK_DEFAULTS;
        options.edge_radius_px = radii_px[round % 5];
        struct neph_mask *mask = NULL;
        struct neph_diag diag = {0};
        neph_assert_ok(neph_mask_create(image, "depth_edge", &options, &mask, &diag), &diag);
        for (int y = 0; y < height_px; y++)
            for (int x = 0; x < width_px; x++)
                assert_int_equal(mask->inside[y * width_px + x],
                                 is_near_edge_by_definition(depth_m, width_px, height_px, x, y,
                                                            options.edge_radius_px));
        neph_mask_destroy(mask);
        neph_image_destroy(image);
    }
}

/* ---- rings and thin objects ------------------------------------------------------------------ */

static void test_rings_of_a_wall(void **state)
{
    struct neph_image *image = depth_map(16, 1, "aaaaaaaaaaff....");
    /* Two steps: the wall in front of the far surface, and the far surface in front of the sky,
     * where it is the nearer one at an infinite ratio. */
    assert_mask(image, "edge_near_0", 2, "---------#-#----");
    assert_mask(image, "edge_far_0", 2, "----------#-#---");
    assert_mask(image, "edge_near_1", 2, "--------#-------");
    assert_mask(image, "edge_far_1", 2, "-------------#--");
    assert_mask(image, "edge_near_2", 2, "-------#--------");
    assert_mask(image, "edge_far_2", 2, "--------------#-");
    assert_mask(image, "edge_near_3_4", 2, "-----##---------");
    assert_mask(image, "edge_far_3_4", 2, "---------------#");
    assert_mask(image, "edge_near_5_8", 2, "-####-----------");
    assert_mask(image, "edge_far_5_8", 2, "----------------");
    assert_mask(image, "non_edge", 2, "#######--------#");
    neph_image_destroy(image);
}

/* At equal distance to both sides: near. A wire in front of the sky, and its corners. */
static void test_sides_at_equal_distance(void **state)
{
    struct neph_image *image = depth_map(7, 5,
                                         "......."
                                         "......."
                                         "...a..."
                                         "......."
                                         ".......");
    assert_mask(image, "edge_near_0", 0,
                "-------"
                "-------"
                "---#---"
                "-------"
                "-------");
    assert_mask(image, "edge_far_0", 0,
                "-------"
                "---#---"
                "--#-#--"
                "---#---"
                "-------");
    assert_mask(image, "edge_near_1", 0, /* diagonals touch the wire and its sky equally */
                "-------"
                "--#-#--"
                "-------"
                "--#-#--"
                "-------");
    assert_mask(image, "edge_far_1", 0,
                "--###--"
                "-#---#-"
                "-#---#-"
                "-#---#-"
                "--###--");
    neph_image_destroy(image);
}

/* The side of a pixel between two steps: that with the larger ratio, near if equal. */
static void test_steepest_step(void **state)
{
    static const struct {
        float depth_m[3];
        const char *near, *far;
    } cases[] = {
        {{1, 2, 8}, "##-", "--#"},        {{1, 8, 16}, "#--", "-##"},
        {{1, 4, 16}, "##-", "--#"},       {{1, 100, INFINITY}, "##-", "--#"},
        {{0, 1, INFINITY}, "##-", "--#"}, {{0, 1, 100}, "#--", "-##"},
        {{16, 4, 1}, "-##", "#--"},       {{0, 0, 1}, "-#-", "--#"},
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        struct neph_image *image = create_image(3, 1);
        add_channel(image, "Z", cases[i].depth_m);
        assert_mask(image, "edge_near_0", 0, cases[i].near);
        assert_mask(image, "edge_far_0", 0, cases[i].far);
        neph_image_destroy(image);
    }
}

/* 0: no step, 1: the nearer one, 2: the farther one; from ratios. */
static int side_by_definition(const float *depth_m, int width_px, int height_px, int x, int y)
{
    static const int neighbours[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    double here = (double)depth_m[y * width_px + x], behind = 1.0, before = 1.0;
    for (int n = 0; n < 4; n++) {
        int nx = x + neighbours[n][0], ny = y + neighbours[n][1];
        if (nx < 0 || ny < 0 || nx >= width_px || ny >= height_px)
            continue;
        double there = (double)depth_m[ny * width_px + nx];
        if (there > here)
            behind = fmax(behind, there / here);
        if (there < here)
            before = fmax(before, here / there);
    }
    if (fmax(behind, before) <= 1.1)
        return 0;
    return behind >= before ? 1 : 2;
}

static void assert_rings_by_definition(const struct neph_image *image, const float *depth_m)
{
    static const struct {
        const char *name;
        bool is_near;
        int least_px, most_px;
    } rings[] = {
        {"edge_near_0", true, 0, 0},   {"edge_near_1", true, 1, 1},   {"edge_near_2", true, 2, 2},
        {"edge_near_3_4", true, 3, 4}, {"edge_near_5_8", true, 5, 8}, {"edge_far_0", false, 0, 0},
        {"edge_far_1", false, 1, 1},   {"edge_far_2", false, 2, 2},   {"edge_far_3_4", false, 3, 4},
        {"edge_far_5_8", false, 5, 8},
    };
    enum { RING_COUNT = sizeof(rings) / sizeof(rings[0]) };
    struct neph_mask *masks[RING_COUNT];
    for (int r = 0; r < RING_COUNT; r++)
        masks[r] = create_mask(image, rings[r].name);
    int width_px = image->width_px, height_px = image->height_px;
    for (int y = 0; y < height_px; y++) {
        for (int x = 0; x < width_px; x++) {
            int near_px = 1000, far_px = 1000;
            for (int ey = 0; ey < height_px; ey++) {
                for (int ex = 0; ex < width_px; ex++) {
                    int distance_px = abs(ex - x) > abs(ey - y) ? abs(ex - x) : abs(ey - y);
                    int side = side_by_definition(depth_m, width_px, height_px, ex, ey);
                    if (side == 1 && distance_px < near_px)
                        near_px = distance_px;
                    if (side == 2 && distance_px < far_px)
                        far_px = distance_px;
                }
            }
            bool is_near = near_px <= far_px;
            int distance_px = is_near ? near_px : far_px;
            for (int r = 0; r < RING_COUNT; r++)
                assert_int_equal(masks[r]->inside[y * width_px + x],
                                 is_near == rings[r].is_near && distance_px >= rings[r].least_px &&
                                     distance_px <= rings[r].most_px);
        }
    }
    for (int r = 0; r < RING_COUNT; r++)
        neph_mask_destroy(masks[r]);
}

static void assert_thin_by_definition(const struct neph_image *image, const float *depth_m)
{
    struct neph_mask *thin = create_mask(image, "thin");
    int width_px = image->width_px, height_px = image->height_px;
    int across_px = width_px < 4 ? width_px : 4, down_px = height_px < 4 ? height_px : 4;
    for (int y = 0; y < height_px; y++) {
        for (int x = 0; x < width_px; x++) {
            bool is_thin = true; /* until a square is found with no surface behind */
            for (int top = y - 3; top <= y; top++) {
                for (int left = x - 3; left <= x; left++) {
                    if (top < 0 || left < 0 || top + down_px > height_px ||
                        left + across_px > width_px || top + down_px <= y || left + across_px <= x)
                        continue;
                    bool has_behind = false;
                    for (int sy = top; sy < top + down_px; sy++)
                        for (int sx = left; sx < left + across_px; sx++)
                            has_behind |= (double)depth_m[sy * width_px + sx] >
                                          1.1 * (double)depth_m[y * width_px + x];
                    is_thin &= has_behind;
                }
            }
            assert_int_equal(thin->inside[y * width_px + x], is_thin);
        }
    }
    neph_mask_destroy(thin);
}

static void test_rings_and_thin_are_their_definitions(void **state)
{
    uint64_t random = test_seed(31415);
    for (int round = 0; round < 40; round++) {
        int width_px = 1 + (int)(neph_test_random(&random) % 31);
        int height_px = 1 + (int)(neph_test_random(&random) % 17);
        struct neph_image *image = create_image(width_px, height_px);
        float *depth_m = add_channel(image, "Z", NULL);
        static const float depths_m[] = {10, 10.5f, 3, 1, 30, INFINITY, 0};
        double change = neph_test_uniform(&random, 0.0, 0.1);
        for (size_t i = 0; i < neph_image_pixel_count(image); i++) {
            bool is_other = neph_test_uniform(&random, 0.0, 1.0) < change;
            depth_m[i] = is_other ? depths_m[neph_test_random(&random) % 7] : 10.0f;
            if (round % 2 && i % (size_t)width_px >= (size_t)width_px / 2)
                depth_m[i] *= 4.0f;
        }
        assert_rings_by_definition(image, depth_m);
        assert_thin_by_definition(image, depth_m);
        neph_image_destroy(image);
    }
}

static void test_thin_things(void **state)
{
    struct neph_image *image = depth_map(12, 6,
                                         "aaa.....aaaa"
                                         "aaa.aaa.aaaa"
                                         "aaa.aaa.aaaa"
                                         "aaa.aaa.aaaa"
                                         "aaa.....aaaa"
                                         "aaa.........");
    assert_mask(image, "thin", 2,
                "###---------"
                "###-###-----"
                "###-###-----"
                "###-###-----"
                "###---------"
                "###---------");
    neph_image_destroy(image);
    image = depth_map(7, 7, /* a slanted bar, 3 px wide in both directions */
                      "aaa...."
                      ".aaa..."
                      "..aaa.."
                      "...aaa."
                      "....aaa"
                      ".....aa"
                      "......a");
    assert_mask(image, "thin", 2,
                "###----"
                "-###---"
                "--###--"
                "---###-"
                "----###"
                "-----##"
                "------#");
    neph_image_destroy(image);
}

/* ---- masks from channels and images ---------------------------------------------------------- */

static void test_channels_make_masks(void **state)
{
    struct neph_image *image = depth_map(4, 1, ".aa.");
    assert_null(neph_mask_channel_at(image, 0));
    add_channel(image, "mask.cloud", (float[]){0, 0.5f, 0.51f, 1});
    add_channel(image, "mask.", (float[]){1, 1, 1, 1});
    add_channel(image, "masked", (float[]){1, 1, 1, 1});
    add_channel(image, "mask.sky", (float[]){-1, 2, 0, 0});
    assert_string_equal(neph_mask_channel_at(image, 0), "cloud");
    assert_string_equal(neph_mask_channel_at(image, 1), "sky");
    assert_null(neph_mask_channel_at(image, 2));
    assert_null(neph_mask_channel_at(image, -1));
    assert_mask(image, "cloud", 2, "--##");
    assert_mask(image, "sky", 2, "-#--"); /* the scene's data take precedence over detection */
    assert_mask(image, "solid", 2, "-##-");
    neph_image_destroy(image);
}

static void test_mask_from_a_picture(void **state)
{
    struct neph_image *image = create_image(4, 1);
    struct neph_mask *mask = NULL;
    struct neph_diag diag = {0};
    assert_int_equal(neph_mask_from_image(image, "wire", &mask, &diag), NEPH_ERR_INPUT);
    assert_non_null(strstr(diag.message, "'wire'"));
    float *opacity = add_channel(image, "A", (float[]){1, 0, 1, 1});
    neph_assert_ok(neph_mask_from_image(image, "wire", &mask, &diag), &diag);
    assert_int_equal(mask->pixel_count, 3); /* only an A is a mask */
    neph_mask_destroy(mask);
    add_channel(image, "R", (float[]){0, 1, 0.5f, 0});
    float *green = add_channel(image, "G", (float[]){0, 0, 0, 0.6f});
    neph_assert_ok(neph_mask_from_image(image, "wire", &mask, &diag), &diag);
    assert_memory_equal(mask->inside, ((uint8_t[]){0, 1, 0, 1}), 4);
    assert_int_equal(mask->pixel_count, 2);
    assert_string_equal(mask->name, "wire");
    neph_mask_destroy(mask);
    mask = NULL;
    green[2] = NAN;
    opacity[0] = NAN; /* not read */
    assert_int_equal(neph_mask_from_image(image, "wire", &mask, &diag), NEPH_ERR_GATE);
    assert_non_null(strstr(diag.message, "'G' is nan at pixel (2, 0)"));
    assert_null(mask);
    add_channel(image, "mask.bad", (float[]){NAN, 0, 0, 0});
    assert_int_equal(neph_mask_create(image, "bad", NULL, &mask, &diag), NEPH_ERR_GATE);
    assert_null(mask);
    neph_image_destroy(image);
}

static void test_union(void **state)
{
    struct neph_image *first = depth_map(6, 1, "aa...."), *second = depth_map(6, 1, "aaaa..");
    struct neph_mask *mask = create_mask(first, "edge_near_0"),
                     *other = create_mask(second, "edge_near_0");
    neph_assert_ok(neph_mask_unite(mask, other, NULL), NULL);
    assert_memory_equal(mask->inside, ((uint8_t[]){0, 1, 0, 1, 0, 0}), 6);
    assert_int_equal(mask->pixel_count, 2);
    neph_assert_ok(neph_mask_unite(mask, mask, NULL), NULL);
    assert_int_equal(mask->pixel_count, 2);
    neph_mask_destroy(other);
    struct neph_image *small = depth_map(5, 1, "aa...");
    other = create_mask(small, "all");
    struct neph_diag diag = {0};
    assert_int_equal(neph_mask_unite(mask, other, &diag), NEPH_ERR_INPUT);
    assert_non_null(strstr(diag.message, "6x1 pixels in one frame, 5x1 in another"));
    neph_mask_destroy(mask);
    neph_mask_destroy(other);
    neph_image_destroy(first);
    neph_image_destroy(second);
    neph_image_destroy(small);
}

static void test_medium_in_any_channel(void **state)
{
    struct neph_image *image = create_image(5, 1);
    add_rgb(image, "transmittance",
            (float[]){1, 1, 1,               /* nothing */
                      1, 1, 0.9985f,         /* 1.5e-3 only in blue */
                      0.9995f, 0.9995f, 1,   /* below the threshold of 1e-3 */
                      0, 0, 0,               /* a wall */
                      1.01f, 1.01f, 1.01f}); /* a noisy estimate of nothing */
    assert_mask(image, "medium", 2, "-#-#-");

    struct neph_mask_options options = NEPH_MASK_DEFAULTS;
    options.medium_optical_depth = 1e-4;
    struct neph_mask *mask = NULL;
    neph_assert_ok(neph_mask_create(image, "medium", &options, &mask, NULL), NULL);
    assert_int_equal(mask->pixel_count, 3);
    neph_mask_destroy(mask);
    neph_image_destroy(image);
}

static void assert_refused(const struct neph_image *image, const char *name,
                           const struct neph_mask_options *options, enum neph_status status,
                           const char *words)
{
    struct neph_mask *mask = NULL;
    struct neph_diag diag = {0};
    assert_int_equal(neph_mask_create(image, name, options, &mask, &diag), status);
    assert_null(mask);
    if (!strstr(diag.message, words))
        fail_msg("'%s' does not say '%s'", diag.message, words);
}

static void test_refusals(void **state)
{
    struct neph_image *image = create_image(2, 2);
    assert_refused(image, "fog", NULL, NEPH_ERR_USAGE, "no mask 'fog'");
    assert_refused(image, "sky", NULL, NEPH_ERR_UNSUPPORTED, "needs the channel 'Z'");
    assert_refused(image, "depth_edge", NULL, NEPH_ERR_UNSUPPORTED, "'depth_edge'");
    assert_refused(image, "medium", NULL, NEPH_ERR_UNSUPPORTED, "needs the layer 'transmittance'");

    float *depth_m = add_channel(image, "Z", (float[]){1, 1, NAN, 1});
    assert_refused(image, "sky", NULL, NEPH_ERR_GATE, "nan at pixel (0, 1)");
    depth_m[2] = -INFINITY;
    assert_refused(image, "solid", NULL, NEPH_ERR_GATE, "-inf at pixel (0, 1)");
    depth_m[2] = -1.0f;
    assert_refused(image, "depth_edge", NULL, NEPH_ERR_GATE, "-1 at pixel (0, 1)");
    depth_m[2] = 1.0f;

    struct neph_mask_options options = NEPH_MASK_DEFAULTS;
    options.edge_depth_ratio = 0.9;
    assert_refused(image, "depth_edge", &options, NEPH_ERR_INPUT, "0.9");
    options = NEPH_MASK_DEFAULTS;
    options.edge_radius_px = -1;
    assert_refused(image, "depth_edge", &options, NEPH_ERR_INPUT, "-1");
    options = NEPH_MASK_DEFAULTS;
    options.medium_optical_depth = NAN;
    assert_refused(image, "all", &options, NEPH_ERR_INPUT, "nan");

    add_rgb(image, "transmittance", (float[]){1, 1, 1, 1, 1, INFINITY, 1, 1, 1, 1, 1, 1});
    assert_refused(image, "medium", NULL, NEPH_ERR_GATE, "inf at pixel (1, 0)");
    neph_image_destroy(image);
}

/* Pixels that edges move over are no surroundings for a comparison. */
static void test_non_edge_is_never_an_edge(void **state)
{
    struct neph_image *first = depth_map(16, 1, "aa.............."),
                      *second = depth_map(16, 1, "aaaa............");
    struct neph_mask *edge = create_mask(first, "depth_edge"),
                     *more_edge = create_mask(second, "depth_edge"),
                     *rest = create_mask(first, "non_edge"),
                     *more_rest = create_mask(second, "non_edge");
    neph_assert_ok(neph_mask_unite(edge, more_edge, NULL), NULL);
    neph_assert_ok(neph_mask_unite(rest, more_rest, NULL), NULL);
    assert_int_equal(edge->pixel_count, 7);
    for (int i = 0; i < 16; i++)
        assert_int_equal(rest->inside[i], !edge->inside[i]);
    assert_int_equal(rest->pixel_count, 16 - edge->pixel_count);
    neph_mask_destroy(edge);
    neph_mask_destroy(more_edge);
    neph_mask_destroy(rest);
    neph_mask_destroy(more_rest);
    neph_image_destroy(first);
    neph_image_destroy(second);
}

#include "tests/main.h"
