/* SPDX-License-Identifier: MIT
 *
 * The CPU reference of anti-aliasing and upsampling, in the order of the shader's files:
 * neighbourhood.glsl, motion.glsl, history.glsl, taa.glsl, rounding.glsl. Decisions are made in
 * float32, operation by operation as in the shader; colours are double.
 */
#include "renderer/realtime/anti_aliasing/check_reference.h"

#include "renderer/realtime/shared/check_reference_dither.h"

#include <math.h>
#include <string.h>

static const double half_max = 65504.0;

struct box {
    double low[3], high[3];
};

static float setting(const struct reference *cpu, int index)
{
    return cpu->view->settings[index];
}

static int choice(const struct reference *cpu, int index)
{
    return (int)cpu->view->settings[index];
}

/* --- numbers that may be bad, samples --------------------------------------------------------- */

double taa_clamp(double value, double low, double high)
{
    return low > high ? value : value < low ? low : value > high ? high : value;
}

bool taa_is_finite(struct colour colour)
{
    return isfinite(colour.c[0]) && isfinite(colour.c[1]) && isfinite(colour.c[2]);
}

struct colour taa_guard(const struct reference *cpu, struct colour colour)
{
    for (int c = 0; c < 3 && choice(cpu, RT_TAA_GUARD); c++)
        colour.c[c] = taa_clamp(colour.c[c], 0.0, half_max);
    return colour;
}

double taa_luma_4(struct colour colour)
{
    return colour.c[0] + 2.0 * colour.c[1] + colour.c[2];
}

static double hdr_weight(const struct reference *cpu, struct colour colour)
{
    return choice(cpu, RT_TAA_HDR_WEIGHT) ? 1.0 / (taa_luma_4(colour) + 4.0) : 1.0;
}

/* The frame's colour, exposed. */
struct colour taa_fetch_colour(const struct reference *cpu, int target, int x, int y)
{
    float value[4];
    cpu_fetch_full(cpu, target, x, y, value);
    const float exposure = cpu->view->exposure;
    return (struct colour){{exposure * value[0], exposure * value[1], exposure * value[2]}};
}

static bool upsamples(const struct reference *cpu)
{
    return choice(cpu, RT_TAA) == RT_TAA_UPSAMPLING || choice(cpu, RT_TAA) == RT_TAA_LOCKS;
}

/* The rendered pixel with the nearest ray, in the shader's float32. */
struct place taa_find_source(const struct reference *cpu, int x, int y)
{
    const struct neph_gpu_view *view = cpu->view;
    if (!upsamples(cpu))
        return (struct place){x, y, x, y};
    const float rendered_x = ((float)x + 0.5f) * view->rendered_per_px[0] - view->jitter_px[0];
    const float rendered_y = ((float)y + 0.5f) * view->rendered_per_px[1] - view->jitter_px[1];
    return (struct place){x, y, (int)floorf(rendered_x), (int)floorf(rendered_y)};
}

/* From a pixel's centre to its source's ray, along one axis. */
float taa_shift_px(const struct reference *cpu, int pixel, int source, int axis)
{
    const struct neph_gpu_view *view = cpu->view;
    if (!upsamples(cpu))
        return view->jitter_px[axis];
    const float way = ((float)pixel + 0.5f) * view->rendered_per_px[axis] - view->jitter_px[axis];
    return (float)source + 0.5f - way;
}

struct neighbourhood taa_fetch_neighbourhood(const struct reference *cpu, struct place at)
{
    const float shift_x = taa_shift_px(cpu, at.x, at.source_x, 0);
    const float shift_y = taa_shift_px(cpu, at.y, at.source_y, 1);
    struct neighbourhood around;
    for (int i = 0; i < 9; i++) {
        const struct colour colour = taa_fetch_colour(cpu, RT_COLOR, at.source_x + i % 3 - 1,
                                                      at.source_y + i / 3 - 1);
        around.is_valid[i] = !choice(cpu, RT_TAA_GUARD) || taa_is_finite(colour);
        around.colours[i] = taa_guard(cpu, colour);
        around.off_px[i][0] = (float)(i % 3 - 1) + shift_x;
        around.off_px[i][1] = (float)(i / 3 - 1) + shift_y;
    }
    return around;
}

/* --- the filter ------------------------------------------------------------------------------- */

