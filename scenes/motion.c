/* SPDX-License-Identifier: MIT */
#include "scenes/motion.h"

#include "scenes/load.h"
#include "scenes/media.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* --- between keys ---------------------------------------------------------------------------- */

/* The keys around a frame, and how far it is from the one to the other: 0..1. */
struct span {
    int from, to;
    double part;
};

/* `keys` is an array of structures of `size` bytes that begin with their frame. */
static double frame_of(const void *keys, size_t size, int index)
{
    return *(const double *)((const char *)keys + (size_t)index * size);
}

static struct span span_at(const void *keys, size_t size, int count, double frame)
{
    const int last = count - 1;
    if (frame <= frame_of(keys, size, 0))
        return (struct span){0, 0, 0.0};
    if (frame >= frame_of(keys, size, last))
        return (struct span){last, last, 0.0};
    int from = 0, to = last;
    while (to - from > 1) {
        const int middle = (from + to) / 2;
        if (frame_of(keys, size, middle) <= frame)
            from = middle;
        else
            to = middle;
    }
    const double start = frame_of(keys, size, from), end = frame_of(keys, size, to);
    return (struct span){from, to, (frame - start) / (end - start)};
}

static struct neph_vec3 mix(struct neph_vec3 a, struct neph_vec3 b, double part)
{
    return neph_vec3_add(neph_vec3_scale(a, 1.0 - part), neph_vec3_scale(b, part));
}

static struct neph_rgb mix_rgb(struct neph_rgb a, struct neph_rgb b, double part)
{
    return neph_rgb_add(neph_rgb_scale(a, 1.0 - part), neph_rgb_scale(b, part));
}

/* Shoemake, "Animating Rotation with Quaternion Curves", SIGGRAPH 1985, for unit vectors that are
 * not opposite. The angle has digits at any size; an error of it cancels in small ones. */
static struct neph_vec3 slerp(struct neph_vec3 a, struct neph_vec3 b, double part)
{
    const double angle_rad = atan2(neph_vec3_length(neph_vec3_cross(a, b)), neph_vec3_dot(a, b));
    if (angle_rad == 0.0)
        return a;
    const struct neph_vec3 start = neph_vec3_scale(a, sin((1.0 - part) * angle_rad));
    return neph_vec3_normalize(neph_vec3_along(start, b, sin(part * angle_rad)));
}

/* --- pictures and keys ----------------------------------------------------------------------- */

double neph_scene_time_frame(const struct neph_scene *scene, double frame)
{
    for (int i = 0; i < scene->pause_count; i++)
        if (frame > scene->pauses[i].frame)
            frame = fmax(scene->pauses[i].frame, frame - scene->pauses[i].count);
    return frame;
}

void neph_scene_frame_size(const struct neph_scene *scene, double frame, int *width_px,
                           int *height_px)
{
    double scale = 1.0;
    for (int i = 0; i < scene->frame_scale_count && scene->frame_scales[i].frame <= frame; i++)
        scale = scene->frame_scales[i].scale;
    *width_px = (int)fmax(1.0, round(*width_px * scale));
    *height_px = (int)fmax(1.0, round(*height_px * scale));
}

/* --- camera ---------------------------------------------------------------------------------- */

struct neph_camera_key neph_camera_key_at(const struct neph_scene *scene, double key_frame)
{
    const struct neph_camera_key *keys = scene->camera_keys;
    const struct span span = span_at(keys, sizeof(*keys), scene->camera_key_count, key_frame);
    const struct neph_camera_key *a = &keys[span.from], *b = &keys[span.to];
    const double part = b->cut ? 0.0 : span.part;
    return (struct neph_camera_key){
        .frame = key_frame,
        .position_m = mix(a->position_m, b->position_m, part),
        .look_at_m = mix(a->look_at_m, b->look_at_m, part),
    };
}

