/* SPDX-License-Identifier: MIT */
#include "renderer/post/metadata.h"

#include <string.h>

static enum neph_status copy_others(const struct neph_image *from, struct neph_image *to,
                                    struct neph_diag *diag)
{
    const bool fits = from->width_px == to->width_px && from->height_px == to->height_px;
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < from->channel_count && fits && !status; i++) {
        const struct neph_channel *channel = &from->channels[i];
        float *samples;
        if (strcmp(channel->name, "Z") != 0 && strncmp(channel->name, "mask.", 5) != 0 &&
            strncmp(channel->name, "motion.", 7) != 0)
            continue;
        status = neph_image_add_channel(to, channel->name, &samples, diag);
        if (!status)
            memcpy(samples, channel->samples, neph_image_pixel_count(from) * sizeof(*samples));
    }
    return status;
}

enum neph_status neph_post_copy_metadata(const struct neph_image *from, struct neph_image *to,
                                         struct neph_diag *diag)
{
    const enum neph_status status = neph_image_copy_labels(from, to, diag);
    return status ? status : copy_others(from, to, diag);
}
