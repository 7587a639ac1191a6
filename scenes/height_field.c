/* SPDX-License-Identifier: MIT */
#include "scenes/height_field.h"

#include "base/exr.h"
#include "base/png.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* Values of an image, row by row from the top. */
struct heights {
    int width_px, height_px;
    float *values; /* owned */
};

static enum neph_status read_png(const char *path, struct heights *heights, struct neph_diag *diag)
{
    uint16_t *codes = NULL;
    enum neph_status status = neph_png_read_grey16(path, &heights->width_px, &heights->height_px,
                                                   &codes, diag);
    if (status)
        return status;
    const size_t count = (size_t)heights->width_px * (size_t)heights->height_px;
    heights->values = malloc(count * sizeof(*heights->values));
    for (size_t i = 0; i < count && heights->values; i++)
        heights->values[i] = (float)(codes[i] / 65535.0);
    free(codes);
    return heights->values ? NEPH_OK : neph_fail_memory(diag);
}

static const struct neph_channel *find_channel(const struct neph_image *image, const char *name)
{
    for (int i = 0; i < image->channel_count; i++)
        if (strcmp(image->channels[i].name, name) == 0)
            return &image->channels[i];
    return NULL;
}

static enum neph_status read_exr(const char *path, const char *name, struct heights *heights,
                                 struct neph_diag *diag)
{
    struct neph_image *image = NULL;
    enum neph_status status = neph_exr_read(path, &image, diag);
    if (status)
        return status;
    const struct neph_channel *channel = !name && image->channel_count == 1
                                             ? &image->channels[0]
                                             : find_channel(image, name ? name : "R");
    const size_t count = (size_t)image->width_px * (size_t)image->height_px;
    heights->width_px = image->width_px;
    heights->height_px = image->height_px;
    if (!channel) {
        status = neph_fail(diag, NEPH_ERR_INPUT, "'%s' has no channel '%s'", path,
                           name ? name : "R");
        neph_hint(diag, "`channel` names one; the first of its %d is '%s'", image->channel_count,
                  image->channels[0].name);
    } else if (!(heights->values = malloc(count * sizeof(*heights->values)))) {
        status = neph_fail_memory(diag);
    } else {
        memcpy(heights->values, channel->samples, count * sizeof(*heights->values));
    }
    neph_image_destroy(image);
    return status;
}

static bool has_extension(const char *path, const char *extension)
{
    const char *dot = strrchr(path, '.');
    return dot && strcasecmp(dot, extension) == 0;
}

static enum neph_status read_heights(const char *path, const char *channel, struct heights *heights,
                                     struct neph_diag *diag)
{
    if (has_extension(path, ".exr"))
        return read_exr(path, channel, heights, diag);
    if (!has_extension(path, ".png"))
        return neph_fail(diag, NEPH_ERR_INPUT, "'%s' must end in .png or .exr", path);
    if (channel)
        return neph_fail(diag, NEPH_ERR_INPUT, "'%s' has one channel: leave `channel` out", path);
    return read_png(path, heights, diag);
}

static enum neph_status check(const char *path, const struct heights *heights,
                              struct neph_diag *diag)
{
    const int width = heights->width_px, height = heights->height_px;
    const long long triangles = 2LL * (width - 1) * (height - 1);
    if (width < 2 || height < 2)
        return neph_fail(diag, NEPH_ERR_INPUT, "'%s' has %dx%d pixels; heights need 2x2 or more",
                         path, width, height);
    if (triangles > NEPH_MESH_TRIANGLES_MAX) {
        neph_fail(diag, NEPH_ERR_INPUT,
                  "'%s' has %dx%d pixels: %lld triangles; a mesh has at most %d", path, width,
                  height, triangles, NEPH_MESH_TRIANGLES_MAX);
        neph_hint(diag, "707x707 pixels are allowed: make the image smaller, or cut it into parts");
        return NEPH_ERR_INPUT;
    }
    for (int i = 0; i < width * height; i++)
        if (!isfinite(heights->values[i]))
            return neph_fail(diag, NEPH_ERR_INPUT, "'%s': the height at pixel (%d, %d) is %g", path,
                             i % width, i / width, (double)heights->values[i]);
    return NEPH_OK;
}

