/* SPDX-License-Identifier: MIT
 *
 * A variant as a file: the text of the original file with some values replaced.
 */
#include "scenes/variant.h"

#include "base/arena.h"
#include "base/files.h"
#include "base/text.h"
#include "scenes/document.h"
#include "scenes/load.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_VARIANT_KIND_COUNT == 3, "a new kind");

/* name, title, frames, sun or camera, and the files of volumes */
enum { SPLICES_MAX = 4 + NEPH_SCENE_MEDIA_MAX };

/* A range of bytes of the file, and its replacement. */
struct splice {
    size_t from, to;
    const char *text;
};

struct file {
    struct neph_arena arena; /* memory of the replacements */
    char *text;              /* owned */
    size_t size;
    struct neph_document document;
    struct splice splices[SPLICES_MAX];
    int splice_count;
};

/* --- places in the file ----------------------------------------------------------------------- */

/* libyaml counts characters, without a byte order mark. */
static size_t find_byte(const struct file *file, size_t character)
{
    size_t byte = strncmp(file->text, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
    for (; byte < file->size && (character > 0 || ((unsigned char)file->text[byte] & 0xc0) == 0x80);
         byte++)
        character -= ((unsigned char)file->text[byte] & 0xc0) != 0x80;
    return byte;
}

static bool is_block(const yaml_node_t *node)
{
    return node->type == YAML_MAPPING_NODE && node->data.mapping.style == YAML_BLOCK_MAPPING_STYLE;
}

/* A mapping in block style ends where the next key begins: that key keeps its indentation. */
static void replace_node(struct file *file, const yaml_node_t *node, const char *text)
{
    const size_t from = find_byte(file, node->start_mark.index);
    size_t to = find_byte(file, node->end_mark.index);
    while (is_block(node) && file->text[to - 1] == ' ')
        to--;
    text = neph_arena_format(&file->arena, is_block(node) ? "%s\n" : "%s", text);
    file->splices[file->splice_count++] = (struct splice){from, to, text};
}

/* Replaces the value of a key of the scene, or adds key and value before all others. */
static void replace_key(struct file *file, const char *key, const char *text)
{
    const yaml_node_t *root = neph_document_root(&file->document);
    const yaml_node_t *value = neph_document_value(&file->document, root, key, strlen(key));
    if (value) {
        replace_node(file, value, text);
        return;
    }
    const yaml_node_t *first = yaml_document_get_node(&file->document.yaml,
                                                      root->data.mapping.pairs.start->key);
    const size_t place = find_byte(file, first->start_mark.index);
    const int column = (int)first->start_mark.column;
    const char *pair = is_block(root)
                           ? neph_arena_format(&file->arena, "%s: %s\n%*s", key, text, column, "")
                           : neph_arena_format(&file->arena, "%s: %s, ", key, text);
    file->splices[file->splice_count++] = (struct splice){place, place, pair};
}

/* --- values ----------------------------------------------------------------------------------- */

static const char *quoted(struct neph_arena *arena, const char *text)
{
    char *made = neph_arena_allocate(arena, 2 * strlen(text) + 3, 1), *to = made;
    if (!made)
        return "";
    *to++ = '\'';
    for (; *text; text++) {
        if (*text == '\'')
            *to++ = '\'';
        *to++ = *text;
    }
    *to = '\'';
    return made;
}

static void put_vec3(FILE *out, const char *key, double x, double y, double z)
{
    fprintf(out, "%s: [%.17g, %.17g, %.17g]", key, x, y, z);
}

/* Copies a key with its value from the file, so that it is read as the same number. */
static bool copy_from_file(FILE *out, struct file *file, const char *path, const char *before)
{
    const char *dot = strrchr(path, '.'), *key = dot + 1;
    const yaml_node_t *node = neph_document_find(&file->document, path);
    if (node->type == YAML_MAPPING_NODE)
        return false; /* the file has only a part of the path */
    const size_t from = find_byte(file, node->start_mark.index);
    const size_t to = find_byte(file, node->end_mark.index);
    fprintf(out, "%s%s: %.*s", before, key, (int)(to - from), file->text + from);
    return true;
}

static void put_sun(FILE *out, struct file *file, const struct neph_scene *made)
{
    fprintf(out, "{keys: [");
    for (int i = 0; i < made->sun_key_count; i++) {
        const struct neph_sun_key *key = &made->sun_keys[i];
        fprintf(out, "%s\n    {frame: %g, ", i ? "," : "", key->frame);
        if (!copy_from_file(out, file, "sun.direction", ""))
            put_vec3(out, "direction", key->direction.x, key->direction.y, key->direction.z);
        put_vec3(out, ", irradiance_w_per_m2", key->irradiance_w_per_m2.r,
                 key->irradiance_w_per_m2.g, key->irradiance_w_per_m2.b);
        fprintf(out, "}");
    }
    fprintf(out, "]}");
}

/* Whether a key is replaced by camera keys. */
static bool is_camera_place_key(const char *key)
{
    return !strcmp(key, "position_m") || !strcmp(key, "look_at_m") || !strcmp(key, "keys");
}

static void put_camera(FILE *out, struct file *file, const struct neph_scene *made)
{
    const yaml_node_t *camera = neph_document_find(&file->document, "camera");
    const yaml_node_pair_t *pair = camera->data.mapping.pairs.start;
    fprintf(out, "{");
    for (; pair < camera->data.mapping.pairs.top; pair++) {
        const char *key = neph_document_text(
            yaml_document_get_node(&file->document.yaml, pair->key));
        if (!is_camera_place_key(key) &&
            copy_from_file(out, file, neph_format_path("camera.%s", key).text, ""))
            fprintf(out, ", ");
    }
    fprintf(out, "keys: [");
    for (int i = 0; i < made->camera_key_count; i++) {
        fprintf(out, "%s\n    {", i ? "," : "");
        neph_fields_write(neph_camera_key_fields, &made->camera_keys[i], out);
        fprintf(out, "}");
    }
    fprintf(out, "]}");
}

static void put_frames(FILE *out, struct file *file, const struct neph_scene *made)
{
    (void)file;
    fprintf(out, "{count: %d, rate_hz: %.17g", made->frame_count, made->frame_rate_hz);
    for (int i = 0; i < made->frame_scale_count; i++)
        fprintf(out, "%s{frame: %d, scale: %.17g}", i ? ", " : ", sizes: [",
                made->frame_scales[i].frame, made->frame_scales[i].scale);
    fprintf(out, "%s", made->frame_scale_count > 0 ? "]" : "");
    for (int i = 0; i < made->advance_count; i++)
        fprintf(out, "%s%.17g", i ? ", " : ", advance: [", made->advances[i]);
    fprintf(out, "%s", made->advance_count > 0 ? "]" : "");
    for (int i = 0; i < made->clear_count; i++)
        fprintf(out, "%s{frame: %d, count: %d}", i ? ", " : ", clear: [", made->clears[i].frame,
                made->clears[i].count);
    fprintf(out, "%s}", made->clear_count > 0 ? "]" : "");
}

typedef void put_function(FILE *out, struct file *file, const struct neph_scene *made);

static enum neph_status rewrite(struct file *file, const char *key, put_function *put,
                                const struct neph_scene *made, struct neph_diag *diag)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return neph_fail_memory(diag);
    put(out, file, made);
    const bool is_whole = fclose(out) == 0;
    if (is_whole)
        replace_key(file, key, text);
    free(text);
    return is_whole ? NEPH_OK : neph_fail_memory(diag);
}

