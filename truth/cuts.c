/* SPDX-License-Identifier: MIT */
#include "truth/cuts.h"

#include "scenes/media.h"
#include "scenes/medium_bounds.h"
#include "scenes/solids.h"

#include <math.h>
#include <stdlib.h>

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* ---- kinks ---- */

static void cut_faces(struct neph_cuts *cuts, const struct neph_medium *medium)
{
    double near_m = cuts->t0_m, far_m = cuts->t1_m;
    if (neph_medium_clip(medium, cuts->origin_m, cuts->direction, &near_m, &far_m)) {
        neph_cuts_add(cuts, near_m);
        neph_cuts_add(cuts, far_m);
    }
}

/* Cut at the kinks of the optical depth towards the sun: where the sun ray from o + t d changes the
 * face by which it enters or leaves the bounds. The distances to the faces are affine in t; the
 * kinks are where two of them are equal, or one is zero. */
static void cut_sun_kinks(struct neph_cuts *cuts, const struct neph_medium *medium)
{
    const struct neph_bounds box = neph_medium_own_box(medium);
    const struct neph_vec3 s = neph_medium_own_direction(medium, cuts->scene->sun.direction),
                           o = neph_medium_own_point_m(medium, cuts->origin_m),
                           d = neph_medium_own_direction(medium, cuts->direction);
    const double face_m[6] = {box.min_m.x, box.max_m.x, box.min_m.y,
                              box.max_m.y, box.min_m.z, box.max_m.z};
    const double sun[3] = {s.x, s.y, s.z}, origin[3] = {o.x, o.y, o.z}, view[3] = {d.x, d.y, d.z};
    double constant[7] = {0.0}, slope[7] = {0.0}; /* the first entry is the start of the sun ray */
    int count = 1;
    for (int face = 0; face < 6; face++) {
        const int axis = face / 2;
        if (isinf(face_m[face]) || sun[axis] == 0.0)
            continue;
        constant[count] = (face_m[face] - origin[axis]) / sun[axis];
        slope[count++] = -view[axis] / sun[axis];
    }
    for (int i = 0; i < count; i++)
        for (int j = i + 1; j < count; j++)
            if (slope[i] != slope[j])
                neph_cuts_add(cuts, (constant[j] - constant[i]) / (slope[i] - slope[j]));
}

/* Cut at the kinks of a light: its rays change their face of the bounds at an edge, which is where
 * the view ray crosses the plane through the light and the edge. */
static void cut_light_kinks(struct neph_cuts *cuts, const struct neph_medium *medium,
                            struct neph_vec3 light_m)
{
    const struct neph_bounds box = neph_medium_own_box(medium);
    const double low_m[3] = {box.min_m.x, box.min_m.y, box.min_m.z};
    const double high_m[3] = {box.max_m.x, box.max_m.y, box.max_m.z};
    const struct neph_vec3 l = neph_medium_own_point_m(medium, light_m),
                           w = neph_vec3_sub(neph_medium_own_point_m(medium, cuts->origin_m), l),
                           d = neph_medium_own_direction(medium, cuts->direction);
    const double light[3] = {l.x, l.y, l.z};
    const double way_m[3] = {w.x, w.y, w.z}, slope[3] = {d.x, d.y, d.z};
    for (int edge = 0; edge < 12; edge++) {
        const int a = (edge / 4 + 1) % 3, b = (edge / 4 + 2) % 3;
        const double a_m = (edge & 1 ? high_m : low_m)[a] - light[a];
        const double b_m = (edge & 2 ? high_m : low_m)[b] - light[b];
        if (isfinite(a_m) && isfinite(b_m))
            neph_cuts_add(cuts,
                          -(b_m * way_m[a] - a_m * way_m[b]) / (b_m * slope[a] - a_m * slope[b]));
    }
}

/* Cut where the angle from a spot's axis has a given cosine. Also cuts at the mirrored cone, which
 * is harmless. */
static void cut_cone(struct neph_cuts *cuts, const struct neph_light *light, double cosine)
{
    const struct neph_vec3 w = neph_vec3_sub(cuts->origin_m, light->position_m);
    const double c2 = cosine * cosine, wa = neph_vec3_dot(w, light->axis);
    const double da = neph_vec3_dot(cuts->direction, light->axis);
    const double a = da * da - c2, b = wa * da - c2 * neph_vec3_dot(w, cuts->direction);
    const double c = wa * wa - c2 * neph_vec3_dot(w, w);
    const double q = -(b + copysign(sqrt(fmax(0.0, b * b - a * c)), b));
    neph_cuts_add(cuts, q / a);
    neph_cuts_add(cuts, c / q);
}

static void cut_light(struct neph_cuts *cuts, const struct neph_light *light)
{
    const struct neph_vec3 way_m = neph_vec3_sub(light->position_m, cuts->origin_m);
    neph_cuts_add(cuts, neph_vec3_dot(way_m, cuts->direction));
    if (light->is_spot) {
        cut_cone(cuts, light, light->inner_cosine);
        cut_cone(cuts, light, light->outer_cosine);
        cut_cone(cuts, light, 0.0);
    }
    for (int m = 0; m < cuts->scene->medium_count; m++)
        cut_light_kinks(cuts, &cuts->scene->media[m], light->position_m);
}

