/* SPDX-License-Identifier: MIT */
#include "renderer/post/colour.h"

const struct neph_primaries neph_rec709 = {
    {0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}, {0.3127, 0.3290}};
const struct neph_primaries neph_rec2020 = {
    {0.708, 0.292}, {0.170, 0.797}, {0.131, 0.046}, {0.3127, 0.3290}};
const struct neph_primaries neph_ap0 = {
    {0.7347, 0.2653}, {0.0, 1.0}, {0.0001, -0.077}, {0.32168, 0.33767}};
const struct neph_primaries neph_ap1 = {
    {0.713, 0.293}, {0.165, 0.830}, {0.128, 0.044}, {0.32168, 0.33767}};

struct vec {
    double v[3];
};

static struct vec multiply_vector(const struct neph_matrix3 *a, struct vec b)
{
    struct vec product = {{0}};
    for (int row = 0; row < 3; row++)
        for (int k = 0; k < 3; k++)
            product.v[row] += a->m[row][k] * b.v[k];
    return product;
}

struct neph_matrix3 neph_matrix_product(const struct neph_matrix3 *a, const struct neph_matrix3 *b)
{
    struct neph_matrix3 product = {{{0}}};
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++)
            for (int k = 0; k < 3; k++)
                product.m[row][column] += a->m[row][k] * b->m[k][column];
    return product;
}

/* By cofactors. */
static struct neph_matrix3 invert_matrix(const struct neph_matrix3 *a)
{
    struct neph_matrix3 cofactors, result;
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++) {
            const int r1 = (row + 1) % 3, r2 = (row + 2) % 3;
            const int c1 = (column + 1) % 3, c2 = (column + 2) % 3;
            cofactors.m[row][column] = a->m[r1][c1] * a->m[r2][c2] - a->m[r1][c2] * a->m[r2][c1];
        }
    double determinant = 0.0;
    for (int k = 0; k < 3; k++)
        determinant += a->m[0][k] * cofactors.m[0][k];
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++)
            result.m[row][column] = cofactors.m[column][row] / determinant;
    return result;
}

static struct neph_matrix3 scaling(struct vec by)
{
    return (struct neph_matrix3){{{by.v[0], 0, 0}, {0, by.v[1], 0}, {0, 0, by.v[2]}}};
}

/* CIE XYZ at Y = 1. */
static struct vec convert_to_xyz(struct neph_chromaticity c)
{
    return (struct vec){{c.x / c.y, 1.0, (1.0 - c.x - c.y) / c.y}};
}

/* Columns are the primaries, scaled so that their sum is the white. */
static struct neph_matrix3 to_xyz(const struct neph_primaries *space)
{
    const struct neph_chromaticity *const all[3] = {&space->red, &space->green, &space->blue};
    struct neph_matrix3 columns;
    for (int c = 0; c < 3; c++) {
        columns.m[0][c] = all[c]->x;
        columns.m[1][c] = all[c]->y;
        columns.m[2][c] = 1.0 - all[c]->x - all[c]->y;
    }
    const struct neph_matrix3 back = invert_matrix(&columns);
    const struct neph_matrix3 scale = scaling(multiply_vector(&back, convert_to_xyz(space->white)));
    return neph_matrix_product(&columns, &scale);
}

static struct neph_matrix3 adaptation(struct neph_chromaticity from, struct neph_chromaticity to)
{
    static const struct neph_matrix3 bradford = {
        {{0.8951, 0.2664, -0.1614}, {-0.7502, 1.7135, 0.0367}, {0.0389, -0.0685, 1.0296}}};
    const struct vec cones_from = multiply_vector(&bradford, convert_to_xyz(from));
    const struct vec cones_to = multiply_vector(&bradford, convert_to_xyz(to));
    struct vec gains;
    for (int k = 0; k < 3; k++)
        gains.v[k] = cones_to.v[k] / cones_from.v[k];
    const struct neph_matrix3 scale = scaling(gains), back = invert_matrix(&bradford);
    const struct neph_matrix3 scaled = neph_matrix_product(&scale, &bradford);
    return neph_matrix_product(&back, &scaled);
}

struct neph_matrix3 neph_colour_matrix(const struct neph_primaries *from,
                                       const struct neph_primaries *to)
{
    const struct neph_matrix3 in = to_xyz(from), out = to_xyz(to);
    const struct neph_matrix3 adapted = adaptation(from->white, to->white),
                              back = invert_matrix(&out);
    const struct neph_matrix3 seen = neph_matrix_product(&adapted, &in);
    return neph_matrix_product(&back, &seen);
}

/* a + b/T + c/T^2 + d/T^3, with T in thousands of kelvins */
static double cubic(const double c[4], double temperature_k)
{
    const double inverse_kk = 1000.0 / temperature_k;
    return c[0] + inverse_kk * (c[1] + inverse_kk * (c[2] + inverse_kk * c[3]));
}

static struct neph_chromaticity daylight(double temperature_k)
{
    static const double below_7000_k[4] = {0.244063, 0.09911, 2.9678, -4.6070};
    static const double above[4] = {0.237040, 0.24748, 1.9018, -2.0064};
    const double x = cubic(temperature_k <= 7000.0 ? below_7000_k : above, temperature_k);
    return (struct neph_chromaticity){x, -3.0 * x * x + 2.870 * x - 0.275};
}

static struct neph_chromaticity black_body(double temperature_k)
{
    static const double x_of[4] = {0.179910, 0.8776956, -0.2343589, -0.2661239};
    const double x = cubic(x_of, temperature_k);
    const double y = temperature_k < 2222.0
                         ? ((-1.1063814 * x - 1.34811020) * x + 2.18555832) * x - 0.20219683
                         : ((-0.9549476 * x - 1.37418593) * x + 2.09137015) * x - 0.16748867;
    return (struct neph_chromaticity){x, y};
}

struct neph_chromaticity neph_white_chromaticity(double temperature_k)
{
    return temperature_k < 4000.0 ? black_body(temperature_k) : daylight(temperature_k);
}

struct neph_matrix3 neph_white_balance(double temperature_k)
{
    const struct neph_matrix3 in = to_xyz(&neph_rec709), back = invert_matrix(&in);
    const struct neph_matrix3 adapted = adaptation(neph_white_chromaticity(temperature_k),
                                                   neph_white_chromaticity(NEPH_WHITE_K));
    const struct neph_matrix3 seen = neph_matrix_product(&adapted, &in);
    return neph_matrix_product(&back, &seen);
}
