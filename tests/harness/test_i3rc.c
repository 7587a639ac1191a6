/* SPDX-License-Identifier: MIT
 *
 * The I3RC suite on files of its own: clouds that are homogeneous slabs, whose consensus is known
 * (truth/slab.h), and broken files.
 */
#include "tests/neph_test.h"

#include "base/files.h"
#include "base/path.h"
#include "harness/physics/i3rc.h"
#include "harness/physics/i3rc_files.h"
#include "truth/slab.h"

#include <unistd.h>

enum { COLUMNS = 640, LAYERS = 54, SIDE = 128 };

static const char radar[] = "mmcr_tau_32km_020898";

/* A folder, which the test removes. */
static char *make_folder(void)
{
    char *folder = strdup("/tmp/neph-test-XXXXXX");
    assert_non_null(folder);
    assert_non_null(mkdtemp(folder));
    return folder;
}

static void test_end_folder(char **folder)
{
    neph_dir_remove(*folder, NULL);
    free(*folder);
}

static FILE *open_file(const char *folder, const char *name)
{
    const struct neph_path path = neph_path_in(folder, name);
    FILE *file = fopen(path.text, "w");
    assert_non_null(file);
    return file;
}

static void write_values(const char *folder, const char *name, int count, double value)
{
    FILE *file = open_file(folder, name);
    for (int i = 0; i < count; i++)
        fprintf(file, " %.6g%s", value, i % 100 == 99 ? "\n" : "");
    fclose(file);
}

/* Case 2 as a slab of this optical depth in the upper half of its layers. */
static void write_radar_slab(const char *folder, double depth)
{
    FILE *file = open_file(folder, radar);
    for (int line = 0; line < LAYERS; line++)
        for (int x = 0; x < COLUMNS; x++)
            fprintf(file, "%8.4f%s", line < LAYERS / 2 ? depth / (LAYERS / 2) : 0.0,
                    x == COLUMNS - 1 ? "\n" : "");
    fclose(file);
}

static struct neph_slab_fluxes solve_slab(double depth, double sun_cosine)
{
    struct neph_slab *slab = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(
        neph_slab_create(&(struct neph_slab_params){.optical_depth = depth,
                                                    .albedo = 1.0,
                                                    .phase = {NEPH_PHASE_HENYEY_GREENSTEIN, 0.85},
                                                    .sun_cosine = sun_cosine},
                         &slab, &diag),
        &diag);
    const struct neph_slab_fluxes fluxes = neph_slab_fluxes(slab);
    neph_slab_destroy(slab);
    return fluxes;
}

static struct neph_i3rc run(const char *folder, const char *only, int paths)
{
    struct neph_i3rc suite = {.rows = NULL};
    struct neph_diag diag = {0};
    const struct neph_i3rc_params params = {.folder = folder,
                                            .engine = "oracle",
                                            .only = &only,
                                            .only_count = only != NULL,
                                            .paths = paths,
                                            .quiet = true};
    neph_assert_ok(neph_i3rc_run(&params, &suite, &diag), &diag);
    return suite;
}

/* Consensus of the slab with noise, a trend from column to column in T, and one wrong column. */
static void write_consensus(const char *folder, const struct neph_slab_fluxes *truth, double noise)
{
    uint64_t seed = 12;
    FILE *reflected = open_file(folder, "case2_exp2_R.txt");
    FILE *transmitted = open_file(folder, "I3RC_cons_res_case2_exp2_T.txt");
    for (int x = 0; x < COLUMNS; x++) {
        const double off = neph_test_uniform(&seed, -sqrt(3.0), sqrt(3.0)) * noise;
        fprintf(reflected, "    %.5E\n", truth->reflected + off + (x == 77 ? 0.4 : 0.0));
        fprintf(transmitted, "    %.5E\n",
                truth->transmitted + truth->direct + sqrt(2.0) * noise * sin(0.1 * M_PI * x));
    }
    fclose(reflected);
    fclose(transmitted);
}

