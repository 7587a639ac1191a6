/* SPDX-License-Identifier: MIT
 *
 * Both kinds of solids are convex, so a ray meets each in one interval. The shadow of a solid is
 * convex, too: the points from which the sun is hidden are the solid swept away from the sun. The
 * same is true for a point light at L: with k1 and k2 in the solid and factors a, b >= 1 the middle
 * of L + a (k1 - L) and L + b (k2 - L) is L + (a + b)/2 (k - L), with k between k1 and k2.
 */
#include "scenes/solids.h"

#include "scenes/bounds.h"
#include "scenes/box_shadow.h"

#include <math.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_SOLID_KIND_COUNT == 2, "a new kind");

/* --- rotated boxes --------------------------------------------------------------------------- */

struct neph_vec3 neph_rotate(const struct neph_turn *turn, struct neph_vec3 v)
{
    const double c = turn->cosine, s = turn->sine;
    switch (turn->axis) {
    case 0:
        return (struct neph_vec3){v.x, c * v.y - s * v.z, s * v.y + c * v.z};
    case 1:
        return (struct neph_vec3){c * v.x + s * v.z, v.y, c * v.z - s * v.x};
    default:
        return (struct neph_vec3){c * v.x - s * v.y, s * v.x + c * v.y, v.z};
    }
}

struct neph_vec3 neph_rotate_back(const struct neph_turn *turn, struct neph_vec3 vector)
{
    const struct neph_turn back = {turn->axis, turn->cosine, -turn->sine};
    return neph_rotate(&back, vector);
}

static struct neph_vec3 find_middle(const struct neph_bounds *box)
{
    return neph_vec3_scale(neph_vec3_add(box->min_m, box->max_m), 0.5);
}

struct neph_vec3 neph_box_direction(const struct neph_solid *box, struct neph_vec3 direction)
{
    return neph_is_turned(&box->turn) ? neph_rotate_back(&box->turn, direction) : direction;
}

struct neph_vec3 neph_box_place_m(const struct neph_solid *box, struct neph_vec3 point_m)
{
    return neph_box_direction(box, neph_vec3_sub(point_m, find_middle(&box->box)));
}

/* A point in the coordinates of the unrotated box. */
static struct neph_vec3 to_box_axes(const struct neph_solid *solid, struct neph_vec3 point_m)
{
    if (!neph_is_turned(&solid->turn))
        return point_m;
    return neph_vec3_add(find_middle(&solid->box), neph_box_place_m(solid, point_m));
}

/* Half the sides of the axis-aligned box around a rotated box. */
static struct neph_vec3 half_around(const struct neph_solid *solid)
{
    const struct neph_vec3 half_m = neph_vec3_scale(
        neph_vec3_sub(solid->box.max_m, solid->box.min_m), 0.5);
    const struct neph_turn turn = {solid->turn.axis, fabs(solid->turn.cosine),
                                   fabs(solid->turn.sine)};
    const struct neph_turn back = {turn.axis, turn.cosine, -turn.sine};
    const struct neph_vec3 a = neph_rotate(&turn, half_m), b = neph_rotate(&back, half_m);
    return (struct neph_vec3){fmax(a.x, b.x), fmax(a.y, b.y), fmax(a.z, b.z)};
}

struct neph_bounds neph_solid_bounds(const struct neph_solid *solid)
{
    if (solid->kind == NEPH_SOLID_SPHERE)
        return neph_bounds_around(solid->center_m, solid->radius_m);
    if (!neph_is_turned(&solid->turn))
        return solid->box;
    const struct neph_vec3 middle_m = find_middle(&solid->box), half_m = half_around(solid);
    return (struct neph_bounds){neph_vec3_sub(middle_m, half_m), neph_vec3_add(middle_m, half_m)};
}

/* --- rays ------------------------------------------------------------------------------------ */

bool neph_solid_contains(const struct neph_solid *solid, struct neph_vec3 point_m)
{
    if (solid->kind == NEPH_SOLID_SPHERE)
        return neph_vec3_length(neph_vec3_sub(point_m, solid->center_m)) <= solid->radius_m;
    return neph_bounds_contain(&solid->box, to_box_axes(solid, point_m));
}

