/* SPDX-License-Identifier: MIT
 *
 * LDR-FLIP, computed tile by tile so that the data stay in the L2 cache. Rows enter a ring buffer,
 * each filtered horizontally once. They leave as rows of the map as soon as the rows below that the
 * vertical filters need are present. Rows leave in batches, and tiles are narrow, so that the lines
 * for one output of a batch stay in the L1 cache. The result of a pixel does not depend on its
 * tile.
 */
#include "metrics/extractors/flip.h"

#include "base/threads.h"
#include "metrics/vector_math.h"

#include <math.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_FLIP_TONE_COUNT == 4, "a new kind");

enum {
    TILE_WIDTH_PX = 192,
    TILE_HEIGHT_PX = 256,
    BATCH_ROWS = 4,
    LANES = 8, /* of the widest vectors; rows are processed in whole vectors, beyond their end */
    STRIDE = TILE_WIDTH_PX + LANES, /* with a power of two, rows would collide in the cache */
};

/* Rows of one image in the ring, named by their horizontal filter. Colour rows come from luminance
 * Yn and the opponents Xn - Yn and Yn - Zn, feature rows from Yn. The published YCxCz is linear in
 * these three (116 Yn - 16, 500, 200), and the filters are linear, too: the factors cancel. */
enum ring_row {
    RING_LUMINANCE,
    RING_RED_GREEN,
    RING_BLUE_YELLOW_WIDE,
    RING_BLUE_YELLOW_NARROW,
    RING_SMOOTH,
    RING_EDGE,
    RING_POINT,
    RING_COUNT,
};

enum input_row { INPUT_LUMINANCE, INPUT_RED_GREEN, INPUT_BLUE_YELLOW, INPUT_COUNT };

/* Rows of an image for the map. */
enum output_row {
    OUTPUT_LUMINANCE, /* the first four: blurred; later L a b in the first three */
    OUTPUT_RED_GREEN,
    OUTPUT_BLUE_YELLOW_WIDE,
    OUTPUT_BLUE_YELLOW_NARROW,
    OUTPUT_EDGE_X, /* later the length of (x, y) */
    OUTPUT_EDGE_Y,
    OUTPUT_POINT_X,
    OUTPUT_POINT_Y,
    OUTPUT_COUNT,
};

/* Each output is a row of the ring under a vertical kernel. A kernel is named after the ring row
 * that it makes horizontally. */
static const struct {
    enum ring_row row, kernel;
} outputs[OUTPUT_COUNT] = {
    [OUTPUT_LUMINANCE] = {RING_LUMINANCE, RING_LUMINANCE},
    [OUTPUT_RED_GREEN] = {RING_RED_GREEN, RING_RED_GREEN},
    [OUTPUT_BLUE_YELLOW_NARROW] = {RING_BLUE_YELLOW_NARROW, RING_BLUE_YELLOW_NARROW},
    [OUTPUT_BLUE_YELLOW_WIDE] = {RING_BLUE_YELLOW_WIDE, RING_BLUE_YELLOW_WIDE},
    [OUTPUT_EDGE_X] = {RING_EDGE, RING_SMOOTH},
    [OUTPUT_EDGE_Y] = {RING_SMOOTH, RING_EDGE},
    [OUTPUT_POINT_X] = {RING_POINT, RING_SMOOTH},
    [OUTPUT_POINT_Y] = {RING_SMOOTH, RING_POINT},
};

/* Half of a kernel: weights of the distances 0..radius. The other side is equal, or negated for an
 * odd kernel. */
struct kernel {
    int radius_px;
    bool is_odd;
    double *weights;
};

/* The memory of one thread. */
struct workspace {
    atomic_flag taken;
    double *input[INPUT_COUNT];      /* input_stride each */
    double *ring[2][RING_COUNT];     /* of reference and test: ring_rows * STRIDE */
    double *output[2][OUTPUT_COUNT]; /* BATCH_ROWS * STRIDE each */
    const double **lines;            /* 2 radius + BATCH_ROWS rows, the input of a kernel */
};

struct neph_flip {
    int radius_px; /* largest of all kernels */
    int ring_rows, margin_px, input_stride;
    struct kernel kernels[RING_COUNT];
    int workspace_count;
    struct workspace *workspaces;
};

/* ---- colour: constants ----------------------------------------------------------------------- */

/* Linear Rec.709 to XYZ relative to the white (0.950428545, 1, 1.088900371): rows (10135552,
 * 8788810, 4435075) / 24577794, (2613072, 8788810, 887015) / 12288897, (1425312, 8788810, 70074185)
 * / 73733382, each divided by its component of the white; and the inverse. */