/* ---- all ---- */

/* The shadows of all solids in the range of the cuts; light NULL: of the sun. */
static void find_shadows(const struct neph_cuts *cuts, const struct neph_light *light,
                         struct neph_shadows *shadows)
{
    const struct neph_shadow_ray ray = {cuts->origin_m,
                                        cuts->direction,
                                        cuts->scene->sun.direction,
                                        light ? &light->position_m : NULL,
                                        cuts->t0_m,
                                        cuts->t1_m};
    shadows->count = 0;
    neph_scene_add_shadows(cuts->scene, &ray, shadows);
}

/* `shadows` NULL: none. */
static void make_cuts(struct neph_cuts *cuts, const struct neph_shadows *shadows, bool scales)
{
    const struct neph_scene *scene = cuts->scene;
    for (int i = 0; shadows && i < shadows->count; i++) {
        neph_cuts_add(cuts, shadows->at_m[i].low);
        neph_cuts_add(cuts, shadows->at_m[i].high);
    }
    for (int m = 0; m < scene->medium_count; m++) {
        cut_faces(cuts, &scene->media[m]);
        cut_sun_kinks(cuts, &scene->media[m]);
        if (scales)
            neph_medium_cut_scales(cuts, &scene->media[m]);
    }
    for (int m = 0; m < scene->medium_count; m++)
        neph_medium_cut_kinks(cuts, &scene->media[m]);
    cuts->at_m[cuts->count++] = cuts->t0_m;
    cuts->at_m[cuts->count++] = cuts->t1_m;
    qsort(cuts->at_m, (size_t)cuts->count, sizeof(cuts->at_m[0]), compare_doubles);
}

static void start_cuts(struct neph_cuts *cuts, const struct neph_scene *scene,
                       struct neph_vec3 origin_m, struct neph_vec3 direction, double t0_m,
                       double t1_m)
{
    cuts->scene = scene;
    cuts->origin_m = origin_m;
    cuts->direction = direction;
    cuts->t0_m = t0_m;
    cuts->t1_m = t1_m;
    cuts->count = 0;
}

/* The pieces between cuts outside of all shadows. */
static int lit_pieces(const struct neph_cuts *cuts, const struct neph_shadows *shadows,
                      struct neph_interval *pieces)
{
    int count = 0, shadow = 0;
    double dark_until_m = -INFINITY;
    for (int i = 0; i + 1 < cuts->count; i++) {
        const double low_m = cuts->at_m[i], high_m = cuts->at_m[i + 1];
        const double middle_m = 0.5 * (low_m + high_m);
        while (shadow < shadows->count && shadows->at_m[shadow].low < middle_m)
            dark_until_m = shadows->at_m[shadow++].high;
        if (middle_m > dark_until_m && high_m > low_m)
            pieces[count++] = (struct neph_interval){low_m, high_m};
    }
    return count;
}

int neph_lit_pieces(const struct neph_scene *scene, struct neph_vec3 origin_m,
                    struct neph_vec3 direction, double t0_m, double t1_m, bool scales,
                    struct neph_interval *pieces)
{
    struct neph_shadows shadows; /* these are not zero-initialised: they are large */
    struct neph_cuts cuts;
    start_cuts(&cuts, scene, origin_m, direction, t0_m, t1_m);
    find_shadows(&cuts, NULL, &shadows);
    make_cuts(&cuts, &shadows, scales);
    return lit_pieces(&cuts, &shadows, pieces);
}

int neph_light_lit_pieces(const struct neph_scene *scene, const struct neph_light *light,
                          struct neph_vec3 origin_m, struct neph_vec3 direction, double t0_m,
                          double t1_m, struct neph_interval *pieces)
{
    struct neph_shadows shadows; /* these are not zero-initialised: they are large */
    struct neph_cuts cuts;
    start_cuts(&cuts, scene, origin_m, direction, t0_m, t1_m);
    find_shadows(&cuts, light, &shadows);
    cut_light(&cuts, light);
    make_cuts(&cuts, &shadows, true);
    return lit_pieces(&cuts, &shadows, pieces);
}

int neph_ray_pieces(const struct neph_scene *scene, struct neph_vec3 origin_m,
                    struct neph_vec3 direction, double t0_m, double t1_m,
                    struct neph_interval *pieces)
{
    struct neph_cuts cuts; /* not zero-initialised: it is large */
    start_cuts(&cuts, scene, origin_m, direction, t0_m, t1_m);
    make_cuts(&cuts, NULL, true);
    int count = 0;
    for (int i = 0; i + 1 < cuts.count; i++)
        if (cuts.at_m[i + 1] > cuts.at_m[i])
            pieces[count++] = (struct neph_interval){cuts.at_m[i], cuts.at_m[i + 1]};
    return count;
}
