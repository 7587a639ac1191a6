/* SPDX-License-Identifier: MIT */
#include "truth/reflected.h"

#include "scenes/lights.h"
#include "scenes/surfaces.h"
#include "truth/directions.h"
#include "truth/metal.h"

#include <math.h>
#include <stdio.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_REFLECTED_PARTS == 8, "a new kind");
_Static_assert(NEPH_SOLID_KIND_COUNT == 3, "a new kind");

/* Russian roulette: a path with a throughput below this may be ended (otherwise its value is
 * raised). */
static const double roulette_below = 0.05;

static const struct neph_rgb black = {0, 0, 0}, white = {1, 1, 1};

/* A hit of a path on a solid. */
struct place {
    struct neph_hit hit;
    struct neph_vec3 point_m, from; /* `from`: unit, opposite to the path */
    struct neph_rgb color;
};

static struct place hit_surface_place(const struct neph_hit *hit, struct neph_vec3 origin_m,
                                      struct neph_vec3 direction)
{
    const struct neph_vec3 point_m = neph_vec3_along(origin_m, direction, hit->t_m);
    return (struct place){.hit = *hit,
                          .point_m = neph_hit_outside_m(hit, point_m),
                          .from = neph_vec3_scale(direction, -1.0),
                          .color = neph_surface_color(hit, point_m)};
}

/* ---- beams: light of sun and lights, which comes from points --------------------------------- */

struct beam {
    struct neph_vec3 direction;          /* unit, opposite to the light */
    struct neph_rgb irradiance_w_per_m2; /* on a perpendicular plane */
};

enum { FACES = 6, BEAMS_MAX = (1 + NEPH_SCENE_LIGHTS_MAX) * (1 + FACES) };

struct beams {
    int count;
    struct beam beams[BEAMS_MAX];
};

static void add_beam(struct beams *beams, struct neph_vec3 direction, struct neph_rgb irradiance)
{
    beams->beams[beams->count++] = (struct beam){direction, irradiance};
}

/* The mirror that may reflect beams; NULL: none. */
static const struct neph_solid *find_mirror(const struct neph_scene *scene)
{
    for (int i = 0; i < scene->solid_count; i++)
        if (neph_is_mirror(&scene->solids[i].surface))
            return &scene->solids[i];
    return NULL;
}

struct plane {
    struct neph_vec3 point_m, normal;
};

static struct plane make_face_plane(const struct neph_solid *box, int face)
{
    const struct neph_vec3 middle_m = neph_vec3_scale(neph_vec3_add(box->box.min_m, box->box.max_m),
                                                      0.5);
    const struct neph_vec3 half_m = neph_vec3_sub(box->box.max_m, middle_m);
    const double side = face % 2 ? 1.0 : -1.0;
    struct neph_vec3 normal = {face / 2 == 0 ? side : 0, face / 2 == 1 ? side : 0,
                               face / 2 == 2 ? side : 0};
    const double depth_m = fabs(neph_vec3_dot(normal, half_m));
    if (neph_is_turned(&box->turn))
        normal = neph_rotate(&box->turn, normal);
    return (struct plane){neph_vec3_along(middle_m, normal, depth_m), normal};
}

static double height_above_m(const struct plane *plane, struct neph_vec3 point_m)
{
    return neph_vec3_dot(neph_vec3_sub(point_m, plane->point_m), plane->normal);
}

/* Find the point on a mirror's face that is visible from a point in a direction. */
static bool finds_face(const struct neph_scene *scene, const struct neph_solid *mirror,
                       const struct plane *face, struct neph_vec3 point_m,
                       struct neph_vec3 direction, struct place *place)
{
    const struct neph_hit hit = neph_scene_hit(scene, point_m, direction);
    if (hit.solid != mirror || neph_vec3_dot(hit.normal, face->normal) < 0.5)
        return false;
    *place = hit_surface_place(&hit, point_m, direction);
    return true;
}

static struct neph_rgb mirrored_light(const struct place *mirror, struct neph_rgb irradiance)
{
    return neph_rgb_scale(neph_rgb_mul(mirror->color, irradiance),
                          mirror->hit.solid->surface.metalness);
}