static const double xyz_of_rgb[3][3] = {
    {0.4338953890036959, 0.37624237277156414, 0.18986223862159324},
    {0.21263682167732384, 0.7151829818412507, 0.07218019648142547},
    {0.01775242314843879, 0.1094656286421712, 0.8727819480239991},
};
static const double rgb_of_xyz[3][3] = {
    {3.080341987058017, -1.5373989694887855, -0.5429430188923318},
    {-0.9211783957995509, 1.875929983695176, 0.04524841247833623},
    {0.05288129285455714, -0.20401120612390997, 1.1511299134617756},
};

/* The largest colour difference in the gamut, green to blue, is 41.27609841185736 after the power
 * of 0.7. Differences below the knee, 0.4 of that, are mapped to 0 .. 0.95, those above it to 0.95
 * .. 1. The constants are in log2: the knee as HyAB, log2(0.4 * 41.27...) / 0.7, and the factor
 * below it. */
static const double color_exponent = 0.7;
static const double log2_knee = 5.779009439549646;
static const double log2_below_knee = -4.119307189126324;

static const double feature_width_deg = 0.082;

/* ---- tone curves ----------------------------------------------------------------------------- */

const char *const neph_flip_tones[] = {"none", "aces", "reinhard", "hable", NULL};

/* Tone curves (a x^2 + b x) / (d x^2 + e x + f); Reinhard's is for grey. NVlabs/flip cancels the
 * pre-exposure of 0.6 in ACES [Narkowicz 2015]. */
static const struct {
    double a, b, d, e, f;
} curves[] = {
    [NEPH_FLIP_NONE] = {0.0, 1.0, 0.0, 0.0, 1.0},
    [NEPH_FLIP_ACES] = {0.36 * 2.51, 0.6 * 0.03, 0.36 * 2.43, 0.6 * 0.59, 0.14},
    [NEPH_FLIP_REINHARD] = {0.0, 1.0, 0.0, 1.0, 1.0},
    [NEPH_FLIP_HABLE] = {0.231683, 0.013791, 0.18, 0.3, 0.018},
};

double neph_flip_tone_inverse(enum neph_flip_tone tone, double value)
{
    const double a = curves[tone].a - value * curves[tone].d;
    const double b = curves[tone].b - value * curves[tone].e;
    const double c = -value * curves[tone].f;
    if (a == 0.0)
        return -c / b;
    return (-b + sqrt(b * b - 4.0 * a * c)) / (2.0 * a);
}

/* ---- kernels --------------------------------------------------------------------------------- */

/* The sum over both sides; for an odd kernel, over the positive side. */
static double kernel_sum(const struct kernel *kernel)
{
    double side = 0.0;
    for (int i = 1; i <= kernel->radius_px; i++)
        side += kernel->weights[i];
    return kernel->is_odd ? side : kernel->weights[0] + 2.0 * side;
}

static void scale_kernel(struct kernel *kernel, double factor)
{
    for (int i = 0; i <= kernel->radius_px; i++)
        kernel->weights[i] *= factor;
}

/* exp(-pi^2 x^2 / spread), x in degrees: the spatial contrast sensitivity [HPG 2020, table 1]. */
static void fill_contrast(struct kernel *kernel, double spread, double pixels_per_degree)
{
    for (int i = 0; i <= kernel->radius_px; i++) {
        const double x_deg = i / pixels_per_degree;
        kernel->weights[i] = exp(-M_PI * M_PI * x_deg * x_deg / spread);
    }
}

/* Remove the ends of a kernel whose total weight is below the rounding error of its sum. */
static void trim_kernel(struct kernel *kernel)
{
    double left_out = 2.0 * kernel->weights[kernel->radius_px];
    while (kernel->radius_px > 0 && left_out < 1e-14) {
        kernel->weights[kernel->radius_px--] = 0.0;
        left_out += 2.0 * kernel->weights[kernel->radius_px];
    }
}

static void make_contrast_kernels(struct kernel *kernels, double pixels_per_degree)
{
    const struct {
        double amplitude, spread;
    } wide = {34.1, 0.04}, narrow = {13.5, 0.025};

    fill_contrast(&kernels[RING_LUMINANCE], 0.0047, pixels_per_degree);
    scale_kernel(&kernels[RING_LUMINANCE], 1.0 / kernel_sum(&kernels[RING_LUMINANCE]));
    fill_contrast(&kernels[RING_RED_GREEN], 0.0053, pixels_per_degree);
    scale_kernel(&kernels[RING_RED_GREEN], 1.0 / kernel_sum(&kernels[RING_RED_GREEN]));
    trim_kernel(&kernels[RING_LUMINANCE]);
    trim_kernel(&kernels[RING_RED_GREEN]);

    /* Blue-yellow is the sum of two separable kernels, which together have volume 1. */
    struct kernel *first = &kernels[RING_BLUE_YELLOW_WIDE];
    struct kernel *second = &kernels[RING_BLUE_YELLOW_NARROW];
    fill_contrast(first, wide.spread, pixels_per_degree);
    scale_kernel(first, sqrt(wide.amplitude * sqrt(M_PI / wide.spread)));
    fill_contrast(second, narrow.spread, pixels_per_degree);
    scale_kernel(second, sqrt(narrow.amplitude * sqrt(M_PI / narrow.spread)));
    const double norm = 1.0 / hypot(kernel_sum(first), kernel_sum(second));
    scale_kernel(first, norm);
    scale_kernel(second, norm);
}