/* A shadow ray starts on a surface: nearer hits are that surface. Points of a sphere are rounded to
 * 1e-16 of its size; a low sun increases the resulting distance. */
static double shadow_start_m(const struct neph_solid *solid)
{
    return fmax(1e-9, solid->kind == NEPH_SOLID_SPHERE ? 1e-12 * solid->radius_m : 0.0);
}

/* radius^2 - distance^2 as a product, because the difference cancels on the surface of a planet. */
static double half_chord_squared(double radius_m, double distance_m)
{
    return (radius_m - distance_m) * (radius_m + distance_m);
}

/* The entry and exit of a ray; false when it misses. */
static bool sphere_interval(const struct neph_solid *sphere, struct neph_vec3 origin_m,
                            struct neph_vec3 direction, double *t0_m, double *t1_m)
{
    const struct neph_vec3 offset_m = neph_vec3_sub(origin_m, sphere->center_m);
    const double middle_m = -neph_vec3_dot(offset_m, direction);
    const struct neph_vec3 nearest_m = neph_vec3_along(offset_m, direction, middle_m);
    const double half_squared = half_chord_squared(sphere->radius_m, neph_vec3_length(nearest_m));
    if (half_squared <= 0.0)
        return false;
    *t0_m = middle_m - sqrt(half_squared);
    *t1_m = middle_m + sqrt(half_squared);
    return true;
}

static bool solid_interval(const struct neph_solid *solid, struct neph_vec3 origin_m,
                           struct neph_vec3 direction, double *t0_m, double *t1_m)
{
    if (solid->kind == NEPH_SOLID_SPHERE)
        return sphere_interval(solid, origin_m, direction, t0_m, t1_m);
    *t0_m = -INFINITY;
    *t1_m = INFINITY;
    return neph_bounds_clip(&solid->box, to_box_axes(solid, origin_m),
                            neph_box_direction(solid, direction), t0_m, t1_m);
}

/* The normal of the face on which a point lies: the face nearest to it. */
static struct neph_vec3 box_normal(const struct neph_bounds *box, struct neph_vec3 p)
{
    const double distance_m[6] = {fabs(p.x - box->min_m.x), fabs(p.x - box->max_m.x),
                                  fabs(p.y - box->min_m.y), fabs(p.y - box->max_m.y),
                                  fabs(p.z - box->min_m.z), fabs(p.z - box->max_m.z)};
    static const struct neph_vec3 normals[6] = {{-1, 0, 0}, {1, 0, 0},  {0, -1, 0},
                                                {0, 1, 0},  {0, 0, -1}, {0, 0, 1}};
    int nearest = 0;
    for (int face = 1; face < 6; face++)
        if (distance_m[face] < distance_m[nearest])
            nearest = face;
    return normals[nearest];
}

static struct neph_vec3 solid_normal(const struct neph_solid *solid, struct neph_vec3 point_m)
{
    if (solid->kind == NEPH_SOLID_SPHERE)
        return neph_vec3_normalize(neph_vec3_sub(point_m, solid->center_m));
    const struct neph_vec3 normal = box_normal(&solid->box, to_box_axes(solid, point_m));
    return neph_is_turned(&solid->turn) ? neph_rotate(&solid->turn, normal) : normal;
}

struct neph_hit neph_scene_hit(const struct neph_scene *scene, struct neph_vec3 origin_m,
                               struct neph_vec3 direction)
{
    struct neph_hit hit = {.t_m = INFINITY};
    for (int i = 0; i < scene->solid_count; i++) {
        double t0_m, t1_m;
        if (!solid_interval(&scene->solids[i], origin_m, direction, &t0_m, &t1_m))
            continue;
        const double t_m = t0_m > 0.0 ? t0_m : t1_m;
        if (t_m > 0.0 && t_m < hit.t_m) {
            hit.t_m = t_m;
            hit.solid = &scene->solids[i];
        }
    }
    if (hit.solid)
        hit.normal = solid_normal(hit.solid, neph_vec3_along(origin_m, direction, hit.t_m));
    return hit;
}