/* The outer places are exactly the sides. */
static double find_place_m(double low_m, double high_m, int at, int last)
{
    return at == last ? high_m : low_m + (high_m - low_m) * at / last;
}

/* Adds twice the area of each triangle along its normal, which points up, to its vertices. */
static void add_normals(struct neph_mesh_data *data)
{
    for (int i = 0; i < data->triangle_count; i++) {
        const int *corners = data->triangles[i];
        const struct neph_vec3 a = data->positions[corners[0]];
        const struct neph_vec3 area = neph_vec3_cross(
            neph_vec3_sub(data->positions[corners[1]], a),
            neph_vec3_sub(data->positions[corners[2]], a));
        for (int k = 0; k < 3; k++)
            data->normals[corners[k]] = neph_vec3_add(data->normals[corners[k]], area);
    }
}

static void set_uv(struct neph_mesh_data *data, int columns, int rows)
{
    for (int i = 0; i < data->vertex_count; i++) {
        data->uv[i][0] = (float)find_place_m(0.0, 1.0, i % columns, columns - 1);
        data->uv[i][1] = (float)find_place_m(1.0, 0.0, i / columns, rows - 1);
    }
}

static enum neph_status make_mesh(const struct neph_height_field *field,
                                  const struct heights *heights, struct neph_mesh_data *data,
                                  struct neph_diag *diag)
{
    const struct neph_bounds *box = &field->box;
    const int columns = heights->width_px, rows = heights->height_px;
    struct neph_mesh_data made = {.vertex_count = columns * rows,
                                  .triangle_count = 2 * (columns - 1) * (rows - 1)};
    const size_t count = (size_t)made.vertex_count;
    made.positions = malloc(count * sizeof(*made.positions));
    made.triangles = malloc((size_t)made.triangle_count * sizeof(*made.triangles));
    made.normals = field->has_normals ? calloc(count, sizeof(*made.normals)) : NULL;
    made.uv = field->has_uv ? malloc(count * sizeof(*made.uv)) : NULL;
    if (!made.positions || !made.triangles || (field->has_normals && !made.normals) ||
        (field->has_uv && !made.uv)) {
        neph_mesh_data_finish(&made);
        return neph_fail_memory(diag);
    }
    for (int i = 0; i < made.vertex_count; i++)
        made.positions[i] = (struct neph_vec3){
            find_place_m(box->min_m.x, box->max_m.x, i % columns, columns - 1),
            box->min_m.y + (box->max_m.y - box->min_m.y) * (double)heights->values[i],
            find_place_m(box->min_m.z, box->max_m.z, i / columns, rows - 1)};
    for (int cell = 0; cell < made.triangle_count / 2; cell++) {
        const int a = cell / (columns - 1) * columns + cell % (columns - 1);
        const int corners[2][3] = {{a, a + columns, a + 1}, {a + 1, a + columns, a + columns + 1}};
        memcpy(made.triangles[2 * cell], corners, sizeof(corners));
    }
    if (made.normals)
        add_normals(&made);
    if (made.uv)
        set_uv(&made, columns, rows);
    *data = made;
    return NEPH_OK;
}

enum neph_status neph_height_field_read(const struct neph_height_field *field,
                                        struct neph_mesh_data *data, struct neph_diag *diag)
{
    struct heights heights = {0};
    enum neph_status status = read_heights(field->path, field->channel, &heights, diag);
    if (!status)
        status = check(field->path, &heights, diag);
    if (!status)
        status = make_mesh(field, &heights, data, diag);
    free(heights.values);
    return status;
}
