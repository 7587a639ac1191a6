/* SPDX-License-Identifier: MIT
 *
 * CPU reference: screen-space ambient occlusion by its three methods.
 */
#include "renderer/screen/check_reference.h"

#include <math.h>

struct site {
    const struct reference *ref;
    struct vec2 centre_px, noise;
    struct neph_vec3 point_m, normal, to_camera;
    double radius_m;
};

static bool is_orthographic(const struct site *site)
{
    return site->ref->camera.orthographic_height_m > 0.0;
}

static double setting(const struct site *site, int index)
{
    return site->ref->values[index];
}

static bool load_point(const struct site *site, struct vec2 place_px, struct neph_vec3 *point_m)
{
    const int x = (int)floor(place_px.x), y = (int)floor(place_px.y);
    if (!reference_is_inside(site->ref, x, y) || reference_is_sky(site->ref, x, y))
        return false;
    *point_m = reference_surface_m(site->ref, x, y);
    return setting(site, SCREEN_AO_PLACES) == SCREEN_PLACES_PIXEL ||
           reference_plane_at(site->ref, place_px, x, y, point_m);
}

static struct vec2 step(struct vec2 from, struct vec2 way, double far)
{
    return (struct vec2){from.x + far * way.x, from.y + far * way.y};
}

/* ---- gtao ------------------------------------------------------------------------------------ */

struct slice {
    struct neph_vec3 across;
    struct vec2 way;
    double forward_px, back_px;
};

static double to_edge_px(const struct site *site, struct vec2 way)
{
    const double to_x = way.x > 0.0 ? site->ref->width_px : 0.0;
    const double to_y = way.y > 0.0 ? site->ref->height_px : 0.0;
    const double x = fabs(way.x) < 1e-6 ? NEPH_GPU_FAR_M : (to_x - site->centre_px.x) / way.x;
    const double y = fabs(way.y) < 1e-6 ? NEPH_GPU_FAR_M : (to_y - site->centre_px.y) / way.y;
    return fmax(0.0, fmin(x, y));
}

static double apart_px(const struct site *site, struct neph_vec3 point_m)
{
    const struct vec2 seen = reference_project(site->ref, point_m);
    return hypot(seen.x - site->centre_px.x, seen.y - site->centre_px.y);
}

static double reach_px(const struct site *site, struct neph_vec3 across, struct vec2 way)
{
    const double edge_px = to_edge_px(site, way);
    if (is_orthographic(site))
        return fmin(edge_px,
                    apart_px(site, neph_vec3_along(site->point_m, across, site->radius_m)));
    const double sine = site->radius_m / neph_vec3_length(site->point_m);
    if (sine >= 1.0)
        return edge_px;
    const struct neph_vec3 tangent = neph_vec3_along(neph_vec3_scale(across, sine), site->to_camera,
                                                     -sqrt(1.0 - sine * sine));
    return tangent.z > 1e-3 ? fmin(edge_px, apart_px(site, tangent)) : edge_px;
}

static struct vec2 screen_way(const struct site *site, struct neph_vec3 move)
{
    const struct neph_vec3 p = site->point_m;
    const bool flat = is_orthographic(site);
    const double x = flat ? move.x : (move.x * p.z - p.x * move.z) / (p.z * p.z);
    const double y = flat ? move.y : (move.y * p.z - p.y * move.z) / (p.z * p.z);
    const struct vec2 way = {x / site->ref->half_width * site->ref->width_px,
                             -y / site->ref->half_height * site->ref->height_px};
    return (struct vec2){way.x / hypot(way.x, way.y), way.y / hypot(way.x, way.y)};
}

static struct slice make_slice(const struct site *site, double turn)
{
    struct slice slice;
    if (setting(site, SCREEN_AO_SLICES) == SCREEN_SLICES_AXIS) {
        const struct neph_vec3 way = {cos(M_PI * turn), sin(M_PI * turn), 0.0};
        slice.across = neph_vec3_normalize(
            neph_vec3_along(way, site->to_camera, -neph_vec3_dot(way, site->to_camera)));
    } else {
        struct neph_vec3 first, second;
        neph_basis(site->to_camera, &first, &second);
        slice.across = neph_vec3_along(neph_vec3_scale(first, cos(M_PI * turn)), second,
                                       sin(M_PI * turn));
    }
    slice.way = screen_way(site, slice.across);
    slice.forward_px = reach_px(site, slice.across, slice.way);
    slice.back_px = reach_px(site, neph_vec3_scale(slice.across, -1.0),
                             (struct vec2){-slice.way.x, -slice.way.y});
    return slice;
}