static void test_a_slab_as_case_2(void **state)
{
    const double depth = 5.4, noise = 0.05;
    OWNED(folder) char *folder = make_folder();
    const struct neph_slab_fluxes truth = solve_slab(depth, 0.5);
    write_radar_slab(folder, depth);
    write_consensus(folder, &truth, noise);
    struct neph_i3rc suite = run(folder, "case2_exp2", 192);
    assert_int_equal(suite.row_count, 1);
    const struct neph_i3rc_row *row = &suite.rows[0];
    assert_null(row->missing);
    neph_assert_close(row->optical_depth, depth, 1e-5, 0.0); /* four digits a cell */
    const struct neph_i3rc_number *reflected = &row->numbers[0], *transmitted = &row->numbers[1];
    neph_assert_close(reflected->ours.mean, truth.reflected, 0.0,
                      4.0 * reflected->ours.standard_error);
    neph_assert_close(transmitted->ours.mean, truth.transmitted + truth.direct, 0.0,
                      4.0 * transmitted->ours.standard_error);
    assert_true(reflected->has_consensus && transmitted->has_consensus);
    assert_false(row->numbers[2].has_consensus);
    assert_true(transmitted->agrees);
    neph_assert_close(row->consensus_balance, 1.0, 0.0, 0.02); /* noise of 0.05, 640 columns */
    assert_int_equal(suite.compared, 2);
    assert_int_equal(reflected->columns.worst_x, 77);
    /* The rms falls to the planted noise: that of T exactly, that of R with its wrong column. */
    assert_true(transmitted->columns.rms[0] > transmitted->columns.rms[2]);
    neph_assert_close(transmitted->columns.constant, noise, 0.25, 0.0);
    neph_assert_close(reflected->columns.constant, hypot(noise, 0.4 / sqrt(COLUMNS)), 0.25, 0.0);
    assert_true(transmitted->columns.constant_low < noise);
    assert_true(transmitted->columns.constant_high > noise);
    assert_true(fabs(transmitted->columns.fall) < 4.0);
    assert_true(reflected->columns.worst_score < -4.0 && reflected->columns.worst_p < 0.01);
    /* The trend of T is seen, the noise of R is none. */
    assert_true(transmitted->columns.correlation[0] >
                4.0 * transmitted->columns.correlation_error[0]);
    assert_true(fabs(reflected->columns.correlation[0]) <
                4.0 * reflected->columns.correlation_error[0]);
    assert_true(isnan(reflected->columns.correlation[1]));
    neph_i3rc_finish(&suite);
}

/* ---- the fit ---- */

enum { PLACES = 200, BATCHES = 32 };

static double draw_normal(uint64_t *seed)
{
    const double u = neph_test_uniform(seed, 0.0, 1.0), v = neph_test_uniform(seed, 0.0, 1.0);
    return sqrt(-2.0 * log(1.0 - u)) * cos(2.0 * M_PI * v);
}

/* Reflected light of columns, 0.5 + 0.001 i, with noise that differs from column to column:
 * `noise` times 0.5 to 1.5 in the mean of all batches. */
static struct neph_fluxes make_stage(double noise, double bias, uint64_t *seed)
{
    const struct neph_scene scene = {.name = "none"};
    const struct neph_flux_domain domain = {.columns_x = PLACES, .columns_z = 1};
    struct neph_fluxes fluxes = {.sums = NULL};
    neph_assert_ok(neph_fluxes_create(&scene, &domain, &fluxes, NULL), NULL);
    for (int b = 0; b < BATCHES; b++) {
        double values[NEPH_FLUX_COUNT * PLACES] = {0.0};
        for (int i = 0; i < PLACES; i++)
            values[NEPH_FLUX_REFLECTED * PLACES + i] = 0.5 + 0.001 * i + bias +
                                                       noise * (0.5 + (double)i / PLACES) *
                                                           sqrt(BATCHES) * draw_normal(seed);
        neph_fluxes_add_batch(&fluxes, values);
    }
    return fluxes;
}

/* Compare with a consensus that has this noise, and column 11 off by `wrong`. `bias`: of the stage
 * with the fewest paths. */
static struct neph_i3rc_columns fit(double noise, double constant, double wrong, double bias,
                                    uint64_t *seed)
{
    struct neph_fluxes stages[NEPH_I3RC_STAGES];
    struct neph_i3rc_number number = {.doubtful_columns = 0};
    double consensus[PLACES];
    for (int i = 0; i < PLACES; i++)
        consensus[i] = 0.5 + 0.001 * i + constant * draw_normal(seed) + (i == 11 ? wrong : 0.0);
    for (int s = 0; s < NEPH_I3RC_STAGES; s++)
        stages[s] = make_stage(noise / sqrt(neph_i3rc_stages[s]), s == 0 ? bias : 0.0, seed);
    neph_assert_ok(neph_i3rc_compare(stages, NEPH_FLUX_REFLECTED, consensus, &number, NULL), NULL);
    for (int s = 0; s < NEPH_I3RC_STAGES; s++)
        neph_fluxes_finish(&stages[s]);
    return number.columns;
}

