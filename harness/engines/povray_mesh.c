/* SPDX-License-Identifier: MIT */
#include "harness/engines/povray_mesh.h"

#include "base/files.h"
#include "scenes/mesh_place.h"
#include "scenes/mesh.h"
#include "scenes/solids.h"

#include <math.h>
#include <stdlib.h>
#include <unistd.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_SOLID_KIND_COUNT == 3, "a new kind");

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

static bool put_mesh(FILE *file, const struct neph_mesh_data *data, int index, double unit)
{
    fprintf(file, "#declare Mesh%d = mesh2 {\nvertex_vectors { %d", index + 1, data->vertex_count);
    for (int i = 0; i < data->vertex_count; i++) {
        const struct neph_vec3 at = neph_vec3_scale(data->positions[i], unit);
        fprintf(file, ",\n<%.9g,%.9g,%.9g>", at.x, at.y, at.z);
    }
    fprintf(file, " }\nface_indices { %d", data->triangle_count);
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
    bool is_whole = file && put_mesh(file, &world->scene->meshes[index]->data, index,
                                     scale_m * world->units_per_m);
    if (file && fclose(file) != 0)
        is_whole = false;
    const enum neph_status status = is_whole
                                        ? NEPH_OK
                                        : neph_fail(diag, NEPH_ERR_IO, "cannot write '%s'", path);
    free(path);
    return status;
}

enum neph_status neph_povray_put_meshes(const struct neph_povray_world *world,
                                        const char *directory, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < world->scene->mesh_count && !status; i++)
        status = put_file(world, i, directory, diag);
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
