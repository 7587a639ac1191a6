/* SPDX-License-Identifier: MIT
 *
 * Phase functions as tables: against Henyey-Greenstein's closed forms, and random tables against
 * the definitions of integral, inverse and moments.
 */
#include "tests/base/scratch.h"

#include "base/files.h"
#include "scenes/phase.h"
#include "scenes/phase_colour.h"
#include "scenes/phase_table.h"
#include "scenes/quadrature.h"

#include <math.h>

static const struct neph_phase_table *make(struct neph_arena *arena, int count,
                                           const double *angles_deg, const double *values)
{
    const struct neph_phase_table *table = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_phase_table_make(count, angles_deg, values, arena, &table, &diag), &diag);
    return table;
}

enum { STEPS = 1800 };

/* The straight line between rows of 0.1 degrees is off by 1/8 of the second derivative over the
 * cosine: below 1e-5 of Henyey-Greenstein's for g = 0.5. */
static void test_henyey_greenstein_as_a_table(void **state)
{
    const struct neph_phase exact = {NEPH_PHASE_HENYEY_GREENSTEIN, 0.5};
    double angles_deg[STEPS + 1], values[STEPS + 1];
    struct neph_arena arena = {NULL};
    for (int i = 0; i <= STEPS; i++) {
        angles_deg[i] = i / 10.0;
        values[i] = 4.0 * M_PI * neph_phase_per_sr(&exact, cos(angles_deg[i] * M_PI / 180.0));
    }
    const struct neph_phase table = {.kind = NEPH_PHASE_TABLE,
                                     .table = make(&arena, STEPS + 1, angles_deg, values)};
    neph_assert_close(table.table->given_integral, 4.0 * M_PI, 1e-5, 0.0);
    for (int i = -1000; i <= 1000; i++)
        neph_assert_close(neph_phase_per_sr(&table, i / 1000.0),
                          neph_phase_per_sr(&exact, i / 1000.0), 1e-5, 0.0);
    for (int i = 1; i < 1000; i++)
        neph_assert_close(neph_phase_versine(&table, i / 1000.0),
                          neph_phase_versine(&exact, i / 1000.0), 1e-5, 1e-9);
    for (int l = 0; l <= NEPH_TABULATED_MOMENTS; l++)
        neph_assert_close(neph_phase_moment(&table, l), neph_phase_moment(&exact, l), 0.0, 1e-6);
    neph_arena_finish(&arena);
}

/* P_l of the cosine, times the phase function, for l = 0, 1 and a high one. */
enum { HIGH = 12 };
static void over_versine(double v, void *context, double value[3])
{
    const double c = 1.0 - v, density = 2.0 * M_PI * neph_phase_table_per_sr(context, v);
    double before = 1.0, now = c;
    for (int l = 2; l <= HIGH; l++) {
        const double next = ((2 * l - 1) * c * now - (l - 1) * before) / l;
        before = now;
        now = next;
    }
    value[0] = density;
    value[1] = density * c;
    value[2] = density * now;
}

/* Random rows, some of them 0, with a peak of up to 1e5: it integrates to 1, the versine is the
 * inverse of the light within it, and the moments are those of quadrature. */
static void test_random_tables(void **state)
{
    const uint64_t first_seed = 7;
    for (uint64_t trial = 0; trial < 50; trial++) {
        uint64_t seed = first_seed + trial;
        double angles_deg[40], values[40], moments[3];
        struct neph_arena arena = {NULL};
        const int count = 2 + (int)neph_test_uniform(&seed, 0.0, 38.0);
        for (int i = 0; i < count; i++) {
            angles_deg[i] = i == count - 1
                                ? 180.0
                                : 180.0 * (i + neph_test_uniform(&seed, 0.0, i ? 0.9 : 0.0)) /
                                      count;
            values[i] = fmax(0.0, neph_test_uniform(&seed, -0.2, 1.0)) + 1e-3 * (i % 3);
        }
        values[0] = pow(10.0, neph_test_uniform(&seed, 0.0, 5.0));
        double integral = 0.0;
        struct neph_interval pieces[40];
        for (int i = 0; i + 1 < count; i++) {
            const double near = 1.0 - cos(angles_deg[i] * M_PI / 180.0),
                         far = 1.0 - cos(angles_deg[i + 1] * M_PI / 180.0);
            integral += M_PI * (far - near) * (values[i] + values[i + 1]);
            pieces[i] = (struct neph_interval){near, far};
        }
        for (int i = 0; i < count; i++)
            values[i] /= integral;
        const struct neph_phase_table *table = make(&arena, count, angles_deg, values);
        const struct neph_phase phase = {.kind = NEPH_PHASE_TABLE, .table = table};
        neph_integrate(over_versine, (void *)table, pieces, count - 1, moments);
        neph_assert_close(moments[0], 1.0, 0.0, 1e-9);
        neph_assert_close(moments[1], neph_phase_mean_cosine(&phase), 0.0, 1e-9);
        neph_assert_close(moments[2], neph_phase_moment(&phase, HIGH), 0.0, 1e-9);
        for (int k = 1; k < 200; k++) {
            const double u = k / 200.0, v = neph_phase_table_versine(table, u);
            int i = 0;
            while (i + 2 < count && table->nodes[i + 1].versine < v)
                i++;
            const struct neph_phase_node *node = &table->nodes[i];
            const double light = node->within +
                                 M_PI * (v - node->versine) *
                                     (node->per_sr + neph_phase_table_per_sr(table, v));
            if (fabs(light - (1.0 - u)) > 1e-9)
                print_message("seed %llu\n", (unsigned long long)(first_seed + trial));
            neph_assert_close(light, 1.0 - u, 0.0, 1e-9);
        }
        neph_arena_finish(&arena);
    }
}