static void add_mirrored_sun(const struct neph_scene *scene, const struct neph_solid *mirror,
                             const struct plane *face, struct neph_vec3 point_m,
                             struct beams *beams)
{
    const struct neph_vec3 sun = scene->sun.direction;
    const struct neph_vec3 direction = neph_vec3_scale(neph_mirrored(sun, face->normal), -1.0);
    struct place place;
    if (neph_vec3_dot(sun, face->normal) > 0.0 &&
        finds_face(scene, mirror, face, point_m, direction, &place) &&
        neph_scene_is_sun_visible(scene, place.point_m))
        add_beam(beams, direction, mirrored_light(&place, scene->sun.irradiance_w_per_m2));
}

/* Add the light at the mirrored point, with its direction mirrored back. */
static void add_mirrored_light(const struct neph_scene *scene, const struct neph_light *lamp,
                               const struct neph_solid *mirror, const struct plane *face,
                               struct neph_vec3 point_m, struct beams *beams)
{
    const double height_m = height_above_m(face, point_m);
    if (height_m <= 0.0 || height_above_m(face, lamp->position_m) <= 0.0)
        return;
    const struct neph_lit lit = neph_light_at(
        lamp, neph_vec3_along(point_m, face->normal, -2.0 * height_m));
    const struct neph_vec3 direction = neph_vec3_scale(neph_mirrored(lit.direction, face->normal),
                                                       -1.0);
    struct place place;
    if (finds_face(scene, mirror, face, point_m, direction, &place) &&
        neph_scene_is_visible(scene, place.point_m, lamp->position_m))
        add_beam(beams, direction, mirrored_light(&place, lit.irradiance_w_per_m2));
}

static void add_mirrored(const struct neph_scene *scene, const struct neph_solid *mirror,
                         struct neph_vec3 point_m, struct beams *beams)
{
    for (int f = 0; f < FACES; f++) {
        const struct plane face = make_face_plane(mirror, f);
        if (scene->sun.present)
            add_mirrored_sun(scene, mirror, &face, point_m, beams);
        for (int i = 0; i < scene->light_count; i++)
            add_mirrored_light(scene, &scene->lights[i], mirror, &face, point_m, beams);
    }
}

/* Find all beams that arrive at a point just outside a surface. */
static void find_beams(const struct neph_scene *scene, struct neph_vec3 point_m,
                       struct beams *beams)
{
    beams->count = 0;
    if (scene->sun.present && neph_scene_is_sun_visible(scene, point_m))
        add_beam(beams, scene->sun.direction, scene->sun.irradiance_w_per_m2);
    for (int i = 0; i < scene->light_count; i++) {
        const struct neph_light *lamp = &scene->lights[i];
        const struct neph_lit lit = neph_light_at(lamp, point_m);
        if (lit.distance_m > 0.0 && neph_scene_is_visible(scene, point_m, lamp->position_m))
            add_beam(beams, lit.direction, lit.irradiance_w_per_m2);
    }
    const struct neph_solid *mirror = find_mirror(scene);
    if (mirror && (scene->sun.present || scene->light_count > 0))
        add_mirrored(scene, mirror, point_m, beams);
}

/* Radiance of beams reflected by a white Lambertian and by a white metal; 0 for a mirror, which
 * reflects no point sources. */
static void reflect_beams(const struct neph_scene *scene, const struct place *place,
                          struct neph_rgb *diffuse, struct neph_rgb *glossy)
{
    struct beams found;
    const struct neph_surface *surface = &place->hit.solid->surface;
    const bool shines = surface->metalness > 0.0 && !neph_is_mirror(surface);
    *diffuse = *glossy = black;
    find_beams(scene, place->point_m, &found);
    for (int i = 0; i < found.count; i++) {
        const struct beam *beam = &found.beams[i];
        const double cosine = neph_hit_cosine(&place->hit, beam->direction);
        if (cosine <= 0.0)
            continue;
        *diffuse = neph_rgb_add(*diffuse, neph_rgb_scale(beam->irradiance_w_per_m2, cosine / M_PI));
        if (shines)
            *glossy = neph_rgb_add(
                *glossy, neph_rgb_scale(beam->irradiance_w_per_m2,
                                        neph_metal_per_sr(surface->roughness, place->hit.shading,
                                                          place->from, beam->direction)));
    }
}

/* ---- paths ----------------------------------------------------------------------------------- */

