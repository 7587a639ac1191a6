/* SPDX-License-Identifier: MIT */
#include "truth/cuts.h"

#include "scenes/grid.h"
#include "scenes/media.h"
#include "scenes/solids.h"

#include <math.h>
#include <stdlib.h>

struct ray {
    const struct neph_scene *scene;
    struct neph_vec3 origin_m, direction;
};

struct cuts {
    double t0_m, t1_m; /* only cuts strictly inside are kept */
    int count;
    double at_m[NEPH_CUTS_MAX];
};

static void cut(struct cuts *cuts, double t_m)
{
    /* Room is kept for the two ends. */
    if (t_m > cuts->t0_m && t_m < cuts->t1_m && cuts->count < NEPH_CUTS_MAX - 2)
        cuts->at_m[cuts->count++] = t_m;
}

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The part of the cuts' range inside the bounds. */
static bool range_inside(const struct cuts *cuts, const struct ray *ray,
                         const struct neph_bounds *bounds, double *t0_m, double *t1_m)
{
    *t0_m = cuts->t0_m;
    *t1_m = cuts->t1_m;
    return neph_bounds_clip(bounds, ray->origin_m, ray->direction, t0_m, t1_m);
}

/* ---- kinks ---- */

static void cut_faces(struct cuts *cuts, const struct ray *ray, const struct neph_bounds *bounds)
{
    double near_m, far_m;
    if (range_inside(cuts, ray, bounds, &near_m, &far_m)) {
        cut(cuts, near_m);
        cut(cuts, far_m);
    }
}

/* Where the sun ray from o + t d changes the face by which it enters or leaves the bounds: the
 * distances to the faces are affine in t, and the kinks lie where two of them cross, or one
 * crosses zero. */
static void cut_sun_kinks(struct cuts *cuts, const struct ray *ray,
                          const struct neph_bounds *bounds)
{
    const struct neph_vec3 s = ray->scene->sun.direction, o = ray->origin_m, d = ray->direction;
    const double face_m[6] = {bounds->min_m.x, bounds->max_m.x, bounds->min_m.y,
                              bounds->max_m.y, bounds->min_m.z, bounds->max_m.z};
    const double sun[3] = {s.x, s.y, s.z}, origin[3] = {o.x, o.y, o.z}, view[3] = {d.x, d.y, d.z};
    double constant[7] = {0.0}, slope[7] = {0.0}; /* the first is the start of the sun ray */
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
                cut(cuts, (constant[j] - constant[i]) / (slope[i] - slope[j]));
}

/* ---- height fog ---- */

enum { LADDER_COUNT = 9 };

/* Cuts where a layer has given its whole / 2 * 64^-k from either end: between two of them its
 * density changes 64-fold at most, or it gives less than 1e-14 of its whole. However far away or
 * thin a layer is, some piece has its scale. */
static void cut_fog(struct cuts *cuts, const struct ray *ray, const struct neph_medium *medium)
{
    double near_m, far_m;
    if (!range_inside(cuts, ray, &medium->bounds, &near_m, &far_m))
        return;
    const double k_y = ray->direction.y;
    const double near_y_m = ray->origin_m.y + near_m * k_y, far_y_m = ray->origin_m.y + far_m * k_y;
    for (int l = 0; l < medium->layer_count; l++) {
        const struct neph_fog_layer *layer = &medium->layers[l];
        double step = 0.5 * neph_fog_layer_optical_depth(layer, near_y_m, k_y, far_m - near_m);
        if (layer->falloff_per_m * k_y == 0.0)
            continue; /* even along the ray */
        for (int k = 0; k < LADDER_COUNT && step > 0.0; k++, step /= 64.0) {
            cut(cuts, near_m + neph_fog_layer_distance_m(layer, near_y_m, k_y, step));
            cut(cuts, far_m - neph_fog_layer_distance_m(layer, far_y_m, -k_y, step));
        }
    }
}

/* ---- Gaussian ---- */

/* At every second width, to where e^-50 of the density is left. */
static void cut_widths(struct cuts *cuts, double middle_m, double width_m)
{
    for (int k = -10; k <= 10; k += 2)
        cut(cuts, middle_m + k * width_m);
}

/* On the ray, and where the blob's shadow crosses it: the distance of the sun ray from the centre
 * is a hyperbola in t, with its own middle and width. */
