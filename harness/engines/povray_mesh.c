/* SPDX-License-Identifier: MIT */
#include "harness/engines/povray_mesh.h"

#include "base/files.h"
#include "base/png.h"
#include "scenes/mesh.h"
#include "scenes/mesh_place.h"
#include "scenes/solids.h"

#include <math.h>
#include <stdlib.h>
#include <unistd.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_SOLID_KIND_COUNT == 3, "a new kind");
_Static_assert(NEPH_ALPHA_COUNT == 3, "a new kind");
_Static_assert(NEPH_POVRAY_KIND_COUNT == 6, "a new kind");

static void name_file(int index, char name[NEPH_POVRAY_FILE_NAME_MAX])
{
    snprintf(name, NEPH_POVRAY_FILE_NAME_MAX, "mesh%d.inc", index + 1);
}

/* POV-Ray meets triangles in the mesh's own units, between 1e-6 and 1e7 of them. So these are those
 * of the world for the smallest of its solids: no distance is longer than in the world. */
static double smallest_scale_m(const struct neph_scene *scene, int index)
{
    double scale_m = INFINITY;
    for (int i = 0; i < scene->solid_count; i++)
        if (scene->solids[i].kind == NEPH_SOLID_MESH &&
            scene->solids[i].mesh == scene->meshes[index])
            scale_m = fmin(scale_m, scene->solids[i].scale_m);
    return scale_m;
}

/* A normal of a vertex, turned by up to 1e-4. POV-Ray shades a triangle flat, by its plane, where
 * its normals differ by less than 1e-5, also if they are not the plane's; turned, they differ. */
static struct neph_vec3 find_normal(const struct neph_mesh_data *data, int vertex)
{
    const struct neph_vec3 n = neph_vec3_normalize(data->normals[vertex]);
    const struct neph_vec3 axis = {fabs(n.x) < 0.5, fabs(n.x) >= 0.5, 0.0};
    const double part = fmod(0.6180339887 * vertex, 1.0);
    return neph_vec3_normalize(neph_vec3_along(n, neph_vec3_cross(n, axis), 1e-4 * part));
}

static bool put_mesh(FILE *file, const struct neph_mesh *mesh, int index, double unit)
{
    const struct neph_mesh_data *data = &mesh->data;
    fprintf(file, "#declare Mesh%d = mesh2 {\nvertex_vectors { %d", index + 1, data->vertex_count);
    for (int i = 0; i < data->vertex_count; i++) {
        const struct neph_vec3 at = neph_vec3_scale(data->positions[i], unit);
        fprintf(file, ",\n<%.9g,%.9g,%.9g>", at.x, at.y, at.z);
    }
    fprintf(file, " }\n");
    if (mesh->material.is_smooth) {
        fprintf(file, "normal_vectors { %d", data->vertex_count);
        for (int i = 0; i < data->vertex_count; i++) {
            const struct neph_vec3 n = find_normal(data, i);
            fprintf(file, ",\n<%.9g,%.9g,%.9g>", n.x, n.y, n.z);
        }
        fprintf(file, " }\n");
    }
    if (mesh->material.texture) {
        fprintf(file, "uv_vectors { %d", data->vertex_count);
        for (int i = 0; i < data->vertex_count; i++)
            fprintf(file, ",\n<%.9g,%.9g>", (double)data->uv[i][0], (double)data->uv[i][1]);
        fprintf(file, " }\n");
    }
    fprintf(file, "face_indices { %d", data->triangle_count);
    for (int i = 0; i < data->triangle_count; i++)
        fprintf(file, ",\n<%d,%d,%d>", data->triangles[i][0], data->triangles[i][1],
                data->triangles[i][2]);
    fprintf(file, " } }\n");
    return !ferror(file);
}

/* The file is in the scratch folder of a job: it need not be whole after a crash. */
static enum neph_status put_file(const struct neph_povray_world *world, int index,
                                 const char *directory, struct neph_diag *diag)
{
    const double scale_m = smallest_scale_m(world->scene, index);
    char name[NEPH_POVRAY_FILE_NAME_MAX];
    name_file(index, name);
    char *path = isfinite(scale_m) ? neph_path_join(directory, name) : NULL;
    if (!isfinite(scale_m))
        return NEPH_OK; /* no solid has it */
    if (!path)
        return neph_fail_memory(diag);
    FILE *file = fopen(path, "we");
    bool is_whole = file && put_mesh(file, world->scene->meshes[index], index,
                                     scale_m * world->units_per_m);
    if (file && fclose(file) != 0)
        is_whole = false;
    const enum neph_status status = is_whole
                                        ? NEPH_OK
                                        : neph_fail(diag, NEPH_ERR_IO, "cannot write '%s'", path);
    free(path);
    return status;
}

/* ---- images of a texture --------------------------------------------------------------------- */

/* Red, green and blue in one image, each as grey, or alpha. */
enum { ALL_COLOURS = 3, ALPHA, IMAGE_COUNT };

static void name_image(int index, int which, char name[NEPH_POVRAY_FILE_NAME_MAX])
{
    static const char *const names[IMAGE_COUNT] = {"red", "green", "blue", "colour", "alpha"};
    snprintf(name, NEPH_POVRAY_FILE_NAME_MAX, "texture%d_%s.png", index + 1, names[which]);
}

/* Times the albedo. */
static uint16_t find_code(const struct neph_albedo_texture *texture, struct neph_rgb albedo,
                          size_t pixel, int channel)
{
    const double factors[4] = {albedo.r, albedo.g, albedo.b, 1.0};
    return (uint16_t)lround(65535.0 * factors[channel] *
                            (double)texture->rgba[4 * pixel + (size_t)channel]);
}