static void make_feature_kernels(struct kernel *kernels, double sigma_px)
{
    double positive = 0.0, negative = 0.0;
    for (int i = 0; i <= kernels[RING_SMOOTH].radius_px; i++) {
        const double gauss = exp(-0.5 * i * i / (sigma_px * sigma_px));
        const double second = (i * i / (sigma_px * sigma_px) - 1.0) * gauss;
        const double count = i ? 2.0 : 1.0;
        kernels[RING_SMOOTH].weights[i] = gauss;
        kernels[RING_EDGE].weights[i] = i * gauss;
        kernels[RING_POINT].weights[i] = second;
        positive += second > 0.0 ? count * second : 0.0;
        negative -= second < 0.0 ? count * second : 0.0;
    }
    scale_kernel(&kernels[RING_SMOOTH], 1.0 / kernel_sum(&kernels[RING_SMOOTH]));
    scale_kernel(&kernels[RING_EDGE], 1.0 / kernel_sum(&kernels[RING_EDGE]));
    for (int i = 0; i <= kernels[RING_POINT].radius_px; i++) {
        double *weight = &kernels[RING_POINT].weights[i];
        *weight /= *weight > 0.0 ? positive : negative;
    }
}

/* ---- creation -------------------------------------------------------------------------------- */

/* Set radii by the published rule, three standard deviations, and each kernel's place in memory. */
static enum neph_status make_kernels(struct neph_flip *flip, double pixels_per_degree,
                                     struct neph_arena *memory, struct neph_diag *diag)
{
    const double feature_sigma_px = 0.5 * feature_width_deg * pixels_per_degree;
    const int feature_radius = (int)ceil(3.0 * feature_sigma_px);
    const int color_radius = (int)ceil(3.0 * sqrt(0.04 / (2.0 * M_PI * M_PI)) * pixels_per_degree);
    flip->radius_px = color_radius > feature_radius ? color_radius : feature_radius;
    const size_t stride = (size_t)flip->radius_px + 2; /* weights are read in pairs: a 0 at the
                                                        * end */

    for (int k = 0; k < RING_COUNT; k++)
        flip->kernels[k] = (struct kernel){
            .radius_px = k < RING_SMOOTH ? color_radius : feature_radius,
            .is_odd = k == RING_EDGE,
            .weights = neph_arena_allocate(memory, stride, sizeof(double)),
        };
    const enum neph_status status = neph_arena_check(memory, diag);
    if (status)
        return status;
    make_contrast_kernels(flip->kernels, pixels_per_degree);
    make_feature_kernels(flip->kernels, feature_sigma_px);
    return NEPH_OK;
}

static enum neph_status make_workspace(const struct neph_flip *flip, struct workspace *space,
                                       struct neph_arena *memory, struct neph_diag *diag)
{
    const size_t input_size = (size_t)flip->input_stride;
    const size_t ring_size = (size_t)flip->ring_rows * STRIDE;
    const size_t output_size = (size_t)BATCH_ROWS * STRIDE;
    double *rows = neph_arena_allocate(memory,
                                       LANES + INPUT_COUNT * input_size +
                                           2 * RING_COUNT * ring_size +
                                           2 * OUTPUT_COUNT * output_size,
                                       sizeof(*rows));
    space->lines = neph_arena_allocate(memory, (size_t)flip->ring_rows, sizeof(*space->lines));
    if (!rows || !space->lines)
        return neph_fail_memory(diag);

    /* Align rows to vectors, so that no vector crosses a cache line. */
    const size_t vector_size = LANES * sizeof(*rows);
    double *next = rows + (vector_size - (uintptr_t)rows % vector_size) / sizeof(*rows);
    for (int i = 0; i < 2 * RING_COUNT; i++, next += ring_size)
        space->ring[i / RING_COUNT][i % RING_COUNT] = next;
    for (int i = 0; i < 2 * OUTPUT_COUNT; i++, next += output_size)
        space->output[i / OUTPUT_COUNT][i % OUTPUT_COUNT] = next;
    for (int i = 0; i < INPUT_COUNT; i++, next += input_size)
        space->input[i] = next;
    atomic_flag_clear(&space->taken);
    return NEPH_OK;
}

