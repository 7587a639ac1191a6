/* SPDX-License-Identifier: MIT */
#include "metrics/metric.h"

#include <string.h>

/* Units as in base/image.h. */
static const struct neph_quantity quantities[] = {
    {"radiance", "W m^-2 sr^-1", "radiance with everything, R G B jointly", NULL, 3, NEPH_RADIANCE},
    {"volume", "W m^-2 sr^-1", "in-scattered radiance alone, R G B jointly", "volume", 3,
     NEPH_VOLUME},
    {"transmittance", "1", "camera to the first solid or to infinity, R G B jointly",
     "transmittance", 3, NEPH_TRANSMITTANCE},
    {"depth", "m", "linear eye depth where both images see a solid", "Z", 1, NEPH_DEPTH},
};

enum { QUANTITY_COUNT = sizeof(quantities) / sizeof(quantities[0]) };

int neph_quantity_count(void)
{
    return QUANTITY_COUNT;
}

const struct neph_quantity *neph_quantity_at(int index)
{
    return index >= 0 && index < QUANTITY_COUNT ? &quantities[index] : NULL;
}

const struct neph_quantity *neph_quantity_find(const char *name)
{
    for (int i = 0; i < QUANTITY_COUNT; i++)
        if (strcmp(quantities[i].name, name) == 0)
            return &quantities[i];
    return NULL;
}

bool neph_quantity_planes(const struct neph_quantity *quantity, const struct neph_image *image,
                          const float *planes[3])
{
    float *found[3] = {NULL, NULL, NULL};
    if (quantity->plane_count == 3 && !neph_image_rgb(image, quantity->layer, found))
        return false;
    if (quantity->plane_count == 1) {
        found[0] = neph_image_channel(image, quantity->layer);
        if (!found[0])
            return false;
    }
    for (int c = 0; c < 3; c++)
        planes[c] = found[c];
    return true;
}