/* Weight by the distance in output pixels. */
static double filter_weight(const struct reference *cpu, const struct neighbourhood *around, int i)
{
    double squared = 0.0;
    for (int axis = 0; axis < 2; axis++)
        squared += pow(around->off_px[i][axis] / (double)cpu->view->rendered_per_px[axis], 2.0);
    return exp(-2.29 * squared);
}

/* Coverage of the pixel by samples: the sum of the filter's weights, at most 1. */
double taa_coverage(const struct reference *cpu, const struct neighbourhood *around)
{
    double sum = upsamples(cpu) ? 0.0 : 1.0;
    for (int i = 0; i < 9; i++)
        sum += filter_weight(cpu, around, i);
    return fmin(sum, 1.0);
}

bool taa_filter_samples(const struct reference *cpu, const struct neighbourhood *around,
                        struct colour *filtered)
{
    *filtered = around->colours[4];
    if (!choice(cpu, RT_TAA_FILTER))
        return around->is_valid[4];
    double weights = 0.0, sum[3] = {0.0};
    for (int i = 0; i < 9; i++) {
        const double weight = filter_weight(cpu, around, i) * hdr_weight(cpu, around->colours[i]);
        weights += around->is_valid[i] ? weight : 0.0;
        for (int c = 0; c < 3 && around->is_valid[i]; c++)
            sum[c] += weight * around->colours[i].c[c];
    }
    for (int c = 0; c < 3; c++)
        filtered->c[c] = sum[c] / weights;
    return weights != 0.0;
}

/* --- the clamp box ---------------------------------------------------------------------------- */

static struct colour to_space(int space, struct colour colour)
{
    const double r = colour.c[0], g = colour.c[1], b = colour.c[2];
    if (space == RT_SPACE_YCOCG)
        return (struct colour){{r + 2.0 * g + b, 2.0 * r - 2.0 * b, 2.0 * g - r - b}};
    if (space == RT_SPACE_REINHARD)
        return (struct colour){{r / (1.0 + fabs(r)), g / (1.0 + fabs(g)), b / (1.0 + fabs(b))}};
    return colour;
}

static struct colour from_space(int space, struct colour value)
{
    const double y = value.c[0] / 4.0, orange = value.c[1] / 4.0, green = value.c[2] / 4.0;
    if (space == RT_SPACE_YCOCG)
        return (struct colour){{y + orange - green, y + green, y - orange - green}};
    for (int c = 0; c < 3 && space == RT_SPACE_REINHARD; c++)
        value.c[c] /= 1.0 - fabs(value.c[c]);
    return value;
}

/* Empty, with low above high, when no colour is valid. */
static struct box extremes(const struct neighbourhood *around, const bool among[9])
{
    struct box box = {{3e38, 3e38, 3e38}, {-3e38, -3e38, -3e38}};
    for (int i = 0; i < 9; i++)
        for (int c = 0; c < 3 && among[i] && around->is_valid[i]; c++) {
            const double value = around->colours[i].c[c];
            box.low[c] = value < box.low[c] ? value : box.low[c];
            box.high[c] = value > box.high[c] ? value : box.high[c];
        }
    return box;
}

static struct box rounded_box(const struct neighbourhood *around)
{
    static const bool square[9] = {1, 1, 1, 1, 1, 1, 1, 1, 1}, plus[9] = {0, 1, 0, 1, 1, 1, 0, 1};
    const struct box outer = extremes(around, square), inner = extremes(around, plus);
    struct box box = outer;
    bool has_plus = false;
    for (int i = 0; i < 9; i++)
        has_plus |= plus[i] && around->is_valid[i];
    for (int c = 0; c < 3 && has_plus; c++) {
        box.low[c] = 0.5 * (outer.low[c] + inner.low[c]);
        box.high[c] = 0.5 * (outer.high[c] + inner.high[c]);
    }
    return box;
}

static struct box variance_box(const struct neighbourhood *around, struct colour filtered,
                               double sigma)
{
    struct box box;
    for (int c = 0; c < 3; c++) {
        double count = 0.0, sum = 0.0, squares = 0.0;
        for (int i = 0; i < 9; i++)
            if (around->is_valid[i])
                count += 1.0, sum += around->colours[i].c[c];
        for (int i = 0; i < 9; i++)
            if (around->is_valid[i])
                squares += pow(around->colours[i].c[c] - sum / count, 2.0);
        const double reach = sigma * sqrt(squares / count);
        box.low[c] = fmin(sum / count - reach, filtered.c[c]);
        box.high[c] = fmax(sum / count + reach, filtered.c[c]);
    }
    return box;
}