static enum neph_status make_workspaces(struct neph_flip *flip, struct neph_arena *memory,
                                        struct neph_diag *diag)
{
    flip->ring_rows = 2 * flip->radius_px + BATCH_ROWS;
    flip->margin_px = flip->radius_px + 1; /* for that 0 */
    flip->input_stride = STRIDE + 2 * flip->margin_px;
    flip->workspace_count = neph_thread_count();
    flip->workspaces = neph_arena_allocate(memory, (size_t)flip->workspace_count,
                                           sizeof(*flip->workspaces));
    enum neph_status status = flip->workspaces ? NEPH_OK : neph_fail_memory(diag);
    for (int i = 0; i < flip->workspace_count && !status; i++)
        status = make_workspace(flip, &flip->workspaces[i], memory, diag);
    return status;
}

enum neph_status neph_flip_create(double pixels_per_degree, struct neph_arena *memory,
                                  struct neph_flip **flip, struct neph_diag *diag)
{
    if (!(pixels_per_degree >= 1.0 && pixels_per_degree <= 1000.0)) {
        neph_fail(diag, NEPH_ERR_INPUT, "FLIP: %g pixels per degree are outside 1..1000",
                  pixels_per_degree);
        neph_hint(diag, "distance [m] * pixels per metre of the screen * pi / 180; a desk monitor "
                        "has 40, the publication 67.02");
        return NEPH_ERR_INPUT;
    }
    struct neph_flip *made = neph_arena_allocate(memory, 1, sizeof(*made));
    enum neph_status status = neph_arena_check(memory, diag);
    if (!status)
        status = make_kernels(made, pixels_per_degree, memory, diag);
    if (!status)
        status = make_workspaces(made, memory, diag);
    if (!status)
        *flip = made;
    return status;
}

/* ---- rows in --------------------------------------------------------------------------------- */

NEPH_VECTOR static void widen(int count, const float *restrict from, double *restrict to)
{
    for (int i = 0; i < count; i++)
        to[i] = from[i];
}

/* Copy samples x0 .. of a row; borders are repeated outwards. */
static void copy_row(const float *row, int width_px, int x0, int count, double *to)
{
    const int before = x0 < 0 ? -x0 : 0;
    const int last = width_px - x0 < count ? width_px - x0 : count;
    for (int i = 0; i < before; i++)
        to[i] = row[0];
    widen(last - before, row + x0 + before, to + before);
    for (int i = last; i < count; i++)
        to[i] = row[width_px - 1];
}

/* Ordered so that NaN passes through. */
static inline double clamp(double x, double low, double high)
{
    const double above = x < low ? low : x;
    return above > high ? high : above;
}

NEPH_VECTOR static void apply_rational(enum neph_flip_tone tone, double scale, int count, double *x)
{
    const double a = curves[tone].a, b = curves[tone].b;
    const double d = curves[tone].d, e = curves[tone].e, f = curves[tone].f;
    for (int i = 0; i < count; i++) {
        const double v = clamp(scale * x[i], 0.0, 1e100); /* so that its square is finite */
        x[i] = clamp((a * v * v + b * v) / (d * v * v + e * v + f), 0.0, 1.0);
    }
}

NEPH_VECTOR static void apply_reinhard(double scale, int count, double *restrict r,
                                       double *restrict g, double *restrict b)
{
    for (int i = 0; i < count; i++) {
        const double red = clamp(scale * r[i], 0.0, INFINITY);
        const double green = clamp(scale * g[i], 0.0, INFINITY);
        const double blue = clamp(scale * b[i], 0.0, INFINITY);
        const double factor = 1.0 / (1.0 + (0.2126 * red + 0.7152 * green + 0.0722 * blue));
        r[i] = clamp(red * factor, 0.0, 1.0);
        g[i] = clamp(green * factor, 0.0, 1.0);
        b[i] = clamp(blue * factor, 0.0, 1.0);
    }
}

NEPH_VECTOR static void apply_none(double scale, int count, double *x)
{
    for (int i = 0; i < count; i++)
        x[i] = clamp(scale * x[i], 0.0, 1.0);
}

static void apply_display(const struct neph_flip_display *display, int count,
                          double *const rgb[INPUT_COUNT])
{
    const double scale = exp2(display->exposure_ev);
    if (display->tone == NEPH_FLIP_REINHARD) {
        apply_reinhard(scale, count, rgb[0], rgb[1], rgb[2]);
        return;
    }
    for (int c = 0; c < 3; c++) {
        if (display->tone == NEPH_FLIP_NONE)
            apply_none(scale, count, rgb[c]);
        else
            apply_rational(display->tone, scale, count, rgb[c]);
    }
}

