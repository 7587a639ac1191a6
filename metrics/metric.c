/* SPDX-License-Identifier: MIT */
#include "metrics/metric.h"

#include "metrics/error.h"

#include <string.h>

#define COUNT_OF(array) ((int)(sizeof(array) / sizeof((array)[0])))

struct family {
    int (*count)(void);
    const struct neph_metric *(*at)(int index);
};

static const struct family families[] = {
    {neph_error_metric_count, neph_error_metric_at},
};

int neph_metric_count(void)
{
    int count = 0;
    for (int i = 0; i < COUNT_OF(families); i++)
        count += families[i].count();
    return count;
}

const struct neph_metric *neph_metric_at(int index)
{
    for (int i = 0; i < COUNT_OF(families); i++) {
        if (index < families[i].count())
            return families[i].at(index);
        index -= families[i].count();
    }
    return NULL;
}

const struct neph_metric *neph_metric_find(const char *name)
{
    for (int i = 0; i < neph_metric_count(); i++)
        if (strcmp(neph_metric_at(i)->name, name) == 0)
            return neph_metric_at(i);
    return NULL;
}

/* Units as in base/image.h. */
static const struct neph_quantity quantities[] = {
    {"radiance", "W m^-2 sr^-1", "radiance with everything, R G B jointly", NULL, 3},
    {"volume", "W m^-2 sr^-1", "in-scattered radiance alone, R G B jointly", "volume", 3},
    {"transmittance", "1", "camera to the first solid or to infinity, R G B jointly",
     "transmittance", 3},
    {"depth", "m", "linear eye depth where both images see a solid", "Z", 1},
};

int neph_quantity_count(void)
{
    return COUNT_OF(quantities);
}

const struct neph_quantity *neph_quantity_at(int index)
{
    return index >= 0 && index < COUNT_OF(quantities) ? &quantities[index] : NULL;
}

const struct neph_quantity *neph_quantity_find(const char *name)
{
    for (int i = 0; i < COUNT_OF(quantities); i++)
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
