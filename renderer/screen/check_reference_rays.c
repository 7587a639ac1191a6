/* SPDX-License-Identifier: MIT
 *
 * CPU reference: screen-space rays for indirect diffuse light and for reflections of metal.
 */
#include "renderer/screen/check_reference.h"

#include "scenes/lights.h"
#include "truth/metal.h"

#include <math.h>

/* Does not compile with a new kind: this file then needs a change. */
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");

/* ---- a ray ----------------------------------------------------------------------------------- */

struct ray {
    const struct reference *ref;
    int x, y; /* the pixel at its origin */
    struct neph_vec3 from_m, direction;
    double length_m, per_from, per_to, share;
    struct vec2 from_px, to_px;
};

struct meeting {
    bool is_found;
    int x, y;
    struct neph_vec3 point_m;
};

/* The fraction of the ray at which it leaves the frame along an axis. */
static double edge_share(double from, double to, double size)
{
    const double way = to - from;
    return fabs(way) < 1e-6 ? 1.0 : ((way > 0.0 ? size : 0.0) - from) / way;
}

static struct ray make_screen_ray(const struct reference *ref, int x, int y,
                                  struct neph_vec3 from_m, struct neph_vec3 direction,
                                  double most_m)
{
    const bool is_flat = ref->camera.orthographic_height_m > 0.0;
    struct ray ray = {ref, x, y, from_m, direction, .length_m = most_m};
    if (direction.z < 0.0)
        ray.length_m = fmin(most_m, 0.99 * from_m.z / -direction.z);
    const struct neph_vec3 to_m = neph_vec3_along(from_m, direction, ray.length_m);
    ray.from_px = reference_project(ref, from_m);
    ray.to_px = reference_project(ref, to_m);
    ray.per_from = is_flat ? 1.0 : 1.0 / from_m.z;
    ray.per_to = is_flat ? 1.0 : 1.0 / to_m.z;
    ray.share = fmax(0.0, fmin(1.0, fmin(edge_share(ray.from_px.x, ray.to_px.x, ref->width_px),
                                         edge_share(ray.from_px.y, ray.to_px.y, ref->height_px))));
    return ray;
}

static double along_m(const struct ray *ray, double share)
{
    const double end = share * ray->per_to;
    return ray->length_m * end / ((1.0 - share) * ray->per_from + end);
}

/* Distance of a point of the ray behind the depth buffer; `*depth_m`: the point's own depth. */
static double behind_m(const struct ray *ray, double share, int *x, int *y, double *depth_m)
{
    const struct vec2 place = {ray->from_px.x + share * (ray->to_px.x - ray->from_px.x),
                               ray->from_px.y + share * (ray->to_px.y - ray->from_px.y)};
    struct neph_vec3 seen_m;
    *depth_m = ray->from_m.z + along_m(ray, share) * ray->direction.z;
    *x = (int)floor(place.x);
    *y = (int)floor(place.y);
    if (!reference_is_inside(ray->ref, *x, *y) || (*x == ray->x && *y == ray->y) ||
        reference_is_sky(ray->ref, *x, *y))
        return -NEPH_GPU_FAR_M;
    return *depth_m - (reference_plane_at(ray->ref, place, *x, *y, &seen_m)
                           ? seen_m.z
                           : reference_depth_m(ray->ref, *x, *y));
}

/* Bisection between a point in front of a surface and one behind it. */
static double refine(const struct ray *ray, double before, struct meeting *met, double *behind,
                     double gap_m)
{
    for (int i = 0; i < reference_choice(ray->ref, SCREEN_RAY_REFINE); i++) {
        const double middle = 0.5 * (before + *behind);
        int x, y;
        double depth_m;
        const double found_m = behind_m(ray, middle, &x, &y, &depth_m);
        if (!(found_m > 0.0)) {
            before = middle;
            continue;
        }
        *behind = middle;
        met->x = x;
        met->y = y;
        gap_m = found_m;
    }
    return gap_m;
}

static struct neph_vec3 compute_hit_m(const struct ray *ray, int x, int y, double share)
{
    const struct neph_vec3 normal = reference_normal(ray->ref, x, y);
    const double falling = neph_vec3_dot(normal, ray->direction), at_m = along_m(ray, share);
    const struct neph_vec3 way_m = neph_vec3_sub(reference_surface_m(ray->ref, x, y), ray->from_m);
    const double meets_m = falling < 0.0 ? neph_vec3_dot(normal, way_m) / falling : at_m;
    return neph_vec3_along(ray->from_m, ray->direction,
                           meets_m > 0.0 && meets_m < 1.5 * at_m ? meets_m : at_m);
}