/* Convert R G B to Yn, Xn - Yn, Yn - Zn, in place. */
NEPH_VECTOR static void to_opponents(int count, double *restrict red, double *restrict green,
                                     double *restrict blue)
{
    for (int i = 0; i < count; i++) {
        const double r = red[i], g = green[i], b = blue[i];
        const double x = xyz_of_rgb[0][0] * r + xyz_of_rgb[0][1] * g + xyz_of_rgb[0][2] * b;
        const double y = xyz_of_rgb[1][0] * r + xyz_of_rgb[1][1] * g + xyz_of_rgb[1][2] * b;
        const double z = xyz_of_rgb[2][0] * r + xyz_of_rgb[2][1] * g + xyz_of_rgb[2][2] * b;
        red[i] = y;
        green[i] = x - y;
        blue[i] = y - z;
    }
}

/* ---- filters --------------------------------------------------------------------------------- */

/* out = sum over j of weights[j] (lines[radius - j] + lines[radius + j]), four j at a time to load
 * and store `out` less often. */
NEPH_VECTOR static void filter_even(const struct kernel *kernel, const double *const *lines,
                                    int count, double *restrict out)
{
    const int radius = kernel->radius_px;
    const double *w = kernel->weights;
    const double *center = lines[radius];
    for (int x = 0; x < count; x++)
        out[x] = w[0] * center[x];
    int j = 1;
    for (; j + 3 <= radius; j += 4) {
        const double w0 = w[j], w1 = w[j + 1], w2 = w[j + 2], w3 = w[j + 3];
        const double *a0 = lines[radius - j], *b0 = lines[radius + j];
        const double *a1 = lines[radius - j - 1], *b1 = lines[radius + j + 1];
        const double *a2 = lines[radius - j - 2], *b2 = lines[radius + j + 2];
        const double *a3 = lines[radius - j - 3], *b3 = lines[radius + j + 3];
        for (int x = 0; x < count; x++)
            out[x] += w0 * (a0[x] + b0[x]) + w1 * (a1[x] + b1[x]) + w2 * (a2[x] + b2[x]) +
                      w3 * (a3[x] + b3[x]);
    }
    for (; j <= radius; j++) {
        const double w0 = w[j];
        const double *a0 = lines[radius - j], *b0 = lines[radius + j];
        for (int x = 0; x < count; x++)
            out[x] += w0 * (a0[x] + b0[x]);
    }
}

/* filter_even() with lines[radius + j] - lines[radius - j]. */
NEPH_VECTOR static void filter_odd(const struct kernel *kernel, const double *const *lines,
                                   int count, double *restrict out)
{
    const int radius = kernel->radius_px;
    const double *w = kernel->weights;
    for (int x = 0; x < count; x++)
        out[x] = 0.0;
    int j = 1;
    for (; j + 3 <= radius; j += 4) {
        const double w0 = w[j], w1 = w[j + 1], w2 = w[j + 2], w3 = w[j + 3];
        const double *a0 = lines[radius - j], *b0 = lines[radius + j];
        const double *a1 = lines[radius - j - 1], *b1 = lines[radius + j + 1];
        const double *a2 = lines[radius - j - 2], *b2 = lines[radius + j + 2];
        const double *a3 = lines[radius - j - 3], *b3 = lines[radius + j + 3];
        for (int x = 0; x < count; x++)
            out[x] += w0 * (b0[x] - a0[x]) + w1 * (b1[x] - a1[x]) + w2 * (b2[x] - a2[x]) +
                      w3 * (b3[x] - a3[x]);
    }
    for (; j <= radius; j++) {
        const double w0 = w[j];
        const double *a0 = lines[radius - j], *b0 = lines[radius + j];
        for (int x = 0; x < count; x++)
            out[x] += w0 * (b0[x] - a0[x]);
    }
}

/* Apply one kernel vertically: `row_count` rows of out, STRIDE apart, from row_count + 2 radius
 * lines. */
static void filter_columns(const struct kernel *kernel, const double *const *lines, int row_count,
                           int count, double *out)
{
    for (int row = 0; row < row_count; row++)
        if (kernel->is_odd)
            filter_odd(kernel, lines + row, count, out + (size_t)row * STRIDE);
        else
            filter_even(kernel, lines + row, count, out + (size_t)row * STRIDE);
}

/* Filter horizontally with all kernels of an input at once, because they share its sums and
 * differences; kernels of smaller radius have weights of 0 beyond it. `center` is the input at
 * out[0]. */
