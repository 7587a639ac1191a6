/* SPDX-License-Identifier: MIT
 *
 * Mesh files: one box in each format gives the same triangles; damaged, huge and unusual files, and
 * files that name others outside of their folder, are refused with a message, or have a documented
 * meaning. Not run where neph was built without Assimp.
 *
 * The mutations take their seed from NEPH_TEST_SEED, or from the clock, and print it.
 */
#include "tests/base/scratch.h"

#include "base/vec3.h"
#include "scenes/mesh_file.h"

#include <math.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { MIB = 1 << 20, LIMIT = 64 * MIB, TEXT = 8192, CORNERS = 8, TRIANGLES = 12 };

/* A box from (-1, 0, 2) to (1, 0.5, 6): numbers that float32 has. */
static const float corners[CORNERS][3] = {{-1, 0, 2}, {-1, 0, 6}, {-1, 0.5f, 2}, {-1, 0.5f, 6},
                                          {1, 0, 2},  {1, 0, 6},  {1, 0.5f, 2},  {1, 0.5f, 6}};
static const uint16_t faces[TRIANGLES][3] = {{0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5},
                                             {0, 4, 5}, {0, 5, 1}, {2, 3, 7}, {2, 7, 6},
                                             {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};

static void want_program(void)
{
    char *program = NULL;
    const enum neph_status status = neph_mesh_find_program(&program, NULL);
    free(program);
    if (status == NEPH_OK)
        return;
    print_message("not run: neph was built without Assimp\n");
    skip();
}

/* ---- files ----------------------------------------------------------------------------------- */

static const char *put(void **state, char path[SCRATCH_PATH_MAX], const char *name,
                       const void *data, size_t size)
{
    scratch_write(scratch_path(state, path, name), data, size);
    return path;
}

static const char *put_text(void **state, char path[SCRATCH_PATH_MAX], const char *name,
                            const char *text)
{
    return put(state, path, name, text, strlen(text));
}

/* The text of the box as vertices and faces of OBJ or PLY. */
static void list_box(char text[TEXT], const char *vertex, const char *face, int first)
{
    size_t used = strlen(text);
    for (int v = 0; v < CORNERS; v++)
        used += (size_t)snprintf(text + used, TEXT - used, "%s%g %g %g\n", vertex,
                                 (double)corners[v][0], (double)corners[v][1],
                                 (double)corners[v][2]);
    for (int f = 0; f < TRIANGLES; f++)
        used += (size_t)snprintf(text + used, TEXT - used, "%s%d %d %d\n", face,
                                 faces[f][0] + first, faces[f][1] + first, faces[f][2] + first);
}

static const char *put_obj(void **state, char path[SCRATCH_PATH_MAX], const char *name,
                           const char *before, const char *after)
{
    char text[TEXT] = "";
    snprintf(text, sizeof(text), "%s", before);
    list_box(text, "v ", "f ", 1);
    strncat(text, after, sizeof(text) - strlen(text) - 1);
    return put_text(state, path, name, text);
}

static size_t append(unsigned char *bytes, size_t used, const void *value, size_t size,
                     bool is_reversed)
{
    for (size_t i = 0; i < size; i++)
        bytes[used + i] = ((const unsigned char *)value)[is_reversed ? size - 1 - i : i];
    return used + size;
}

/* `format`: "ascii", "binary_little_endian" or "binary_big_endian". The last bytes are left out. */
static const char *put_ply(void **state, char path[SCRATCH_PATH_MAX], const char *format,
                           size_t left_out)
{
    char bytes[TEXT] = "", name[64];
    snprintf(bytes, sizeof(bytes),
             "ply\nformat %s 1.0\ncomment a box\nelement vertex 8\nproperty double x\n"
             "property float y\nproperty float z\nelement face 12\n"
             "property list uchar int vertex_indices\nend_header\n",
             format);
    size_t size = strlen(bytes);
    if (strcmp(format, "ascii") == 0) {
        list_box(bytes, "", "3 ", 0);
        size = strlen(bytes);
    } else {
        const bool is_big = strcmp(format, "binary_big_endian") == 0;
        unsigned char *to = (unsigned char *)bytes;
        for (int v = 0; v < CORNERS; v++) {
            const double x = (double)corners[v][0];
            size = append(to, size, &x, sizeof(x), is_big);
            for (int i = 1; i < 3; i++)
                size = append(to, size, &corners[v][i], sizeof(float), is_big);
        }
        for (int f = 0; f < TRIANGLES; f++) {
            bytes[size++] = 3;
            for (int i = 0; i < 3; i++)
                size = append(to, size, &(int32_t){faces[f][i]}, sizeof(int32_t), is_big);
        }
    }
    snprintf(name, sizeof(name), "%s.ply", format);
    return put(state, path, name, bytes, size - left_out);
}

struct box_bytes {
    float positions[CORNERS][3];
    uint16_t indices[TRIANGLES][3];
};

static struct box_bytes box_bytes(void)
{
    struct box_bytes box;
    memcpy(box.positions, corners, sizeof(corners));
    memcpy(box.indices, faces, sizeof(faces));
    return box;
}

/* The JSON with the buffer of a URI, as a member "uri": "..." or "". */
static void write_json(char json[TEXT], const char *uri, const char *nodes, int component,
                       const char *more)
{
    snprintf(json, TEXT,
             "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"
             "\"nodes\":[%s],\"meshes\":[{\"name\":\"shape\",\"primitives\":"
             "[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}],"
             "\"buffers\":[{\"byteLength\":168%s%s%s}],"
             "\"bufferViews\":[{\"buffer\":0,\"byteLength\":96},"
             "{\"buffer\":0,\"byteOffset\":96,\"byteLength\":72}],"
             "\"accessors\":[{\"bufferView\":0,\"componentType\":%d,\"count\":8,\"type\":\"VEC3\"},"
             "{\"bufferView\":1,\"componentType\":5123,\"count\":36,\"type\":\"SCALAR\"}]%s}",
             nodes, *uri ? ",\"uri\":\"" : "", uri, *uri ? "\"" : "", component, more);
}

#define ONE_NODE "{\"mesh\":0,\"name\":\"box\"}"

static const char *put_gltf(void **state, char path[SCRATCH_PATH_MAX], const char *name,
                            const char *uri)
{
    char json[TEXT];
    write_json(json, uri, ONE_NODE, 5126, "");
    return put_text(state, path, name, json);
}

static const char *put_glb(void **state, char path[SCRATCH_PATH_MAX], size_t left_out)
{
    const struct box_bytes box = box_bytes();
    char json[TEXT];
    unsigned char bytes[TEXT];
    write_json(json, "", ONE_NODE, 5126, "");
    while (strlen(json) % 4 != 0)
        strcat(json, " ");
    const uint32_t length = (uint32_t)strlen(json),
                   head[] = {0x46546c67, 2, 12 + 8 + length + 8 + sizeof(box), length, 0x4e4f534a},
                   chunk[] = {sizeof(box), 0x004e4942};
    size_t size = append(bytes, 0, head, sizeof(head), false);
    size = append(bytes, size, json, length, false);
    size = append(bytes, size, chunk, sizeof(chunk), false);
    size = append(bytes, size, &box, sizeof(box), false);
    return put(state, path, "box.glb", bytes, size - left_out);
}

static void encode_base64(char text[TEXT], const unsigned char *bytes, size_t size)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    char *to = text + strlen(text);
    for (size_t i = 0; i < size; i += 3) {
        const unsigned three = (unsigned)bytes[i] << 16 | (unsigned)bytes[i + 1] << 8 |
                               bytes[i + 2];
        for (int shift = 18; shift >= 0; shift -= 6)
            *to++ = digits[three >> shift & 63];
    }
    *to = '\0';
}