static double near_weight(const struct site *site, double distance_m)
{
    const double fade_m = setting(site, SCREEN_AO_FALLOFF) * site->radius_m;
    if (distance_m >= site->radius_m)
        return 0.0;
    return fade_m > 0.0 ? fmin(1.0, (site->radius_m - distance_m) / fade_m) : 1.0;
}

static double mix(double a, double b, double share)
{
    return a + (b - a) * share;
}

static double horizon_cosine(const struct site *site, struct vec2 way, double reach, double lowest)
{
    const int steps = (int)setting(site, SCREEN_AO_STEPS);
    double highest = lowest;
    for (int s = 0; s < steps && reach > 1.0; s++) {
        const double share = pow((s + site->noise.y) / steps, setting(site, SCREEN_AO_STEP_POWER));
        struct neph_vec3 seen_m;
        if (!load_point(site, step(site->centre_px, way, mix(1.0, reach, share)), &seen_m))
            continue;
        const struct neph_vec3 offset_m = neph_vec3_sub(seen_m, site->point_m);
        const double distance_m = neph_vec3_length(offset_m);
        if (!(distance_m > 0.0))
            continue;
        const double cosine = neph_vec3_dot(offset_m, site->to_camera) / distance_m;
        const double held = mix(lowest, cosine, near_weight(site, distance_m));
        highest = held > highest ? held : mix(highest, held, setting(site, SCREEN_AO_THICKNESS));
    }
    return highest;
}

static double open_arc(double horizon, double tilt)
{
    return 0.25 * (cos(tilt) + 2.0 * horizon * sin(tilt) - cos(2.0 * horizon - tilt));
}

/* Add the open part of a slice to the first sum, and that of an unoccluded slice to the second. */
static void add_slice(const struct site *site, const struct slice *slice, double sums[2])
{
    const struct neph_vec3 axis = neph_vec3_cross(slice->across, site->to_camera);
    const struct neph_vec3 within = neph_vec3_along(site->normal, axis,
                                                    -neph_vec3_dot(site->normal, axis));
    const double share = neph_vec3_length(within);
    if (!(share > 1e-6))
        return;
    const double tilt = atan2(neph_vec3_dot(within, slice->across),
                              neph_vec3_dot(within, site->to_camera));
    const struct vec2 back = {-slice->way.x, -slice->way.y};
    const double ahead = horizon_cosine(site, slice->way, slice->forward_px, cos(tilt + M_PI_2));
    const double behind = horizon_cosine(site, back, slice->back_px, cos(tilt - M_PI_2));
    const double high = fmin(acos(fmax(-1.0, fmin(1.0, ahead))), tilt + M_PI_2);
    const double low = fmax(-acos(fmax(-1.0, fmin(1.0, behind))), tilt - M_PI_2);
    sums[0] += share * (open_arc(high, tilt) + open_arc(low, tilt));
    sums[1] += share * (cos(tilt) + tilt * sin(tilt));
}

static double gtao(const struct site *site)
{
    const int slices = (int)setting(site, SCREEN_AO_DIRECTIONS);
    double sums[2] = {0.0, 0.0};
    for (int i = 0; i < slices; i++) {
        const struct slice slice = make_slice(site, (i + site->noise.x) / slices);
        add_slice(site, &slice, sums);
    }
    return setting(site, SCREEN_AO_SUM) == SCREEN_SUM_RATIO ? sums[0] / fmax(sums[1], 1e-6)
                                                            : sums[0] / slices;
}

/* ---- unreal ---------------------------------------------------------------------------------- */

static bool find_pair_sample(const struct site *site, struct vec2 place_px, double *cosine,
                             double *weight)
{
    struct neph_vec3 seen_m;
    *cosine = *weight = 0.0;
    if (!load_point(site, place_px, &seen_m))
        return false;
    const struct neph_vec3 offset_m = neph_vec3_sub(seen_m, site->point_m);
    const double distance_m = neph_vec3_length(offset_m);
    *weight = fmax(0.0, 1.0 - distance_m / (2.0 * site->radius_m));
    if (distance_m > 0.0)
        *cosine = fmax(0.0, fmin(1.0, neph_vec3_dot(offset_m, site->normal) / distance_m));
    return true;
}