static struct meeting march(const struct ray *ray, int steps, double offset)
{
    const double *values = ray->ref->values;
    const double way_px = ray->share *
                          hypot(ray->to_px.x - ray->from_px.x, ray->to_px.y - ray->from_px.y);
    const double power = values[SCREEN_RAY_STEP_POWER];
    const double thickness_m = values[SCREEN_RAY_THICKNESS_M];
    const int count = (int)fmin(steps, ceil(power * way_px));
    double before = 0.0;
    bool is_hidden = false;
    for (int i = 0; i < count; i++) {
        double share = ray->share * pow((i + 1.0 - offset) / count, power), depth_m;
        struct meeting met = {.is_found = true};
        double gap_m = behind_m(ray, share, &met.x, &met.y, &depth_m);
        const double step = share;
        if (gap_m > 1e-4 * depth_m && !is_hidden) {
            gap_m = refine(ray, before, &met, &share, gap_m);
            if (thickness_m == 0.0 || gap_m < thickness_m) {
                met.point_m = compute_hit_m(ray, met.x, met.y, share);
                return met;
            }
        }
        is_hidden = gap_m > 1e-4 * depth_m;
        before = step;
    }
    return (struct meeting){.is_found = false};
}

static double choose_offset(const struct reference *ref, int x, int y, uint32_t salt,
                            uint32_t index)
{
    return ref->values[SCREEN_RAY_NOISE] != 0.0 ? reference_ray_noise(x, y, salt, index).x : 0.0;
}

/* ---- light at the hit point ------------------------------------------------------------------ */

static struct neph_vec3 get_texel_rgb(struct texel texel)
{
    return (struct neph_vec3){texel.v[0], texel.v[1], texel.v[2]};
}

static struct neph_vec3 times(struct neph_vec3 a, struct neph_vec3 b)
{
    return (struct neph_vec3){a.x * b.x, a.y * b.y, a.z * b.z};
}

static struct neph_vec3 in_world(const struct reference *ref, struct neph_vec3 v)
{
    const struct neph_camera *camera = &ref->camera;
    return neph_vec3_along(neph_vec3_along(neph_vec3_scale(camera->right, v.x), camera->up, v.y),
                           camera->forward, v.z);
}

static double masking(double alpha, double cosine)
{
    return 2.0 / (1.0 + sqrt(1.0 + alpha * alpha * (1.0 / (cosine * cosine) - 1.0)));
}

/* Light number `light` at a point in world space. */
static struct neph_lit get_light_at(const struct neph_scene *scene, unsigned light,
                                    struct neph_vec3 point_m)
{
    if (light > 0)
        return neph_light_at(&scene->lights[light - 1], point_m);
    return (struct neph_lit){.direction = scene->sun.direction,
                             .irradiance_w_per_m2 = scene->sun.present
                                                        ? scene->sun.irradiance_w_per_m2
                                                        : (struct neph_rgb){0.0, 0.0, 0.0}};
}

static uint32_t count_lights(const struct reference *ref, int x, int y)
{
    union {
        float number;
        uint32_t bits;
    } marks = {ref->targets[SCREEN_MARKS][4 * (y * ref->width_px + x)]};
    return marks.bits;
}

static struct neph_vec3 direct_into(const struct reference *ref, struct neph_vec3 direction, int x,
                                    int y)
{
    const struct texel base = reference_load(ref, SCREEN_BASE, x, y);
    const double roughness = reference_load(ref, SCREEN_NORMAL, x, y).v[3];
    struct neph_vec3 sum = {0.0, 0.0, 0.0};
    if (!(base.v[3] > 0.0) || ref->values[SCREEN_RAY_METAL] == SCREEN_METAL_CAMERA)
        return get_texel_rgb(reference_load(ref, SCREEN_DIRECT, x, y));
    const struct neph_vec3 normal = in_world(ref, reference_normal(ref, x, y));
    const struct neph_vec3 point_m = neph_vec3_add(ref->camera.position_m,
                                                   in_world(ref, reference_surface_m(ref, x, y)));
    const struct neph_vec3 out = neph_vec3_scale(in_world(ref, direction), -1.0);
    for (unsigned i = 0; i <= (unsigned)ref->scene->light_count; i++) {
        const struct neph_lit lit = get_light_at(ref->scene, i, point_m);
        const struct neph_rgb light = lit.irradiance_w_per_m2;
        const double cosine = fmax(0.0, neph_vec3_dot(normal, lit.direction));
        const double metal_per_sr = roughness > 0.0
                                        ? neph_metal_per_sr(roughness, normal, out, lit.direction)
                                        : 0.0;
        if (count_lights(ref, x, y) >> i & 1u)
            sum = neph_vec3_along(
                sum, times(get_texel_rgb(base), (struct neph_vec3){light.r, light.g, light.b}),
                (1.0 - base.v[3]) / M_PI * cosine + base.v[3] * metal_per_sr);
    }
    return sum;
}