/* The buffer in the file, with these nodes. */
static const char *put_whole(void **state, char path[SCRATCH_PATH_MAX], const char *name,
                             const struct box_bytes *box, const char *nodes)
{
    char uri[TEXT] = "data:application/octet-stream;base64,", json[TEXT];
    encode_base64(uri, (const unsigned char *)box, sizeof(*box));
    write_json(json, uri, nodes, 5126, "");
    return put_text(state, path, name, json);
}

/* ---- reading --------------------------------------------------------------------------------- */

static struct neph_mesh_data read_object(const char *path, const char *object)
{
    struct neph_mesh_data data = {0};
    struct neph_diag diag = {0};
    neph_assert_ok(
        neph_mesh_read(
            &(struct neph_mesh_request){.path = path, .object = object, .limit_bytes = LIMIT},
            &data, &diag),
        &diag);
    return data;
}

static void assert_refused(const char *path, const char *object, size_t limit, const char *words)
{
    struct neph_mesh_data data = {0};
    struct neph_diag diag = {0};
    const struct neph_mesh_request request = {
        .path = path, .shown = "shown", .object = object, .limit_bytes = limit};
    const enum neph_status status = neph_mesh_read(&request, &data, &diag);
    assert_null(data.positions);
    if (status == NEPH_ERR_INPUT && strstr(diag.message, words) && strstr(diag.message, "'shown'"))
        return;
    print_error("%s: %s: %s; expected '%s'\n", path, neph_status_name(status), diag.message, words);
    fail();
}