/* Makes the path of a volume absolute, in quotes: relative paths start at the scene file, and the
 * variant is in another folder. */
static enum neph_status rewrite_volume(struct file *file, int medium, const char *scene_path,
                                       struct neph_diag *diag)
{
    char key[64];
    snprintf(key, sizeof(key), "media[%d].volume.file", medium);
    const yaml_node_t *node = neph_document_find(&file->document, key);
    if (node->type != YAML_SCALAR_NODE || strchr("$/", neph_document_text(node)[0]))
        return NEPH_OK;
    const char *slash = strrchr(scene_path, '/');
    const char *joined = neph_arena_format(&file->arena, "%.*s%s",
                                           slash ? (int)(slash - scene_path + 1) : 0, scene_path,
                                           neph_document_text(node));
    const enum neph_status status = neph_arena_check(&file->arena, diag);
    if (status)
        return status;
    char *absolute = realpath(joined, NULL);
    if (!absolute)
        return neph_fail(diag, NEPH_ERR_IO, "cannot resolve '%s': %s", joined, strerror(errno));
    replace_node(file, node, quoted(&file->arena, absolute));
    free(absolute);
    return NEPH_OK;
}

/* --- the file --------------------------------------------------------------------------------- */

static enum neph_status read_file(const char *path, struct file *file, struct neph_diag *diag)
{
    enum neph_status status = neph_file_read(path, NEPH_DOCUMENT_MAX_BYTES, &file->text,
                                             &file->size, diag);
    if (status)
        return status;
    if (!neph_text_is_utf8(file->text, file->size))
        status = neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                           "'%s' is not in UTF-8: its variants cannot be written as a file", path);
    else
        status = neph_document_init(&file->document, path, file->text, file->size,
                                    NEPH_DOCUMENT_DEPTH_MAX, diag);
    if (status)
        free(file->text);
    return status;
}