static double largest_throughput(struct neph_rgb value)
{
    return fmax(value.r, fmax(value.g, value.b));
}

static bool survives(struct neph_rgb *value, struct neph_random *random)
{
    const double most = largest_throughput(*value);
    if (most >= roulette_below)
        return true;
    if (neph_random_uniform(random) * roulette_below >= most)
        return false;
    *value = neph_rgb_scale(*value, roulette_below / most);
    return true;
}

/* Sample one of the two reflections of a surface; returns its weight without the colour. */
static double leave(const struct place *place, struct neph_random *random,
                    struct neph_vec3 *direction)
{
    const struct neph_surface *surface = &place->hit.solid->surface;
    const bool is_metal = surface->metalness > 0.0 &&
                          (surface->metalness == 1.0 ||
                           neph_random_uniform(random) < surface->metalness);
    if (is_metal)
        return neph_metal_sample(surface->roughness, place->hit.shading, place->from, random,
                                 direction);
    *direction = neph_cosine_sample(place->hit.shading, random);
    return 1.0;
}

/* Whether a direction does not go through the surface, as the shading normal of a smooth mesh may
 * have it; if not, no light comes from there. */
static bool leads_outside(const struct neph_hit *hit, struct neph_vec3 direction)
{
    return neph_vec3_dot(hit->normal, direction) > 0.0;
}

/* Light of beams that a surface on a path reflects. */
static struct neph_rgb lit_surface(const struct neph_scene *scene, const struct place *place)
{
    const double metalness = place->hit.solid->surface.metalness;
    struct neph_rgb diffuse, glossy;
    reflect_beams(scene, place, &diffuse, &glossy);
    return neph_rgb_mul(place->color, neph_rgb_add(neph_rgb_scale(diffuse, 1.0 - metalness),
                                                   neph_rgb_scale(glossy, metalness)));
}

/* Trace the light that arrives from a direction: environment light directly, or light from
 * surfaces. */
static void follow(const struct neph_scene *scene, int bounces, struct neph_vec3 point_m,
                   struct neph_vec3 direction, double worth, struct neph_random *random,
                   struct neph_rgb *direct, struct neph_rgb *indirect)
{
    struct neph_rgb value = neph_rgb_scale(white, worth), *escaped = direct;
    for (int met = 0; survives(&value, random); met++, escaped = indirect) {
        const struct neph_hit hit = neph_scene_hit(scene, point_m, direction);
        if (!hit.solid && scene->environment_light)
            *escaped = neph_rgb_add(*escaped, neph_rgb_mul(value, scene->background_w_per_m2_sr));
        if (!hit.solid || met == bounces)
            return;
        const struct place place = hit_surface_place(&hit, point_m, direction);
        *indirect = neph_rgb_add(*indirect, neph_rgb_mul(value, lit_surface(scene, &place)));
        point_m = place.point_m;
        value = neph_rgb_mul(value, neph_rgb_scale(place.color, leave(&place, random, &direction)));
        if (!(largest_throughput(value) > 0.0) || !leads_outside(&place.hit, direction))
            return;
    }
}

/* Whether a direction leads to a point in the frame. */
static bool leads_on_screen(const struct neph_scene *scene, const struct neph_screen *screen,
                            struct neph_vec3 point_m, struct neph_vec3 direction)
{
    const struct neph_hit hit = neph_scene_hit(scene, point_m, direction);
    if (!screen || !hit.solid)
        return false;
    const struct neph_vec3 met_m = neph_vec3_along(point_m, direction, hit.t_m);
    return neph_is_on_screen(scene, screen, neph_hit_outside_m(&hit, met_m));
}

/* ---- views ----------------------------------------------------------------------------------- */

static struct place viewed(const struct neph_reflected_view *view)
{
    return (struct place){.hit = view->hit, .point_m = view->point_m, .from = view->from};
}

struct neph_reflected_view neph_reflected_view(const struct neph_scene *scene,
                                               struct neph_vec3 origin_m,
                                               struct neph_vec3 direction)
{
    struct neph_reflected_view view = {.hit = neph_scene_hit(scene, origin_m, direction)};
    if (!view.hit.solid)
        return view;
    const struct place place = hit_surface_place(&view.hit, origin_m, direction);
    const double metalness = place.hit.solid->surface.metalness;
    view.point_m = place.point_m;
    view.from = place.from;
    view.color[0] = neph_rgb_scale(place.color, 1.0 - metalness);
    view.color[1] = neph_rgb_scale(place.color, metalness);
    reflect_beams(scene, &place, &view.direct[0], &view.direct[1]);
    return view;
}

