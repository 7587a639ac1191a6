/* SPDX-License-Identifier: MIT */
#include "harness/engines/cycles_layers.h"

#include <stdio.h>
#include <string.h>

static const struct {
    const char *name, *in_full;
} names[] = {
    {"VolumeDir", "Volume Direct"}, {"VolumeInd", "Volume Indirect"}, {"Emit", "Emission"},
    {"DiffDir", "Diffuse Direct"},  {"DiffInd", "Diffuse Indirect"},  {"DiffCol", "Diffuse Color"},
    {"GlossDir", "Glossy Direct"},  {"GlossInd", "Glossy Indirect"},  {"GlossCol", "Glossy Color"},
    {"AO", "Ambient Occlusion"},
};

enum neph_status neph_cycles_layer(const struct neph_image *image, const char *name,
                                   float *channels[3], struct neph_diag *diag)
{
    char layer[64];
    snprintf(layer, sizeof(layer), "pass.%s", name);
    if (neph_image_rgb(image, layer, channels))
        return NEPH_OK;
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
        snprintf(layer, sizeof(layer), "pass.%s", names[i].in_full);
        if (strcmp(names[i].name, name) == 0 && neph_image_rgb(image, layer, channels))
            return NEPH_OK;
    }
    return neph_fail(diag, NEPH_ERR_ENGINE, "Blender's image has no layer 'pass.%s'", name);
}

enum neph_status neph_cycles_depth(const struct neph_image *image, const float **depth,
                                   struct neph_diag *diag)
{
    static const char *const channels[] = {"pass.Depth.Z", "pass.Depth.V"};
    for (size_t i = 0; i < sizeof(channels) / sizeof(channels[0]); i++)
        if ((*depth = neph_image_channel(image, channels[i])))
            return NEPH_OK;
    return neph_fail(diag, NEPH_ERR_ENGINE, "Blender's image has no depth");
}