NEPH_VECTOR static void filter_luminance(const struct kernel *kernels, int radius, int count,
                                         const double *restrict center, double *restrict luminance,
                                         double *restrict smooth, double *restrict edge,
                                         double *restrict point)
{
    const double *wl = kernels[RING_LUMINANCE].weights, *ws = kernels[RING_SMOOTH].weights;
    const double *we = kernels[RING_EDGE].weights, *wp = kernels[RING_POINT].weights;
    for (int x = 0; x < count; x++) {
        luminance[x] = wl[0] * center[x];
        smooth[x] = ws[0] * center[x];
        edge[x] = 0.0;
        point[x] = wp[0] * center[x];
    }
    for (int j = 1; j <= radius; j += 2) {
        const double wl0 = wl[j], ws0 = ws[j], we0 = we[j], wp0 = wp[j];
        const double wl1 = wl[j + 1], ws1 = ws[j + 1], we1 = we[j + 1], wp1 = wp[j + 1];
        const double *a = center - j - 1, *b = center + j;
        for (int x = 0; x < count; x++) {
            const double sum0 = a[x + 1] + b[x], sum1 = a[x] + b[x + 1];
            const double difference0 = b[x] - a[x + 1], difference1 = b[x + 1] - a[x];
            luminance[x] += wl0 * sum0 + wl1 * sum1;
            smooth[x] += ws0 * sum0 + ws1 * sum1;
            edge[x] += we0 * difference0 + we1 * difference1;
            point[x] += wp0 * sum0 + wp1 * sum1;
        }
    }
}

NEPH_VECTOR static void filter_blue_yellow(const struct kernel *kernels, int radius, int count,
                                           const double *restrict center, double *restrict wide,
                                           double *restrict narrow)
{
    const double *ww = kernels[RING_BLUE_YELLOW_WIDE].weights;
    const double *wn = kernels[RING_BLUE_YELLOW_NARROW].weights;
    for (int x = 0; x < count; x++) {
        wide[x] = ww[0] * center[x];
        narrow[x] = wn[0] * center[x];
    }
    for (int j = 1; j <= radius; j += 2) {
        const double ww0 = ww[j], wn0 = wn[j], ww1 = ww[j + 1], wn1 = wn[j + 1];
        const double *a = center - j - 1, *b = center + j;
        for (int x = 0; x < count; x++) {
            const double sum0 = a[x + 1] + b[x], sum1 = a[x] + b[x + 1];
            wide[x] += ww0 * sum0 + ww1 * sum1;
            narrow[x] += wn0 * sum0 + wn1 * sum1;
        }
    }
}

/* ---- a row of the map ------------------------------------------------------------------------ */

/* The curve of CIE 1976 L*a*b*, of a component relative to white. */
static inline double lab_curve(double t)
{
    const double delta = 6.0 / 29.0;
    const double root = neph_cbrt(t);
    const double line = t * (1.0 / (3.0 * delta * delta)) + 4.0 / 29.0;
    return t > delta * delta * delta ? root : line;
}

/* Convert blurred opponents to L a b, with reduced chroma of dark colours [Hunt 1952]; in place. */
NEPH_VECTOR static void to_lab(int count, double *restrict luminance, double *restrict red_green,
                               double *restrict blue_yellow, const double *restrict blue_yellow_2)
{
    for (int i = 0; i < count; i++) {
        const double yn = luminance[i];
        const double xn = yn + red_green[i];
        const double zn = yn - (blue_yellow[i] + blue_yellow_2[i]);
        double rgb[3], f[3];
        for (int c = 0; c < 3; c++)
            rgb[c] = clamp(rgb_of_xyz[c][0] * xn + rgb_of_xyz[c][1] * yn + rgb_of_xyz[c][2] * zn,
                           0.0, 1.0);
        for (int c = 0; c < 3; c++)
            f[c] = lab_curve(xyz_of_rgb[c][0] * rgb[0] + xyz_of_rgb[c][1] * rgb[1] +
                             xyz_of_rgb[c][2] * rgb[2]);
        const double lightness = 116.0 * f[1] - 16.0;
        luminance[i] = lightness;
        red_green[i] = 0.01 * lightness * 500.0 * (f[0] - f[1]);
        blue_yellow[i] = 0.01 * lightness * 200.0 * (f[1] - f[2]);
    }
}

/* x = |(x, y)| */
NEPH_VECTOR static void to_length(int count, double *restrict x, const double *restrict y)
{
    for (int i = 0; i < count; i++)
        x[i] = sqrt(x[i] * x[i] + y[i] * y[i]);
}

/* log2 of the colour difference as a share 0..1 of the largest one; -inf for none. HyAB [Abasi
 * 2020] to the power of 0.7, with the knee. Below the knee it is a line in log2 of HyAB; above it,
 * from 5.78 to 7.67 for the whole gamut, a polynomial at Chebyshev nodes with error 1e-14. */