static struct neph_vec3 sky_reflected(const struct reference *ref, int x, int y)
{
    return neph_vec3_scale(
        times(get_texel_rgb(reference_load(ref, SCREEN_BASE, x, y)), reference_sky_light(ref)),
        reference_open(ref, x, y));
}

/* The point in the previous frame; the scene is static. */
static bool find_previous_pixel(const struct reference *ref, const struct meeting *met, int *x,
                                int *y)
{
    if (ref->frame == 0)
        return false;
    const struct vec2 place = reference_project(ref, met->point_m);
    *x = (int)floor(place.x);
    *y = (int)floor(place.y);
    if (!reference_is_inside(ref, *x, *y))
        return false;
    const double depth_m = reference_load(ref, SCREEN_DEPTH_BEFORE, *x, *y).v[0];
    const struct neph_vec3 seen_m = reference_place_m(ref, (struct vec2){*x + 0.5, *y + 0.5},
                                                      depth_m);
    const struct neph_vec3 normal = reference_normal(ref, met->x, met->y);
    return depth_m < NEPH_GPU_FAR_M &&
           fabs(neph_vec3_dot(normal, neph_vec3_sub(seen_m, met->point_m))) < 0.02 * met->point_m.z;
}

/* The value of the pixel's cell. */
static struct neph_vec3 with_sky(const struct reference *ref, int target, int resolution, int x,
                                 int y)
{
    const int side = reference_cell_px(ref, resolution);
    const struct texel texel = reference_load(ref, target, x / side, y / side);
    return neph_vec3_along(get_texel_rgb(texel), reference_sky_light(ref), texel.v[3]);
}

static struct neph_vec3 indirect_before(const struct reference *ref, const struct meeting *met,
                                        bool with_diffuse)
{
    const struct texel base = reference_load(ref, SCREEN_BASE, met->x, met->y);
    struct neph_vec3 light = {0.0, 0.0, 0.0};
    int x, y;
    if (!find_previous_pixel(ref, met, &x, &y))
        return neph_vec3_scale(sky_reflected(ref, met->x, met->y), with_diffuse ? 1.0 : base.v[3]);
    if (with_diffuse && reference_gi_at(ref) >= 0)
        light = neph_vec3_along(light, with_sky(ref, SCREEN_GI_BEFORE, SCREEN_GI_RESOLUTION, x, y),
                                1.0 - base.v[3]);
    if (base.v[3] > 0.0 && reference_ssr_at(ref) >= 0)
        light = neph_vec3_along(
            light, with_sky(ref, SCREEN_SSR_BEFORE, SCREEN_SSR_RESOLUTION, x, y), base.v[3]);
    return times(get_texel_rgb(base), light);
}

static bool is_hit_from_behind(const struct ray *ray, const struct meeting *met)
{
    return neph_vec3_dot(reference_normal(ray->ref, met->x, met->y), ray->direction) >= 0.0;
}

static bool has_bounces(const struct reference *ref)
{
    return ref->scene->scattering == NEPH_SCATTERING_MULTIPLE;
}

static void add(struct texel *sum, struct neph_vec3 light, double open, double weight)
{
    const double more[4] = {light.x, light.y, light.z, open};
    for (int c = 0; c < 4; c++)
        sum->v[c] += weight * more[c];
}

/* ---- indirect light -------------------------------------------------------------------------- */

static struct neph_vec3 diffuse_light(const struct ray *ray, const struct meeting *met)
{
    const struct reference *ref = ray->ref;
    if (is_hit_from_behind(ray, met) || !has_bounces(ref))
        return (struct neph_vec3){0.0, 0.0, 0.0};
    return neph_vec3_add(direct_into(ref, ray->direction, met->x, met->y),
                         ref->values[SCREEN_GI_BOUNCES] == SCREEN_BOUNCES_ALL
                             ? indirect_before(ref, met, true)
                             : sky_reflected(ref, met->x, met->y));
}

static struct neph_vec3 by_cosine(struct neph_vec3 normal, struct vec2 u)
{
    struct neph_vec3 first, second;
    neph_basis(normal, &first, &second);
    struct neph_vec3 way = neph_vec3_scale(normal, sqrt(1.0 - u.x));
    way = neph_vec3_along(way, first, sqrt(u.x) * cos(2.0 * M_PI * u.y));
    return neph_vec3_normalize(neph_vec3_along(way, second, sqrt(u.x) * sin(2.0 * M_PI * u.y)));
}

