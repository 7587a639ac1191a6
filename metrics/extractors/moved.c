/* SPDX-License-Identifier: MIT */
#include "metrics/extractors/moved.h"

static const double opaque_transmittance = 0.5;

static bool find_in(const struct neph_image *image, const char *of, struct neph_moved *moved)
{
    *moved = (struct neph_moved){
        .of = of,
        .x_px = neph_image_channel(image, "motion.x"),
        .y_px = neph_image_channel(image, "motion.y"),
        .depth_m = neph_image_channel(image, "Z"),
        .before_m = neph_image_channel(image, "motion.depth"),
        .distance_m = neph_image_channel(image, "volume.distance"),
    };
    moved->has_transmittance = neph_image_rgb(image, "transmittance", moved->transmittance);
    return moved->x_px && moved->y_px && moved->depth_m;
}

static bool find(const struct neph_frame_pair *pair, struct neph_moved *moved)
{
    return find_in(pair->reference_image, "reference", moved) ||
           find_in(pair->test_image, "test", moved);
}

const char *neph_moved_obstacle(const struct neph_frame_pair *first,
                                const struct neph_settings *settings)
{
    (void)settings;
    struct neph_moved moved;
    return find(first, &moved)
               ? NULL
               : "neither image has both motion vectors (motion.x, motion.y) and depth (Z)";
}

struct check {
    const char *name;
    const float *samples; /* NULL: not there */
    bool any_sign;
};

static enum neph_status check_layer(const struct check *check, const char *of,
                                    const struct neph_frame_pair *pair, struct neph_diag *diag)
{
    const size_t width = (size_t)pair->width_px, count = width * (size_t)pair->height_px;
    for (size_t i = 0; check->samples && i < count; i++)
        if (isnan(check->samples[i]) || (!check->any_sign && check->samples[i] < 0.0f))
            return neph_fail(
                diag, NEPH_ERR_GATE, "'%s' of the %s is %g at the pixel (%zu, %zu) of frame %d",
                check->name, of, (double)check->samples[i], i % width, i / width, pair->frame);
    return NEPH_OK;
}

enum neph_status neph_moved_find(const struct neph_frame_pair *pair, struct neph_moved *moved,
                                 struct neph_diag *diag)
{
    if (!find(pair, moved))
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "frame %d lacks motion.x, motion.y or Z, the first one has them",
                         pair->frame);
    const struct check checks[] = {
        {"motion.x", moved->x_px, true},
        {"motion.y", moved->y_px, true},
        {"Z", moved->depth_m, false},
        {"motion.depth", moved->before_m, false},
        {"volume.distance", moved->distance_m, false},
    };
    enum neph_status status = NEPH_OK;
    for (size_t i = 0; i < sizeof(checks) / sizeof(checks[0]) && !status; i++)
        status = check_layer(&checks[i], moved->of, pair, diag);
    return status;
}

/* Whether the visible point is in a medium, at volume.distance. */
static bool shows_medium(const struct neph_moved *moved, size_t i)
{
    if (!moved->distance_m || isinf(moved->distance_m[i]))
        return false;
    return isinf(moved->depth_m[i]) ||
           (moved->has_transmittance &&
            neph_luminance_at((const float *const *)moved->transmittance, i) <
                opaque_transmittance);
}

/* 1 / depth; depth 0 counts as 1e-30 m. */
static double nearness_per_m(float depth_m)
{
    return 1.0 / fmax((double)depth_m, 1e-30);
}

double neph_moved_nearness_per_m(const struct neph_moved *moved, size_t pixel)
{
    return nearness_per_m(shows_medium(moved, pixel) ? moved->distance_m[pixel]
                                                     : moved->depth_m[pixel]);
}

double neph_moved_nearness_before_per_m(const struct neph_moved *moved, size_t pixel,
                                        double now_per_m)
{
    return moved->before_m && !shows_medium(moved, pixel) ? nearness_per_m(moved->before_m[pixel])
                                                          : now_per_m;
}

enum neph_status neph_kept_init(struct neph_kept frames[2], size_t pixel_count,
                                struct neph_arena *memory, struct neph_diag *diag)
{
    for (int k = 0; k < 2; k++) {
        frames[k].nearness_per_m = neph_arena_allocate(memory, pixel_count, sizeof(double));
        frames[k].planes[0] = neph_arena_allocate(memory, pixel_count, sizeof(double));
        frames[k].planes[1] = neph_arena_allocate(memory, pixel_count, sizeof(double));
        frames[k].age = neph_arena_allocate(memory, pixel_count, sizeof(uint8_t));
        frames[k].flags = neph_arena_allocate(memory, pixel_count, sizeof(uint8_t));
    }
    return neph_arena_check(memory, diag);
}
