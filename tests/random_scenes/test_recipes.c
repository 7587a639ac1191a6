/* SPDX-License-Identifier: MIT
 *
 * The generator itself: its coverage, that it is a pure function, and that the independent wind
 * equals the wind of scenes.
 */
#include "tests/neph_test.h"
#include "tests/random_scenes/recipe.h"

#include "scenes/media.h"
#include "scenes/motion.h"

#include <unistd.h>

static const uint64_t seed = 36;

/* The set of forms of a scene, as bits; a form with itself has one bit and a flag. */
static unsigned collect_forms(int index)
{
    const struct recipe recipe = recipe_draw(seed, index, 0);
    unsigned bits = 0;
    for (int i = 0; i < recipe.medium_count; i++)
        bits |= bits >> recipe.media[i].form & 1u ? 1u << FORM_COUNT : 1u << recipe.media[i].form;
    return bits;
}

static void test_every_pair_and_triple_is_drawn_once_in_a_period(void **state)
{
    static int seen[2 << FORM_COUNT];
    const int first = 12345, period = recipe_period();
    for (int i = 0; i < period; i++)
        seen[collect_forms(first + i)]++;
    int singles = 0, pairs = 0, triples = 0;
    for (unsigned set = 1; set < 1u << FORM_COUNT; set++) {
        const int size = __builtin_popcount(set);
        if (size > 3)
            continue;
        assert_int_equal(seen[set], 1);
        singles += size == 1;
        pairs += size == 2;
        triples += size == 3;
    }
    for (int form = 0; form < FORM_COUNT; form++)
        assert_int_equal(seen[1u << form | 1u << FORM_COUNT], 1);
    assert_int_equal(singles + pairs + triples + FORM_COUNT, period);
    print_message("%d single forms, %d pairs of unlike forms, %d triples\n", singles, pairs,
                  triples);
}

static char *written(const struct recipe *recipe)
{
    char *text = NULL;
    size_t size;
    FILE *file = open_memstream(&text, &size);
    assert_non_null(file);
    recipe_write(recipe, "a_scene", "", file);
    assert_int_equal(fclose(file), 0);
    return text;
}

static void test_the_same_numbers_make_the_same_scene(void **state)
{
    for (int i = 0; i < 50; i++) {
        const struct recipe a = recipe_draw(seed, i, 0), b = recipe_draw(seed, i, 0),
                            c = recipe_draw(seed + 1, i, 0), d = recipe_draw(seed, i, 1);
        char *texts[] = {written(&a), written(&b), written(&c), written(&d)};
        assert_string_equal(texts[0], texts[1]);
        assert_string_not_equal(texts[0], texts[2]);
        assert_string_not_equal(texts[0], texts[3]);
        for (int t = 0; t < 4; t++)
            free(texts[t]);
    }
}

static void test_meshes_are_drawn(void **state)
{
    int scenes = 0, kinds[RECIPE_MESH_KINDS] = {0};
    for (int i = 0; i < 200; i++) {
        const struct recipe recipe = recipe_draw(seed, i, 0);
        scenes += recipe.mesh_count > 0;
        for (int m = 0; m < recipe.mesh_count; m++)
            kinds[recipe.meshes[m].kind]++;
    }
    neph_assert_in_range(scenes, 40, 80);
    for (int kind = 0; kind < RECIPE_MESH_KINDS; kind++)
        assert_true(kinds[kind] > 20);
}

/* The reduction ends: each change either has no effect or cannot be repeated forever. */
static void test_every_change_comes_to_an_end(void **state)
{
    for (int i = 0; i < 50; i++)
        for (int change = 0; change < recipe_change_count(); change++) {
            struct recipe recipe = recipe_draw(seed, i, 0);
            int times = 0;
            while (recipe_simplify(&recipe, change))
                assert_true(++times < 8);
        }
}

static struct neph_scene *load(const struct recipe *recipe, struct neph_diag *diag)
{
    char path[] = "/tmp/neph_recipe_XXXXXX.yaml";
    const int file = mkstemps(path, 5);
    assert_true(file >= 0);
    char *name = neph_scene_name_from_path(path);
    for (char *c = name; *c; c++)
        *c = (char)(*c >= 'A' && *c <= 'Z' ? *c + 32 : *c);
    FILE *stream = fdopen(file, "w");
    assert_non_null(stream);
    recipe_write(recipe, name, "", stream);
    assert_int_equal(fclose(stream), 0);
    char lower[sizeof(path)];
    snprintf(lower, sizeof(lower), "/tmp/%s.yaml", name);
    assert_int_equal(rename(path, lower), 0);
    struct neph_scene *scene = NULL;
    const enum neph_status status = neph_scene_load(lower, &scene, diag);
    unlink(lower);
    free(name);
    return status ? NULL : scene;
}

/* Optical depths along rays through both: the media of neph_scene_at(), and the independently
 * displaced ones. */
static void test_wind_by_hand_is_the_wind_of_scenes(void **state)
{
    int windy = 0;
    for (int i = 0; i < 120 && windy < 12; i++) {
        struct recipe recipe = recipe_draw(seed, i, 0);
        recipe.mesh_count = 0; /* they would need files */
        const struct recipe by_hand = recipe_without_wind(&recipe);
        struct neph_diag diag = {0};
        struct neph_scene *a = recipe.has_wind ? load(&recipe, &diag) : NULL;
        struct neph_scene *b = a ? load(&by_hand, &diag) : NULL, *still = NULL;
        if (b) {
            windy++;
            neph_assert_ok(neph_scene_at(a, recipe.frame, &still, &diag), &diag);
            const struct neph_camera camera = neph_scene_camera(still, 0.0);
            for (int p = 0; p < 6; p++) {
                const struct neph_pixel_ray ray = neph_camera_ray(&camera, 3, 2, p % 3, p / 3);
                const double far_m = 10.0 * recipe.scale_m;
                const double x =
                    neph_scene_optical_depth(still, ray.origin_m, ray.direction, 0.0, far_m).g;
                const double y =
                    neph_scene_optical_depth(b, ray.origin_m, ray.direction, 0.0, far_m).g;
                neph_assert_close(x, y, 1e-7, 1e-12);
            }
        }
        neph_scene_destroy(still);
        neph_scene_destroy(b);
        neph_scene_destroy(a);
    }
    print_message("%d scenes with wind\n", windy);
    assert_true(windy >= 10);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_pair_and_triple_is_drawn_once_in_a_period),
        cmocka_unit_test(test_the_same_numbers_make_the_same_scene),
        cmocka_unit_test(test_meshes_are_drawn),
        cmocka_unit_test(test_every_change_comes_to_an_end),
        cmocka_unit_test(test_wind_by_hand_is_the_wind_of_scenes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