static void test_rows_that_are_no_phase_function(void **state)
{
    static const struct {
        double angles_deg[4], values[4];
        const char *message;
    } cases[] = {
        {{0, 60, 120, 180}, {2, 2, 2, 2}, "integral of the phase function over the sphere is 25.1"},
        {{0, 60, 120, 180}, {0, 0, 0, 0}, "over the sphere is 0"},
        {{0, 120, 60, 180}, {1, 1, 1, 1}, "row 3: 60 degrees after 120"},
        {{0, 60, 60, 180}, {1, 1, 1, 1}, "row 3: 60 degrees after 60"},
        {{0, 60, 120, 180}, {1, -1, 1, 1}, "row 2: the phase function is -1 at 60"},
        {{0, 60, 120, 180}, {1, NAN, 1, 1}, "row 2: the phase function is nan"},
        {{0, 60, NAN, 180}, {1, 1, 1, 1}, "row 3: nan degrees"},
        {{0, 60, 120, INFINITY}, {1, 1, 1, 1}, "row 4: inf degrees are not in 0..180"},
        {{1, 60, 120, 180}, {1, 1, 1, 1}, "reach from 1 to 180 degrees, not from 0 to 180"},
        {{179, 60, 20, 0}, {1, 1, 1, 1}, "reach from 0 to 179 degrees"},
        {{-1, 60, 120, 180}, {1, 1, 1, 1}, "row 1: -1 degrees are not in 0..180"},
        {{0, 1e-200, 120, 180}, {1, 1, 1, 1}, "are one angle"},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct neph_arena arena = {NULL};
        struct neph_diag diag = {0};
        const struct neph_phase_table *table = NULL;
        assert_int_equal(
            neph_phase_table_make(4, cases[i].angles_deg, cases[i].values, &arena, &table, &diag),
            NEPH_ERR_INPUT);
        if (!strstr(diag.message, cases[i].message))
            print_message("%s\n", diag.message);
        assert_non_null(strstr(diag.message, cases[i].message));
        assert_null(table);
        neph_arena_finish(&arena);
    }
}

/* Three linear phase functions, of mean cosine 1/3, 0 and -1/3, each with an integral of its own
 * that is 1 or 4 pi within 1 %. */