static inline double log2_color_share(double dl, double da, double db)
{
    const double hyab = neph_log2(fabs(dl) + sqrt(da * da + db * db));
    const double below = color_exponent * hyab + log2_below_knee;
    const double u = hyab - 6.75;
    double above = 5.6052371859025904e-11;
    above = above * u - 3.2959300258398745e-10;
    above = above * u - 9.82282815675955e-09;
    above = above * u - 9.622368843539889e-08;
    above = above * u - 3.2054471584292027e-07;
    above = above * u + 5.624554051323427e-06;
    above = above * u + 0.00011920720519270522;
    above = above * u + 0.0012712900627835373;
    above = above * u + 0.00883268323479774;
    above = above * u + 0.038528872287022044;
    above = above * u - 0.04385414628950054;
    return hyab < log2_knee ? below : above;
}

/* color^(1 - feature) */
NEPH_VECTOR static void combine(int count, double *const reference[OUTPUT_COUNT],
                                double *const test[OUTPUT_COUNT], size_t at, double *restrict out)
{
    const double *l0 = reference[0] + at, *a0 = reference[1] + at, *b0 = reference[2] + at;
    const double *l1 = test[0] + at, *a1 = test[1] + at, *b1 = test[2] + at;
    const double *edge0 = reference[OUTPUT_EDGE_X] + at, *edge1 = test[OUTPUT_EDGE_X] + at;
    const double *point0 = reference[OUTPUT_POINT_X] + at, *point1 = test[OUTPUT_POINT_X] + at;
    for (int i = 0; i < count; i++) {
        const double color = log2_color_share(l0[i] - l1[i], a0[i] - a1[i], b0[i] - b1[i]);
        const double edge = fabs(edge0[i] - edge1[i]);
        const double point = fabs(point0[i] - point1[i]);
        const double larger = edge > point ? edge : point;
        const double feature = clamp(sqrt(larger * 0.70710678118654752), 0.0, 1.0);
        const double power = neph_exp2(color * (1.0 - feature));
        out[i] = feature < 1.0 ? clamp(power, 0.0, 1.0) : 1.0; /* 0^0 is 1 */
    }
}

NEPH_VECTOR static void keep_maximum(int count, const double *restrict from, double *restrict to)
{
    for (int i = 0; i < count; i++)
        to[i] = from[i] > to[i] ? from[i] : to[i];
}

/* ---- tiles ----------------------------------------------------------------------------------- */

struct map_job {
    struct neph_flip *flip;
    int width_px, height_px, tiles_per_row;
    const float *const *images[2];
    const struct neph_flip_display *displays;
    int display_count;
    double *map;
};

struct tile {
    int x0, y0, width_px, height_px;
};

static struct tile tile_at(const struct map_job *job, int index)
{
    struct tile tile = {.x0 = index % job->tiles_per_row * TILE_WIDTH_PX,
                        .y0 = index / job->tiles_per_row * TILE_HEIGHT_PX};
    tile.width_px = job->width_px - tile.x0 < TILE_WIDTH_PX ? job->width_px - tile.x0
                                                            : TILE_WIDTH_PX;
    tile.height_px = job->height_px - tile.y0 < TILE_HEIGHT_PX ? job->height_px - tile.y0
                                                               : TILE_HEIGHT_PX;
    return tile;
}

/* Number of columns to process: the tile's, rounded up to whole vectors. */
static int lane_count(const struct tile *tile)
{
    return (tile->width_px + LANES - 1) / LANES * LANES;
}

/* Filter row y of an image horizontally into its place in the ring. */
static void enter_row(const struct map_job *job, struct workspace *space, const struct tile *tile,
                      const struct neph_flip_display *display, int image, int y)
{
    const struct neph_flip *flip = job->flip;
    const int margin = flip->margin_px;
    const int count = lane_count(tile);
    for (int c = 0; c < 3; c++)
        copy_row(job->images[image][c] + (size_t)y * (size_t)job->width_px, job->width_px,
                 tile->x0 - margin, count + 2 * margin, space->input[c]);
    apply_display(display, count + 2 * margin, space->input);
    to_opponents(count + 2 * margin, space->input[0], space->input[1], space->input[2]);

    const size_t place = (size_t)(y % flip->ring_rows) * STRIDE;
    double *ring[RING_COUNT];
    for (int k = 0; k < RING_COUNT; k++)
        ring[k] = space->ring[image][k] + place;
    filter_luminance(flip->kernels, flip->radius_px, count, space->input[INPUT_LUMINANCE] + margin,
                     ring[RING_LUMINANCE], ring[RING_SMOOTH], ring[RING_EDGE], ring[RING_POINT]);
    filter_blue_yellow(flip->kernels, flip->radius_px, count,
                       space->input[INPUT_BLUE_YELLOW] + margin, ring[RING_BLUE_YELLOW_WIDE],
                       ring[RING_BLUE_YELLOW_NARROW]);
    const struct kernel *red_green = &flip->kernels[RING_RED_GREEN];
    for (int j = -red_green->radius_px; j <= red_green->radius_px; j++)
        space->lines[j + red_green->radius_px] = space->input[INPUT_RED_GREEN] + margin + j;
    filter_even(red_green, space->lines, count, ring[RING_RED_GREEN]);
}