/* Decides membership in the distance box, therefore float32. */
static float distance_squared(const struct neighbourhood *around, int i)
{
    const float x = around->off_px[i][0], y = around->off_px[i][1];
    return x * x + y * y;
}

static struct box near_box(const struct reference *cpu, const struct neighbourhood *around)
{
    const float reach_px = 1.51f - 0.21f * (1.0f / cpu->view->rendered_per_px[0] - 1.0f);
    const bool is_larger = choice(cpu, RT_TAA) == RT_TAA_UPSAMPLING;
    bool near[9];
    for (int i = 0; i < 9; i++)
        near[i] = distance_squared(around, i) < (is_larger ? reach_px * reach_px : 2.2801f);
    return extremes(around, near);
}

struct colour taa_clamp_history(const struct reference *cpu, struct colour history,
                                struct neighbourhood around, struct colour filtered, double scale)
{
    const int kind = choice(cpu, RT_TAA_BOX), space = choice(cpu, RT_TAA_SPACE);
    if (kind == RT_BOX_NONE)
        return history;
    for (int i = 0; i < 9; i++)
        around.colours[i] = to_space(space, around.colours[i]);
    const struct box box = kind == RT_BOX_MIN_MAX ? rounded_box(&around)
                           : kind == RT_BOX_VARIANCE
                               ? variance_box(&around, to_space(space, filtered),
                                              scale * setting(cpu, RT_TAA_SIGMA))
                               : near_box(cpu, &around);
    struct colour clamped = to_space(space, history);
    bool is_moved = false;
    for (int c = 0; c < 3; c++) {
        const double free = clamped.c[c];
        clamped.c[c] = taa_clamp(free, box.low[c], box.high[c]);
        is_moved |= clamped.c[c] != free;
    }
    return is_moved ? from_space(space, clamped) : history;
}

/* --- motion: the shader's float32, operation by operation ------------------------------------- */

/* Reads the change around the tile of a pixel, of the medium and behind it; false when no setting
 * uses it. */
static bool find_change(const struct reference *cpu, int x, int y, float changes[2][4])
{
    cpu_fetch_tile(cpu, RT_CHANGE, x / 4, y / 4, changes[0]);
    cpu_fetch_tile(cpu, RT_CHANGE_BEHIND, x / 4, y / 4, changes[1]);
    return choice(cpu, RT_GRADIENT) && setting(cpu, RT_TAA_AGE_MAX) != 0.0f;
}

static double beyond(double value, double least)
{
    return least > 0.0 ? taa_clamp(value / least - 1.0, 0.0, 1.0) : 1.0;
}

static double largest_residue(float changes[2][4])
{
    return fmax(changes[0][3], changes[1][3]);
}

/* 0 up to taa_change, 1 from taa_change_full on. */
static double light_change(const struct reference *cpu, float changes[2][4])
{
    const double residue = largest_residue(changes);
    const double least = setting(cpu, RT_TAA_CHANGE), full = setting(cpu, RT_TAA_CHANGE_FULL);
    if (full == 0.0)
        return beyond(residue, least);
    return taa_clamp((residue - least) / fmax(full - least, 1e-6), 0.0, 1.0);
}

/* Whether the light changes by more than taa_change; always true without a gradient. */
static bool is_changing(const struct reference *cpu, int x, int y)
{
    float changes[2][4];
    return !find_change(cpu, x, y, changes) || light_change(cpu, changes) > 0.0;
}