/* Each triangle of the box, at its corners by value. */
static void assert_box(const char *path)
{
    struct neph_mesh_data data = read_object(path, NULL);
    assert_int_equal(data.vertex_count, CORNERS);
    assert_int_equal(data.triangle_count, TRIANGLES);
    assert_null(data.normals);
    assert_null(data.uv);
    for (int t = 0; t < TRIANGLES; t++)
        for (int i = 0; i < 3; i++) {
            const struct neph_vec3 found = data.positions[data.triangles[t][i]];
            const float *expected = corners[faces[t][i]];
            assert_true(found.x == (double)expected[0] && found.y == (double)expected[1] &&
                        found.z == (double)expected[2]);
        }
    neph_mesh_data_finish(&data);
}

/* By the divergence theorem, positive where triangles are counterclockwise from outside. */
static double signed_volume(const struct neph_mesh_data *data)
{
    double volume = 0.0;
    for (int t = 0; t < data->triangle_count; t++) {
        const struct neph_vec3 a = data->positions[data->triangles[t][0]],
                               b = data->positions[data->triangles[t][1]],
                               c = data->positions[data->triangles[t][2]];
        volume += neph_vec3_dot(a, neph_vec3_cross(b, c)) / 6.0;
    }
    return volume;
}

/* ---- formats --------------------------------------------------------------------------------- */

static void test_a_box_in_each_format(void **state)
{
    char path[SCRATCH_PATH_MAX];
    const struct box_bytes box = box_bytes();
    want_program();
    put(state, path, "the box.bin", &box, sizeof(box));
    assert_box(put_obj(state, path, "box.obj", "# a box\nmtllib none.mtl\no box\n", ""));
    assert_box(put_obj(state, path, "BOX.OBJ", "", "l 1 2\np 3\n"));
    assert_box(put_ply(state, path, "ascii", 0));
    assert_box(put_ply(state, path, "binary_little_endian", 0));
    assert_box(put_ply(state, path, "binary_big_endian", 0));
    assert_box(put_gltf(state, path, "file.gltf", "the%20box.bin"));
    assert_box(put_gltf(state, path, "plain.gltf", "the box.bin"));
    assert_box(put_whole(state, path, "data.gltf", &box, ONE_NODE));
    assert_box(put_glb(state, path, 0));
}

static void test_polygons_become_triangles(void **state)
{
    static const char text[] =
        "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\nf -5 -4 \\\n-3 -2 -1\n";
    char path[SCRATCH_PATH_MAX];
    want_program();
    struct neph_mesh_data data = read_object(put_text(state, path, "arrow.obj", text), NULL);
    double area = 0.0;
    for (int t = 0; t < data.triangle_count; t++) {
        const struct neph_vec3 a = data.positions[data.triangles[t][0]],
                               b = data.positions[data.triangles[t][1]],
                               c = data.positions[data.triangles[t][2]];
        const double z = neph_vec3_cross(neph_vec3_sub(b, a), neph_vec3_sub(c, a)).z;
        assert_true(z > 0.0); /* no triangle is turned */
        area += 0.5 * z;
    }
    assert_int_equal(data.triangle_count, 3);
    neph_assert_close(area, 16.0 - 6.0, 1e-12, 0);
    neph_mesh_data_finish(&data);
}