static void cut_gaussian(struct cuts *cuts, const struct ray *ray, const struct neph_medium *medium)
{
    const struct neph_vec3 s = ray->scene->sun.direction, d = ray->direction;
    const struct neph_vec3 to_center_m = neph_vec3_sub(medium->gaussian.center_m, ray->origin_m);
    const struct neph_vec3 across = neph_vec3_along(d, s, -neph_vec3_dot(d, s));
    const double slope2 = neph_vec3_dot(across, across);
    cut_widths(cuts, neph_vec3_dot(to_center_m, d), medium->gaussian.width_m);
    if (slope2 > 0.0 && ray->scene->medium_count > 1) /* its own density has its own scale */
        cut_widths(cuts, neph_vec3_dot(to_center_m, across) / slope2,
                   medium->gaussian.width_m / sqrt(slope2));
}

/* ---- shell ---- */

/* Scale heights between cuts, and how many until nothing is left. */
enum { FOLDS = 4, FOLD_CUTS = 11 };

/* The distance x from the lowest point of the ray at which its radius has grown by `height_m` since
 * x0. */
static double x_at_climb_m(double low_m, double x0_m, double height_m)
{
    return sqrt(x0_m * x0_m + height_m * (2.0 * hypot(low_m, x0_m) + height_m));
}

/* One leg of the ray, on one side (+1 or -1) of its lowest point at t = middle_m: cuts at the
 * ground and at heights over the densest point of the leg. */
static void cut_leg(struct cuts *cuts, const struct neph_shell *shell, double low_m,
                    double middle_m, double side)
{
    const double start_m = side > 0.0 ? cuts->t0_m - middle_m : middle_m - cuts->t1_m;
    double x0_m = fmax(0.0, start_m);
    if (low_m < shell->radius_m)
        x0_m = fmax(x0_m, sqrt((shell->radius_m - low_m) * (shell->radius_m + low_m)));
    for (int k = 0; k <= FOLD_CUTS; k++)
        cut(cuts, middle_m + side * x_at_climb_m(low_m, x0_m, k * FOLDS * shell->scale_height_m));
}

/* On the ray, and where the sun rays that leave it just graze some height: the edges of the shadows
 * of balls. The lowest, the ground, is a kink, for below it there is nothing. */
static void cut_shell(struct cuts *cuts, const struct ray *ray, const struct neph_medium *medium)
{
    const struct neph_shell *shell = &medium->shell;
    const struct neph_vec3 from_center_m = neph_vec3_sub(ray->origin_m, shell->center_m);
    const double middle_m = -neph_vec3_dot(from_center_m, ray->direction);
    const double low_m = neph_vec3_length(neph_vec3_along(from_center_m, ray->direction, middle_m));
    cut_leg(cuts, shell, low_m, middle_m, 1.0);
    cut_leg(cuts, shell, low_m, middle_m, -1.0);
    for (int k = 0; k <= FOLD_CUTS; k++) {
        const struct neph_solid ball = {.kind = NEPH_SOLID_SPHERE,
                                        .center_m = shell->center_m,
                                        .radius_m = shell->radius_m +
                                                    k * FOLDS * shell->scale_height_m};
        double low_t_m, high_t_m;
        if (neph_solid_shadow(&ball, ray->scene->sun.direction, ray->origin_m, ray->direction,
                              cuts->t0_m, cuts->t1_m, &low_t_m, &high_t_m)) {
            cut(cuts, low_t_m);
            cut(cuts, high_t_m);
        }
    }
}

/* ---- grid ---- */

/* The shadow that a grid throws on the ray, an eighth of its cells at a time: nodes are then closer
 * than its cells. */
static void cut_grid_shadow(struct cuts *cuts, const struct ray *ray,
                            const struct neph_medium *medium)
{
    const struct neph_solid box = {.kind = NEPH_SOLID_BOX, .box = neph_medium_support(medium)};
    const int *size = medium->grid->size;
    const int cells = size[0] > size[1] ? size[0] : size[1];
    const int pieces = 1 + (cells > size[2] ? cells : size[2]) / 8;
    double low_m, high_m;
    if (ray->scene->medium_count == 1) /* its own cells are cut finer */
        return;
    if (!neph_solid_shadow(&box, ray->scene->sun.direction, ray->origin_m, ray->direction,
                           cuts->t0_m, cuts->t1_m, &low_m, &high_m))
        return;
    for (int k = 0; k <= pieces; k++)
        cut(cuts, low_m + (high_m - low_m) * k / pieces);
}