float taa_dot(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static float spread(const struct neph_gpu_view_camera *camera, float depth)
{
    return camera->is_parallel ? 1.0f : depth;
}

void taa_ray_through(const struct neph_gpu_view *view, int x, int y, float ray[3])
{
    const struct neph_gpu_view_camera *now = &view->now;
    const float centre_px[2] = {(float)x + 0.5f, (float)y + 0.5f};
    const float right = (2.0f * centre_px[0] / (float)view->picture_px[0] - 1.0f) * now->half_width;
    const float up = (1.0f - 2.0f * centre_px[1] / (float)view->picture_px[1]) * now->half_height;
    for (int c = 0; c < 3; c++)
        ray[c] = now->forward[c] + right * now->right[c] + up * now->up[c];
}

static void project_from_middle(const struct neph_gpu_view *view,
                                const struct neph_gpu_view_camera *camera, const float from[3],
                                float depth, float place[2])
{
    place[0] = 0.5f * (float)view->picture_px[0] *
               (taa_dot(from, camera->right) / (spread(camera, depth) * camera->half_width));
    place[1] = -0.5f * (float)view->picture_px[1] *
               (taa_dot(from, camera->up) / (spread(camera, depth) * camera->half_height));
}

static bool find_motion(const struct neph_gpu_view *view, const float ray[3], float depth_m,
                        const float from_m[3], float motion_px[2])
{
    const struct neph_gpu_view_camera *now = &view->now, *before = &view->before;
    const float spread_m = spread(now, depth_m);
    float ray_before[3], here[2], there[2];
    for (int c = 0; c < 3; c++)
        ray_before[c] = ray[c] - from_m[c] / spread_m;
    const float depth_before = spread(before, taa_dot(ray_before, before->forward));
    project_from_middle(view, now, ray, taa_dot(ray, now->forward), here);
    project_from_middle(view, before, ray_before, depth_before, there);
    motion_px[0] = here[0] - there[0];
    motion_px[1] = here[1] - there[1];
    return depth_before > 0.0f;
}

static float nearest_depth(const struct reference *cpu, int x, int y, float moved_m[4])
{
    static const int cross_px[4][2] = {{-2, -2}, {2, -2}, {-2, 2}, {2, 2}};
    static const int square_px[8][2] = {{-1, -1}, {0, -1}, {1, -1}, {-1, 0},
                                        {1, 0},   {-1, 1}, {0, 1},  {1, 1}};
    const int motion = choice(cpu, RT_TAA_MOTION);
    const int count = motion == RT_MOTION_CROSS ? 4 : motion == RT_MOTION_SQUARE ? 8 : 0;
    const int(*others_px)[2] = motion == RT_MOTION_CROSS ? cross_px : square_px;
    float nearest_m[4], depth_m[4];
    int nearest_x = x, nearest_y = y;
    cpu_fetch_full(cpu, RT_DEPTH, x, y, nearest_m);
    for (int i = 0; i < count; i++) {
        cpu_fetch_full(cpu, RT_DEPTH, x + others_px[i][0], y + others_px[i][1], depth_m);
        if (depth_m[0] < nearest_m[0]) {
            nearest_m[0] = depth_m[0];
            nearest_x = x + others_px[i][0];
            nearest_y = y + others_px[i][1];
        }
    }
    memset(moved_m, 0, 4 * sizeof(*moved_m));
    if (choice(cpu, RT_SOLID_MOTION))
        cpu_fetch_full(cpu, RT_MOVED, nearest_x, nearest_y, moved_m);
    return nearest_m[0];
}

/* False unless the medium is visible, nearer than the solids around, and was in front of the camera
 * of the frame before. A moving solid is followed down to a lower transmittance. */
static bool find_medium_motion(const struct reference *cpu, int x, int y, const float ray[3],
                               float motion_px[2])
{
    const struct neph_gpu_view *view = cpu->view;
    float volume[4], distance[4], from_m[3], moved_m[4];
    cpu_fetch_full(cpu, RT_VOLUME, x, y, volume);
    cpu_fetch_full(cpu, RT_VOLUME_DISTANCE, x, y, distance);
    for (int c = 0; c < 3; c++)
        from_m[c] = view->before.position_m[c] + view->wind_m[c];
    const float scene_m = nearest_depth(cpu, x, y, moved_m);
    const float depth_m = distance[0] / sqrtf(taa_dot(ray, ray));
    const bool is_mover = moved_m[0] != 0.0f || moved_m[1] != 0.0f || moved_m[2] != 0.0f;
    const float most = is_mover ? 0.0625f : scene_m >= NEPH_GPU_FAR_M ? 1.0f : 0.5f;
    return volume[3] >= 0.0f && volume[3] < most && distance[0] > 0.0f &&
           distance[0] < NEPH_GPU_FAR_M && depth_m < scene_m &&
           find_motion(view, ray, depth_m, from_m, motion_px);
}

bool taa_find_before(const struct reference *cpu, struct place at, float place_px[2],
                     double *speed_px)
{
    const struct neph_gpu_view *view = cpu->view;
    const float width_px = (float)view->picture_px[0], height_px = (float)view->picture_px[1];
    const float centre_px[2] = {(float)at.x + 0.5f, (float)at.y + 0.5f};
    float ray[3], motion_px[2], moved_m[4], from_m[3];
    const float scene_m = nearest_depth(cpu, at.source_x, at.source_y, moved_m);
    taa_ray_through(view, at.x, at.y, ray);
    for (int c = 0; c < 3; c++)
        from_m[c] = view->before.position_m[c] + moved_m[c];
    const bool has_wind = view->wind_m[0] != 0.0f || view->wind_m[1] != 0.0f ||
                          view->wind_m[2] != 0.0f;
    const bool is_carried = choice(cpu, RT_TAA_MEDIUM) && choice(cpu, RT_WIND) && has_wind;
    const bool is_before = (is_carried && is_changing(cpu, at.source_x, at.source_y) &&
                            find_medium_motion(cpu, at.source_x, at.source_y, ray, motion_px)) ||
                           find_motion(view, ray, scene_m, from_m, motion_px);
    place_px[0] = centre_px[0] - motion_px[0];
    place_px[1] = centre_px[1] - motion_px[1];
    *speed_px = hypot(motion_px[0], motion_px[1]);
    return is_before && place_px[0] > 0.0f && place_px[0] < width_px && place_px[1] > 0.0f &&
           place_px[1] < height_px;
}

/* --- the history ------------------------------------------------------------------------------ */

/* R. Keys' cubic convolution (IEEE Trans. ASSP 29(6), 1981, a = -1/2) for a texel at a distance. */
static double catmull_rom(double distance)
{
    const double d = fabs(distance);
    if (d >= 2.0)
        return 0.0;
    return d > 1.0 ? ((-0.5 * d + 2.5) * d - 4.0) * d + 2.0 : (1.5 * d - 2.5) * d * d + 1.0;
}

static double tap_weight(const struct reference *cpu, double distance)
{
    switch (choice(cpu, RT_TAA_HISTORY)) {
    case RT_FILTER_NEAREST: /* at half a texel the next one */
        return distance > -0.5 && distance <= 0.5;
    case RT_FILTER_BILINEAR:
        return fabs(distance) < 1.0 ? 1.0 - fabs(distance) : 0.0;
    default:
        return catmull_rom(distance);
    }
}

static struct colour fetch_before(const struct reference *cpu, int x, int y)
{
    float value[4];
    cpu_fetch_output(cpu, RT_TAA_BEFORE, x, y, value);
    return (struct colour){{value[0], value[1], value[2]}};
}

bool taa_fetch_history(const struct reference *cpu, const float place_px[2], struct colour *history)
{
    const float corner[2] = {floorf(place_px[0] - 0.5f), floorf(place_px[1] - 0.5f)};
    const double way[2] = {place_px[0] - 0.5f - corner[0], place_px[1] - 0.5f - corner[1]};
    *history = (struct colour){{0.0}};
    for (int y = -1; y < 3; y++)
        for (int x = -1; x < 3; x++) {
            const double weight = tap_weight(cpu, x - way[0]) * tap_weight(cpu, y - way[1]);
            const struct colour texel = fetch_before(cpu, (int)corner[0] + x, (int)corner[1] + y);
            for (int c = 0; c < 3 && weight != 0.0; c++)
                history->c[c] += weight * texel.c[c];
        }
    const double ratio = (double)cpu->view->exposure / (double)cpu->view->exposure_before;
    for (int c = 0; c < 3 && choice(cpu, RT_TAA_PRE_EXPOSURE); c++)
        history->c[c] *= ratio;
    const bool is_sound = !choice(cpu, RT_TAA_GUARD) || taa_is_finite(*history);
    *history = taa_guard(cpu, *history);
    return is_sound;
}

/* The age of the history at a place; 1 where it is not valid, 0 where ages are not stored. */
static double fetch_age(const struct reference *cpu, const float place_px[2])
{
    const double most = setting(cpu, RT_TAA_AGE_MAX);
    float value[4];
    if (most == 0.0 || !place_px)
        return fmin(most, 1.0);
    cpu_fetch_output(cpu, RT_TAA_BEFORE, (int)floorf(place_px[0]), (int)floorf(place_px[1]), value);
    return value[3] >= 1.0f ? fmin(value[3], most) : 1.0;
}

/* --- share of the clamp, and the blend -------------------------------------------------------- */

static const double static_px = 0.02f;

/* The history of a static pixel, multiplied by the gain. */
static struct colour relight(const struct reference *cpu, int x, int y, struct colour history,
                             const struct neighbourhood *around, double speed_px)
{
    float changes[2][4], volume[4];
    if (!find_change(cpu, x, y, changes) || setting(cpu, RT_RELIGHT) == 0.0f ||
        !around->is_valid[4])
        return history;
    cpu_fetch_full(cpu, RT_VOLUME, x, y, volume);
    const double moved = beyond(speed_px, static_px);
    for (int c = 0; c < 3; c++) {
        const double colour = around->colours[4].c[c];
        const double medium = taa_clamp((double)(cpu->view->exposure * volume[c]), 0.0, colour);
        const double before = medium / changes[0][c] + (colour - medium) / changes[1][c];
        const double gain = before > 0.0 ? colour / before : 1.0;
        history.c[c] *= (1.0 - moved) * gain + moved;
    }
    return history;
}

/* 0: the pixel is static and in the same light, 1: it moves or changes. */
static double find_change_share(const struct reference *cpu, int x, int y, double speed_px)
{
    float changes[2][4];
    if (!find_change(cpu, x, y, changes))
        return 1.0;
    return fmax(beyond(speed_px, static_px), light_change(cpu, changes));
}

static double frame_weight(const struct reference *cpu, double part, double luma,
                           double history_luma, double speed_px)
{
    const double contrast = setting(cpu, RT_TAA_CONTRAST);
    const double way = fmin(speed_px / 20.0, 1.0);
    const double alpha = (1.0 - way) * part * setting(cpu, RT_TAA_ALPHA) + way * (double)0.2f;
    if (contrast == 0.0 || (choice(cpu, RT_TAA_GUARD) && !(history_luma > 0.0)))
        return alpha;
    const double least = contrast * history_luma / fabs(luma - history_luma);
    return least <= alpha ? alpha : least > 1.0 ? 1.0 : least;
}

/* Number of frames within which the light changes by taa_change. */
static double frames_alike(const struct reference *cpu, int x, int y)
{
    const double limit = setting(cpu, RT_TAA_CHANGE);
    const double frames[2] = {4.0, setting(cpu, RT_TAA_JITTER_LENGTH)};
    float changes[2][4];
    double least = INFINITY;
    if (!find_change(cpu, x, y, changes))
        return least;
    for (int c = 0; c < 2; c++)
        if (changes[c][3] > 0.0f)
            least = fmin(least, frames[c] * limit / changes[c][3]);
    return least;
}

/* The frame's weight, and the age after this frame. Motion or a change of the light limits the age
 * to taa_age_least, at least 1; a change of all light to 1. A changed frame counts a quarter in a
 * mean of less than two frames. */
static double weight_with_age(const struct reference *cpu, struct place at, double speed_px,
                              double alpha, double *age)
{
    const int x = at.source_x, y = at.source_y;
    const double age_max = setting(cpu, RT_TAA_AGE_MAX);
    if (age_max == 0.0)
        return alpha;
    const double change_share = find_change_share(cpu, x, y, speed_px);
    float changes[2][4];
    const bool is_other = find_change(cpu, x, y, changes) && largest_residue(changes) >= 1.0;
    const double least = is_other ? 1.0 : fmax(setting(cpu, RT_TAA_AGE_LEAST), 1.0);
    if (choice(cpu, RT_GRADIENT))
        *age = fmax(fmin(*age, frames_alike(cpu, x, y)), fmin(*age, least));
    alpha = (1.0 - change_share) / (*age + 1.0) + change_share * alpha;
    const double counted = *age < 2.0 ? 0.25 : 1.0;
    *age = fmin((1.0 - change_share) * (*age + 1.0) + change_share * fmin(*age + counted, least),
                age_max);
    return alpha;
}

/* Whether the medium hides more than half. */
static bool is_responsive(const struct reference *cpu, int x, int y)
{
    float volume[4];
    cpu_fetch_full(cpu, RT_VOLUME, x, y, volume);
    return choice(cpu, RT_TAA_RESPONSIVE) && volume[3] < 0.5f;
}

struct colour taa_blend(const struct reference *cpu, struct colour frame, struct colour history,
                        double alpha)
{
    const double frame_part = alpha * hdr_weight(cpu, frame);
    const double history_part = (1.0 - alpha) * hdr_weight(cpu, history);
    const double weight = frame_part / (frame_part + history_part);
    for (int c = 0; c < 3 && weight != 1.0; c++)
        frame.c[c] = (1.0 - weight) * history.c[c] + weight * frame.c[c];
    return frame;
}

/* `to` at part 1, `from` at 0. */
static struct colour between(struct colour from, struct colour to, double part)
{
    for (int c = 0; c < 3 && part != 1.0; c++)
        to.c[c] = (1.0 - part) * from.c[c] + part * to.c[c];
    return to;
}

static struct colour resolve(const struct reference *cpu, struct place at, double *age)
{
    const int x = at.source_x, y = at.source_y;
    const struct neph_gpu_view *view = cpu->view;
    const bool is_reset = !view->has_history || (view->is_cut && choice(cpu, RT_CUT_RESET));
    float before_px[2];
    double speed_px = 0.0;
    struct colour history, filtered;
    const bool has_history = !is_reset && taa_find_before(cpu, at, before_px, &speed_px) &&
                             taa_fetch_history(cpu, before_px, &history);
    const struct neighbourhood around = taa_fetch_neighbourhood(cpu, at);
    *age = fetch_age(cpu, has_history ? before_px : NULL);
    if (!taa_filter_samples(cpu, &around, &filtered))
        return has_history ? history : (struct colour){{0.0}};
    if (!has_history)
        return filtered;
    history = relight(cpu, x, y, history, &around, speed_px);
    double alpha = frame_weight(cpu, taa_coverage(cpu, &around), taa_luma_4(filtered),
                                taa_luma_4(history), speed_px);
    alpha = weight_with_age(cpu, at, speed_px, alpha, age);
    if (is_responsive(cpu, x, y))
        alpha = fmax(alpha, 0.25);
    const struct colour clamped = taa_clamp_history(cpu, history, around, filtered, 1.0);
    const double change_share = find_change_share(cpu, x, y, speed_px);
    return taa_blend(cpu, filtered, between(history, clamped, change_share), alpha);
}

/* --- the output ------------------------------------------------------------------------------- */

static float round_by_chance(float value, float number)
{
    if (!(fabsf(value) < 65504.0f))
        return value;
    int exponent; /* of the octave above the value's */
    frexpf(value, &exponent);
    const float half_step = ldexpf(1.0f, (exponent < -13 ? -13 : exponent) - 11);
    const float halves = value / half_step, below = floorf(halves);
    return (number < halves - below ? below + 1.0f : below) * half_step;
}

void taa_put_pixel(const struct reference *cpu, int x, int y, struct colour colour, double age)
{
    const struct neph_gpu_view *view = cpu->view;
    float value[4] = {[3] = (float)age};
    uint32_t bits[4] = {(uint32_t)x, (uint32_t)y, view->frame, view->seed};
    cpu_pcg4d(bits); /* the first number is the white dither's */
    const bool by_chance = choice(cpu, RT_TARGET_FORMAT) == RT_FORMAT_HALF &&
                           choice(cpu, RT_TAA_ROUNDING) == RT_ROUNDING_STOCHASTIC;
    for (int c = 0; c < 3; c++) {
        const double least = choice(cpu, RT_TAA_GUARD) ? 0.0 : -half_max;
        value[c] = (float)taa_clamp(colour.c[c], least, half_max);
        if (by_chance)
            value[c] = round_by_chance(value[c], ((float)(bits[c + 1] >> 9) + 0.5f) * 0x1p-23f);
    }
    cpu_put_output(cpu, RT_TAA_OUT, x, y, value);
}

void cpu_taa(const struct reference *cpu)
{
    for (int y = 0; y < (int)cpu->view->picture_px[1]; y++)
        for (int x = 0; x < (int)cpu->view->picture_px[0]; x++) {
            double age;
            const struct place at = taa_find_source(cpu, x, y);
            const struct colour colour = resolve(cpu, at, &age);
            taa_put_pixel(cpu, x, y, colour, age);
        }
}