static enum neph_status put_image(const struct neph_albedo_texture *texture, struct neph_rgb albedo,
                                  int which, const char *path, struct neph_diag *diag)
{
    const size_t count = (size_t)texture->width_px * (size_t)texture->height_px;
    uint16_t *codes = malloc(count * 3 * sizeof(*codes));
    if (!codes)
        return neph_fail_memory(diag);
    for (size_t i = 0; i < count; i++)
        for (int c = 0; c < 3; c++) {
            const int channel = which == ALL_COLOURS ? c : which == ALPHA ? 3 : which;
            codes[3 * i + (size_t)c] = find_code(texture, albedo, i, channel);
        }
    const enum neph_status status = neph_png_write_rgb16(
        path, texture->width_px, texture->height_px, 16, NEPH_PNG_SRGB, codes, diag);
    free(codes);
    return status;
}

/* The solids of a mesh, which are of one entry, have one albedo. */
static struct neph_rgb find_albedo(const struct neph_scene *scene, int index)
{
    for (int i = 0; i < scene->solid_count; i++)
        if (scene->solids[i].kind == NEPH_SOLID_MESH &&
            scene->solids[i].mesh == scene->meshes[index])
            return scene->solids[i].albedo;
    return (struct neph_rgb){0, 0, 0};
}

static enum neph_status put_images(const struct neph_scene *scene, int index, const char *directory,
                                   struct neph_diag *diag)
{
    const struct neph_mesh_material *material = &scene->meshes[index]->material;
    enum neph_status status = NEPH_OK;
    for (int which = 0; material->texture && which < IMAGE_COUNT && !status; which++) {
        char name[NEPH_POVRAY_FILE_NAME_MAX];
        if (which == ALPHA && material->alpha == NEPH_ALPHA_IGNORED)
            continue;
        name_image(index, which, name);
        char *path = neph_path_join(directory, name);
        status = path ? put_image(material->texture, find_albedo(scene, index), which, path, diag)
                      : neph_fail_memory(diag);
        free(path);
    }
    return status;
}

static void write_image(struct neph_povray_writer *writer, const struct neph_solid *solid,
                        const char *kind, int which)
{
    char name[NEPH_POVRAY_FILE_NAME_MAX];
    name_image(neph_mesh_index(writer->world->scene, solid), which, name);
    neph_povray_write_text(writer, " uv_mapping %s { png \"%s\" gamma 1.0 interpolate 2 }", kind,
                           name);
}

void neph_povray_write_mesh_pigment(struct neph_povray_writer *writer,
                                    const struct neph_solid *solid)
{
    neph_povray_write_text(writer, " pigment {");
    write_image(writer, solid, "image_map",
                writer->pass->kind == NEPH_POVRAY_BEAUTY ? ALL_COLOURS : writer->pass->channel);
    neph_povray_write_text(writer, " }");
}

void neph_povray_write_alpha(struct neph_povray_writer *writer, const struct neph_solid *solid)
{
    write_image(writer, solid, "image_pattern", ALPHA);
}

void neph_povray_start_cutout(struct neph_povray_writer *writer, const struct neph_solid *solid)
{
    const bool is_mix = solid->mesh->material.alpha == NEPH_ALPHA_COVERAGE &&
                        writer->pass->kind != NEPH_POVRAY_TRANSMITTANCE;
    neph_povray_write_text(writer, " hollow texture {");
    neph_povray_write_alpha(writer, solid);
    neph_povray_write_text(writer,
                           " texture_map { [%n pigment { rgbt 1 } finish { ambient 0 diffuse 0 }] "
                           "[%n",
                           is_mix ? 0.0 : 0.5, is_mix ? 1.0 : 0.5);
}

void neph_povray_end_cutout(struct neph_povray_writer *writer)
{
    neph_povray_write_text(writer, "] } }");
}

/* ---- all ------------------------------------------------------------------------------------- */

enum neph_status neph_povray_put_meshes(const struct neph_povray_world *world,
                                        const char *directory, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < world->scene->mesh_count && !status; i++)
        status = put_file(world, i, directory, diag);
    for (int i = 0; i < world->scene->mesh_count && !status; i++)
        status = put_images(world->scene, i, directory, diag);
    return status;
}

void neph_povray_include_meshes(struct neph_povray_writer *writer)
{
    const struct neph_scene *scene = writer->world->scene;
    for (int i = 0; i < scene->mesh_count; i++) {
        char name[NEPH_POVRAY_FILE_NAME_MAX];
        name_file(i, name);
        if (isfinite(smallest_scale_m(scene, i)))
            neph_povray_write_text(writer, "#include \"%s\"\n", name);
    }
}

/* Row i of POV-Ray's matrix is the image of unit vector i. */
void neph_povray_write_mesh(struct neph_povray_writer *writer, const struct neph_solid *solid)
{
    const struct neph_scene *scene = writer->world->scene;
    const int index = neph_mesh_index(scene, solid);
    const double scale = solid->scale_m / smallest_scale_m(scene, index);
    struct neph_vec3 axes[3];
    neph_mesh_axes(solid, axes);
    neph_povray_write_text(writer, "object { Mesh%i matrix <", index + 1);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            neph_povray_write_text(writer, "%n, ", scale * neph_povray_axis(axes[i], k));
    neph_povray_write_text(writer, "0, 0, 0> translate %p", solid->center_m);
}