struct neph_reflected neph_reflected_sample(const struct neph_scene *scene,
                                            const struct neph_reflected_view *view,
                                            const struct neph_reflected_limits *limits,
                                            struct neph_random *random)
{
    const struct neph_surface *surface = &view->hit.solid->surface;
    const struct place place = viewed(view);
    struct neph_reflected light = {{{0, 0, 0}}};
    struct neph_rgb *part = light.part;
    struct neph_vec3 direction = neph_cosine_sample(place.hit.shading, random);
    bool is_open = leads_outside(&place.hit, direction);
    const struct neph_hit ahead = neph_scene_hit(scene, place.point_m, direction);
    bool shown = leads_on_screen(scene, limits->screen, place.point_m, direction);
    part[NEPH_AMBIENT] = is_open && (ahead.t_m > limits->ao_distance_m || !ahead.solid) ? white
                                                                                        : black;
    part[NEPH_AMBIENT_ON_SCREEN] = shown ? part[NEPH_AMBIENT] : white;
    if (surface->metalness < 1.0) {
        part[NEPH_DIFFUSE_DIRECT] = view->direct[0];
        if (is_open)
            follow(scene, limits->bounces, place.point_m, direction, 1.0, random,
                   &part[NEPH_DIFFUSE_DIRECT], &part[NEPH_DIFFUSE_INDIRECT]);
        part[NEPH_DIFFUSE_ON_SCREEN] = shown ? part[NEPH_DIFFUSE_INDIRECT] : black;
    }
    if (surface->metalness > 0.0) {
        part[NEPH_GLOSSY_DIRECT] = view->direct[1];
        const double worth = neph_metal_sample(surface->roughness, place.hit.shading, place.from,
                                               random, &direction);
        is_open = worth > 0.0 && leads_outside(&place.hit, direction);
        if (is_open) {
            follow(scene, limits->bounces, place.point_m, direction, worth, random,
                   &part[NEPH_GLOSSY_DIRECT], &part[NEPH_GLOSSY_INDIRECT]);
            shown = leads_on_screen(scene, limits->screen, place.point_m, direction);
        }
        part[NEPH_GLOSSY_ON_SCREEN] = is_open && shown ? part[NEPH_GLOSSY_INDIRECT] : black;
    }
    return light;
}

struct neph_rgb neph_reflected_radiance(const struct neph_reflected_view *view,
                                        const struct neph_reflected *light)
{
    const struct neph_rgb *part = light->part;
    return neph_rgb_add(neph_rgb_mul(view->color[0], neph_rgb_add(part[NEPH_DIFFUSE_DIRECT],
                                                                  part[NEPH_DIFFUSE_INDIRECT])),
                        neph_rgb_mul(view->color[1], neph_rgb_add(part[NEPH_GLOSSY_DIRECT],
                                                                  part[NEPH_GLOSSY_INDIRECT])));
}

/* ---- scenes that can be rendered --------------------------------------------------------- */

static const char *find_obstacle(const struct neph_scene *scene)
{
    int mirrors = 0, curved = 0;
    for (int i = 0; i < scene->solid_count; i++) {
        const bool is_mirror = neph_is_mirror(&scene->solids[i].surface);
        mirrors += is_mirror;
        curved += is_mirror && scene->solids[i].kind != NEPH_SOLID_BOX;
    }
    if (scene->medium_count > 0)
        return "media: this is light between solids in clear air";
    if (neph_coverage_obstacle(scene))
        return neph_coverage_obstacle(scene);
    if ((scene->sun.present || scene->light_count > 0) && (curved > 0 || mirrors > 1))
        return "sun or lights with a mirrored sphere or mesh, or several mirrors: no path finds "
               "their reflected light; give them a roughness";
    return NULL;
}

bool neph_reflected_is_supported(const struct neph_scene *scene, char *reason, size_t reason_size)
{
    const char *obstacle = find_obstacle(scene);
    if (obstacle)
        snprintf(reason, reason_size, "%s", obstacle);
    return !obstacle;
}