struct texel reference_gi(const struct reference *ref, int x, int y)
{
    struct texel sum = {{0.0}};
    const int rays = reference_choice(ref, SCREEN_GI_RAYS);
    const double reach_m = ref->values[SCREEN_GI_REACH_M];
    const struct reference_pixel at = reference_sampled_pixel(ref, SCREEN_GI_RESOLUTION, x, y);
    if (reference_is_sky(ref, at.x, at.y) ||
        reference_load(ref, SCREEN_BASE, at.x, at.y).v[3] >= 1.0)
        return sum;
    for (int i = 0; i < rays; i++) {
        const uint32_t index = ref->frame * (uint32_t)rays + (uint32_t)i;
        const struct neph_vec3 direction = by_cosine(reference_normal(ref, at.x, at.y),
                                                     reference_ray_noise(x, y, 1, index));
        const struct ray ray = make_screen_ray(ref, at.x, at.y,
                                               reference_surface_m(ref, at.x, at.y), direction,
                                               reach_m > 0.0 ? reach_m : NEPH_GPU_FAR_M);
        const struct meeting met = march(&ray, reference_choice(ref, SCREEN_GI_STEPS),
                                         choose_offset(ref, x, y, 2, ref->frame + (uint32_t)i));
        if (met.is_found)
            add(&sum, diffuse_light(&ray, &met), 0.0, 1.0 / rays);
        else
            add(&sum, (struct neph_vec3){0.0, 0.0, 0.0}, 1.0, 1.0 / rays);
    }
    return sum;
}

/* ---- reflections ----------------------------------------------------------------------------- */

static struct neph_vec3 visible_facet(double alpha, struct neph_vec3 eye, struct vec2 u)
{
    const struct neph_vec3 stretched = neph_vec3_normalize(
        (struct neph_vec3){alpha * eye.x, alpha * eye.y, eye.z});
    const double across = hypot(stretched.x, stretched.y);
    const struct neph_vec3 first = across > 1e-7 ? (struct neph_vec3){-stretched.y / across,
                                                                      stretched.x / across, 0.0}
                                                 : (struct neph_vec3){1.0, 0.0, 0.0};
    const struct neph_vec3 second = neph_vec3_cross(stretched, first);
    const double x = sqrt(u.x) * cos(2.0 * M_PI * u.y), share = 0.5 * (1.0 + stretched.z);
    const double y = (1.0 - share) * sqrt(fmax(0.0, 1.0 - x * x)) +
                     share * sqrt(u.x) * sin(2.0 * M_PI * u.y);
    struct neph_vec3 facet = neph_vec3_scale(stretched, sqrt(fmax(0.0, 1.0 - x * x - y * y)));
    facet = neph_vec3_along(neph_vec3_along(facet, first, x), second, y);
    return neph_vec3_normalize(
        (struct neph_vec3){alpha * facet.x, alpha * facet.y, fmax(1e-6, facet.z)});
}

/* SCREEN_LIT, interpolated between pixels of similar depth. */
static struct neph_vec3 load_lit(const struct reference *ref, const struct meeting *met)
{
    const struct vec2 place = reference_project(ref, met->point_m);
    const int left = (int)floor(place.x - 0.5), top = (int)floor(place.y - 0.5);
    const double depth_m = reference_depth_m(ref, met->x, met->y);
    struct neph_vec3 sum = {0.0, 0.0, 0.0};
    double weights = 0.0;
    for (int i = 0; i < 4; i++) {
        const int x = left + i % 2, y = top + i / 2;
        const double weight = (1.0 - fabs(place.x - 0.5 - x)) * (1.0 - fabs(place.y - 0.5 - y));
        if (!reference_is_inside(ref, x, y) ||
            !(fabs(reference_depth_m(ref, x, y) - depth_m) < 0.05 * depth_m))
            continue;
        sum = neph_vec3_along(sum, get_texel_rgb(reference_load(ref, SCREEN_LIT, x, y)), weight);
        weights += weight;
    }
    return weights > 0.01 ? neph_vec3_scale(sum, 1.0 / weights)
                          : get_texel_rgb(reference_load(ref, SCREEN_LIT, met->x, met->y));
}