static void finish(struct file *file)
{
    neph_arena_finish(&file->arena);
    neph_document_finish(&file->document);
    free(file->text);
}

static enum neph_status make_splices(struct file *file, const struct neph_scene *made,
                                     bool has_camera, struct neph_diag *diag)
{
    replace_key(file, "name", quoted(&file->arena, made->name));
    replace_key(file, "title", quoted(&file->arena, made->title));
    enum neph_status status = rewrite(file, "frames", put_frames, made, diag);
    if (!status)
        status = rewrite(file, has_camera ? "camera" : "sun", has_camera ? put_camera : put_sun,
                         made, diag);
    for (int i = 0; i < made->medium_count && !status; i++)
        status = rewrite_volume(file, i, made->path, diag);
    return status ? status : neph_arena_check(&file->arena, diag);
}

static int compare_places(const void *a_, const void *b_)
{
    const struct splice *a = a_, *b = b_;
    return (a->from > b->from) - (a->from < b->from);
}

static enum neph_status join(struct file *file, char **text, struct neph_diag *diag)
{
    char *joined = NULL;
    size_t size = 0, place = 0;
    FILE *out = open_memstream(&joined, &size);
    if (!out)
        return neph_fail_memory(diag);
    qsort(file->splices, (size_t)file->splice_count, sizeof(file->splices[0]), compare_places);
    for (int i = 0; i < file->splice_count; i++) {
        fwrite(file->text + place, 1, file->splices[i].from - place, out);
        fputs(file->splices[i].text, out);
        place = file->splices[i].to;
    }
    fwrite(file->text + place, 1, file->size - place, out);
    if (fclose(out) != 0) {
        free(joined);
        return neph_fail_memory(diag);
    }
    *text = joined;
    return NEPH_OK;
}

/* `has_camera`: the camera is replaced, not the sun. */
static enum neph_status write_text(const struct neph_scene *made, bool has_camera, char **text,
                                   struct neph_diag *diag)
{
    struct file file = {.splice_count = 0};
    enum neph_status status = read_file(made->path, &file, diag);
    if (status)
        return status;
    status = make_splices(&file, made, has_camera, diag);
    if (!status)
        status = join(&file, text, diag);
    finish(&file);
    return status;
}

enum neph_status neph_scene_variant_text(const struct neph_scene *scene,
                                         const struct neph_variant *variant, char **text,
                                         struct neph_diag *diag)
{
    struct neph_scene *made = NULL;
    enum neph_status status = neph_scene_variant(scene, variant, &made, diag);
    if (!status)
        status = write_text(made, variant->kind == NEPH_VARIANT_CAMERA_CUT, text, diag);
    neph_scene_destroy(made);
    return status;
}

enum neph_status neph_scene_camera_text(const struct neph_scene *made, char **text,
                                        struct neph_diag *diag)
{
    if (made->orthographic_height_m > 0.0)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "%s has an orthographic camera", made->name);
    return write_text(made, true, text, diag);
}
