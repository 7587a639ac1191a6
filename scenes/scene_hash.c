/* SPDX-License-Identifier: MIT
 *
 * The hash of a scene: BLAKE2b of a text with every key that changes a rendered value, written by
 * the tables that read the keys, each number with 17 digits. A row of a table is part of the text
 * unless its `hashing` excludes it. The text has no comments, names, title, gates and exposure, and
 * does not depend on the order of keys; solids and movers appear as expanded from the file's
 * entries.
 */
#include "scenes/hash_text.h"
#include "scenes/load.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Increase when the meaning of a key changes, so that old results are not reused. */
#define HASH_VERSION 1

/* The sun of frame 0. */
static void put_sun(const struct neph_scene *scene, FILE *text)
{
    if (!scene->sun.present)
        return;
    neph_put_vec3(text, "sun_direction", scene->sun.direction);
    neph_put_rgb(text, "sun_irradiance_w_per_m2", scene->sun.irradiance_w_per_m2);
}

static void put_scattering(const struct neph_scene *scene, FILE *text)
{
    fprintf(text, "scattering %s\n", neph_scattering_name(scene->scattering));
}

/* The start of the text in the order of existing hashes: values that were converted from the
 * file's, mixed with rows of the file. All other rows follow in the order of their table. */
static const struct part {
    void (*put)(const struct neph_scene *scene, FILE *text);
    const char *key;
} parts[] = {
    {.key = "camera"},
    {.key = "frames"},
    {.put = neph_movers_hash},
    {.key = "sun"},
    {.key = "wind"},
    {.put = put_sun},
    {.key = "lights"},
    {.key = "background_w_per_m2_sr"},
    {.key = "environment_light"},
    {.put = put_scattering},
    {.put = neph_solids_hash},
    {.key = "media"},
    {.key = "fog_look"},
    {.key = "octaves"},
    {.key = "bake_resolution"},
};
enum { PART_COUNT = sizeof(parts) / sizeof(parts[0]) };

static void put_row(const struct neph_field *row, const struct neph_scene *scene, FILE *text)
{
    const struct neph_field only[] = {*row, {0}};
    neph_fields_hash(only, scene, text);
}

static const struct neph_field *find_row(const char *key)
{
    const struct neph_field *row = neph_scene_fields;
    while (strcmp(row->key, key))
        row++;
    return row;
}

static bool is_part(const struct neph_field *row)
{
    for (int i = 0; i < PART_COUNT; i++)
        if (parts[i].key && !strcmp(parts[i].key, row->key))
            return true;
    return false;
}

static void put_scene(const struct neph_scene *scene, FILE *text)
{
    neph_put_number(text, "neph_scene", HASH_VERSION);
    for (int i = 0; i < PART_COUNT; i++)
        if (parts[i].put)
            parts[i].put(scene, text);
        else
            put_row(find_row(parts[i].key), scene, text);
    for (const struct neph_field *row = neph_scene_fields; row->key; row++)
        if (!is_part(row))
            put_row(row, scene, text);
}

enum neph_status neph_scene_hash(struct neph_scene *scene, struct neph_diag *diag)
{
    char *data = NULL;
    size_t size = 0;
    FILE *text = open_memstream(&data, &size);
    if (!text)
        return neph_fail_memory(diag);
    put_scene(scene, text);
    int failed = ferror(text);
    failed |= fclose(text);
    enum neph_status status = failed ? neph_fail_memory(diag)
                                     : neph_hash(data, size, scene->hash, diag);
    free(data);
    return status;
}