struct neph_camera neph_scene_camera(const struct neph_scene *scene, double frame)
{
    struct neph_camera_key key = neph_camera_key_at(scene, neph_scene_time_frame(scene, frame));
    struct neph_camera camera = {.position_m = key.position_m,
                                 .vertical_fov_rad = scene->vertical_fov_rad,
                                 .orthographic_height_m = scene->orthographic_height_m};
    camera.forward = neph_vec3_normalize(neph_vec3_sub(key.look_at_m, key.position_m));
    camera.right = neph_vec3_normalize(neph_vec3_cross(camera.forward, scene->camera_up));
    camera.up = neph_vec3_cross(camera.right, camera.forward);
    return camera;
}

double neph_camera_half_height(const struct neph_camera *camera)
{
    return camera->orthographic_height_m > 0.0 ? 0.5 * camera->orthographic_height_m
                                               : tan(0.5 * camera->vertical_fov_rad);
}

/* Pixels are square. Blender and POV-Ray were measured to use the same rays. */
struct neph_pixel_ray neph_camera_ray(const struct neph_camera *camera, int width_px, int height_px,
                                      double i, double j)
{
    const bool is_parallel = camera->orthographic_height_m > 0.0;
    const double half_height = neph_camera_half_height(camera);
    const double half_width = half_height * width_px / height_px;
    const double x = (2.0 * (i + 0.5) / width_px - 1.0) * half_width;
    const double y = (1.0 - 2.0 * (j + 0.5) / height_px) * half_height;
    const struct neph_vec3 middle = is_parallel ? camera->position_m : camera->forward;
    const struct neph_vec3 place = neph_vec3_along(neph_vec3_along(middle, camera->right, x),
                                                   camera->up, y);
    if (is_parallel)
        return (struct neph_pixel_ray){place, camera->forward};
    return (struct neph_pixel_ray){camera->position_m, neph_vec3_normalize(place)};
}

bool neph_scene_is_cut(const struct neph_scene *scene, double frame_from, double frame_to)
{
    const double earlier = neph_scene_time_frame(scene, fmin(frame_from, frame_to));
    const double later = neph_scene_time_frame(scene, fmax(frame_from, frame_to));
    for (int i = 0; i < scene->camera_key_count; i++) {
        const struct neph_camera_key *key = &scene->camera_keys[i];
        if (key->cut && key->frame > earlier && key->frame <= later)
            return true;
    }
    return false;
}

/* --- sun and wind ---------------------------------------------------------------------------- */

struct neph_sun neph_scene_sun(const struct neph_scene *scene, double frame)
{
    if (scene->sun_key_count == 0)
        return scene->sun;
    const struct neph_sun_key *keys = scene->sun_keys;
    const struct span span = span_at(keys, sizeof(*keys), scene->sun_key_count,
                                     neph_scene_time_frame(scene, frame));
    const struct neph_sun_key *a = &keys[span.from], *b = &keys[span.to];
    return (struct neph_sun){
        .present = true,
        .direction = slerp(a->direction, b->direction, span.part),
        .irradiance_w_per_m2 = mix_rgb(a->irradiance_w_per_m2, b->irradiance_w_per_m2, span.part),
    };
}

static struct neph_vec3 velocity_at(const struct neph_scene *scene, double key_frame)
{
    const struct neph_wind_key *keys = scene->wind_keys;
    const struct span span = span_at(keys, sizeof(*keys), scene->wind_key_count, key_frame);
    return mix(keys[span.from].velocity_m_per_s, keys[span.to].velocity_m_per_s, span.part);
}

/* The integral of the velocity over frames [start, end], cut at the keys: what is linear has the
 * value of its middle as its mean. */
static struct neph_vec3 integrate_wind(const struct neph_scene *scene, double start, double end)
{
    struct neph_vec3 sum = {0, 0, 0};
    for (int i = 0; i <= scene->wind_key_count && start < end; i++) {
        const double cut = i < scene->wind_key_count ? fmin(scene->wind_keys[i].frame, end) : end;
        if (cut <= start)
            continue;
        sum = neph_vec3_along(sum, velocity_at(scene, 0.5 * (start + cut)), cut - start);
        start = cut;
    }
    return sum;
}

