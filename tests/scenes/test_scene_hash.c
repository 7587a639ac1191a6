/* SPDX-License-Identifier: MIT
 *
 * Every key of a scene file that the tables read changes the hash of the scene, except keys whose
 * row declares that no rendered value depends on them. Keys of `volume` and of meshes, which need
 * files, are in test_volume_placement.c and test_mesh_scene.c. A key that no scene of every_key/
 * contains fails here.
 */
#include "tests/base/scratch.h"
#include "tests/printed_table.h"

#include "scenes/document.h"
#include "scenes/load.h"

enum { PATHS_MAX = 400 };

/* Keys not required in every_key/: keys of files, and one that depends on other keys. */
static const char *const left_out[] = {"media[].volume.", "media[].grid.size",
                                       "media[].KIND.phase_table", "solids[].mesh.",
                                       "solids[].height_field."};

/* Paths of keys without indices: "media[].gaussian.width_m". */
struct paths {
    char texts[PATHS_MAX][NEPH_FIELD_PATH_MAX];
    int count;
};

static bool has_path(const struct paths *paths, const char *path)
{
    for (int i = 0; i < paths->count; i++)
        if (!strcmp(paths->texts[i], path))
            return true;
    return false;
}

static void add_path(struct paths *paths, const char *path)
{
    assert_true(paths->count < PATHS_MAX);
    snprintf(paths->texts[paths->count++], NEPH_FIELD_PATH_MAX, "%s", path);
}

/* --- one change ------------------------------------------------------------------------------- */

struct probe {
    char path[SCRATCH_PATH_MAX]; /* of the changed file */
    char *text;
    size_t size;
    struct neph_document document;
    char hash[NEPH_HASH_HEX_SIZE]; /* of the unchanged file */
    struct paths *seen;
};

/* "": the scene is refused. */
static void hash_file(struct probe *probe, const char *text, size_t size,
                      char hash[NEPH_HASH_HEX_SIZE])
{
    struct neph_scene *scene = NULL;
    struct neph_diag diag = {.line = 0};
    scratch_write(probe->path, text, size);
    *hash = '\0';
    if (neph_scene_load(probe->path, &scene, &diag))
        return;
    memcpy(hash, scene->hash, NEPH_HASH_HEX_SIZE);
    neph_scene_destroy(scene);
}

/* Whether the scene with another value for a scalar has another hash; false: it is refused. */
static bool moves_hash(struct probe *probe, const yaml_node_t *node, const char *path,
                       const char *value)
{
    char hash[NEPH_HASH_HEX_SIZE];
    const size_t from = node->start_mark.index, to = node->end_mark.index;
    char *text = neph_format("%.*s%s%s", (int)from, probe->text, value, probe->text + to);
    hash_file(probe, text, strlen(text), hash);
    free(text);
    if (*hash && !strcmp(hash, probe->hash))
        fail_msg("%s: %s has the same hash", path, value);
    return *hash != '\0';
}

/* A slightly larger or smaller number, the opposite flag or another word; false: none gives a valid
 * scene. */
static bool change(struct probe *probe, const yaml_node_t *node, const char *path)
{
    static const char *const words[] = {
        "true", "false",  "x",    "z",        "checker",           "noise",   "streaks",
        "even", "single", "none", "rayleigh", "henyey_greenstein", "constant"};
    char *end;
    const char *old = neph_document_text(node);
    const double number = strtod(old, &end);
    const double numbers[] = {number * 1.0078125, number * 0.9921875, number + 1.0, number - 1.0};
    bool moved = false;
    for (size_t i = 0; i < COUNT(numbers) && !*end && !moved; i++) {
        char value[32];
        snprintf(value, sizeof(value), "%.17g", numbers[i]);
        moved = numbers[i] != number && moves_hash(probe, node, path, value);
    }
    for (size_t i = 0; i < COUNT(words) && *end && !moved; i++)
        moved = strcmp(words[i], old) && moves_hash(probe, node, path, words[i]);
    return moved;
}

/* --- all keys of a file ----------------------------------------------------------------------- */

static bool is_hashed(const char *path)
{
    const struct neph_field *row = neph_scene_fields;
    while (strncmp(row->key, path, strlen(row->key)) ||
           strchr(".[", path[strlen(row->key)]) == NULL)
        row++;
    return row->hashing != NEPH_NOT_HASHED;
}

