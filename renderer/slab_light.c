/* SPDX-License-Identifier: MIT */
#include "renderer/slab_light.h"

#include "scenes/media.h"

#include <math.h>
#include <stdlib.h>

/* Does not compile with a new lighting: this file then needs a change. */
_Static_assert(NEPH_MARCH_LIGHTING_COUNT == 8, "a new kind");

enum { NODES = NEPH_GPU_SLAB_NODES, CELLS = 48 };

double neph_slab_light_depth(int node)
{
    return (exp2(NEPH_GPU_SLAB_OCTAVES * node / (NODES - 1.0)) - 1.0) / NEPH_GPU_SLAB_PER_DEPTH;
}

/* --- the slab -------------------------------------------------------------------------------- */

/* E2(x), x >= 0: e^-x - x E1(x), with E1 by its series (M. Abramowitz, I. A. Stegun, "Handbook of
 * Mathematical Functions", 1964, 5.1.11) and its continued fraction (5.1.22). */
double neph_slab_light_e2(double x)
{
    static const double euler = 0.57721566490153286;
    if (x <= 0.0)
        return 1.0;
    if (x > 700.0)
        return 0.0;
    if (x < 1.0) {
        double sum = -euler - log(x), term = -1.0;
        for (int n = 1; n < 20; n++) {
            term *= -x / n;
            sum += term / n;
        }
        return exp(-x) - x * sum;
    }
    double fraction = 0.0;
    for (int n = 32; n > 0; n--)
        fraction = n / (1.0 + n / (x + fraction));
    return exp(-x) * (1.0 - x / (x + fraction));
}

/* Integral of E1(|t - s|) over s from a to b. */
static double integrate_e1(double t, double a, double b)
{
    if (t <= a)
        return neph_slab_light_e2(a - t) - neph_slab_light_e2(b - t);
    if (t >= b)
        return neph_slab_light_e2(t - b) - neph_slab_light_e2(t - a);
    return 2.0 - neph_slab_light_e2(t - a) - neph_slab_light_e2(b - t);
}

/* Edge i of the cells, denser near both boundaries. */
static double compute_cell_edge(int i, double depth)
{
    const double x = 2.0 * i / CELLS - 1.0, bend = fmin(depth, 30.0) / 8.0 + 1e-3;
    return 0.5 * depth * (1.0 + tanh(bend * x * 0.5) / tanh(bend * 0.5));
}

/* Gaussian elimination without pivoting: the matrix is diagonally dominant, because the rows of the
 * kernel sum up to at most 2. */
static void solve_linear_system(double matrix[CELLS][CELLS], double right[CELLS])
{
    for (int i = 0; i < CELLS; i++)
        for (int j = i + 1; j < CELLS; j++) {
            const double part = matrix[j][i] / matrix[i][i];
            for (int k = i; k < CELLS; k++)
                matrix[j][k] -= part * matrix[i][k];
            right[j] -= part * right[i];
        }
    for (int i = CELLS - 1; i >= 0; i--) {
        for (int k = i + 1; k < CELLS; k++)
            right[i] -= matrix[i][k] * right[k];
        right[i] /= matrix[i][i];
    }
}

/* Milne's equation (E. A. Milne, 1921) with a source function S that is constant in a cell: S =
 * albedo (mean + e^-t / 4 pi), where the mean radiance is half the integral of E1(|t - s|) S(s)
 * over the slab. */
double neph_slab_light_infinite_per_sr(double above, double below, double albedo)
{
    double matrix[CELLS][CELLS], source[CELLS], edges[CELLS + 1], mean = 0.0;
    const double depth = above + below;
    if (!(depth > 0.0))
        return 0.0;
    for (int i = 0; i <= CELLS; i++)
        edges[i] = compute_cell_edge(i, depth);
    for (int i = 0; i < CELLS; i++) {
        const double t = 0.5 * (edges[i] + edges[i + 1]);
        for (int j = 0; j < CELLS; j++)
            matrix[i][j] = (i == j) - 0.5 * albedo * integrate_e1(t, edges[j], edges[j + 1]);
        source[i] = albedo / (4.0 * M_PI) * (exp(-edges[i]) - exp(-edges[i + 1])) /
                    (edges[i + 1] - edges[i]);
    }
    solve_linear_system(matrix, source);
    for (int j = 0; j < CELLS; j++)
        mean += 0.5 * integrate_e1(above, edges[j], edges[j + 1]) * source[j];
    return mean;
}

/* Loss through the sides of a column as wide as it is long, as an equivalent absorption: with a
 * fluence that is a cosine across the column it is D 2 (pi / (width + 2 q))^2, in units of the
 * extinction; D = 1/3, q = 0.7104 (S. Glasstone, M. C. Edlund, "The Elements of Nuclear Reactor
 * Theory", 1952: buckling). */
static double compute_side_loss(double width)
{
    const double q = 0.7104, wave = M_PI / (width + 2.0 * q);
    return 2.0 / 3.0 * wave * wave;
}

double neph_slab_light_per_sr(double above, double below, double albedo)
{
    return neph_slab_light_infinite_per_sr(above, below,
                                           fmax(0.0, albedo - compute_side_loss(above + below)));
}

/* --- on the device --------------------------------------------------------------------------- */

/* Albedo of the similar isotropic medium. */
static double isotropic_albedo(double albedo, double g)
{
    return albedo >= 1.0 ? 1.0 : albedo * (1.0 - g) / (1.0 - albedo * g);
}

/* Fill the table, one channel for each albedo. */
static void fill_slab_table(const struct neph_medium *medium, float table[NODES * NODES][4])
{
    const double g = neph_phase_mean_cosine(&medium->phase);
    const double albedos[3] = {medium->albedo.r, medium->albedo.g, medium->albedo.b};
    for (int i = 0; i < NODES * NODES; i++)
        for (int c = 0; c < 3; c++)
            table[i][c] = c > 0 && albedos[c] == albedos[c - 1]
                              ? table[i][c - 1]
                              : (float)neph_slab_light_per_sr(neph_slab_light_depth(i % NODES),
                                                              neph_slab_light_depth(i / NODES),
                                                              isotropic_albedo(albedos[c], g));
}

enum neph_status neph_slab_light_create(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                        const struct neph_march_params *params,
                                        struct neph_slab_light *light, struct neph_diag *diag)
{
    if (params->lighting != NEPH_MARCH_SLAB)
        return NEPH_OK;
    light->vulkan = vulkan;
    float(*table)[4] = calloc(NODES * NODES, sizeof(*table));
    if (!table)
        return neph_fail_memory(diag);
    if (scene->medium_count > 0)
        fill_slab_table(&scene->media[0], table);
    const size_t bytes = NODES * NODES * sizeof(*table);
    enum neph_status status = neph_buffer_create(vulkan, NEPH_BUFFER_DEVICE, bytes, "slab light",
                                                 &light->table, diag);
    if (!status)
        status = neph_buffer_upload(vulkan, &light->table, 0, table, bytes, diag);
    free(table);
    return status;
}

void neph_slab_light_destroy(struct neph_slab_light *light)
{
    if (light->vulkan)
        neph_buffer_destroy(light->vulkan, &light->table);
    *light = (struct neph_slab_light){0};
}