static void test_normals_and_uv_of_all_vertices_or_none(void **state)
{
    static const char vertices[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvn 0 0 2\nvn 0 3 0\n"
                                   "vt 0 0.25\nvt 1 0.75\n";
    char path[SCRATCH_PATH_MAX], text[TEXT];
    want_program();
    snprintf(text, sizeof(text), "%sf 1/1/1 2/1/1 3/2/1\nf 4/2/2 3/2/1 2/1/1\n", vertices);
    struct neph_mesh_data data = read_object(put_text(state, path, "all.obj", text), NULL);
    assert_int_equal(data.vertex_count, 4);
    assert_non_null(data.normals);
    const int last = data.triangles[1][0];
    assert_true(data.normals[last].y == 1.0 && data.normals[0].z == 1.0);
    assert_true(data.uv[last][0] == 1.0f && data.uv[last][1] == 0.75f);
    neph_mesh_data_finish(&data);
    snprintf(text, sizeof(text), "%sf 1//1 2//1 3//1\nf 4 3 2\n", vertices);
    data = read_object(put_text(state, path, "some.obj", text), NULL);
    assert_int_equal(data.vertex_count, 4);
    assert_null(data.normals);
    assert_null(data.uv);
    neph_mesh_data_finish(&data);
}

static void test_objects(void **state)
{
    char path[SCRATCH_PATH_MAX];
    want_program();
    put_obj(state, path, "two.obj", "o first\n", "o second\nv 9 9 9\ng third\nf 1 2 9\n");
    struct neph_mesh_data data = read_object(path, "third");
    assert_int_equal(data.triangle_count, 1);
    assert_true(data.positions[data.triangles[0][2]].x == 9.0);
    neph_mesh_data_finish(&data);
    data = read_object(path, NULL);
    assert_int_equal(data.triangle_count, TRIANGLES + 1);
    neph_mesh_data_finish(&data);
    assert_refused(path, "fourth", LIMIT, "it has no object 'fourth'; it has 'first'");
    assert_refused(put_ply(state, path, "ascii", 0), "x", LIMIT, "it has no object 'x'");
}

/* A child of a moved node, which mirrors and scales; the mesh once more beside it. */
static void test_nodes_are_placed(void **state)
{
    static const char nodes[] =
        "{\"name\":\"top\",\"children\":[1,2]},"
        "{\"name\":\"moved\",\"translation\":[10,0,0],\"children\":[3]},"
        "{\"name\":\"other\",\"mesh\":0},"
        "{\"name\":\"leaf\",\"mesh\":0,\"scale\":[2,-3,1],\"translation\":[0.5,0,0]}";
    const struct box_bytes box = box_bytes();
    char path[SCRATCH_PATH_MAX];
    want_program();
    put_whole(state, path, "nodes.gltf", &box, nodes);
    struct neph_mesh_data data = read_object(path, "moved");
    assert_int_equal(data.triangle_count, TRIANGLES);
    for (int v = 0; v < data.vertex_count; v++) {
        assert_true(data.positions[v].x == 8.5 || data.positions[v].x == 12.5);
        assert_true(data.positions[v].y == 0.0 || data.positions[v].y == -1.5);
    }
    neph_assert_close(signed_volume(&data), 4.0 * 6.0, 1e-12, 0);
    neph_mesh_data_finish(&data);
    data = read_object(path, "shape"); /* the name of the mesh: at all of its nodes */
    assert_int_equal(data.triangle_count, 2 * TRIANGLES);
    neph_assert_close(signed_volume(&data), 4.0 * 7.0, 1e-12, 0);
    neph_mesh_data_finish(&data);
}

/* Read as they are: rays meet each triangle (scenes/mesh.h has their meaning as solids). */
static void test_open_and_non_manifold_meshes(void **state)
{
    char path[SCRATCH_PATH_MAX];
    want_program();
    put_text(state, path, "open.obj",
             "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 0 -1\nf 1 2 3\nf 1 2 4\nf 1 2 5\nf 2 2 2\n");
    struct neph_mesh_data data = read_object(path, NULL);
    assert_int_equal(data.vertex_count, 5);
    assert_int_equal(data.triangle_count, 4);
    neph_mesh_data_finish(&data);
}

/* ---- files that are refused ------------------------------------------------------------------ */

static void test_text_at_fault(void **state)
{
    static const struct {
        const char *name, *text, *words;
    } rows[] = {
        {"empty.obj", "", "it is empty"},
        {"points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\np 1 2\nl 1 2 3\n", "it has no triangles"},
        {"nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "line 1, 'v nan 0 0'"},
        {"inf.obj", "v 0 0 0\nv 1e60 0 0\nv 0 1 0\nf 1 2 3\n", "line 2, 'v 1e60 0 0'"},
        {"short.obj", "v 0 0 0\nv 1 0\nv 0 1 0\nf 1 2 3\n", "line 2, 'v 1 0'"},
        {"point.obj", "v .5 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n", "line 1, 'v .5 0 0'"},
        {"seven.obj", "v 1 2 3 1 1 1 1\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n", "line 1, 'v 1 2"},
        {"five.obj", "v 0 0 0\nv 1 2 \\\n3 4 5\nv 0 1 0\nv 0 0 1\nf 1 2 3\n", "line 2, 'v 1"},
        {"hex.obj", "v 0 0 0\nv 0x1 0 0\nv 0 1 0\nf 1 2 3\n", "line 2, 'v 0x1 0 0'"},
        {"strips.ply",
         "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
         "property float z\nelement tristrips 1\nproperty list int int vertex_indices\n"
         "end_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n4 0 1 2 3\n",
         "strips"},
        {"word.obj", "v 0 0 0\nv 1 0 zero\nv 0 1 0\nf 1 2 3\n", "line 2"},
        {"high.obj", "v 0 0 0\nv 1 0 0\nf 1 2 3\nv 0 1 0\nf 1 2 4\n", "names vertex 4, and"},
        {"zero.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", "line 4, 'f 0 1 2'"},
        {"low.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -4 1 2\n", "there is no vertex -4"},
        {"uv.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1 2/1 3/1\n", "names texture coordinate 1"},
        {"far.obj", "v 500000 0 0\nv 500001 0 0\nv 500000 1 0\nf 1 2 3\n", "steps of 0.0596"},
        {"two.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n", "three corners or more"},
        {"face.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 x\n", "line 4, 'f 1 2 x'"},
        {"binary.obj", "\1\2\3\4\5\6\7\1\2\3\4\5\6\7\1\2\3\4", "it has no triangles"},
        {"no.ply", "solid\n", "its first line is not 'ply'"},
        {"endless.ply", "ply\nformat ascii 1.0\n", "no end_header"},
        {"format.ply", "ply\nformat utf8 1.0\nend_header\n", "line 2 of its header"},
        {"type.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty half x\nend_header\n",
         "'property half x'"},
        {"many.ply",
         "ply\nformat ascii 1.0\nelement vertex 9\nproperty int x\nelement face "
         "4000000000\nproperty list uchar int vertex_indices\nend_header\n",
         "more than 1000000 triangles"},
        {"points.ply",
         "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
         "property float y\nproperty float z\nend_header\n0 0 0\n",
         "it has no triangles"},
        {"broken.gltf", "{\"asset\":", "line 1 of its JSON"},
        {"one.gltf", "{\"asset\":{\"version\":\"1.0\"}}", "version"},
        {"none.gltf", "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[]}]}",
         "it has no triangles"},
        {"box.stl", "solid\n", "not a mesh file"},
        {"obj", "v 0 0 0\n", "not a mesh file"},
    };
    char path[SCRATCH_PATH_MAX];
    want_program();
    for (size_t i = 0; i < COUNT(rows); i++)
        assert_refused(put_text(state, path, rows[i].name, rows[i].text), NULL, LIMIT,
                       rows[i].words);
}

static void test_truncated_files(void **state)
{
    char path[SCRATCH_PATH_MAX];
    want_program();
    assert_refused(put_ply(state, path, "ascii", 12), NULL, LIMIT, "face 10 of 12");
    assert_refused(put_ply(state, path, "ascii", 3), NULL, LIMIT, "face 11 of 12");
    assert_refused(put_ply(state, path, "binary_little_endian", 1), NULL, LIMIT, "face 11 of 12");
    assert_refused(put_ply(state, path, "binary_big_endian", 12 * 13 + 1), NULL, LIMIT,
                   "vertex 7 of 8");
    assert_refused(put_glb(state, path, 4), NULL, LIMIT, "Assimp says");
    assert_refused(put_glb(state, path, 400), NULL, LIMIT, "it ends before its JSON does");
}

static void test_indices_and_numbers_of_gltf(void **state)
{
    struct box_bytes box = box_bytes();
    char path[SCRATCH_PATH_MAX], json[TEXT];
    want_program();
    box.indices[11][2] = 8;
    assert_refused(put_whole(state, path, "index.gltf", &box, ONE_NODE), NULL, LIMIT,
                   "1 of its 12 faces");
    box = box_bytes();
    box.positions[3][1] = NAN;
    assert_refused(put_whole(state, path, "nan.gltf", &box, ONE_NODE), NULL, LIMIT, "(-1, nan, 6)");
    put(state, path, "box.bin", &box, sizeof(box));
    write_json(json, "box.bin", ONE_NODE, 5122, "");
    assert_refused(put_text(state, path, "short.gltf", json), NULL, LIMIT, "componentType 5122");
    write_json(json, "box.bin", ONE_NODE, 5126,
               ",\"extensionsRequired\":[\"KHR_mesh_quantization\"]");
    assert_refused(put_text(state, path, "quantized.gltf", json), NULL, LIMIT,
                   "extension KHR_mesh_quantization");
}

/* The file would be 4 GiB; it has no blocks on the disk. */
static void test_huge_files(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_diag diag = {0};
    struct neph_mesh_data data = {0};
    want_program();
    put_obj(state, path, "huge.obj", "", "");
    assert_int_equal(truncate(path, (off_t)4 << 30), 0);
    const enum neph_status status = neph_mesh_read(
        &(struct neph_mesh_request){.path = path, .limit_bytes = LIMIT}, &data, &diag);
    assert_int_equal(status, NEPH_ERR_INPUT);
    assert_non_null(strstr(diag.message, "it has 4096 MiB, and the limit is 64 MiB"));
    assert_non_null(strstr(diag.hint, "binary PLY"));
    assert_refused(put_ply(state, path, "binary_little_endian", 0), NULL, 580, "memory");
}

static void test_files_outside_of_the_folder(void **state)
{
    char path[SCRATCH_PATH_MAX], folder[SCRATCH_PATH_MAX], link[SCRATCH_PATH_MAX];
    const struct box_bytes box = box_bytes();
    want_program();
    put(state, path, "outside.bin", &box, sizeof(box));
    assert_int_equal(mkdir(scratch_path(state, folder, "in"), 0700), 0);
    assert_int_equal(symlink(path, scratch_path(state, link, "in/link.bin")), 0);
    assert_int_equal(mkfifo(scratch_path(state, link, "in/pipe.bin"), 0600), 0);
    const struct {
        const char *uri, *words;
    } rows[] = {{"../outside.bin", "'../outside.bin', which is outside its folder"},
                {"%2E%2e/outside.bin", "'../outside.bin', which is outside its folder"},
                {path, "which is outside its folder"},
                {"link.bin", "'link.bin', which is outside its folder"},
                {"file:///etc/hostname", "which does not exist in its folder"},
                {"none.bin", "'none.bin', which does not exist in its folder"},
                {"pipe.bin", "'pipe.bin' cannot be opened"}};
    for (size_t i = 0; i < COUNT(rows); i++) {
        char gltf[SCRATCH_PATH_MAX];
        assert_refused(put_gltf(state, gltf, "in/box.gltf", rows[i].uri), NULL, LIMIT,
                       rows[i].words);
    }
    assert_int_equal(symlink("in/../outside.bin", scratch_path(state, link, "link.bin")), 0);
    char gltf[SCRATCH_PATH_MAX];
    assert_box(put_gltf(state, gltf, "inside.gltf", "link.bin"));
}

/* Reading the pipe would not end. */
static void test_materials_are_not_opened(void **state)
{
    char path[SCRATCH_PATH_MAX];
    want_program();
    assert_int_equal(mkfifo(scratch_path(state, path, "pipe.mtl"), 0600), 0);
    assert_box(put_obj(state, path, "box.obj", "mtllib pipe.mtl\nusemtl a\n", ""));
}

static void test_a_missing_program_is_reported(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_diag diag = {0};
    struct neph_mesh_data data = {0};
    put_obj(state, path, "box.obj", "", "");
    setenv("NEPH_MESH", "/nowhere/neph-mesh", 1);
    const enum neph_status status = neph_mesh_read(
        &(struct neph_mesh_request){.path = path, .limit_bytes = LIMIT}, &data, &diag);
    unsetenv("NEPH_MESH");
    assert_int_equal(status, NEPH_ERR_UNAVAILABLE);
    assert_non_null(strstr(diag.message, "/nowhere/neph-mesh"));
    assert_non_null(strstr(diag.hint, "libassimp-dev"));
}

/* ---- damage ---------------------------------------------------------------------------------- */

/* The result is a sound mesh or an error with a reason. */
static void read_damaged(const char *path)
{
    struct neph_mesh_data data = {0};
    struct neph_diag diag = {0};
    const enum neph_status status = neph_mesh_read(
        &(struct neph_mesh_request){.path = path, .limit_bytes = MIB}, &data, &diag);
    if (status) {
        assert_int_equal(status, NEPH_ERR_INPUT);
        assert_non_null(strstr(diag.message, path));
    }
    for (int v = 0; v < data.vertex_count; v++)
        assert_true(isfinite(neph_vec3_length(data.positions[v])));
    neph_mesh_data_finish(&data);
}

static void damage(const char *path, int count, uint64_t *seed)
{
    char *bytes = NULL, *copy = NULL;
    size_t size = 0;
    neph_assert_ok(neph_file_read(path, LIMIT, &bytes, &size, NULL), NULL);
    copy = malloc(size);
    for (int i = 0; i < count; i++) {
        memcpy(copy, bytes, size);
        for (uint64_t left = neph_test_random(seed) % 4; left > 0; left--)
            copy[neph_test_random(seed) % size] = (char)neph_test_random(seed);
        scratch_write(path, copy, i % 4 == 0 ? neph_test_random(seed) % size : size);
        read_damaged(path);
    }
    free(copy);
    free(bytes);
}

static void test_damaged_files(void **state)
{
    const char *text = getenv("NEPH_TEST_SEED");
    uint64_t seed = text ? strtoull(text, NULL, 10) : (uint64_t)time(NULL);
    const struct box_bytes box = box_bytes();
    const int count = neph_test_by_day(4, 60);
    char path[SCRATCH_PATH_MAX];
    want_program();
    print_message("mutations of files: NEPH_TEST_SEED=%llu\n", (unsigned long long)seed);
    damage(put_obj(state, path, "box.obj", "o box\n", ""), count, &seed);
    damage(put_ply(state, path, "ascii", 0), count, &seed);
    damage(put_ply(state, path, "binary_big_endian", 0), count, &seed);
    damage(put_whole(state, path, "box.gltf", &box, ONE_NODE), count, &seed);
    damage(put_glb(state, path, 0), count, &seed);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        scratch_test(test_a_box_in_each_format),
        scratch_test(test_polygons_become_triangles),
        scratch_test(test_normals_and_uv_of_all_vertices_or_none),
        scratch_test(test_objects),
        scratch_test(test_nodes_are_placed),
        scratch_test(test_open_and_non_manifold_meshes),
        scratch_test(test_text_at_fault),
        scratch_test(test_truncated_files),
        scratch_test(test_indices_and_numbers_of_gltf),
        scratch_test(test_huge_files),
        scratch_test(test_files_outside_of_the_folder),
        scratch_test(test_materials_are_not_opened),
        scratch_test(test_a_missing_program_is_reported),
        scratch_test(test_damaged_files),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
