/* SPDX-License-Identifier: MIT
 *
 * Triangle meshes that tests create in memory.
 */
#ifndef NEPH_TESTS_MESH_BUILDERS_H
#define NEPH_TESTS_MESH_BUILDERS_H

#include "tests/scene_builders.h"

#include "scenes/mesh.h"

/* A 16-bit grey PNG of 3 x 2 pixels: 0, 1, 1/5; 2/5, 3/5, 4/5. */
static const uint8_t hills_png[] = {
    137, 80,  78,  71,  13,  10, 26,  10,  0,   0,   0,   13,  73,  72,  68,  82,  0,  0,   0,  3,
    0,   0,   0,   2,   16,  0,  0,   0,   0,   232, 143, 229, 133, 0,   0,   0,   22, 73,  68, 65,
    84,  120, 156, 99,  96,  96, 248, 255, 223, 216, 152, 33,  45,  109, 230, 204, 51, 103, 0,  35,
    81,  5,   251, 216, 231, 55, 35,  0,   0,   0,   0,   73,  69,  78,  68,  174, 66, 96,  130};

static inline void test_end_mesh(struct neph_mesh **mesh)
{
    neph_mesh_destroy(*mesh);
}

static inline struct neph_mesh_data allocate_mesh(int vertices, int triangles)
{
    struct neph_mesh_data data = {.vertex_count = vertices, .triangle_count = triangles};
    data.positions = calloc((size_t)vertices, sizeof(*data.positions));
    data.triangles = calloc((size_t)triangles, sizeof(*data.triangles));
    assert_true(data.positions && data.triangles);
    return data;
}

static inline struct neph_mesh *finish_mesh(struct neph_mesh_data data)
{
    struct neph_diag diag = {0};
    struct neph_mesh *mesh = NULL;
    neph_assert_ok(neph_mesh_create(&data, &mesh, &diag), &diag);
    return mesh;
}

static inline void set_triangle(struct neph_mesh_data *data, int triangle, int a, int b, int c)
{
    data->triangles[triangle][0] = a;
    data->triangles[triangle][1] = b;
    data->triangles[triangle][2] = c;
}