/* The 95 % interval of the constant holds the planted one in 95 of 100 fits, of which a binomial
 * number is within 87 to 100 but once in 2,000; a constant of 0 is told apart in 2.5. */
static void test_the_constant_has_an_interval(void **state)
{
    enum { FITS = 100 };
    const double noise = 0.05, constant = 0.04;
    int held = 0, found = 0, risen = 0;
    uint64_t seed = 8;
    for (int i = 0; i < FITS; i++) {
        const struct neph_i3rc_columns columns = fit(noise, constant, 0.0, 0.0, &seed);
        held += columns.constant_low <= constant && columns.constant_high >= constant;
        risen += fabs(columns.fall) > 3.0;
        const struct neph_i3rc_columns none = fit(noise, 0.0, 0.0, 0.0, &seed);
        found += !isnan(none.constant);
        assert_true(none.constant_low == 0.0 || !isnan(none.constant));
    }
    print_message("%d of %d intervals hold the constant, %d of 0 are told apart from 0\n", held,
                  FITS, found);
    assert_true(held >= 87);
    assert_true(found <= 10);
    assert_true(risen <= 5);
}

static void test_what_noise_is_not(void **state)
{
    uint64_t seed = 9;
    const struct neph_i3rc_columns wrong = fit(0.01, 0.01, -0.2, 0.0, &seed);
    assert_int_equal(wrong.worst_x, 11);
    assert_true(wrong.worst_score > 5.0 && wrong.worst_p < 1e-4);
    const struct neph_i3rc_columns right = fit(0.01, 0.01, 0.0, 0.0, &seed);
    assert_true(right.worst_p > 0.001 && fabs(right.worst_score) < 5.0);
    /* A difference of the method that is there only with few paths. */
    assert_true(fit(0.01, 0.01, 0.0, 0.1, &seed).fall > 5.0);
}

/* ---- files ---- */

/* A flat cloud of one thickness: a slab that fills its topmost layer by half. */
static void test_a_slab_as_case_3(void **state)
{
    OWNED(folder) char *folder = make_folder();
    const struct neph_slab_fluxes truth = solve_slab(3.0, 1.0);
    write_values(folder, "scene43.tau.128x128", SIDE * SIDE, 3.0);
    write_values(folder, "scene43.dz.128x128", SIDE * SIDE, 0.05);
    struct neph_i3rc_scene *scene = NULL;
    struct neph_diag diag = {0};
    for (int i = 0; i < neph_i3rc_experiment_count; i++)
        if (neph_i3rc_experiments[i].case_number == 3 && !scene)
            neph_assert_ok(neph_i3rc_scene_create(&neph_i3rc_experiments[i], folder, &scene, &diag),
                           &diag);
    assert_non_null(scene);
    assert_int_equal(scene->columns_x * scene->columns_z, SIDE * SIDE);
    assert_int_equal(scene->grid->size[1], 3);
    neph_assert_close(scene->grid->origin_m.y, 210.0, 0.0, 1e-9);
    neph_assert_close(scene->optical_depth, 3.0, 1e-6, 0.0);
    assert_true(scene->grid->values[2 * SIDE] == 0.5f * scene->grid->values[0]);
    struct neph_fluxes fluxes = {.sums = NULL};
    const struct neph_fluxes_params params = {.columns_x = 4,
                                              .columns_z = 4,
                                              .bottom_m = NAN,
                                              .top_m = NAN,
                                              .paths = neph_test_paths(3000),
                                              .seed = 3};
    neph_assert_ok(neph_fluxes_trace(&scene->scene, &params, &fluxes, &diag), &diag);
    const struct neph_flux_estimate found = neph_flux_of_domain(&fluxes, NEPH_FLUX_REFLECTED, 0);
    neph_assert_close(found.mean, truth.reflected, 0.0, 4.0 * found.standard_error);
    neph_fluxes_finish(&fluxes);
    neph_i3rc_scene_destroy(scene);
}