struct neph_vec3 neph_scene_wind_displacement_m(const struct neph_scene *scene, double frame)
{
    if (scene->wind_key_count == 0)
        return (struct neph_vec3){0, 0, 0};
    const double key_frame = neph_scene_time_frame(scene, frame);
    const double frame_s = (key_frame < 0.0 ? -1.0 : 1.0) / scene->frame_rate_hz;
    return neph_vec3_scale(integrate_wind(scene, fmin(0.0, key_frame), fmax(0.0, key_frame)),
                           frame_s);
}

bool neph_scene_moves(const struct neph_scene *scene)
{
    return scene->sun_key_count > 0 || scene->wind_key_count > 0;
}

/* All that engines take from the time of a picture; doubles alone, so that bytes can be compared.
 */
struct moment {
    struct neph_camera camera;
    struct neph_vec3 sun_direction, wind_m;
    struct neph_rgb sun_w_per_m2;
    double width_px, height_px; /* of the largest picture */
};
_Static_assert(sizeof(struct moment) == 25 * sizeof(double), "no padding");

static struct moment moment_at(const struct neph_scene *scene, double frame)
{
    const struct neph_sun sun = neph_scene_sun(scene, frame);
    int width_px = 16384, height_px = 16384;
    neph_scene_frame_size(scene, frame, &width_px, &height_px);
    return (struct moment){
        .camera = neph_scene_camera(scene, frame),
        .sun_direction = sun.direction,
        .sun_w_per_m2 = sun.irradiance_w_per_m2,
        .wind_m = neph_scene_wind_displacement_m(scene, frame),
        .width_px = width_px,
        .height_px = height_px,
    };
}

bool neph_scene_is_same_moment(const struct neph_scene *scene, double frame_a, double frame_b)
{
    const struct moment a = moment_at(scene, frame_a), b = moment_at(scene, frame_b);
    return memcmp(&a, &b, sizeof(a)) == 0;
}

/* --- a scene that stands still --------------------------------------------------------------- */

/* One block, so that it is freed at once; the scene comes first. */
struct still {
    struct neph_scene scene;
    struct neph_camera_key camera_key;
    max_align_t rooms[]; /* what media need to drift by themselves */
};

static size_t units_of(const struct neph_medium *medium)
{
    return (neph_medium_room(medium) + sizeof(max_align_t) - 1) / sizeof(max_align_t);
}

/* Media of its own, so that they can be moved. */
static void place_media(struct still *still, struct neph_vec3 by_m)
{
    max_align_t *room = still->rooms;
    for (int i = 0; i < still->scene.medium_count; i++) {
        struct neph_medium *medium = &still->scene.media[i];
        neph_medium_borrow(medium, room);
        room += units_of(medium);
        neph_medium_drift(medium, by_m);
    }
}

/* Without the keys, which are in the numbers now. */
static void stop_time(struct neph_scene *scene)
{
    scene->pause_count = scene->frame_scale_count = 0;
    scene->sun_key_count = scene->wind_key_count = 0;
    scene->pauses = NULL;
    scene->frame_scales = NULL;
    scene->sun_keys = NULL;
    scene->wind_keys = NULL;
}

enum neph_status neph_scene_at(const struct neph_scene *scene, double frame,
                               struct neph_scene **still, struct neph_diag *diag)
{
    size_t units = 0;
    for (int i = 0; i < scene->medium_count; i++)
        units += units_of(&scene->media[i]);
    struct still *made = calloc(1, sizeof(*made) + units * sizeof(made->rooms[0]));
    if (!made)
        return neph_fail_memory(diag);
    made->scene = *scene;
    made->scene.borrows = true;
    made->camera_key = neph_camera_key_at(scene, neph_scene_time_frame(scene, frame));
    made->scene.camera_keys = &made->camera_key;
    made->scene.camera_key_count = 1;
    made->scene.sun = neph_scene_sun(scene, frame);
    place_media(made, neph_scene_wind_displacement_m(scene, frame));
    stop_time(&made->scene);
    *still = &made->scene;
    return NEPH_OK;
}