/* Filter rows y .. y + row_count - 1 vertically, and convert them to L a b and to the strengths of
 * edges and points. */
static void leave_rows(const struct map_job *job, struct workspace *space, const struct tile *tile,
                       int image, int y, int row_count)
{
    const struct neph_flip *flip = job->flip;
    const int count = lane_count(tile);
    double *const *out = space->output[image];
    for (int i = 0; i < OUTPUT_COUNT; i++) {
        const struct kernel *kernel = &flip->kernels[outputs[i].kernel];
        const double *ring = space->ring[image][outputs[i].row];
        for (int j = 0; j < 2 * kernel->radius_px + row_count; j++) {
            const int wanted = y + j - kernel->radius_px;
            const int row = wanted < 0 ? 0 : wanted >= job->height_px ? job->height_px - 1 : wanted;
            space->lines[j] = ring + (size_t)(row % flip->ring_rows) * STRIDE;
        }
        filter_columns(kernel, space->lines, row_count, count, out[i]);
    }
    for (size_t at = 0; at < (size_t)row_count * STRIDE; at += STRIDE) {
        to_lab(count, out[OUTPUT_LUMINANCE] + at, out[OUTPUT_RED_GREEN] + at,
               out[OUTPUT_BLUE_YELLOW_WIDE] + at, out[OUTPUT_BLUE_YELLOW_NARROW] + at);
        to_length(count, out[OUTPUT_EDGE_X] + at, out[OUTPUT_EDGE_Y] + at);
        to_length(count, out[OUTPUT_POINT_X] + at, out[OUTPUT_POINT_Y] + at);
    }
}

/* Write row y of the map from row `row` of the batch; for later displays, only where it is
 * larger. */
static void write_row(const struct map_job *job, struct workspace *space, const struct tile *tile,
                      bool is_first, int row, int y)
{
    double *to = job->map + (size_t)y * (size_t)job->width_px + tile->x0;
    double *scratch = space->input[0];
    combine(lane_count(tile), space->output[0], space->output[1], (size_t)row * STRIDE, scratch);
    if (is_first)
        memcpy(to, scratch, (size_t)tile->width_px * sizeof(*to));
    else
        keep_maximum(tile->width_px, scratch, to);
}

/* Take a free workspace. There are as many workspaces as threads, so one is free at once or
 * soon. */
static struct workspace *take_workspace(struct neph_flip *flip)
{
    for (int i = 0;; i = (i + 1) % flip->workspace_count)
        if (!atomic_flag_test_and_set(&flip->workspaces[i].taken))
            return &flip->workspaces[i];
}

static void map_display(const struct map_job *job, struct workspace *space, const struct tile *tile,
                        int display)
{
    const int radius = job->flip->radius_px;
    const int end = tile->y0 + tile->height_px;
    int next = tile->y0 > radius ? tile->y0 - radius : 0;
    for (int y = tile->y0; y < end; y += BATCH_ROWS) {
        const int row_count = end - y < BATCH_ROWS ? end - y : BATCH_ROWS;
        for (; next < y + row_count + radius && next < job->height_px; next++)
            for (int image = 0; image < 2; image++)
                enter_row(job, space, tile, &job->displays[display], image, next);
        for (int image = 0; image < 2; image++)
            leave_rows(job, space, tile, image, y, row_count);
        for (int row = 0; row < row_count; row++)
            write_row(job, space, tile, display == 0, row, y + row);
    }
}

/* Process all displays of a tile one after another, while its samples and its map are in the
 * cache. */
static void map_tile(int index, void *context)
{
    const struct map_job *job = context;
    struct workspace *space = take_workspace(job->flip);
    const struct tile tile = tile_at(job, index);
    for (int i = 0; i < job->display_count; i++)
        map_display(job, space, &tile, i);
    atomic_flag_clear(&space->taken);
}

enum neph_status neph_flip_map(struct neph_flip *flip, int width_px, int height_px,
                               const float *const reference[3], const float *const test[3],
                               const struct neph_flip_display *displays, int display_count,
                               double *map, struct neph_diag *diag)
{
    struct map_job job = {
        .flip = flip,
        .width_px = width_px,
        .height_px = height_px,
        .tiles_per_row = (width_px + TILE_WIDTH_PX - 1) / TILE_WIDTH_PX,
        .images = {reference, test},
        .displays = displays,
        .display_count = display_count,
        .map = map,
    };
    const int tile_rows = (height_px + TILE_HEIGHT_PX - 1) / TILE_HEIGHT_PX;
    return neph_parallel_rows(tile_rows * job.tiles_per_row, map_tile, &job, diag);
}