static void walk(struct probe *probe, const yaml_node_t *node, const char *path)
{
    yaml_document_t *yaml = &probe->document.yaml;
    if (node->type == YAML_MAPPING_NODE) {
        const yaml_node_pair_t *pair = node->data.mapping.pairs.start;
        for (; pair < node->data.mapping.pairs.top; pair++) {
            const char *key = neph_document_text(yaml_document_get_node(yaml, pair->key));
            walk(probe, yaml_document_get_node(yaml, pair->value),
                 neph_format_path("%s%s%s", path, *path ? "." : "", key).text);
        }
    } else if (node->type == YAML_SEQUENCE_NODE) {
        const yaml_node_item_t *item = node->data.sequence.items.start;
        for (; item < node->data.sequence.items.top; item++) {
            const yaml_node_t *value = yaml_document_get_node(yaml, *item);
            const bool is_entry = value->type == YAML_MAPPING_NODE;
            walk(probe, value, neph_format_path("%s%s", path, is_entry ? "[]" : "").text);
        }
    } else if (is_hashed(path) && !has_path(probe->seen, path)) {
        if (change(probe, node, path))
            add_path(probe->seen, path);
    }
}

static void walk_file(void **state, const char *name, struct paths *seen)
{
    struct probe probe = {.seen = seen};
    struct neph_diag diag = {.line = 0};
    char *path = neph_format(NEPH_SOURCE_DIR "/tests/scenes/every_key/%s", name);
    neph_assert_ok(neph_file_read(path, 1 << 20, &probe.text, &probe.size, &diag), &diag);
    scratch_path(state, probe.path, "probe.yaml");
    hash_file(&probe, probe.text, probe.size, probe.hash);
    if (!*probe.hash)
        fail_msg("%s is no scene", name);
    neph_assert_ok(neph_document_init(&probe.document, path, probe.text, probe.size,
                                      NEPH_DOCUMENT_DEPTH_MAX, &diag),
                   &diag);
    walk(&probe, neph_document_root(&probe.document), "");
    neph_document_finish(&probe.document);
    free(probe.text);
    free(path);
}

/* --- all keys of the tables ------------------------------------------------------------------- */

/* For `media[].KIND.albedo` any medium counts. */
static bool is_seen(const struct paths *seen, const char *path)
{
    static const char kind[] = "media[].KIND.";
    if (strncmp(path, kind, strlen(kind)) != 0)
        return has_path(seen, path);
    for (int i = 0; i < seen->count; i++) {
        const char *key = strrchr(seen->texts[i], '.');
        if (!strncmp(seen->texts[i], "media[].", 8) && !strcmp(key + 1, path + strlen(kind)))
            return true;
    }
    return false;
}

static void check_seen(const struct paths *seen, const char *path)
{
    bool is_owed = is_hashed(path);
    for (size_t i = 0; i < COUNT(left_out); i++)
        is_owed &= strncmp(path, left_out[i], strlen(left_out[i])) != 0;
    if (is_owed && !is_seen(seen, path))
        fail_msg("%s is changed in no scene of tests/scenes/every_key/", path);
}

/* A row of the printed table: "| `owner.key`, `.other_key` | value | ...". Mappings and lists of
 * mappings have no value of their own. */
static void check_row(const struct paths *seen, char *row)
{
    char *value = strchr(row + 2, '|') + 2, *rest = NULL;
    char first[NEPH_FIELD_PATH_MAX] = "";
    if (strchr(" |", *value) || strstr(value, " entries |"))
        return;
    value[-2] = '\0';
    for (char *key = strtok_r(row, "`", &rest); key; key = strtok_r(NULL, "`", &rest)) {
        if (strchr("|, ", *key))
            continue;
        const char *last = strrchr(first, '.');
        const int owner = *key == '.' && last ? (int)(last - first) : 0;
        const struct neph_path path = neph_format_path("%.*s%s", owner, first, key);
        check_seen(seen, path.text);
        snprintf(first, sizeof(first), "%s", path.text);
    }
}

static void test_every_key_moves_the_hash(void **state)
{
    static const char *const files[] = {"still.yaml", "moving.yaml", "parallel.yaml"};
    struct paths *seen = calloc(1, sizeof(*seen));
    assert_non_null(seen);
    for (size_t i = 0; i < COUNT(files); i++)
        walk_file(state, files[i], seen);
    char *rows = printed(neph_scene_print_keys), *rest = NULL;
    int count = 0;
    for (char *row = strtok_r(rows, "\n", &rest); row; row = strtok_r(NULL, "\n", &rest), count++)
        if (count > 1) /* after the head of the table */
            check_row(seen, row);
    assert_true(count > 150);
    free(rows);
    free(seen);
}

int main(void)
{
    const struct CMUnitTest tests[] = {scratch_test(test_every_key_moves_the_hash)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
