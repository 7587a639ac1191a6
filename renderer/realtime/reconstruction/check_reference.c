/* SPDX-License-Identifier: MIT
 *
 * The CPU reference of the reconstruction. Choice of rays and box: float32, as in the shader.
 * Places and values: double.
 */
#include "renderer/realtime/shared/check_reference.h"
#include "renderer/realtime/tile_index/check_reference_slots.h"

#include <math.h>
#include <string.h>

enum { RAYS = 9, TAPS = 4 };

struct box {
    double low[4], high[4];
};

struct ray {
    int tile_x, tile_y;
    float value[4];
    float depth_m;
    bool is_usable, is_sky, is_in_box;
};

struct history {
    double value[4];
    float age;
    bool is_invalid, is_rejected;
    double motion_px;
};

static float setting(const struct reference *cpu, int index)
{
    return cpu->view->settings[index];
}

static int choice(const struct reference *cpu, int index)
{
    return (int)cpu->view->settings[index];
}

static int clamp_int(int value, int low, int high)
{
    return value < low ? low : value > high ? high : value;
}

static bool is_sky(float depth_m)
{
    return depth_m >= NEPH_GPU_FAR_M;
}

/* --- geometry ------------------------------------------------------------------------------- */

static double dot(const double a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The line of sight of this frame's camera through a place in pixels: unit direction and origin. */
static void line_at(const struct neph_gpu_view *view, const double place_px[2], double origin_m[3],
                    double direction[3])
{
    const struct neph_gpu_view_camera *camera = &view->now;
    const double x = (2.0 * place_px[0] / view->size_px[0] - 1.0) * camera->half_width;
    const double y = (1.0 - 2.0 * place_px[1] / view->size_px[1]) * camera->half_height;
    double square = 0.0;
    for (int i = 0; i < 3; i++) {
        const double across = x * camera->right[i] + y * camera->up[i];
        origin_m[i] = camera->is_parallel ? across : 0.0;
        direction[i] = camera->forward[i] + (camera->is_parallel ? 0.0 : across);
        square += direction[i] * direction[i];
    }
    for (int i = 0; i < 3; i++)
        direction[i] /= sqrt(square);
}

/* Projects a point into a camera's image [px]; returns its eye depth [m]. */
static double project(const struct neph_gpu_view *view, const struct neph_gpu_view_camera *camera,
                      const double point_m[3], double place_px[2])
{
    double from_m[3];
    for (int i = 0; i < 3; i++)
        from_m[i] = point_m[i] - camera->position_m[i];
    const double depth_m = dot(from_m, camera->forward);
    const double spread_m = camera->is_parallel ? 1.0 : depth_m;
    const double x = dot(from_m, camera->right) / (spread_m * camera->half_width);
    const double y = dot(from_m, camera->up) / (spread_m * camera->half_height);
    place_px[0] = (0.5 + 0.5 * x) * view->size_px[0];
    place_px[1] = (0.5 - 0.5 * y) * view->size_px[1];
    return depth_m;
}

static double known_distance_m(float distance_m)
{
    return isfinite(distance_m) && distance_m > 0.0f ? fmin(distance_m, NEPH_GPU_FAR_M)
                                                     : NEPH_GPU_FAR_M;
}

/* --- rays ------------------------------------------------------------------------------------ */

/* In the article's order: centre, right, left, down, up, and the corners. */
static const int around[RAYS][2] = {{0, 0}, {1, 0},  {-1, 0}, {0, 1},  {0, -1},
                                    {1, 1}, {-1, 1}, {1, -1}, {-1, -1}};

/* Tile of a neighbour along one axis. */
static int neighbour(const struct reference *cpu, int axis, int tile, int offset)
{
    const struct neph_gpu_view *view = cpu->view;
    int last = (int)view->tile_count[axis] - 1;
    if (choice(cpu, RT_EDGE_TILES) == RT_EDGE_TILES_DROPPED)
        last = view->size_px[axis] < 4 ? 0 : (int)view->size_px[axis] / 4 - 1;
    return clamp_int(tile + offset, 0, last);
}

/* Texel along one axis of a 2x2 gather about the tile's upper left corner (0) or lower right one
 * (1). */
static int find_gathered_texel(const struct reference *cpu, int axis, int tile, int offset,
                               int corner)
{
    const struct neph_gpu_view *view = cpu->view;
    const struct neph_gpu_target *full = &view->targets[RT_DEPTH];
    const struct neph_gpu_target *quarter = &view->targets[RT_TILE];
    const uint32_t size = axis == 0 ? full->width : full->height;
    const int size_quarter = (int)(axis == 0 ? quarter->width : quarter->height);
    const double place = (4.0 * (tile + corner) + view->origin_px[axis]) / size * size_quarter;
    /* The gather changes texels at halves; in these sizes they are hit exactly or missed by more
     * than 1e-5. */
    const int beyond = (int)floor(place + 0.5 + 1e-9);
    return clamp_int(beyond - corner + offset, 0, size_quarter - 1);
}

static float ray_depth_m(const struct reference *cpu, int tile_x, int tile_y, int i,
                         const struct ray *ray)
{
    const int *offset = around[i];
    float tile[4];
    if (choice(cpu, RT_GATHER) == RT_GATHER_NORMALISED && offset[0] + offset[1] != 0) {
        const int corner = offset[0] + offset[1] > 0;
        cpu_fetch(cpu, RT_TILE, find_gathered_texel(cpu, 0, tile_x, offset[0], corner),
                  find_gathered_texel(cpu, 1, tile_y, offset[1], corner), tile);
    } else {
        cpu_fetch_tile(cpu, RT_TILE, ray->tile_x, ray->tile_y, tile);
    }
    return CPU_TILE_UNIT_M * tile[1];
}

/* The half-resolution texel of a tile's ray, and its depth [m]. */
static float marched_depth_m(const struct reference *cpu, const struct ray *ray, int half_pixel[2])
{
    float tile[4], depth[4];
    cpu_fetch_tile(cpu, RT_TILE, ray->tile_x, ray->tile_y, tile);
    const int *offset = cpu_slot_place(cpu->view, (int)tile[0]);
    half_pixel[0] = clamp_int(2 * ray->tile_x + offset[0], 0, (int)cpu->view->half_size_px[0] - 1);
    half_pixel[1] = clamp_int(2 * ray->tile_y + offset[1], 0, (int)cpu->view->half_size_px[1] - 1);
    cpu_fetch_half(cpu, RT_HALF_DEPTH, half_pixel[0], half_pixel[1], depth);
    return depth[0];
}

static void load_rays(const struct reference *cpu, int tile_x, int tile_y, struct ray rays[RAYS])
{
    for (int i = 0; i < RAYS; i++) {
        struct ray *ray = &rays[i];
        ray->tile_x = i == 0 ? tile_x : neighbour(cpu, 0, tile_x, around[i][0]);
        ray->tile_y = i == 0 ? tile_y : neighbour(cpu, 1, tile_y, around[i][1]);
        cpu_fetch_tile(cpu, RT_RAY, ray->tile_x, ray->tile_y, ray->value);
        ray->depth_m = ray_depth_m(cpu, tile_x, tile_y, i, ray);
        ray->is_usable = choice(cpu, RT_VALIDITY) == 0 || cpu_is_valid(ray->value);
        ray->is_sky = is_sky(marched_depth_m(cpu, ray, (int[2]){0, 0}));
    }
}

/* The ray nearest in depth among those from `asked` on; NULL if none is usable. */
static const struct ray *nearest_ray(const struct reference *cpu, const struct ray rays[RAYS],
                                     int asked, float center_depth_m)
{
    const bool is_limited = choice(cpu, RT_CLAMP_PIXEL_DEPTH) != 0;
    float least_m = is_limited ? NEPH_GPU_FAR_M : setting(cpu, RT_SKY_M);
    const struct ray *first = NULL, *nearest = NULL;
    for (int i = asked; i < RAYS; i++) {
        if (!rays[i].is_usable)
            continue;
        if (!first)
            first = &rays[i];
        if (fabsf(center_depth_m - rays[i].depth_m) < least_m) {
            nearest = &rays[i];
            least_m = fabsf(center_depth_m - rays[i].depth_m);
        }
    }
    return nearest ? nearest : first;
}

/* --- the box --------------------------------------------------------------------------------- */

static void extend(struct box *box, const double value[4])
{
    for (int c = 0; c < 4; c++) {
        box->low[c] = value[c] < box->low[c] ? value[c] : box->low[c];
        box->high[c] = value[c] > box->high[c] ? value[c] : box->high[c];
    }
}

static double clamp_number(double value, double low, double high)
{
    return value < low ? low : value > high ? high : value;
}

static double luminance(const double color[3])
{
    return 0.2126 * color[0] + 0.7152 * color[1] + 0.0722 * color[2];
}

static void to_space(int space, const double value[4], double seen[4])
{
    const double r = value[0], g = value[1], b = value[2];
    memcpy(seen, value, 4 * sizeof(*seen));
    if (space == RT_SPACE_REINHARD)
        for (int c = 0; c < 3; c++)
            seen[c] = value[c] / (1.0 + luminance(value));
    if (space == RT_SPACE_CHANNELS)
        for (int c = 0; c < 3; c++)
            seen[c] = value[c] / (1.0 + value[c]);
    if (space == RT_SPACE_YCOCG) {
        seen[0] = r / 4 + g / 2 + b / 4;
        seen[1] = r / 2 - b / 2;
        seen[2] = -r / 4 + g / 2 - b / 4;
    }
}

static void from_space(int space, const double seen[4], double brightest, double value[4])
{
    memcpy(value, seen, 4 * sizeof(*value));
    if (space == RT_SPACE_REINHARD)
        for (int c = 0; c < 3; c++)
            value[c] = seen[c] / fmax(1.0 - luminance(seen), 1.0 / (1.0 + brightest));
    if (space == RT_SPACE_CHANNELS)
        for (int c = 0; c < 3; c++)
            value[c] = seen[c] / fmax(1.0 - seen[c], 0x1p-24);
    if (space == RT_SPACE_YCOCG) {
        value[0] = fmax(seen[0] + seen[1] - seen[2], 0.0);
        value[1] = fmax(seen[0] + seen[2], 0.0);
        value[2] = fmax(seen[0] - seen[1] - seen[2], 0.0);
    }
}

static bool is_alike(const struct reference *cpu, float transmittance, float other)
{
    const float opacity = 1.0f - fmaxf(transmittance, other);
    const bool is_by_opacity = choice(cpu, RT_CONTRAST) == RT_CONTRAST_OPACITY;
    const float unit = is_by_opacity ? fmaxf(opacity, 1e-6f) : 1.0f;
    return fabsf(transmittance - other) < setting(cpu, RT_BOX_TRANSMITTANCE) * unit;
}

static void choose_rays(const struct reference *cpu, struct ray rays[RAYS],
                        const struct ray *nearest, float center_depth_m, bool is_center_sky)
{
    for (int i = 0; i < RAYS; i++) {
        struct ray *ray = &rays[i];
        const bool belongs = fabsf(center_depth_m - ray->depth_m) <
                                 setting(cpu, RT_BOX_DEPTH) * ray->depth_m ||
                             is_alike(cpu, ray->value[3], nearest->value[3]);
        const bool is_tested_ray = (i > 0 || choice(cpu, RT_BOX_CENTRE) != 0) &&
                                   (!choice(cpu, RT_BOX_SAME_KIND) || ray->is_sky == is_center_sky);
        ray->is_in_box = ray == nearest || (ray->is_usable && is_tested_ray && belongs);
    }
}

static void ray_in_space(const struct ray *ray, int space, double seen[4])
{
    const double value[4] = {ray->value[0], ray->value[1], ray->value[2], ray->value[3]};
    to_space(space, value, seen);
}

static void extend_by_variance(struct box *box, const struct ray rays[RAYS], int space)
{
    double seen[RAYS][4], low[4], high[4];
    int count = 0;
    for (int i = 0; i < RAYS; i++)
        if (rays[i].is_in_box)
            ray_in_space(&rays[i], space, seen[count++]);
    for (int c = 0; c < 4; c++) {
        double mean = 0.0, variance = 0.0;
        for (int i = 0; i < count; i++)
            mean += seen[i][c] / count;
        for (int i = 0; i < count; i++)
            variance += (seen[i][c] - mean) * (seen[i][c] - mean) / count;
        low[c] = mean - sqrt(variance);
        high[c] = mean + sqrt(variance);
    }
    extend(box, low);
    extend(box, high);
}

/* Moves a colour towards the centre of the box until it is on the box's surface. */
static void clip(const struct box *box, const double seen[4], double limited[4])
{
    double part = 1.0;
    for (int c = 0; c < 3; c++) {
        const double reach = (box->high[c] - box->low[c]) / 2;
        const double away = fabs(seen[c] - (box->high[c] + box->low[c]) / 2);
        part = away > reach ? fmin(part, reach / away) : part;
    }
    for (int c = 0; c < 3; c++) {
        const double middle = (box->high[c] + box->low[c]) / 2;
        limited[c] = middle + part * (seen[c] - middle);
    }
}

static void clamp_to_rays(const struct reference *cpu, struct ray rays[RAYS],
                          const struct ray *nearest, float center_depth_m, bool is_center_sky,
                          double value[4])
{
    if (choice(cpu, RT_BOX) == RT_BOX_NONE)
        return;
    const int space = choice(cpu, RT_BOX_SPACE);
    struct box box;
    double seen[4], limited[4];
    ray_in_space(nearest, space, box.low);
    memcpy(box.high, box.low, sizeof(box.high));
    choose_rays(cpu, rays, nearest, center_depth_m, is_center_sky);
    if (choice(cpu, RT_BOX) == RT_BOX_VARIANCE)
        extend_by_variance(&box, rays, space);
    for (int i = 0; i < RAYS && choice(cpu, RT_BOX) == RT_BOX_MIN_MAX; i++) {
        ray_in_space(&rays[i], space, seen);
        if (rays[i].is_in_box)
            extend(&box, seen);
    }
    to_space(space, value, seen);
    for (int c = 0; c < 4; c++)
        limited[c] = clamp_number(seen[c], box.low[c], box.high[c]);
    value[3] = limited[3];
    if (!memcmp(limited, seen, 3 * sizeof(*seen)))
        return;
    if (choice(cpu, RT_BOX_HOLD) == RT_HOLD_CLIP)
        clip(&box, seen, limited);
    const double first[3] = {nearest->value[0], nearest->value[1], nearest->value[2]};
    from_space(space, limited, fmax(luminance(value), luminance(first)), value);
}

/* --- history --------------------------------------------------------------------------------- */

static struct history fetch_history_texel(const struct reference *cpu, int x, int y)
{
    float value[4], state[4];
    cpu_fetch_half(cpu, RT_HISTORY_BEFORE, x, y, value);
    cpu_fetch_half(cpu, RT_HISTORY_STATE_BEFORE, x, y, state);
    const bool has_age = isfinite(state[0]) && state[0] > 0.0f;
    struct history history = {.age = has_age ? state[0] : 0.0f};
    history.is_invalid = choice(cpu, RT_VALIDITY) != 0 && !(has_age && cpu_is_valid(value));
    for (int c = 0; c < 4; c++)
        history.value[c] = value[c];
    return history;
}

static struct history interpolate_history(const struct reference *cpu, const double place_px[2])
{
    const double place[2] = {0.5 * place_px[0] - 0.5, 0.5 * place_px[1] - 0.5};
    const int base[2] = {(int)floor(place[0]), (int)floor(place[1])};
    double sum[4] = {0}, total = 0.0, heaviest = 0.0;
    struct history history = {.is_invalid = true};
    struct box range = {{INFINITY, INFINITY, INFINITY, INFINITY},
                        {-INFINITY, -INFINITY, -INFINITY, -INFINITY}};
    for (int i = 0; i < 4; i++) {
        const double x = place[0] - base[0], y = place[1] - base[1];
        const double weight = (i % 2 ? x : 1.0 - x) * (i / 2 ? y : 1.0 - y);
        const struct history tap = fetch_history_texel(cpu, base[0] + i % 2, base[1] + i / 2);
        if (weight == 0.0 || tap.is_invalid)
            continue;
        history.is_invalid = false;
        total += weight;
        for (int c = 0; c < 4; c++)
            sum[c] += weight * tap.value[c];
        if (weight > heaviest)
            history.age = tap.age;
        heaviest = fmax(heaviest, weight);
        extend(&range, tap.value);
    }
    for (int c = 0; c < 4 && !history.is_invalid; c++)
        history.value[c] = clamp_number(sum[c] / total, range.low[c], range.high[c]);
    return history;
}

static double followed_jitter_px(const struct reference *cpu, const float jitter_px[2], int axis)
{
    const bool is_followed = choice(cpu, RT_REPROJECT_JITTER) && choice(cpu, RT_JITTERED_DEPTH);
    return is_followed ? jitter_px[axis] : 0.0;
}

static bool find_before(const struct reference *cpu, const double place_px[2], double distance_m,
                        double before_px[2])
{
    const struct neph_gpu_view *view = cpu->view;
    double origin_m[3], direction[3], point_m[3], moved_m[3], now_px[2], earlier_px[2];
    line_at(view, place_px, origin_m, direction);
    if (choice(cpu, RT_REPROJECT_MEASURE) == RT_MEASURE_EYE)
        distance_m /= dot(direction, view->now.forward);
    if (view->now.is_parallel) /* all distances move alike */
        distance_m = 0.0;
    for (int i = 0; i < 3; i++) {
        point_m[i] = origin_m[i] + distance_m * direction[i];
        moved_m[i] = point_m[i] - (choice(cpu, RT_WIND) ? view->wind_m[i] : 0.0);
    }
    project(view, &view->now, point_m, now_px);
    const double depth_m = project(view, &view->before, moved_m, earlier_px);
    bool is_seen = view->now.is_parallel || depth_m > 0.0;
    for (int axis = 0; axis < 2; axis++) {
        /* exactly the place in static frames */
        before_px[axis] = place_px[axis] + (earlier_px[axis] - now_px[axis]) -
                          followed_jitter_px(cpu, view->jitter_before_px, axis);
        is_seen = is_seen && before_px[axis] >= 0.0 && before_px[axis] <= view->size_px[axis];
    }
    return is_seen;
}

static bool is_same_depth(const struct reference *cpu, double expected_m, double before_m)
{
    return !(fabs(expected_m - before_m) >= setting(cpu, RT_REJECT_DEPTH) * expected_m);
}

static bool is_same_scene(const struct reference *cpu, const double place_px[2],
                          const double before_px[2], float depth_m)
{
    const struct neph_gpu_view *view = cpu->view;
    double expected_m = setting(cpu, RT_SKY_M);
    if (!is_sky(depth_m)) {
        double origin_m[3], direction[3], point_m[3], unused_px[2];
        line_at(view, place_px, origin_m, direction);
        const double length_m = depth_m / dot(direction, view->now.forward);
        for (int i = 0; i < 3; i++)
            point_m[i] = origin_m[i] + length_m * direction[i];
        expected_m = project(view, &view->before, point_m, unused_px);
    }
    const int x = (int)floor(before_px[0] / 2), y = (int)floor(before_px[1] / 2);
    const double displacement_px = hypot(before_px[0] - place_px[0], before_px[1] - place_px[1]);
    const bool is_around = choice(cpu, RT_REJECT_AROUND) == RT_AROUND_ON ||
                           (choice(cpu, RT_REJECT_AROUND) == RT_AROUND_MOVED &&
                            displacement_px >= 0.125);
    bool found = false;
    for (int i = 0; i < 9; i++) {
        if (i != 4 && !is_around)
            continue;
        float before[4];
        cpu_fetch_half(cpu, RT_HALF_DEPTH_BEFORE, x + i % 3 - 1, y + i / 3 - 1, before);
        const double before_m = is_sky(before[0]) ? setting(cpu, RT_SKY_M) : before[0];
        found = found || is_same_depth(cpu, expected_m, before_m);
    }
    return found && expected_m > 0.0;
}

static struct history find_history(const struct reference *cpu, int x, int y, float depth_m,
                                   float distance_m)
{
    const struct neph_gpu_view *view = cpu->view;
    const struct history none = {.is_invalid = true};
    const double centre_px[2] = {2.0 * x + 1.0, 2.0 * y + 1.0};
    double place_px[2], before_px[2];
    for (int axis = 0; axis < 2; axis++)
        place_px[axis] = centre_px[axis] + followed_jitter_px(cpu, view->jitter_px, axis);
    if (choice(cpu, RT_VALIDITY) && !view->has_history)
        return none;
    if (choice(cpu, RT_CUT_RESET) && view->is_cut)
        return none;
    if (!find_before(cpu, place_px, known_distance_m(distance_m), before_px))
        return none;
    if (setting(cpu, RT_REJECT_DEPTH) > 0.0f && !is_same_scene(cpu, place_px, before_px, depth_m))
        return (struct history){.is_invalid = true, .is_rejected = true};
    struct history history = interpolate_history(cpu, before_px);
    history.motion_px = hypot(before_px[0] - centre_px[0], before_px[1] - centre_px[1]);
    return history;
}

/* --- the result ------------------------------------------------------------------------------ */

static double blend(double a, double b, double weight_of_b)
{
    return weight_of_b == 0.0 ? a : weight_of_b == 1.0 ? b : a + weight_of_b * (b - a);
}

static double beyond(double value, double least)
{
    return least > 0.0 ? clamp_number(value / least - 1.0, 0.0, 1.0) : 1.0;
}

/* Difference between a ray and the history of its own texel. */
static double change_at_ray(const struct reference *cpu, const struct ray *ray)
{
    float distance[4];
    int at[2];
    cpu_fetch_tile(cpu, RT_RAY_DISTANCE, ray->tile_x, ray->tile_y, distance);
    const float depth_m = marched_depth_m(cpu, ray, at);
    const struct history then = find_history(cpu, at[0], at[1], depth_m, distance[0]);
    if (then.is_invalid)
        return 1.0;
    const double now = luminance((double[3]){ray->value[0], ray->value[1], ray->value[2]});
    const double before = luminance(then.value), most = fmax(now, before);
    return fmax(most > 0.0 ? fabs(now - before) / most : 0.0, fabs(ray->value[3] - then.value[3]));
}

/* For the half-resolution texel (x, y). */
static double clamp_share(const struct reference *cpu, int x, int y, double motion_px,
                          const struct ray *nearest)
{
    const double moved = beyond(motion_px, setting(cpu, RT_BOX_MOTION_PX));
    float found[4];
    cpu_fetch_tile(cpu, RT_CHANGE, x / 2, y / 2, found);
    const double change = choice(cpu, RT_GRADIENT) ? found[3] : change_at_ray(cpu, nearest);
    return fmax(moved, beyond(change, setting(cpu, RT_BOX_CHANGE)));
}

/* In float32: ages are stored in halves and compared exactly. */
static float age_after_change(const struct reference *cpu, int x, int y, bool is_fresh, float age)
{
    const float least = setting(cpu, RT_BOX_CHANGE);
    float found[4];
    if (!choice(cpu, RT_GRADIENT))
        return age;
    cpu_fetch_tile(cpu, RT_CHANGE, x / 2, y / 2, found);
    const float change = found[3];
    const float changed = least > 0.0f ? fminf(fmaxf(change / least - 1.0f, 0.0f), 1.0f) : 1.0f;
    age *= 1.0f - changed;
    if (change > 0.0f)
        age = fminf(age, least / change);
    return fmaxf(age, is_fresh ? 0.0f : 1.0f);
}

/* Multiplies static history by the gain of the light. */
static void relight(const struct reference *cpu, int x, int y, double motion_px, double value[4])
{
    const double moved = beyond(motion_px, setting(cpu, RT_BOX_MOTION_PX));
    float change[4];
    if (!choice(cpu, RT_GRADIENT) || setting(cpu, RT_RELIGHT) == 0.0f)
        return;
    cpu_fetch_tile(cpu, RT_CHANGE, x / 2, y / 2, change);
    for (int c = 0; c < 3; c++)
        value[c] *= (1.0 - moved) * change[c] + moved;
}

static double kept(const struct reference *cpu, double value)
{
    const bool is_limited = choice(cpu, RT_VALIDITY) &&
                            choice(cpu, RT_TARGET_FORMAT) == RT_FORMAT_HALF;
    return is_limited && value > CPU_HALF_MAX ? CPU_HALF_MAX : value;
}

static void put_result(const struct reference *cpu, int x, int y, const double value[4], float age,
                       double distance_m)
{
    float rounded[4];
    for (int c = 0; c < 4; c++)
        rounded[c] = (float)kept(cpu, value[c]);
    cpu_put_half(cpu, RT_HISTORY, x, y, rounded);
    const float state[4] = {age, (float)kept(cpu, distance_m)};
    cpu_put_half(cpu, RT_HISTORY_STATE, x, y, state);
}

/* A ray's place relative to the texel, in tiles along one axis. */
static double ray_offset_tiles(int half_pixel, int ray_tile_offset)
{
    return ray_tile_offset - (half_pixel % 2 ? 0.25 : -0.25);
}

static double ray_weight(const struct reference *cpu, int kind, const struct ray *ray,
                         const double ways[2], float center_depth_m)
{
    if (kind == RT_FALLBACK_BILINEAR)
        return fmax(1.0 - fabs(ways[0]), 0.0) * fmax(1.0 - fabs(ways[1]), 0.0);
    const double difference_m = fabsf(center_depth_m - ray->depth_m);
    return exp(-ways[0] * ways[0] - ways[1] * ways[1]) /
           (difference_m + setting(cpu, RT_UPSCALE_TOLERANCE_M));
}

static void fallback(const struct reference *cpu, int kind, int x, int y,
                     const struct ray rays[RAYS], const struct ray *nearest, float center_depth_m,
                     bool is_center_sky, double value[4])
{
    const struct ray *taken = nearest, *around_it = nearest_ray(cpu, rays, 1, center_depth_m);
    if (kind == RT_FALLBACK_AROUND && around_it)
        taken = around_it;
    if (kind == RT_FALLBACK_TILE && rays[0].is_usable)
        taken = &rays[0];
    double sum[4] = {0.0}, total = 0.0;
    const bool is_mean = kind == RT_FALLBACK_BILINEAR || kind == RT_FALLBACK_BILATERAL;
    for (int i = 0; i < RAYS && is_mean; i++) {
        const double ways[2] = {ray_offset_tiles(x, around[i][0]),
                                ray_offset_tiles(y, around[i][1])};
        const double weight = ray_weight(cpu, kind, &rays[i], ways, center_depth_m);
        const bool is_foreign = kind == RT_FALLBACK_BILATERAL && rays[i].is_sky != is_center_sky;
        if (!rays[i].is_usable || is_foreign || weight == 0.0)
            continue;
        total += weight;
        for (int c = 0; c < 4; c++)
            sum[c] += weight * rays[i].value[c];
    }
    for (int c = 0; c < 4; c++)
        value[c] = total > 0.0 ? sum[c] / total : taken->value[c];
}

/* Weight of a fresh ray. */
static double fresh_weight(const struct reference *cpu, double age, double part)
{
    const double age_max = setting(cpu, RT_HISTORY_AGE_MAX);
    const double history_part = 1.0 - 1.0 / fmin(age, age_max);
    return age_max > 0.0 ? 1.0 - part * setting(cpu, RT_HISTORY_FADE) * history_part
                         : setting(cpu, RT_FRESH_WEIGHT);
}

static void blend_fresh(const struct reference *cpu, const double history[4], const double ray[4],
                        double weight, double value[4])
{
    const int space = choice(cpu, RT_FRESH_SPACE);
    const bool is_direct = space == RT_SPACE_LINEAR || weight == 0.0 || weight == 1.0;
    double seen[2][4], mixed[4];
    to_space(is_direct ? RT_SPACE_LINEAR : space, history, seen[0]);
    to_space(is_direct ? RT_SPACE_LINEAR : space, ray, seen[1]);
    for (int c = 0; c < 4; c++)
        mixed[c] = blend(seen[0][c], seen[1][c], weight);
    from_space(is_direct ? RT_SPACE_LINEAR : space, mixed, fmax(luminance(history), luminance(ray)),
               value);
}

static void reconstruct(const struct reference *cpu, int x, int y)
{
    struct ray rays[RAYS];
    float depth[4], tile[4], distance[4];
    load_rays(cpu, x / 2, y / 2, rays);
    cpu_fetch_half(cpu, RT_HALF_DEPTH, x, y, depth);
    float center_depth_m = is_sky(depth[0]) ? setting(cpu, RT_SKY_M) : depth[0];
    if (choice(cpu, RT_CLAMP_PIXEL_DEPTH))
        center_depth_m = cpu_stored_depth_m(cpu->view, depth[0]);
    const struct ray *nearest = nearest_ray(cpu, rays, 0, center_depth_m);
    if (!nearest) {
        put_result(cpu, x, y, (double[4]){0, 0, 0, 1}, 0.0f, NEPH_GPU_FAR_M);
        return;
    }
    const bool uses_tile_ray = choice(cpu, RT_REPROJECT_DEPTH) == RT_REPROJECT_TILE &&
                               rays[0].is_usable;
    const struct ray *seen = uses_tile_ray ? &rays[0] : nearest;
    cpu_fetch_tile(cpu, RT_RAY_DISTANCE, seen->tile_x, seen->tile_y, distance);
    cpu_fetch_tile(cpu, RT_TILE, x / 2, y / 2, tile);
    const bool is_fresh = rays[0].is_usable && (int)tile[0] == cpu_find_slot(cpu->view, x, y);
    struct history history = find_history(cpu, x, y, depth[0], distance[0]);
    double part = 1.0;
    if (!history.is_invalid) {
        relight(cpu, x, y, history.motion_px, history.value);
        double clamped[4];
        memcpy(clamped, history.value, sizeof(clamped));
        clamp_to_rays(cpu, rays, nearest, center_depth_m, is_sky(depth[0]), clamped);
        const double share = clamp_share(cpu, x, y, history.motion_px, nearest);
        if (memcmp(clamped, history.value, 3 * sizeof(*clamped)))
            part = 1.0 - share * (1.0 - (double)setting(cpu, RT_BOX_AGE));
        for (int c = 0; c < 4; c++)
            history.value[c] = blend(history.value[c], clamped[c], share);
        history.age = age_after_change(cpu, x, y, is_fresh, history.age);
    }

    const double age_max = setting(cpu, RT_HISTORY_AGE_MAX);
    double age = history.is_invalid ? 1.0 : history.age, value[4], own[4];
    for (int c = 0; c < 4; c++)
        own[c] = is_fresh ? rays[0].value[c] : nearest->value[c];
    memcpy(value, own, sizeof(value));
    if (history.is_invalid && !is_fresh) {
        const int kind = choice(cpu, history.is_rejected ? RT_FALLBACK_REJECTED : RT_FALLBACK);
        fallback(cpu, kind, x, y, rays, nearest, center_depth_m, is_sky(depth[0]), value);
    } else if (is_fresh && !history.is_invalid) {
        age = fmin(age + 1.0, 255.0);
        blend_fresh(cpu, history.value, own, fresh_weight(cpu, age, part), value);
    } else if (!history.is_invalid) {
        if (age_max > 0.0 && part < 1.0)
            age = fmax(part * fmin(age, age_max), 1.0);
        for (int c = 0; c < 4; c++)
            value[c] = blend(history.value[c], own[c],
                             1.0 - (double)setting(cpu, RT_HISTORY_WEIGHT));
    }
    put_result(cpu, x, y, value, (float)age, known_distance_m(distance[0]));
}

void cpu_reconstruct(const struct reference *cpu)
{
    for (int y = 0; y < (int)cpu->view->half_size_px[1]; y++)
        for (int x = 0; x < (int)cpu->view->half_size_px[0]; x++)
            reconstruct(cpu, x, y);
}