static void test_three_channels(void **state)
{
    static const double factors[3] = {1.0, 0.995, 1.005 * 4.0 * M_PI};
    const double angles_deg[2] = {180.0, 0.0};
    double values[6];
    struct neph_arena arena = {NULL};
    struct neph_diag diag = {0};
    const struct neph_phase_table *table = NULL;
    for (int j = 0; j < 3; j++) {
        values[j] = factors[j] * j / (4.0 * M_PI); /* 1 - slope, behind */
        values[3 + j] = factors[j] * (2 - j) / (4.0 * M_PI);
    }
    neph_assert_ok(neph_phase_table_make_coloured(2, angles_deg, values, &arena, &table, &diag),
                   &diag);
    const struct neph_phase phase = {.kind = NEPH_PHASE_TABLE, .table = table};
    assert_true(neph_phase_is_coloured(&phase));
    for (int j = 0; j < 3; j++) {
        const struct neph_phase own = neph_phase_channel(&phase, j);
        neph_assert_close(own.table->given_integral, factors[j], 1e-14, 0.0);
        neph_assert_close(neph_phase_mean_cosine(&own), (1 - j) / 3.0, 0.0, 1e-15);
        assert_false(neph_phase_is_coloured(&own));
        assert_true(neph_phase_table_is_same(own.table, own.table));
    }
    assert_false(neph_phase_table_is_same(table->channels[0], table->channels[1]));
    neph_assert_close(neph_phase_mean_cosine(&phase), 0.0, 0.0, 1e-15);
    const struct neph_rgb at = neph_phase_rgb_per_sr(&phase, 0.5);
    neph_assert_close(at.r, 1.5 / (4.0 * M_PI), 1e-14, 0.0);
    neph_assert_close(at.g, 1.0 / (4.0 * M_PI), 1e-14, 0.0);
    neph_assert_close(at.b, 0.5 / (4.0 * M_PI), 1e-14, 0.0);
    neph_assert_close(neph_phase_per_sr(&phase, 0.5), 1.0 / (4.0 * M_PI), 1e-14, 0.0);
    neph_arena_finish(&arena);
}

/* Each text and a part of its message; "" where it is read. */
static void test_files(void **state)
{
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"0 1\n90 1\n180 1\n", ""},
        {"angle_deg,phase_per_sr\r\n0,1\r\n90,1\r\n180,1\r\n", ""},
        {"# a table\n\n 180\t1 # back\n90;1\n0 +1.0e0", ""},
        {"0 1\n90 one\n180 1\n", "line 2: '90 one' is not an angle"},
        {"0 1\n90 1 2\n180 1\n", "line 2: '90 1 2' is not an angle"},
        {"0 1 1 1\n180 1 1 1\n", ""},
        {"0 1 1 1\n180 1 1 1 1\n", "line 2: '180 1 1 1 1' is not an angle"},
        {"0 1 1 1\n180 1\n", "line 2: '180 1' has 1 values after an angle, the rows before it 3"},
        {"0 1 1 3\n180 1 1 3\n", "blue: the integral"},
        {"0 1\n90\n180 1\n", "line 2: '90' is not an angle"},
        {"0 1\nangle value\n180 1\n", "line 2: 'angle value' is not an angle"},
        {"0 1\n90 inf\n180 1\n", "line 2: "},
        {"angle value\n# rows\n0 1\n90 -1\n180 1\n", "line 4: the phase function is -1 at 90"},
        {"0 1\n90 1e999\n180 1\n", "line 2: the phase function is inf at 90"},
        {"0 1\n\n90 1\n90 1\n180 1\n", "line 4: 90 degrees after 90"},
        {"0 1\n90 1\n181 1\n", "line 3: 181 degrees are not in 0..180"},
        {"0 0x1p0\n180 1\n", "line 1: "},
        {"0 1\n", "a phase function of 1 rows"},
        {"", "a phase function of 0 rows"},
    };
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "table");
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct neph_arena arena = {NULL};
        struct neph_diag diag = {0};
        const struct neph_phase_table *table = NULL;
        scratch_write(path, cases[i].text, strlen(cases[i].text));
        const enum neph_status status = neph_phase_table_read(path, &arena, &table, &diag);
        if (!*cases[i].message) {
            neph_assert_ok(status, &diag);
            neph_assert_close(neph_phase_table_per_sr(table, 0.7), 0.25 / M_PI, 1e-15, 0.0);
        } else {
            assert_int_equal(status, NEPH_ERR_INPUT);
            if (!strstr(diag.message, cases[i].message))
                print_message("%s\n", diag.message);
            assert_non_null(strstr(diag.message, cases[i].message));
            assert_non_null(strstr(diag.message, path));
        }
        neph_arena_finish(&arena);
    }
    struct neph_diag diag = {0};
    const struct neph_phase_table *table = NULL;
    struct neph_arena arena = {NULL};
    scratch_write(path, "0 1\0002\n", 7);
    assert_int_equal(neph_phase_table_read(path, &arena, &table, &diag), NEPH_ERR_INPUT);
    assert_int_equal(neph_phase_table_read(scratch_path(state, path, "no"), &arena, &table, &diag),
                     NEPH_ERR_NOT_FOUND);
    neph_arena_finish(&arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_henyey_greenstein_as_a_table),
        cmocka_unit_test(test_random_tables),
        cmocka_unit_test(test_rows_that_are_no_phase_function),
        cmocka_unit_test(test_three_channels),
        scratch_test(test_files),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