/* A box: 8 vertices, 12 triangles, counterclockwise from outside. */
static inline struct neph_mesh *make_box_mesh(struct neph_vec3 low, struct neph_vec3 high)
{
    static const int faces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                    {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    struct neph_mesh_data data = allocate_mesh(8, 12);
    for (int i = 0; i < 8; i++)
        data.positions[i] = (struct neph_vec3){i & 1 ? high.x : low.x, i & 2 ? high.y : low.y,
                                               i & 4 ? high.z : low.z};
    for (int face = 0; face < 6; face++) {
        const int *v = faces[face];
        set_triangle(&data, 2 * face, v[0], v[1], v[2]);
        set_triangle(&data, 2 * face + 1, v[0], v[2], v[3]);
    }
    return finish_mesh(data);
}

/* A closed lump around the origin: rings of longitude and latitude of radius 1 +- roughness. The
 * triangles at the poles have a collapsed side. */
static inline struct neph_mesh_data make_lump(int rings, double roughness, uint64_t *seed)
{
    const int around = 2 * rings;
    struct neph_mesh_data data = allocate_mesh((rings + 1) * around, 2 * rings * around);
    for (int ring = 0; ring <= rings; ring++)
        for (int i = 0; i < around; i++) {
            const bool is_pole = ring == 0 || ring == rings;
            const double polar = M_PI * ring / rings, azimuth = 2.0 * M_PI * i / around;
            const double radius = is_pole ? 1.0
                                          : 1.0 + neph_test_uniform(seed, -roughness, roughness);
            const double across = is_pole ? 0.0 : sin(polar);
            data.positions[ring * around + i] = neph_vec3_scale(
                (struct neph_vec3){across * sin(azimuth), cos(polar), across * cos(azimuth)},
                radius);
        }
    for (int ring = 0; ring < rings; ring++)
        for (int i = 0; i < around; i++) {
            const int a = ring * around + i, b = ring * around + (i + 1) % around;
            const int cell = 2 * (ring * around + i);
            set_triangle(&data, cell, a, a + around, b);
            set_triangle(&data, cell + 1, b, a + around, b + around);
        }
    return data;
}

/* Hills over [-size, size]^2 with 2 cells^2 triangles. */
static inline struct neph_mesh_data make_hills(int cells, double size, double height)
{
    const int row = cells + 1;
    struct neph_mesh_data data = allocate_mesh(row * row, 2 * cells * cells);
    for (int j = 0; j < row; j++)
        for (int i = 0; i < row; i++) {
            const double x = size * (2.0 * i / cells - 1.0), z = size * (2.0 * j / cells - 1.0);
            const double u = 9.0 * x / size, v = 9.0 * z / size;
            data.positions[j * row + i] = (struct neph_vec3){
                x, height * (sin(u) * cos(0.7 * v) + 0.3 * sin(3.1 * u + 2.0 * v)), z};
        }
    for (int j = 0; j < cells; j++)
        for (int i = 0; i < cells; i++) {
            const int a = j * row + i, cell = 2 * (j * cells + i);
            set_triangle(&data, cell, a, a + row, a + 1);
            set_triangle(&data, cell + 1, a + 1, a + row, a + row + 1);
        }
    return data;
}

/* Triangles anywhere within 1 m. */
static inline struct neph_mesh_data make_soup(int count, double size, uint64_t *seed)
{
    struct neph_mesh_data data = allocate_mesh(3 * count, count);
    for (int i = 0; i < count; i++) {
        const struct neph_vec3 at = random_point(seed, 1.0);
        for (int corner = 0; corner < 3; corner++)
            data.positions[3 * i + corner] = neph_vec3_add(at, random_point(seed, size));
        set_triangle(&data, i, 3 * i, 3 * i + 1, 3 * i + 2);
    }
    return data;
}

/* --- materials -------------------------------------------------------------------------------- */

static inline struct neph_albedo_texture *make_texture(int width, int height, const float *rgba)
{
    const size_t bytes = (size_t)width * (size_t)height * 4 * sizeof(*rgba);
    float *own = malloc(bytes);
    struct neph_albedo_texture *texture = NULL;
    assert_non_null(own);
    memcpy(own, rgba, bytes);
    neph_assert_ok(neph_albedo_texture_create(width, height, own, true, &texture, NULL), NULL);
    return texture;
}

/* The square [0, 1]^2 of z = 0, with uv = (x, y), whose normal is +z; width: its part along x. */
static inline struct neph_mesh *make_quad(double width, struct neph_albedo_texture *texture,
                                          enum neph_alpha alpha)
{
    struct neph_mesh_data data = allocate_mesh(4, 2);
    data.uv = calloc(4, sizeof(*data.uv));
    assert_non_null(data.uv);
    for (int i = 0; i < 4; i++) {
        data.positions[i] = (struct neph_vec3){i & 1 ? width : 0.0, i >> 1, 0.0};
        data.uv[i][0] = (float)data.positions[i].x;
        data.uv[i][1] = (float)data.positions[i].y;
    }
    set_triangle(&data, 0, 0, 1, 3);
    set_triangle(&data, 1, 0, 3, 2);
    struct neph_mesh *mesh = finish_mesh(data);
    mesh->material = (struct neph_mesh_material){.alpha = alpha, .texture = texture};
    return mesh;
}

static inline struct neph_solid put_mesh(const struct neph_mesh *mesh)
{
    return (struct neph_solid){
        .kind = NEPH_SOLID_MESH, .mesh = mesh, .scale_m = 1.0, .albedo = {0.5, 0.25, 1.0}};
}

/* Alpha is `left` up to u = 1/2, then `right`; bilinear within a pixel of 1/64. */
static inline struct neph_albedo_texture *make_half_texture(float left, float right)
{
    enum { SIDE = 64 };
    float rgba[4 * SIDE];
    for (int i = 0; i < SIDE; i++) {
        rgba[4 * i] = rgba[4 * i + 1] = rgba[4 * i + 2] = 1.0f;
        rgba[4 * i + 3] = i < SIDE / 2 ? left : right;
    }
    return make_texture(SIDE, 1, rgba);
}

/* A ball of radius 1 whose vertices have its normals, of any length. */
static inline struct neph_mesh *make_ball(int rings, double length)
{
    uint64_t seed = 1;
    struct neph_mesh_data data = make_lump(rings, 0.0, &seed);
    data.normals = calloc((size_t)data.vertex_count, sizeof(*data.normals));
    assert_non_null(data.normals);
    for (int i = 0; i < data.vertex_count; i++)
        data.normals[i] = neph_vec3_scale(data.positions[i], length);
    struct neph_mesh *mesh = finish_mesh(data);
    mesh->material.is_smooth = true;
    return mesh;
}

#endif
