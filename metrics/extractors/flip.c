/* SPDX-License-Identifier: MIT
 *
 * The work goes tile by tile, so that it stays in the second-level cache: rows enter a ring, each
 * filtered horizontally once, and leave as a row of the map as soon as the rows below that the
 * vertical filters need are there. What a pixel gets does not depend on its tile.
 */
#include "metrics/extractors/flip.h"

#include "base/threads.h"
#include "metrics/vector_math.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum {
    TILE_WIDTH_PX = 256,
    TILE_HEIGHT_PX = 128,
};

/* Rows of one image in the ring, and the filter that makes each: those of colour from luminance Yn
 * and the opponents Xn - Yn and Yn - Zn, those of features from Yn. The published YCxCz is linear
 * in these three (116 Yn - 16, 500, 200), and the filters are linear too: the factors cancel. */
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

static const enum input_row ring_input[RING_COUNT] = {
    [RING_LUMINANCE] = INPUT_LUMINANCE,
    [RING_RED_GREEN] = INPUT_RED_GREEN,
    [RING_BLUE_YELLOW_NARROW] = INPUT_BLUE_YELLOW,
    [RING_BLUE_YELLOW_WIDE] = INPUT_BLUE_YELLOW,
    [RING_SMOOTH] = INPUT_LUMINANCE,
    [RING_EDGE] = INPUT_LUMINANCE,
    [RING_POINT] = INPUT_LUMINANCE,
};

/* What an image contributes to a row of the map. */
enum output_row {
    OUTPUT_LUMINANCE, /* the first four: blurred, then L a b in the first three */
    OUTPUT_RED_GREEN,
    OUTPUT_BLUE_YELLOW_WIDE,
    OUTPUT_BLUE_YELLOW_NARROW,
    OUTPUT_EDGE_X, /* then the length of (x, y) */
    OUTPUT_EDGE_Y,
    OUTPUT_POINT_X,
    OUTPUT_POINT_Y,
    OUTPUT_COUNT,
};

/* An output is a row of the ring under a kernel down the columns; a kernel has the name of the row
 * of the ring that it makes along the rows. */
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

/* Half of a kernel: weights of the distances 0..radius; on the other side the same, or negated. */
struct kernel {
    int radius_px;
    bool is_odd;
    double *weights;
};

/* The memory of one thread. */
struct workspace {
    atomic_flag taken;
    double *memory;
    double *input[INPUT_COUNT];      /* input_stride each */
    double *ring[2][RING_COUNT];     /* of reference and test: ring_rows * TILE_WIDTH_PX */
    double *output[2][OUTPUT_COUNT]; /* TILE_WIDTH_PX each */
    const double **lines;            /* 2 radius + 1 rows under a kernel */
};

struct neph_flip {
    int radius_px; /* largest of all kernels */
    int ring_rows, input_stride;
    struct kernel kernels[RING_COUNT];
    double *weights; /* of all kernels */
    int workspace_count;
    struct workspace *workspaces;
};

/* ---- colour: constants ----------------------------------------------------------------------- */

/* Linear Rec.709 to XYZ, in units of the white (0.950428545, 1, 1.088900371): rows (10135552,
 * 8788810, 4435075) / 24577794, (2613072, 8788810, 887015) / 12288897, (1425312, 8788810, 70074185)
 * / 73733382, each over its component of the white; and the inverse. */
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

/* Largest colour difference in the gamut, green to blue, to the power of 0.7, and the share of it
 * that is spread over 0 .. 0.95. */
static const double color_exponent = 0.7;
static const double largest_color_difference = 41.27609841185736;
static const double knee_share = 0.4;
static const double knee_value = 0.95;

static const double feature_width_deg = 0.082;

static const double pi = 3.14159265358979323846;

/* ---- tone curves ----------------------------------------------------------------------------- */

const char *const neph_flip_tones[] = {"none", "aces", "reinhard", "hable", NULL};

/* (a x^2 + b x) / (d x^2 + e x + f); Reinhard's is that of a grey. NVlabs/flip cancels the
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

/* Sum over both sides; of an odd kernel, over the positive side. */
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

