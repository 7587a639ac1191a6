/* SPDX-License-Identifier: MIT */
#include "harness/engines/frame_check.h"

#include "scenes/emission.h"
#include "scenes/media.h"
#include "scenes/solids.h"

#include <math.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");

enum { COLUMNS = 16, ROWS = 9 };

/* A pixel with an optical depth above 0.05 counts as missing the medium if its image shows less
 * than a tenth of that depth. A tenth of 0.05 is 0.005: 20 times the transmittance error of a
 * working Blender, 2.2e-4 (results/blender). */
static const double thick_depth = 0.05, missing_part = 0.1;
/* Expect light only where it does not round to 0 in a 16-bit image such as POV-Ray's, whose step is
 * 1.5e-5 of white: background at a transmittance of 1e-3 (66 steps), sunlight at an optical depth
 * of 10 (exp(-10): 3 steps). */
static const double seen_transmittance = 1e-3, lit_depth = 10.0;

/* The exact view of one pixel. */
struct sight {
    struct neph_pixel_ray ray;
    int column, row;
    size_t pixel;
    double depths[3]; /* optical, up to the first solid */
    struct neph_hit hit;
};

static double most(struct neph_rgb color)
{
    return fmax(color.r, fmax(color.g, color.b));
}

static struct sight sight_of(const struct neph_scene *scene, const struct neph_camera *camera,
                             const struct neph_image *image, int index)
{
    const int column = (2 * (index % COLUMNS) + 1) * image->width_px / (2 * COLUMNS);
    const int row = (2 * (index / COLUMNS) + 1) * image->height_px / (2 * ROWS);
    const struct neph_pixel_ray ray = neph_camera_ray(camera, image->width_px, image->height_px,
                                                      column, row);
    const struct neph_hit hit = neph_scene_hit(scene, ray.origin_m, ray.direction);
    const struct neph_rgb depth = neph_scene_optical_depth(scene, ray.origin_m, ray.direction, 0.0,
                                                           hit.t_m);
    return (struct sight){.ray = ray,
                          .column = column,
                          .row = row,
                          .pixel = (size_t)row * (size_t)image->width_px + (size_t)column,
                          .depths = {depth.r, depth.g, depth.b},
                          .hit = hit};
}

static int thickest(const struct sight *sight)
{
    const double *d = sight->depths;
    return d[0] >= d[1] && d[0] >= d[2] ? 0 : d[1] >= d[2] ? 1 : 2;
}

static enum neph_status check_media(const struct sight sights[], const char *name,
                                    const struct neph_image *image, struct neph_diag *diag)
{
    float *layers[3];
    int thick = 0, missing = 0;
    const struct sight *worst = NULL;
    if (!neph_image_rgb(image, "transmittance", layers))
        return NEPH_OK;
    for (int i = 0; i < COLUMNS * ROWS; i++) {
        const int channel = thickest(&sights[i]);
        const double depth = sights[i].depths[channel];
        if (!(depth > thick_depth))
            continue;
        thick++;
        if (!(-log((double)layers[channel][sights[i].pixel]) < missing_part * depth))
            continue;
        missing++;
        if (!worst || depth > worst->depths[thickest(worst)])
            worst = &sights[i];
    }
    if (!worst || 2 * missing <= thick)
        return NEPH_OK;
    const int channel = thickest(worst);
    return neph_fail(diag, NEPH_ERR_ENGINE,
                     "%s has left a medium out: the transmittance of pixel (%d, %d) is %.4g, and "
                     "%.4g in the scene; so in %d of %d pixels that see media",
                     name, worst->column, worst->row, (double)layers[channel][worst->pixel],
                     exp(-worst->depths[channel]), missing, thick);
}

static bool is_black(const struct neph_image *image)
{
    float *rgb[3];
    if (!neph_image_rgb(image, NULL, rgb))
        return false;
    for (int channel = 0; channel < 3; channel++)
        for (size_t p = 0; p < neph_image_pixel_count(image); p++)
            if (rgb[channel][p] != 0.0f)
                return false;
    return true;
}

/* Whether all media scatter, also those outside of the pixel's view. */
static bool scatters(const struct neph_scene *scene)
{
    bool all = scene->scattering != NEPH_SCATTERING_NONE;
    for (int i = 0; i < scene->medium_count; i++)
        all &= most(scene->media[i].albedo) > 0.0;
    return all;
}