static struct neph_vec3 glossy_light(const struct ray *ray, const struct meeting *met)
{
    const struct reference *ref = ray->ref;
    if (!has_bounces(ref))
        return (struct neph_vec3){0.0, 0.0, 0.0};
    if (!(reference_load(ref, SCREEN_BASE, met->x, met->y).v[3] > 0.0))
        return load_lit(ref, met);
    const struct neph_vec3 diffuse = neph_vec3_sub(
        get_texel_rgb(reference_load(ref, SCREEN_LIT, met->x, met->y)),
        get_texel_rgb(reference_load(ref, SCREEN_DIRECT, met->x, met->y)));
    const struct neph_vec3 held = {fmax(0.0, diffuse.x), fmax(0.0, diffuse.y),
                                   fmax(0.0, diffuse.z)};
    return neph_vec3_add(neph_vec3_add(held, direct_into(ref, ray->direction, met->x, met->y)),
                         indirect_before(ref, met, false));
}

static void add_reflection(const struct reference *ref, struct reference_pixel at,
                           struct neph_vec3 direction, double offset, double weight,
                           struct texel *sum)
{
    const struct ray ray = make_screen_ray(ref, at.x, at.y, reference_surface_m(ref, at.x, at.y),
                                           direction, NEPH_GPU_FAR_M);
    const struct meeting met = march(&ray, reference_choice(ref, SCREEN_SSR_STEPS), offset);
    if (!met.is_found || is_hit_from_behind(&ray, &met))
        add(sum, (struct neph_vec3){0.0, 0.0, 0.0}, 1.0, weight);
    else
        add(sum, glossy_light(&ray, &met), 0.0, weight);
}

bool reference_mirror(const struct reference *ref, int x, int y, struct neph_vec3 *point_m)
{
    const struct neph_vec3 normal = reference_normal(ref, x, y);
    const struct neph_vec3 from_m = reference_surface_m(ref, x, y);
    const struct neph_vec3 eye = reference_to_camera(ref, from_m);
    const struct neph_vec3 direction = neph_vec3_along(neph_vec3_scale(eye, -1.0), normal,
                                                       2.0 * neph_vec3_dot(normal, eye));
    const struct ray ray = make_screen_ray(ref, x, y, from_m, direction, NEPH_GPU_FAR_M);
    const struct meeting met = march(&ray, reference_choice(ref, SCREEN_SSR_STEPS),
                                     choose_offset(ref, x, y, 4, ref->frame));
    *point_m = met.point_m;
    return met.is_found && !is_hit_from_behind(&ray, &met);
}

struct texel reference_ssr(const struct reference *ref, int x, int y)
{
    struct texel sum = {{0.0}};
    const struct reference_pixel at = reference_sampled_pixel(ref, SCREEN_SSR_RESOLUTION, x, y);
    if (reference_is_sky(ref, at.x, at.y) ||
        !(reference_load(ref, SCREEN_BASE, at.x, at.y).v[3] > 0.0))
        return sum;
    const struct neph_vec3 normal = reference_normal(ref, at.x, at.y);
    const struct neph_vec3 eye = reference_to_camera(ref, reference_surface_m(ref, at.x, at.y));
    const double roughness = reference_load(ref, SCREEN_NORMAL, at.x, at.y).v[3];
    const double alpha = roughness * roughness;
    if (roughness > ref->values[SCREEN_SSR_ROUGHEST]) {
        sum.v[3] = reference_open(ref, at.x, at.y);
        return sum;
    }
    const int rays = alpha > 0.0 ? reference_choice(ref, SCREEN_SSR_RAYS) : 1;
    struct neph_vec3 first, second;
    neph_basis(normal, &first, &second);
    const struct neph_vec3 own_eye = {neph_vec3_dot(eye, first), neph_vec3_dot(eye, second),
                                      fmax(1e-4, neph_vec3_dot(eye, normal))};
    for (int i = 0; i < rays; i++) {
        const uint32_t index = ref->frame * (uint32_t)rays + (uint32_t)i;
        struct neph_vec3 facet = {0.0, 0.0, 1.0};
        if (alpha > 0.0)
            facet = visible_facet(alpha, own_eye, reference_ray_noise(x, y, 3, index));
        const struct neph_vec3 own = neph_vec3_along(neph_vec3_scale(own_eye, -1.0), facet,
                                                     2.0 * neph_vec3_dot(facet, own_eye));
        if (!(own.z > 0.0))
            continue;
        struct neph_vec3 direction = neph_vec3_scale(normal, own.z);
        direction = neph_vec3_along(neph_vec3_along(direction, first, own.x), second, own.y);
        add_reflection(ref, at, neph_vec3_normalize(direction),
                       choose_offset(ref, x, y, 4, ref->frame + (uint32_t)i),
                       (alpha > 0.0 ? masking(alpha, own.z) : 1.0) / rays, &sum);
    }
    return sum;
}
