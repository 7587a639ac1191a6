/* SPDX-License-Identifier: MIT */
#include "base/image_window.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct neph_window neph_image_window(const struct neph_image *image)
{
    const struct neph_file_header *header = image->header;
    struct neph_window window = {.size_px = {image->width_px, image->height_px},
                                 .display_px = {image->width_px, image->height_px}};
    for (int axis = 0; header && axis < 2; axis++) {
        window.min_px[axis] = (int64_t)header->data_min_px[axis] - header->display_min_px[axis];
        window.display_px[axis] = header->display_px[axis];
    }
    return window;
}

bool neph_window_is_equal(const struct neph_window *a, const struct neph_window *b)
{
    bool is_equal = true;
    for (int axis = 0; axis < 2; axis++)
        is_equal &= a->min_px[axis] == b->min_px[axis] && a->size_px[axis] == b->size_px[axis] &&
                    a->display_px[axis] == b->display_px[axis];
    return is_equal;
}

static enum neph_status check(const struct neph_image *image, const struct neph_window *from,
                              const struct neph_window *to, struct neph_diag *diag)
{
    const double needed = (double)image->channel_count * (double)to->size_px[0] *
                          (double)to->size_px[1] * sizeof(float);
    const double memory = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE);
    for (int axis = 0; axis < 2; axis++) {
        if (from->display_px[axis] != to->display_px[axis])
            return neph_fail(diag, NEPH_ERR_INPUT,
                             "the display window has %lldx%lld pixels, that of other frames "
                             "%lldx%lld",
                             (long long)from->display_px[0], (long long)from->display_px[1],
                             (long long)to->display_px[0], (long long)to->display_px[1]);
        if (to->size_px[axis] < 1 || to->size_px[axis] > NEPH_IMAGE_SIDE_MAX_PX)
            return neph_fail(diag, NEPH_ERR_INPUT,
                             "a data window of %lldx%lld pixels; allowed are 1 to %d per side",
                             (long long)to->size_px[0], (long long)to->size_px[1],
                             NEPH_IMAGE_SIDE_MAX_PX);
    }
    if (needed <= memory)
        return NEPH_OK;
    return neph_fail(diag, NEPH_ERR_MEMORY,
                     "%d channels of %lldx%lld pixels need %.0f GB of memory; this machine has "
                     "%.0f GB",
                     image->channel_count, (long long)to->size_px[0], (long long)to->size_px[1],
                     needed / 1e9, memory / 1e9);
}

/* Copy the rectangle that both windows have. */
static void copy_common(const float *samples, const struct neph_window *from, float *placed,
                        const struct neph_window *to)
{
    int64_t first[2], last[2]; /* in pixels of the display window; behind the last one */
    for (int axis = 0; axis < 2; axis++) {
        const int64_t ends[2] = {from->min_px[axis] + from->size_px[axis],
                                 to->min_px[axis] + to->size_px[axis]};
        first[axis] = from->min_px[axis] > to->min_px[axis] ? from->min_px[axis] : to->min_px[axis];
        last[axis] = ends[0] < ends[1] ? ends[0] : ends[1];
    }
    for (int64_t y = first[1]; y < last[1] && first[0] < last[0]; y++)
        memcpy(placed + (y - to->min_px[1]) * to->size_px[0] + first[0] - to->min_px[0],
               samples + (y - from->min_px[1]) * from->size_px[0] + first[0] - from->min_px[0],
               (size_t)(last[0] - first[0]) * sizeof(*placed));
}

static enum neph_status place_channel(struct neph_channel *channel, const struct neph_window *from,
                                      const struct neph_window *to, float value,
                                      struct neph_diag *diag)
{
    const size_t count = (size_t)to->size_px[0] * (size_t)to->size_px[1];
    float *placed = calloc(count, sizeof(*placed));
    if (!placed)
        return neph_fail_memory(diag);
    for (size_t i = 0; i < count && value != 0.0f; i++)
        placed[i] = value;
    copy_common(channel->samples, from, placed, to);
    free(channel->samples);
    channel->samples = placed;
    return NEPH_OK;
}

enum neph_status neph_image_set_window(struct neph_image *image, const struct neph_window *to,
                                       struct neph_diag *diag)
{
    if (!image->header) {
        struct neph_file_header *header = calloc(1, sizeof(*header));
        if (!header)
            return neph_fail_memory(diag);
        header->pixel_aspect = header->screen_width = 1.0f;
        image->header = header;
    }
    for (int axis = 0; axis < 2; axis++) {
        image->header->data_min_px[axis] = (int32_t)(image->header->display_min_px[axis] +
                                                     to->min_px[axis]);
        image->header->display_px[axis] = (int32_t)to->display_px[axis];
    }
    if (to->min_px[0] == 0 && to->min_px[1] == 0 && to->size_px[0] == to->display_px[0] &&
        to->size_px[1] == to->display_px[1]) {
        neph_image_remove_attribute(image, "crop");
        return NEPH_OK;
    }
    return neph_image_set_attribute(image, "crop", diag, "(%lld, %lld) of %lldx%lld",
                                    (long long)to->min_px[0], (long long)to->min_px[1],
                                    (long long)to->display_px[0], (long long)to->display_px[1]);
}

enum neph_status neph_image_place(struct neph_image *image, const struct neph_window *window,
                                  float (*outside)(const char *channel), struct neph_diag *diag)
{
    const struct neph_window from = neph_image_window(image);
    if (neph_window_is_equal(&from, window))
        return NEPH_OK;
    enum neph_status status = check(image, &from, window, diag);
    for (int c = 0; c < image->channel_count && !status; c++)
        status = place_channel(&image->channels[c], &from, window, outside(image->channels[c].name),
                               diag);
    if (status)
        return status;
    image->width_px = (int)window->size_px[0];
    image->height_px = (int)window->size_px[1];
    return neph_image_set_window(image, window, diag);
}