/* Rows without files say so, with the name; the suite goes on. */
static void test_files_that_are_not_here(void **state)
{
    OWNED(folder) char *folder = make_folder();
    struct neph_i3rc suite = run(folder, NULL, 16);
    assert_int_equal(suite.row_count, neph_i3rc_experiment_count);
    for (int r = 0; r < suite.row_count; r++) {
        const struct neph_i3rc_row *row = &suite.rows[r];
        assert_int_equal(row->missing == NULL, row->experiment->case_number == 1);
        if (row->missing)
            assert_non_null(strstr(row->missing, row->experiment->has_c1 ? "C.1" : folder));
    }
    assert_int_equal(suite.compared, 0);
    neph_i3rc_finish(&suite);
    suite = run(NULL, "case3", 16);
    assert_int_equal(suite.row_count, 4);
    assert_non_null(strstr(suite.rows[0].missing, NEPH_I3RC_VARIABLE));
    neph_i3rc_finish(&suite);
}

/* The error of case 2 with this text as its file. */
static struct neph_diag refuse(const char *folder, const char *text, size_t size)
{
    struct neph_i3rc suite = {.rows = NULL};
    struct neph_diag diag = {0};
    const char *only = "case2_exp1";
    const struct neph_i3rc_params params = {
        .folder = folder, .engine = "oracle", .only = &only, .only_count = 1, .quiet = true};
    FILE *file = open_file(folder, radar);
    assert_int_equal(fwrite(text, 1, size, file), size);
    fclose(file);
    assert_int_equal(neph_i3rc_run(&params, &suite, &diag), NEPH_ERR_INPUT);
    neph_i3rc_finish(&suite);
    return diag;
}

static void test_bad_files_are_named_with_their_place(void **state)
{
    static const struct {
        const char *text, *message;
        int line, column;
    } cases[] = {
        {"0.1 0.2\n 0.3 x.4\n", "'x.4' is not an optical depth", 2, 6},
        {"0.1\n0.2 -0.3\n", "-0.3 is not an optical depth: it must be 0..1000", 2, 5},
        {"0.1 1e9", "1e+09 is not an optical depth", 1, 5},
        {"0.1 nan", "'nan' is not an optical depth", 1, 5},
        {"0.1 inf", "'inf'", 1, 5},
        {"0.1 1e999", "'1e999'", 1, 5},
        {"0.10.2 0.3", "'0.10.2'", 1, 1},
        {"0.1 ********", "'********'", 1, 5},
        {"0.1 1.2D-01", "'1.2D-01'", 1, 5},
        {"0.1 0.2\n", "the file ends after 2 of 34560 values", 2, 1},
        {"", "the file ends after 0 of 34560 values", 1, 1},
    };
    OWNED(folder) char *folder = make_folder();
    for (size_t i = 0; i < COUNT(cases); i++) {
        const struct neph_diag diag = refuse(folder, cases[i].text, strlen(cases[i].text));
        if (!strstr(diag.message, cases[i].message))
            fail_msg("'%s' does not contain '%s'", diag.message, cases[i].message);
        assert_non_null(strstr(diag.file, radar));
        assert_int_equal(diag.line, cases[i].line);
        assert_int_equal(diag.column, cases[i].column);
    }
    const struct neph_diag binary = refuse(folder, "0.1\n 0.2\0 0.3", 13);
    assert_non_null(strstr(binary.message, "byte 0"));
    assert_int_equal(binary.line, 2);
    assert_int_equal(binary.column, 5);
}

static void test_wrong_sizes_and_pairs(void **state)
{
    OWNED(folder) char *folder = make_folder();
    write_values(folder, radar, COLUMNS * LAYERS, 0.0);
    struct neph_i3rc_scene *scene = NULL;
    struct neph_diag diag = {0};
    const struct neph_i3rc_experiment *radar_case = &neph_i3rc_experiments[4],
                                      *landsat_case = &neph_i3rc_experiments[11];
    assert_int_equal(neph_i3rc_scene_create(radar_case, folder, &scene, &diag), NEPH_ERR_INPUT);
    assert_non_null(strstr(diag.message, "every optical depth is 0"));
    write_values(folder, radar, COLUMNS * LAYERS + 1, 0.1);
    assert_int_equal(neph_i3rc_scene_create(radar_case, folder, &scene, &diag), NEPH_ERR_INPUT);
    assert_non_null(strstr(diag.message, "more than 34560 values"));
    write_values(folder, "scene43.tau.128x128", SIDE * SIDE, 0.1);
    write_values(folder, "scene43.dz.128x128", SIDE * SIDE, 0.0);
    assert_int_equal(neph_i3rc_scene_create(landsat_case, folder, &scene, &diag), NEPH_ERR_INPUT);
    assert_non_null(strstr(diag.message, "value 1 has the optical depth 0.1"));
    assert_null(scene);
}

#include "tests/main.h"