/* exp(-pi^2 x^2 / spread), x in degrees: the contrast sensitivity in space [HPG 2020, table 1]. */
static void fill_contrast(struct kernel *kernel, double spread, double pixels_per_degree)
{
    for (int i = 0; i <= kernel->radius_px; i++) {
        const double x_deg = i / pixels_per_degree;
        kernel->weights[i] = exp(-pi * pi * x_deg * x_deg / spread);
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

    /* Blue-yellow is the sum of two separable kernels: together they have the volume 1. */
    struct kernel *first = &kernels[RING_BLUE_YELLOW_WIDE];
    struct kernel *second = &kernels[RING_BLUE_YELLOW_NARROW];
    fill_contrast(first, wide.spread, pixels_per_degree);
    scale_kernel(first, sqrt(wide.amplitude * sqrt(pi / wide.spread)));
    fill_contrast(second, narrow.spread, pixels_per_degree);
    scale_kernel(second, sqrt(narrow.amplitude * sqrt(pi / narrow.spread)));
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

/* Radii by the published rule, three standard deviations, and where each kernel lies in memory. */
static enum neph_status make_kernels(struct neph_flip *flip, double pixels_per_degree,
                                     struct neph_diag *diag)
{
    const double feature_sigma_px = 0.5 * feature_width_deg * pixels_per_degree;
    const int feature_radius = (int)ceil(3.0 * feature_sigma_px);
    const int color_radius = (int)ceil(3.0 * sqrt(0.04 / (2.0 * pi * pi)) * pixels_per_degree);
    flip->radius_px = color_radius > feature_radius ? color_radius : feature_radius;
    const size_t stride = (size_t)flip->radius_px + 1;

    flip->weights = calloc(RING_COUNT * stride, sizeof(*flip->weights));
    if (!flip->weights)
        return neph_fail_memory(diag);
    for (int k = 0; k < RING_COUNT; k++)
        flip->kernels[k] = (struct kernel){
            .radius_px = k < RING_SMOOTH ? color_radius : feature_radius,
            .is_odd = k == RING_EDGE,
            .weights = flip->weights + (size_t)k * stride,
        };
    make_contrast_kernels(flip->kernels, pixels_per_degree);
    make_feature_kernels(flip->kernels, feature_sigma_px);
    return NEPH_OK;
}

static bool make_workspace(const struct neph_flip *flip, struct workspace *space)
{
    const size_t input_size = (size_t)flip->input_stride;
    const size_t ring_size = (size_t)flip->ring_rows * TILE_WIDTH_PX;
    space->memory = calloc(INPUT_COUNT * input_size + 2 * RING_COUNT * ring_size +
                               2 * OUTPUT_COUNT * TILE_WIDTH_PX,
                           sizeof(*space->memory));
    space->lines = calloc((size_t)flip->ring_rows, sizeof(*space->lines));
    if (!space->memory || !space->lines)
        return false;

    double *next = space->memory;
    for (int i = 0; i < INPUT_COUNT; i++, next += input_size)
        space->input[i] = next;
    for (int i = 0; i < 2 * RING_COUNT; i++, next += ring_size)
        space->ring[i / RING_COUNT][i % RING_COUNT] = next;
    for (int i = 0; i < 2 * OUTPUT_COUNT; i++, next += TILE_WIDTH_PX)
        space->output[i / OUTPUT_COUNT][i % OUTPUT_COUNT] = next;
    atomic_flag_clear(&space->taken);
    return true;
}

static enum neph_status make_workspaces(struct neph_flip *flip, struct neph_diag *diag)
{
    flip->ring_rows = 2 * flip->radius_px + 1;
    flip->input_stride = TILE_WIDTH_PX + 2 * flip->radius_px;
    const int count = neph_processor_count();
    flip->workspaces = calloc((size_t)count, sizeof(*flip->workspaces));
    if (!flip->workspaces)
        return neph_fail_memory(diag);
    for (; flip->workspace_count < count; flip->workspace_count++)
        if (!make_workspace(flip, &flip->workspaces[flip->workspace_count])) {
            flip->workspace_count++; /* half made: to be freed as well */
            return neph_fail_memory(diag);
        }
    return NEPH_OK;
}

enum neph_status neph_flip_create(double pixels_per_degree, struct neph_flip **flip,
                                  struct neph_diag *diag)
{
    if (!(pixels_per_degree >= 1.0 && pixels_per_degree <= 1000.0)) {
        neph_fail(diag, NEPH_ERR_INPUT, "FLIP: %g pixels per degree are outside 1..1000",
                  pixels_per_degree);
        neph_hint(diag, "distance [m] * pixels per metre of the screen * pi / 180; a desk monitor "
                        "has 40, the publication 67.02");
        return NEPH_ERR_INPUT;
    }
    struct neph_flip *made = calloc(1, sizeof(*made));
    if (!made)
        return neph_fail_memory(diag);
    enum neph_status status = make_kernels(made, pixels_per_degree, diag);
    if (status == NEPH_OK)
        status = make_workspaces(made, diag);
    if (status == NEPH_OK)
        *flip = made;
    else
        neph_flip_destroy(made);
    return status;
}

void neph_flip_destroy(struct neph_flip *flip)
{
    if (!flip)
        return;
    for (int i = 0; i < flip->workspace_count; i++) {
        free(flip->workspaces[i].memory);
        free(flip->workspaces[i].lines);
    }
    free(flip->workspaces);
    free(flip->weights);
    free(flip);
}

/* ---- rows in --------------------------------------------------------------------------------- */

/* Samples x0 - margin .. of a row, the borders repeated outwards. */
static void copy_row(const float *row, int width_px, int x0, int count, double *to)
{
    const int before = x0 < 0 ? -x0 : 0;
    const int last = width_px - x0 < count ? width_px - x0 : count;
    for (int i = 0; i < before; i++)
        to[i] = row[0];
    for (int i = before; i < last; i++)
        to[i] = row[x0 + i];
    for (int i = last; i < count; i++)
        to[i] = row[width_px - 1];
}

/* Written so that NaN would come out as it came in. */
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
        const double v = clamp(scale * x[i], 0.0, 1e100); /* whose square is finite */
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

/* R G B to Yn, Xn - Yn, Yn - Zn, in place. */
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

/* out = sum over j of weights[j] (lines[radius - j] + lines[radius + j]), four j at a time so that
 * `out` is loaded and stored less often than the lines are. */
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

/* The same with lines[radius + j] - lines[radius - j]. */
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

static void filter(const struct kernel *kernel, const double *const *lines, int count, double *out)
{
    if (kernel->is_odd)
        filter_odd(kernel, lines, count, out);
    else
        filter_even(kernel, lines, count, out);
}

/* ---- a row of the map ------------------------------------------------------------------------ */

/* CIE 1976, of a component relative to white. */
static inline double lab_curve(double t)
{
    const double delta = 6.0 / 29.0;
    const double root = neph_cbrt(t);
    const double line = t * (1.0 / (3.0 * delta * delta)) + 4.0 / 29.0;
    return t > delta * delta * delta ? root : line;
}

/* Blurred opponents to L a b, with the chroma of a dark colour lessened [Hunt 1952]; in place. */
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

/* Share 0..1 of the largest colour difference: HyAB [Abasi 2020], bent and stretched. */
static inline double color_share(double dl, double da, double db)
{
    const double knee = knee_share * largest_color_difference;
    const double bent = neph_pow(fabs(dl) + sqrt(da * da + db * db), color_exponent);
    const double below = bent * (knee_value / knee);
    const double above = knee_value +
                         (bent - knee) * ((1.0 - knee_value) / (largest_color_difference - knee));
    return bent < knee ? below : above;
}

/* color^(1 - feature) */
NEPH_VECTOR static void combine(int count, double *const reference[OUTPUT_COUNT],
                                double *const test[OUTPUT_COUNT], double *restrict out)
{
    const double *l0 = reference[0], *a0 = reference[1], *b0 = reference[2];
    const double *l1 = test[0], *a1 = test[1], *b1 = test[2];
    const double *edge0 = reference[OUTPUT_EDGE_X], *edge1 = test[OUTPUT_EDGE_X];
    const double *point0 = reference[OUTPUT_POINT_X], *point1 = test[OUTPUT_POINT_X];
    for (int i = 0; i < count; i++) {
        const double color = color_share(l0[i] - l1[i], a0[i] - a1[i], b0[i] - b1[i]);
        const double edge = fabs(edge0[i] - edge1[i]);
        const double point = fabs(point0[i] - point1[i]);
        const double larger = edge > point ? edge : point;
        const double feature = clamp(sqrt(larger * 0.70710678118654752), 0.0, 1.0);
        out[i] = clamp(neph_pow(color, 1.0 - feature), 0.0, 1.0);
    }
}

NEPH_VECTOR static void keep_larger_of(int count, const double *restrict from, double *restrict to)
{
    for (int i = 0; i < count; i++)
        to[i] = from[i] > to[i] ? from[i] : to[i];
}

/* ---- tiles ----------------------------------------------------------------------------------- */

struct map_job {
    struct neph_flip *flip;
    int width_px, height_px, tiles_per_row;
    const float *const *images[2];
    const struct neph_flip_display *display;
    bool keep_larger;
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

/* Filter row y of an image along x into its place in the ring. */
static void enter_row(const struct map_job *job, struct workspace *space, const struct tile *tile,
                      int image, int y)
{
    const struct neph_flip *flip = job->flip;
    const int margin = flip->radius_px;
    const int count = tile->width_px + 2 * margin;
    for (int c = 0; c < 3; c++)
        copy_row(job->images[image][c] + (size_t)y * (size_t)job->width_px, job->width_px,
                 tile->x0 - margin, count, space->input[c]);
    apply_display(job->display, count, space->input);
    to_opponents(count, space->input[0], space->input[1], space->input[2]);

    const size_t place = (size_t)(y % flip->ring_rows) * TILE_WIDTH_PX;
    for (int k = 0; k < RING_COUNT; k++) {
        const struct kernel *kernel = &flip->kernels[k];
        const double *first = space->input[ring_input[k]] + margin - kernel->radius_px;
        for (int j = 0; j <= 2 * kernel->radius_px; j++)
            space->lines[j] = first + j;
        filter(kernel, space->lines, tile->width_px, space->ring[image][k] + place);
    }
}

/* Filter row y down the columns, and turn it into L a b and the strengths of edge and point. */
static void leave_row(const struct map_job *job, struct workspace *space, const struct tile *tile,
                      int image, int y)
{
    const struct neph_flip *flip = job->flip;
    double *const *out = space->output[image];
    for (int i = 0; i < OUTPUT_COUNT; i++) {
        const struct kernel *kernel = &flip->kernels[outputs[i].kernel];
        const double *ring = space->ring[image][outputs[i].row];
        for (int j = 0; j <= 2 * kernel->radius_px; j++) {
            const int wanted = y + j - kernel->radius_px;
            const int row = wanted < 0 ? 0 : wanted >= job->height_px ? job->height_px - 1 : wanted;
            space->lines[j] = ring + (size_t)(row % flip->ring_rows) * TILE_WIDTH_PX;
        }
        filter(kernel, space->lines, tile->width_px, out[i]);
    }
    to_lab(tile->width_px, out[OUTPUT_LUMINANCE], out[OUTPUT_RED_GREEN],
           out[OUTPUT_BLUE_YELLOW_WIDE], out[OUTPUT_BLUE_YELLOW_NARROW]);
    to_length(tile->width_px, out[OUTPUT_EDGE_X], out[OUTPUT_EDGE_Y]);
    to_length(tile->width_px, out[OUTPUT_POINT_X], out[OUTPUT_POINT_Y]);
}

static void write_row(const struct map_job *job, struct workspace *space, const struct tile *tile,
                      int y)
{
    double *to = job->map + (size_t)y * (size_t)job->width_px + tile->x0;
    double *const *reference = space->output[0], *const *test = space->output[1];
    double *scratch = space->input[0];
    combine(tile->width_px, reference, test, scratch);
    if (job->keep_larger)
        keep_larger_of(tile->width_px, scratch, to);
    else
        memcpy(to, scratch, (size_t)tile->width_px * sizeof(*to));
}

/* There are as many workspaces as threads run, so one is free or will be at once. */
static struct workspace *take_workspace(struct neph_flip *flip)
{
    for (int i = 0;; i = (i + 1) % flip->workspace_count)
        if (!atomic_flag_test_and_set(&flip->workspaces[i].taken))
            return &flip->workspaces[i];
}

static void map_tile(int index, void *context)
{
    const struct map_job *job = context;
    struct workspace *space = take_workspace(job->flip);
    const struct tile tile = tile_at(job, index);
    const int radius = job->flip->radius_px;
    int next = tile.y0 > radius ? tile.y0 - radius : 0;
    for (int y = tile.y0; y < tile.y0 + tile.height_px; y++) {
        for (; next <= y + radius && next < job->height_px; next++)
            for (int image = 0; image < 2; image++)
                enter_row(job, space, &tile, image, next);
        for (int image = 0; image < 2; image++)
            leave_row(job, space, &tile, image, y);
        write_row(job, space, &tile, y);
    }
    atomic_flag_clear(&space->taken);
}

enum neph_status neph_flip_map(struct neph_flip *flip, int width_px, int height_px,
                               const float *const reference[3], const float *const test[3],
                               const struct neph_flip_display *display, bool keep_larger,
                               double *map, struct neph_diag *diag)
{
    struct map_job job = {
        .flip = flip,
        .width_px = width_px,
        .height_px = height_px,
        .tiles_per_row = (width_px + TILE_WIDTH_PX - 1) / TILE_WIDTH_PX,
        .images = {reference, test},
        .display = display,
        .keep_larger = keep_larger,
        .map = map,
    };
    const int tile_rows = (height_px + TILE_HEIGHT_PX - 1) / TILE_HEIGHT_PX;
    return neph_parallel_rows(tile_rows * job.tiles_per_row, map_tile, &job, diag);
}
