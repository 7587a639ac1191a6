/* SPDX-License-Identifier: MIT */
#include "scenes/emission.h"

const char neph_emission_reason[] = "light that media emit (leave out emission_w_per_m2_sr)";

static double glow(double color, double albedo, double emission)
{
    return color > 0.0 ? (1.0 - albedo) * emission : 0.0;
}

struct neph_rgb neph_medium_glow(const struct neph_medium *medium)
{
    const struct neph_rgb color = medium->extinction_color, albedo = medium->albedo;
    const struct neph_rgb emission = medium->emission_w_per_m2_sr;
    return (struct neph_rgb){glow(color.r, albedo.r, emission.r),
                             glow(color.g, albedo.g, emission.g),
                             glow(color.b, albedo.b, emission.b)};
}

bool neph_medium_emits(const struct neph_medium *medium)
{
    const struct neph_rgb own = neph_medium_glow(medium);
    return own.r > 0.0 || own.g > 0.0 || own.b > 0.0;
}

bool neph_scene_emits(const struct neph_scene *scene)
{
    for (int m = 0; m < scene->medium_count; m++)
        if (neph_medium_emits(&scene->media[m]))
            return true;
    return false;
}