struct neph_vec3 neph_hit_outside_m(const struct neph_hit *hit, struct neph_vec3 point_m)
{
    double scale_m = fmax(1.0, neph_vec3_length(point_m) + hit->t_m);
    if (hit->solid->kind == NEPH_SOLID_SPHERE)
        scale_m = fmax(scale_m, hit->solid->radius_m);
    return neph_vec3_along(point_m, hit->normal, 1e-12 * scale_m);
}

bool neph_scene_is_sun_visible(const struct neph_scene *scene, struct neph_vec3 point_m)
{
    for (int i = 0; i < scene->solid_count; i++) {
        double t0_m, t1_m;
        if (solid_interval(&scene->solids[i], point_m, scene->sun.direction, &t0_m, &t1_m) &&
            t1_m > shadow_start_m(&scene->solids[i]))
            return false;
    }
    return true;
}

bool neph_scene_is_visible(const struct neph_scene *scene, struct neph_vec3 point_m,
                           struct neph_vec3 other_m)
{
    const struct neph_vec3 toward_m = neph_vec3_sub(other_m, point_m);
    const double distance_m = neph_vec3_length(toward_m);
    const struct neph_vec3 direction = neph_vec3_scale(toward_m, 1.0 / distance_m);
    if (distance_m == 0.0)
        return true;
    for (int i = 0; i < scene->solid_count; i++) {
        double t0_m, t1_m;
        if (solid_interval(&scene->solids[i], point_m, direction, &t0_m, &t1_m) &&
            t1_m > shadow_start_m(&scene->solids[i]) && t0_m < distance_m)
            return false;
    }
    return true;
}

/* Shadow of a sphere: where the nearest point of the sun ray lies ahead, the ray is tested with the
 * cylinder along the sun; where it lies behind, with the sphere itself. */
static bool sphere_shadow(const struct neph_solid *sphere, struct neph_vec3 sun, struct neph_vec3 o,
                          struct neph_vec3 d, double *u0, double *u1)
{
    const struct neph_vec3 w = neph_vec3_sub(o, sphere->center_m);
    /* The nearest approach is at t*(u) = -(w + u d).s; it is ahead while t* >= 0. */
    const struct neph_affine behind = {neph_vec3_dot(w, sun), neph_vec3_dot(d, sun)};
    const struct neph_affine zero = {0.0, 0.0};

    double low = INFINITY, high = -INFINITY;
    double a0 = *u0, a1 = *u1;
    if (neph_clip_less_equal(behind, zero, &a0, &a1)) {
        const struct neph_vec3 w_across = neph_vec3_along(w, sun, -behind.constant);
        const struct neph_vec3 d_across = neph_vec3_along(d, sun, -behind.slope);
        const double speed_squared = neph_vec3_dot(d_across, d_across);
        if (speed_squared < 1e-24) { /* parallel to the sun: always inside the cylinder or never */
            if (neph_vec3_dot(w_across, w_across) < sphere->radius_m * sphere->radius_m) {
                low = a0;
                high = a1;
            }
        } else {
            const double middle = -neph_vec3_dot(w_across, d_across) / speed_squared;
            const struct neph_vec3 nearest = neph_vec3_along(w_across, d_across, middle);
            const double half_squared = half_chord_squared(sphere->radius_m,
                                                           neph_vec3_length(nearest));
            if (half_squared > 0.0) {
                const double half = sqrt(half_squared / speed_squared);
                const double c0 = fmax(a0, middle - half), c1 = fmin(a1, middle + half);
                if (c0 < c1) {
                    low = c0;
                    high = c1;
                }
            }
        }
    }
    double b0 = *u0, b1 = *u1, s0, s1;
    if (neph_clip_less_equal(zero, behind, &b0, &b1) && sphere_interval(sphere, o, d, &s0, &s1)) {
        b0 = fmax(b0, s0);
        b1 = fmin(b1, s1);
        if (b0 < b1) {
            low = fmin(low, b0);
            high = fmax(high, b1);
        }
    }
    *u0 = low;
    *u1 = high;
    return low < high;
}