static double depth_along(const struct neph_scene *scene, struct neph_vec3 from_m,
                          struct neph_vec3 direction, double length_m)
{
    return most(neph_scene_optical_depth(scene, from_m, direction, 0.0, length_m));
}

/* Whether sunlight reaches a point, strong enough for single precision. */
static bool is_sunlit(const struct neph_scene *scene, struct neph_vec3 place_m)
{
    const struct neph_vec3 sun = scene->sun.direction;
    return !neph_scene_hit(scene, place_m, sun).solid &&
           depth_along(scene, place_m, sun, INFINITY) < lit_depth;
}

/* The point on a pixel's ray at the optical depth thick_depth. */
static struct neph_vec3 place_in_medium_m(const struct neph_scene *scene, const struct sight *sight)
{
    const struct neph_pixel_ray *ray = &sight->ray;
    double near_m = 0.0, far_m = 1e-3;
    while (far_m < 1e12 && depth_along(scene, ray->origin_m, ray->direction, far_m) < thick_depth)
        far_m *= 2.0;
    for (int i = 0; i < 60; i++) {
        const double middle_m = 0.5 * (near_m + far_m);
        const bool is_near = depth_along(scene, ray->origin_m, ray->direction, middle_m) <
                             thick_depth;
        *(is_near ? &near_m : &far_m) = middle_m;
    }
    return neph_vec3_along(ray->origin_m, ray->direction, far_m);
}

static bool is_lit_solid(const struct neph_scene *scene, const struct sight *sight)
{
    const struct neph_hit *hit = &sight->hit;
    if (!hit->solid || !(most(hit->solid->albedo) > 0.0) ||
        !(neph_vec3_dot(hit->normal, scene->sun.direction) > 0.1) ||
        hit->solid->surface.metalness > 0.0)
        return false;
    const struct neph_vec3 at_m = neph_vec3_along(sight->ray.origin_m, sight->ray.direction,
                                                  hit->t_m);
    return is_sunlit(scene, neph_hit_outside_m(hit, at_m));
}

/* The light that a pixel must show, as text; NULL: it may be black. */
static const char *light_in(const struct neph_scene *scene, const struct sight *sight)
{
    const bool has_medium = sight->depths[thickest(sight)] > thick_depth;
    const bool has_sun = scene->sun.present && most(scene->sun.irradiance_w_per_m2) > 0.0;
    const double *d = sight->depths;
    const bool sees_through = exp(-fmin(d[0], fmin(d[1], d[2]))) > seen_transmittance;
    if (!sight->hit.solid && sees_through && most(scene->background_w_per_m2_sr) > 0.0)
        return "the background";
    if (has_medium && neph_scene_emits(scene))
        return "a medium that emits";
    if (has_medium && has_sun && scatters(scene) &&
        is_sunlit(scene, place_in_medium_m(scene, sight)))
        return "a medium in the sun";
    return has_sun && sees_through && is_lit_solid(scene, sight) ? "a solid in the sun" : NULL;
}

static enum neph_status check_light(const struct neph_scene *scene, const struct sight sights[],
                                    const char *name, const struct neph_image *image,
                                    struct neph_diag *diag)
{
    if (!is_black(image))
        return NEPH_OK;
    for (int i = 0; i < COLUMNS * ROWS; i++) {
        const char *light = light_in(scene, &sights[i]);
        if (light)
            return neph_fail(diag, NEPH_ERR_ENGINE,
                             "%s gave a black frame: all radiance is 0, and pixel (%d, %d) sees %s",
                             name, sights[i].column, sights[i].row, light);
    }
    return NEPH_OK;
}

enum neph_status neph_frame_check(const struct neph_scene *scene, int frame, const char *name,
                                  const struct neph_image *image, struct neph_diag *diag)
{
    const struct neph_camera camera = neph_scene_camera(scene, frame);
    struct sight sights[COLUMNS * ROWS];
    for (int i = 0; i < COLUMNS * ROWS; i++)
        sights[i] = sight_of(scene, &camera, image, i);
    enum neph_status status = check_media(sights, name, image, diag);
    if (!status)
        status = check_light(scene, sights, name, image, diag);
    if (status)
        neph_hint(diag, "`neph doctor` lists the tested features of this program");
    return status;
}
