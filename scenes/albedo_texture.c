/* SPDX-License-Identifier: MIT */
#include "scenes/albedo_texture.h"

#include "base/png.h"

#include <math.h>
#include <stdlib.h>

enum { CHANNELS = 4 };

enum neph_status neph_albedo_texture_create(int width_px, int height_px, float *rgba,
                                            bool has_alpha, struct neph_albedo_texture **texture,
                                            struct neph_diag *diag)
{
    struct neph_albedo_texture *made = calloc(1, sizeof(*made));
    const size_t bytes = (size_t)width_px * (size_t)height_px * CHANNELS * sizeof(*rgba);
    if (!made) {
        free(rgba);
        return neph_fail_memory(diag);
    }
    *made = (struct neph_albedo_texture){width_px, height_px, rgba, has_alpha, ""};
    char parts[2][NEPH_HASH_HEX_SIZE];
    const int size_px[2] = {width_px, height_px};
    enum neph_status status = neph_hash(size_px, sizeof(size_px), parts[0], diag);
    if (!status)
        status = neph_hash(rgba, bytes, parts[1], diag);
    if (!status)
        status = neph_hash(parts, sizeof(parts), made->hash, diag);
    if (status)
        neph_albedo_texture_destroy(made);
    else
        *texture = made;
    return status;
}

void neph_albedo_texture_destroy(struct neph_albedo_texture *texture)
{
    if (!texture)
        return;
    free(texture->rgba);
    free(texture);
}

enum neph_status neph_albedo_texture_read(const char *path, size_t limit_bytes,
                                          struct neph_albedo_texture **texture,
                                          struct neph_diag *diag)
{
    int width_px, height_px;
    bool has_alpha;
    float *rgba = NULL;
    const enum neph_status status = neph_png_read_rgba(path, limit_bytes, &width_px, &height_px,
                                                       &rgba, &has_alpha, diag);
    return status ? status
                  : neph_albedo_texture_create(width_px, height_px, rgba, has_alpha, texture, diag);
}

/* The two pixels around a coordinate, and the part of the second. */
struct pair {
    int pixels[2];
    double part;
};

static struct pair find_pair(double coordinate, int count)
{
    const double at = (coordinate - floor(coordinate)) * count - 0.5; /* -1/2 .. count - 1/2 */
    const int below = (int)floor(at);
    return (struct pair){{(below + count) % count, (below + 1) % count}, at - below};
}

/* Equal values stay as they are, to the last bit. */
static double mix(double a, double b, double part)
{
    return a + part * (b - a);
}

struct neph_texel neph_albedo_texture_find(const struct neph_albedo_texture *texture, double u,
                                           double v)
{
    const struct pair x = find_pair(u, texture->width_px), y = find_pair(-v, texture->height_px);
    double values[CHANNELS];
    for (int c = 0; c < CHANNELS; c++) {
        double rows[2];
        for (int j = 0; j < 2; j++) {
            const float *row = texture->rgba +
                               (size_t)y.pixels[j] * (size_t)texture->width_px * CHANNELS + c;
            rows[j] = mix((double)row[CHANNELS * x.pixels[0]], (double)row[CHANNELS * x.pixels[1]],
                          x.part);
        }
        values[c] = mix(rows[0], rows[1], y.part);
    }
    return (struct neph_texel){{values[0], values[1], values[2]}, values[3]};
}