/* Add the openness left by the steepest angles of a pair, and its weight. */
static void add_pair(const struct site *site, struct vec2 offset_px, double sums[2])
{
    const int steps = (int)setting(site, SCREEN_AO_STEPS);
    double most[2] = {0.0, 0.0}, counts = 0.0;
    for (int s = 1; s <= steps; s++) {
        const double share = (double)s / steps;
        double cosine[2], weight[2];
        const bool ahead = find_pair_sample(site, step(site->centre_px, offset_px, share),
                                            &cosine[0], &weight[0]);
        const bool behind = find_pair_sample(site, step(site->centre_px, offset_px, -share),
                                             &cosine[1], &weight[1]);
        const double both = ahead && behind ? weight[0] * weight[1] : 0.0;
        for (int side = 0; side < 2; side++)
            most[side] = mix(most[side], fmax(most[side], cosine[side]), both);
        counts = mix(counts, 1.0, both);
    }
    sums[0] += (pow(1.0 - most[0], 2.0) + pow(1.0 - most[1], 2.0)) * counts;
    sums[1] += 2.0 * counts;
}

static double unreal(const struct site *site)
{
    const struct reference *ref = site->ref;
    const int pairs = (int)setting(site, SCREEN_AO_DIRECTIONS);
    const double scale = (is_orthographic(site) ? 1.0 : 1.0 / site->point_m.z) * site->radius_m;
    double sums[2] = {1e-4, 1e-4};
    for (int i = 0; i < pairs; i++) {
        const double angle = 2.39996323 * i + 2.0 * M_PI * site->noise.x;
        const double far = sqrt((i + 0.5) / pairs) * scale * 0.5;
        add_pair(site,
                 (struct vec2){far * ref->width_px / ref->half_width * cos(angle),
                               far * ref->height_px / ref->half_height * sin(angle)},
                 sums);
    }
    return sums[0] / sums[1];
}

/* ---- ssao ------------------------------------------------------------------------------------ */

static double fraction(double value)
{
    return value - floor(value);
}

static double ssao(const struct site *site)
{
    const int count = (int)(setting(site, SCREEN_AO_DIRECTIONS) * setting(site, SCREEN_AO_STEPS));
    struct neph_vec3 first, second;
    int hidden = 0;
    neph_basis(site->normal, &first, &second);
    for (int i = 0; i < count; i++) {
        const double height = fraction((i + 1) * 0.819172513);
        const double angle = 2.0 * M_PI * fraction((i + 1) * 0.671043607 + site->noise.x);
        const double far = site->radius_m * cbrt(fraction((i + 1) * 0.549700478 + site->noise.y));
        const double side = sqrt(fmax(0.0, 1.0 - height * height));
        struct neph_vec3 point_m = neph_vec3_along(site->point_m, site->normal, far * height);
        point_m = neph_vec3_along(point_m, first, far * side * cos(angle));
        point_m = neph_vec3_along(point_m, second, far * side * sin(angle));
        struct neph_vec3 seen_m;
        if (!(point_m.z > 0.0) || !load_point(site, reference_project(site->ref, point_m), &seen_m))
            continue;
        hidden += seen_m.z < point_m.z * (1.0 - setting(site, SCREEN_AO_BIAS)) &&
                  site->point_m.z - seen_m.z < site->radius_m;
    }
    return 1.0 - (double)hidden / count;
}

/* ---------------------------------------------------------------------------------------------- */

static double open_share(const struct site *site)
{
    switch (reference_choice(site->ref, SCREEN_AO)) {
    case SCREEN_AO_SSAO:
        return ssao(site);
    case SCREEN_AO_UNREAL:
        return unreal(site);
    default:
        return gtao(site);
    }
}

struct texel reference_ao(const struct reference *ref, int x, int y)
{
    double open = 1.0;
    const struct reference_pixel at = reference_sampled_pixel(ref, SCREEN_AO_RESOLUTION, x, y);
    if (!reference_is_sky(ref, at.x, at.y)) {
        const struct neph_vec3 point_m = reference_surface_m(ref, at.x, at.y);
        const struct site site = {
            .ref = ref,
            .centre_px = {at.x + 0.5, at.y + 0.5},
            .noise = ref->values[SCREEN_AO_NOISE] != 0.0 ? reference_tiled_noise(ref, x, y)
                                                         : (struct vec2){0.5, 0.5},
            .point_m = point_m,
            .normal = reference_normal(ref, at.x, at.y),
            .to_camera = reference_to_camera(ref, point_m),
            .radius_m = ref->values[SCREEN_AO_RADIUS_M],
        };
        open = fmax(0.0, fmin(1.0, open_share(&site)));
    }
    open = 1.0 - ref->values[SCREEN_AO_INTENSITY] * (1.0 - pow(open, ref->values[SCREEN_AO_POWER]));
    return (struct texel){{open, open, open, open}};
}