bool neph_solid_shadow(const struct neph_solid *solid, struct neph_vec3 sun_direction,
                       struct neph_vec3 origin_m, struct neph_vec3 direction, double t0_m,
                       double t1_m, double *shadow_t0_m, double *shadow_t1_m)
{
    double u0 = t0_m, u1 = t1_m;
    const bool hidden = solid->kind == NEPH_SOLID_SPHERE
                            ? sphere_shadow(solid, sun_direction, origin_m, direction, &u0, &u1)
                            : neph_box_shadow(&solid->box, neph_box_direction(solid, sun_direction),
                                              to_box_axes(solid, origin_m),
                                              neph_box_direction(solid, direction), &u0, &u1);
    if (!hidden)
        return false;
    *shadow_t0_m = u0;
    *shadow_t1_m = u1;
    return true;
}

/* --- shadows from a point -------------------------------------------------------------------- */

/* Whether a sphere hides one point from another. */
static bool sphere_hides(const struct neph_solid *sphere, struct neph_vec3 light_m,
                         struct neph_vec3 point_m)
{
    const struct neph_vec3 toward_m = neph_vec3_sub(light_m, point_m);
    const double distance_m = neph_vec3_length(toward_m);
    double t0_m, t1_m;
    return distance_m > 0.0 &&
           sphere_interval(sphere, point_m, neph_vec3_scale(toward_m, 1.0 / distance_m), &t0_m,
                           &t1_m) &&
           t1_m > 0.0 && t0_m < distance_m;
}

/* Real roots of a u^2 + 2 b u + c; returns their number. */
static int quadratic_roots(double a, double b, double c, double roots[2])
{
    const double discriminant = b * b - a * c;
    if (discriminant <= 0.0 || (a == 0.0 && b == 0.0))
        return 0;
    const double q = -(b + copysign(sqrt(discriminant), b));
    int count = 0;
    if (a != 0.0)
        roots[count++] = q / a;
    if (q != 0.0)
        roots[count++] = c / q;
    return count;
}

/* The edge of the shadow is on the tangent cone around the sphere or on the sphere; between two
 * intersections of the ray with these the ray is entirely hidden or entirely visible. */
static bool sphere_point_shadow(const struct neph_solid *sphere, struct neph_vec3 light_m,
                                struct neph_vec3 o, struct neph_vec3 d, double *u0, double *u1)
{
    const struct neph_vec3 axis_m = neph_vec3_sub(sphere->center_m, light_m);
    const struct neph_vec3 w = neph_vec3_sub(o, light_m);
    const double tangent_squared = -half_chord_squared(sphere->radius_m, neph_vec3_length(axis_m));
    const double wa = neph_vec3_dot(w, axis_m), da = neph_vec3_dot(d, axis_m);
    double at[6] = {*u0, *u1};
    int count = 2 + quadratic_roots(da * da - tangent_squared,
                                    wa * da - tangent_squared * neph_vec3_dot(w, d),
                                    wa * wa - tangent_squared * neph_vec3_dot(w, w), &at[2]);
    if (sphere_interval(sphere, o, d, &at[count], &at[count + 1]))
        count += 2;
    double low = INFINITY, high = -INFINITY;
    for (int i = 0; i < count; i++) { /* from each place to the next above it */
        double next = INFINITY;
        for (int j = 0; j < count; j++)
            next = at[j] > at[i] ? fmin(next, at[j]) : next;
        const double a = fmax(at[i], *u0), b = fmin(next, *u1);
        if (a < b && sphere_hides(sphere, light_m, neph_vec3_along(o, d, 0.5 * (a + b)))) {
            low = fmin(low, a);
            high = fmax(high, b);
        }
    }
    *u0 = low;
    *u1 = high;
    return low < high;
}

bool neph_solid_point_shadow(const struct neph_solid *solid, struct neph_vec3 light_m,
                             struct neph_vec3 origin_m, struct neph_vec3 direction, double t0_m,
                             double t1_m, double *shadow_t0_m, double *shadow_t1_m)
{
    double u0 = t0_m, u1 = t1_m;
    const bool hidden = solid->kind == NEPH_SOLID_SPHERE
                            ? sphere_point_shadow(solid, light_m, origin_m, direction, &u0, &u1)
                            : neph_box_point_shadow(&solid->box, to_box_axes(solid, light_m),
                                                    to_box_axes(solid, origin_m),
                                                    neph_box_direction(solid, direction), &u0, &u1);
    if (!hidden)
        return false;
    *shadow_t0_m = u0;
    *shadow_t1_m = u1;
    return true;
}
