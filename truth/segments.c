/* SPDX-License-Identifier: MIT
 *
 * Grid traversal by J. Amanatides and A. Woo (1987), with each face computed from its index instead
 * of incrementally, so that errors do not accumulate.
 */
#include "truth/segments.h"

#include "scenes/media.h"
#include "scenes/medium_bounds.h"

#include <math.h>

static double component(struct neph_vec3 v, int axis)
{
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

/* ---- grids ---- */

/* Distance to the face through which the ray leaves its cell along an axis. */
static double face_m(const struct neph_segments *s, int axis)
{
    const double slope = component(s->direction, axis);
    if (slope == 0.0)
        return INFINITY;
    const double low_m = component(s->majorants->box.min_m, axis);
    const double position_m = low_m + (s->cell[axis] + (slope > 0.0)) * s->side_m[axis];
    return (position_m - component(s->origin_m, axis)) / slope;
}

static int nearest_axis(const double next_m[3])
{
    const int xy = next_m[0] <= next_m[1] ? 0 : 1;
    return next_m[xy] <= next_m[2] ? xy : 2;
}

static void enter_cell(struct neph_segments *s)
{
    const struct neph_majorants *m = s->majorants;
    const size_t nx = (size_t)m->size[0], ny = (size_t)m->size[1];
    const size_t at = ((size_t)s->cell[2] * ny + (size_t)s->cell[1]) * nx + (size_t)s->cell[0];
    s->majorant_per_m = (double)m->extinction_per_m[at];
    s->t1_m = fmax(s->t0_m, fmin(s->end_m, s->next_m[nearest_axis(s->next_m)]));
}

static bool grid_start(struct neph_segments *s)
{
    const struct neph_majorants *m = s->majorants;
    if (!neph_bounds_clip(&m->box, s->origin_m, s->direction, &s->t0_m, &s->end_m))
        return false;
    const struct neph_vec3 entry_m = neph_vec3_along(s->origin_m, s->direction, s->t0_m);
    for (int axis = 0; axis < 3; axis++) {
        const double low_m = component(m->box.min_m, axis);
        s->side_m[axis] = (component(m->box.max_m, axis) - low_m) / m->size[axis];
        const double at = floor((component(entry_m, axis) - low_m) / s->side_m[axis]);
        s->cell[axis] = (int)fmax(0.0, fmin(m->size[axis] - 1.0, at));
        s->next_m[axis] = face_m(s, axis);
    }
    enter_cell(s);
    return true;
}

static bool grid_next(struct neph_segments *s)
{
    const int axis = nearest_axis(s->next_m);
    s->cell[axis] += component(s->direction, axis) > 0.0 ? 1 : -1;
    if (s->cell[axis] < 0 || s->cell[axis] >= s->majorants->size[axis])
        return false;
    s->next_m[axis] = face_m(s, axis);
    enter_cell(s);
    return true;
}

/* ---- shells ---- */

/* Above this many scale heights, an atmosphere's remaining optical depth is too small to be
 * resolved by a random number of 52 bits. */
static const double shell_folds = 60.0;

/* Distance along the ray between its lowest point and a larger radius. */
static double half_chord_m(const struct neph_segments *s, double radius_m)
{
    return sqrt(fmax(0.0, (radius_m - s->low_m) * (radius_m + s->low_m)));
}

static double shell_bound_per_m(const struct neph_segments *s, double radius_m)
{
    const struct neph_shell *shell = &s->medium->shell;
    const double height_m = fmax(0.0, radius_m - shell->radius_m);
    /* Slightly larger: the density is evaluated at a rounded point. */
    return s->medium->extinction_per_m * exp(-height_m / shell->scale_height_m) * (1.0 + 1e-6);
}

/* Choose the next segment, one scale height long: the density at its lower end is the bound. */
static void shell_stretch(struct neph_segments *s)
{
    const struct neph_shell *shell = &s->medium->shell;
    const double x_m = s->t0_m - s->nearest_m;
    const double r_m = hypot(s->low_m, x_m);
    const double ground_m = s->low_m < shell->radius_m ? half_chord_m(s, shell->radius_m) : 0.0;
    double to_m;
    if (x_m < -ground_m) { /* downwards: at most to the ground or the lowest point */
        const double lower_m = fmax(r_m - shell->scale_height_m, shell->radius_m);
        to_m = lower_m > s->low_m ? fmin(-half_chord_m(s, lower_m), -ground_m) : 0.0;
        s->majorant_per_m = shell_bound_per_m(s, fmax(lower_m, s->low_m));
    } else if (x_m < ground_m) { /* below the ground there is no medium */
        to_m = ground_m;
        s->majorant_per_m = 0.0;
    } else {
        to_m = half_chord_m(s, fmax(r_m, shell->radius_m) + shell->scale_height_m);
        s->majorant_per_m = shell_bound_per_m(s, r_m);
    }
    /* A segment is never empty, despite rounding, so that the traversal ends. */
    const double least_m = s->t0_m + 1e-15 * (s->t0_m + fabs(s->nearest_m));
    s->t1_m = fmin(s->end_m, fmax(s->nearest_m + to_m, least_m));
}

static bool shell_start(struct neph_segments *s)
{
    const struct neph_shell *shell = &s->medium->shell;
    const struct neph_vec3 to_center_m = neph_vec3_sub(shell->center_m, s->origin_m);
    s->nearest_m = neph_vec3_dot(to_center_m, s->direction);
    s->low_m = neph_vec3_length(neph_vec3_along(to_center_m, s->direction, -s->nearest_m));
    const double top_m = shell->radius_m + shell_folds * shell->scale_height_m;
    if (s->low_m >= top_m ||
        !neph_medium_clip(s->medium, s->origin_m, s->direction, &s->t0_m, &s->end_m))
        return false;
    s->t0_m = fmax(s->t0_m, s->nearest_m - half_chord_m(s, top_m));
    s->end_m = fmin(s->end_m, s->nearest_m + half_chord_m(s, top_m));
    if (!(s->t0_m < s->end_m))
        return false;
    shell_stretch(s);
    return true;
}

/* ---- either ---- */

bool neph_segments_start(struct neph_segments *segments, const struct neph_medium *medium,
                         const struct neph_majorants *majorants, struct neph_vec3 origin_m,
                         struct neph_vec3 direction, double end_m)
{
    segments->medium = medium;
    segments->majorants = majorants;
    segments->origin_m = origin_m;
    segments->direction = direction;
    segments->t0_m = 0.0;
    segments->end_m = end_m;
    return majorants ? grid_start(segments) : shell_start(segments);
}

bool neph_segments_next(struct neph_segments *segments)
{
    segments->t0_m = segments->t1_m;
    if (segments->t0_m >= segments->end_m)
        return false;
    if (segments->majorants)
        return grid_next(segments);
    shell_stretch(segments);
    return true;
}