/* The faces of the cells on the ray, where the density has kinks. */
static void cut_cells(struct cuts *cuts, const struct ray *ray, const struct neph_medium *medium)
{
    const struct neph_grid *grid = medium->grid;
    const struct neph_bounds support = neph_medium_support(medium);
    const double origin[3] = {ray->origin_m.x, ray->origin_m.y, ray->origin_m.z};
    const double view[3] = {ray->direction.x, ray->direction.y, ray->direction.z};
    const double first[3] = {grid->origin_m.x, grid->origin_m.y, grid->origin_m.z};
    const double spacing[3] = {grid->spacing_m.x, grid->spacing_m.y, grid->spacing_m.z};
    double near_m, far_m;
    if (!range_inside(cuts, ray, &support, &near_m, &far_m))
        return;
    for (int axis = 0; axis < 3; axis++)
        for (int i = -1; i <= grid->size[axis] && view[axis] != 0.0; i++) {
            const double t_m = (first[axis] + i * spacing[axis] - origin[axis]) / view[axis];
            if (t_m >= near_m && t_m <= far_m)
                cut(cuts, t_m);
        }
}

/* ---- all ---- */

static void cut_scales(struct cuts *cuts, const struct ray *ray, const struct neph_medium *medium)
{
    switch (medium->kind) {
    case NEPH_MEDIUM_HOMOGENEOUS:
    case NEPH_MEDIUM_HEIGHT_FOG:
        cut_fog(cuts, ray, medium);
        break;
    case NEPH_MEDIUM_GAUSSIAN:
        cut_gaussian(cuts, ray, medium);
        break;
    case NEPH_MEDIUM_SHELL:
        cut_shell(cuts, ray, medium);
        break;
    case NEPH_MEDIUM_GRID:
        cut_grid_shadow(cuts, ray, medium);
        break;
    case NEPH_MEDIUM_HORIZON:
    case NEPH_MEDIUM_KIND_COUNT:
        break; /* never exact */
    }
}

/* The shadows of all solids on the range of the cuts, by ascending start. */
static int shadows_on_ray(const struct cuts *cuts, const struct ray *ray,
                          struct neph_interval shadows[NEPH_SCENE_SOLIDS_MAX])
{
    int count = 0;
    for (int i = 0; i < ray->scene->solid_count; i++) {
        struct neph_interval *shadow = &shadows[count];
        if (neph_solid_shadow(&ray->scene->solids[i], ray->scene->sun.direction, ray->origin_m,
                              ray->direction, cuts->t0_m, cuts->t1_m, &shadow->low, &shadow->high))
            count++;
    }
    /* compare_doubles sees the first member, low. */
    qsort(shadows, (size_t)count, sizeof(shadows[0]), compare_doubles);
    return count;
}

static void make_cuts(struct cuts *cuts, const struct ray *ray, const struct neph_interval *shadows,
                      int shadow_count, bool scales)
{
    const struct neph_scene *scene = ray->scene;
    for (int i = 0; i < shadow_count; i++) {
        cut(cuts, shadows[i].low);
        cut(cuts, shadows[i].high);
    }
    for (int m = 0; m < scene->medium_count; m++) {
        cut_faces(cuts, ray, &scene->media[m].bounds);
        cut_sun_kinks(cuts, ray, &scene->media[m].bounds);
        if (scales)
            cut_scales(cuts, ray, &scene->media[m]);
    }
    for (int m = 0; m < scene->medium_count; m++)
        if (scene->media[m].kind == NEPH_MEDIUM_GRID)
            cut_cells(cuts, ray, &scene->media[m]);
    cuts->at_m[cuts->count++] = cuts->t0_m;
    cuts->at_m[cuts->count++] = cuts->t1_m;
    qsort(cuts->at_m, (size_t)cuts->count, sizeof(cuts->at_m[0]), compare_doubles);
}

int neph_lit_pieces(const struct neph_scene *scene, struct neph_vec3 origin_m,
                    struct neph_vec3 direction, double t0_m, double t1_m, bool scales,
                    struct neph_interval *pieces)
{
    const struct ray ray = {scene, origin_m, direction};
    struct neph_interval shadows[NEPH_SCENE_SOLIDS_MAX];
    struct cuts cuts; /* not initialised as a whole: it is large */
    cuts.t0_m = t0_m;
    cuts.t1_m = t1_m;
    cuts.count = 0;
    const int shadow_count = shadows_on_ray(&cuts, &ray, shadows);
    make_cuts(&cuts, &ray, shadows, shadow_count, scales);

    int count = 0, shadow = 0;
    double dark_until_m = -INFINITY;
    for (int i = 0; i + 1 < cuts.count; i++) {
        const double low_m = cuts.at_m[i], high_m = cuts.at_m[i + 1];
        const double middle_m = 0.5 * (low_m + high_m);
        while (shadow < shadow_count && shadows[shadow].low < middle_m)
            dark_until_m = fmax(dark_until_m, shadows[shadow++].high);
        if (middle_m > dark_until_m && high_m > low_m)
            pieces[count++] = (struct neph_interval){low_m, high_m};
    }
    return count;
}
