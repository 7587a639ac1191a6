/* SPDX-License-Identifier: MIT
 *
 * Compares the conformance folders of two devices within bounds for each engine and channel.
 */
#include "harness/run/conform.h"

#include "base/exr.h"
#include "base/files.h"
#include "base/path.h"
#include "metrics/validity.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The allowed difference of a channel between two devices. A pixel is within its bound when
 *
 *   |a - b| <= relative max(|a|, |b|) + of_largest L,   L: the channel's largest value in A or B.
 *
 * A share of the pixels may exceed the bound: where a branch depends on the last bit of a value,
 * either side is correct. The difference of the means (over all pixels of the frames, while the
 * folders have only the sparse grid) must be below `mean`, relative to L. */
struct bound {
    const char *engine;  /* "": any */
    const char *channel; /* or a layer, with the trailing '.' */
    double relative, of_largest, share, mean;
};

/* Sources of the bounds below, by engine:
 *
 * - Any engine: Vulkan allows exp(x) an error of 3 + 2 |x| units in the last place and a division
 *   2.5. At an optical depth of 16, behind which a marcher stops, that is 35 units or 4e-6 for each
 *   exponential of view and sun. A position 1 km from the camera is known to 6e-5 m, and densities
 *   rise by about 1e-2 per metre at the edges of clouds, over 64 steps. The sum is below 2e-4 of
 *   the value and 2e-5 of the largest value. 2 of 1,000 pixels may fall on the other side of a
 *   silhouette or of a shadow's edge.
 * - Z: the distance to a sphere takes three roundings of its radius, 4.5e-4 of the way for an eye
 *   at 1/2500 of the radius above the sphere, as in scene atmosphere_shell.
 * - realtime, volume.distance: the distance of the tap nearest in depth. Taps along a row of the
 *   ground are equally near, and the last bit decides between them. Of 197 pixels in three frames
 *   of `unity`, which reads nine taps, each had the distance of another tap; the light was equal
 *   and the means were 3e-4 apart. The allowed share of pixels is therefore large, and the bound of
 *   the mean is tight.
 * - realtime: the history is half precision, with units of 5e-4, over several frames, and
 *   thresholds decide whether a history is valid. More pixels may differ; the bound of the mean
 *   stays tight. Of 203 frames on an NVIDIA H100 and on lavapipe the worst had 3.3 % of pixels
 *   beyond the bound, the next one 1 %.
 * - tracer: the random numbers are equal, but a collision that the last bit turns into a null
 *   collision sends the remaining path elsewhere, where it is as correct. Of 33 frames the worst
 *   had 3.2 % of pixels beyond the bound and a mean 1e-4 off.
 * - march_traced: its paths diverge in the same way, and each path counts in one coarse texel,
 *   which covers many pixels, and in the texel's neighbours. Of the 512 paths of a texel one in 18
 *   diverged between an NVIDIA H100 and lavapipe. At 48x27 a third of the pixels differed, by 0.17
 *   % of the largest value (rms) and at most 0.64 %; two seeds are 0.71 % (rms) and 5 % (most)
 *   apart. The bound therefore limits the size of the differences instead of their number: a
 *   quarter of the noise.
 * - fog_look: a closed form per ray; each device is tested against its formula to 1e-5. */
static const struct bound bounds[] = {
    {"realtime", "Z", 5e-4, 0.0, 0.002, 1e-3},
    {"realtime", "volume.distance", 1e-2, 1e-3, 0.2, 1e-2},
    {"realtime", "", 4e-3, 1e-3, 0.05, 5e-4},
    {"march_traced", "Z", 5e-4, 0.0, 0.002, 1e-3},
    {"march_traced", "", 2e-4, 1.25e-2, 0.002, 2e-3},
    {"fog_look", "", 1e-5, 1e-6, 0.002, 1e-6},
    {"tracer", "Z", 5e-4, 0.0, 0.002, 1e-3},
    {"tracer", "", 2e-4, 2e-5, 0.05, 5e-4},
    {"", "Z", 5e-4, 0.0, 0.002, 1e-3},
    {"", "volume.distance", 2e-3, 1e-4, 0.01, 1e-3},
    {"", "", 2e-4, 2e-5, 0.002, 2e-5},
};

static bool matches_channel(const char *channel, const char *name)
{
    const size_t length = strlen(name);
    if (length == 0 || name[length - 1] == '.')
        return strncmp(channel, name, length) == 0;
    return strcmp(channel, name) == 0;
}

static const struct bound *find_bound(const char *engine, const char *channel)
{
    const struct bound *bound = bounds;
    while (!((!bound->engine[0] || strcmp(bound->engine, engine) == 0) &&
             matches_channel(channel, bound->channel)))
        bound++; /* the last row matches every channel */
    return bound;
}

/* --- folders ------------------------------------------------------------------------------ */

static bool is_json(const char *name)
{
    const size_t length = strlen(name);
    return name[0] != '.' && length > 5 && strcmp(name + length - 5, ".json") == 0;
}

static enum neph_status check_scene(const char *path, const json_t *scene, struct neph_diag *diag)
{
    if (strcmp(neph_json_text(scene, "format"), "neph-conform-1") == 0 &&
        json_is_string(json_object_get(scene, "scene_hash")) &&
        json_is_string(json_object_get(scene, "device")) &&
        json_is_array(json_object_get(scene, "pictures")))
        return NEPH_OK;
    return neph_fail(diag, NEPH_ERR_INPUT, "'%s' is not a file of `neph conform`", path);
}

static enum neph_status read_scene(const char *folder, const char *file, json_t *scenes,
                                   struct neph_diag *diag)
{
    const struct neph_path path = neph_path_in(folder, file);
    json_error_t error;
    json_t *scene = json_load_file(path.text, JSON_REJECT_DUPLICATES, &error);
    if (!scene)
        return neph_fail(diag, NEPH_ERR_INPUT, "'%s': %s", path.text, error.text);
    enum neph_status status = check_scene(path.text, scene, diag);
    if (!status)
        status = neph_json_put(scenes, file, json_incref(scene), diag);
    json_decref(scene);
    return status;
}

/* Reads the scenes of a folder, keyed by their file names. */
static enum neph_status read_folder(const char *folder, json_t **scenes, struct neph_diag *diag)
{
    struct neph_arena arena = {NULL};
    struct neph_names names;
    json_t *read = json_object();
    enum neph_status status = NEPH_OK;
    if (neph_dir_list(folder, &arena, &names, NULL))
        status = neph_fail(diag, NEPH_ERR_NOT_FOUND, "'%s': %s", folder, strerror(errno));
    for (int i = 0; i < names.count && !status; i++)
        if (is_json(names.list[i]))
            status = read_scene(folder, names.list[i], read, diag);
    neph_arena_finish(&arena);
    if (!status && json_object_size(read) == 0)
        status = neph_fail(diag, NEPH_ERR_INPUT, "'%s' has no files of `neph conform`", folder);
    if (status)
        json_decref(read);
    else
        *scenes = read;
    return status;
}

/* --- one channel -------------------------------------------------------------------------- */

static const json_t *find_named(const json_t *list, const char *key, const char *name)
{
    size_t i;
    json_t *item;
    json_array_foreach(list, i, item)
    {
        if (strcmp(neph_json_text(item, key), name) == 0)
            return item;
    }
    return NULL;
}

static double read_channel_number(const json_t *entry, const char *channel, const char *key)
{
    const json_t *item = find_named(json_object_get(entry, "channels"), "channel", channel);
    return item ? json_number_value(json_object_get(item, key)) : NAN;
}

/* The entries and the sparse pixel grids of one frame on both devices. */
struct pair {
    const char *engine;
    const json_t *entry[2];
    const struct neph_image *lattice[2];
};

struct distance {
    double worst; /* largest |a - b| of a pixel, relative to the channel's largest value */
    size_t beyond, allowed;
    double mean, mean_allowed; /* both relative to the largest value */
};

static struct distance measure_channel(const struct pair *pair, const char *channel,
                                       const struct bound *bound)
{
    const float *a = neph_image_channel(pair->lattice[0], channel);
    const float *b = neph_image_channel(pair->lattice[1], channel);
    const size_t count = neph_image_pixel_count(pair->lattice[0]);
    const double largest = fmax(read_channel_number(pair->entry[0], channel, "largest"),
                                read_channel_number(pair->entry[1], channel, "largest"));
    const double apart_means = fabs(read_channel_number(pair->entry[0], channel, "mean") -
                                    read_channel_number(pair->entry[1], channel, "mean"));
    struct distance distance = {.allowed = (size_t)(bound->share * (double)count),
                                .mean = apart_means / fmax(largest, 1e-30),
                                .mean_allowed = bound->mean};
    for (size_t i = 0; i < count; i++) {
        if (a[i] == b[i])
            continue;
        const double apart = fabs((double)a[i] - b[i]), size = fmax(fabs(a[i]), fabs(b[i]));
        const bool within = isfinite(apart) &&
                            apart <= bound->relative * size + bound->of_largest * largest;
        distance.beyond += !within;
        if (isfinite(apart))
            distance.worst = fmax(distance.worst, apart / fmax(largest, 1e-30));
    }
    return distance;
}

/* --- one frame ---------------------------------------------------------------------------- */

static bool compare_channels(const struct pair *pair, json_t **channels, char *because, size_t size)
{
    bool agrees = true;
    for (int c = 0; c < pair->lattice[0]->channel_count; c++) {
        const char *name = pair->lattice[0]->channels[c].name;
        if (strncmp(name, "variance.", strlen("variance.")) == 0)
            continue; /* an estimate of the noise, which differs between valid renders */
        const struct distance distance = measure_channel(pair, name,
                                                         find_bound(pair->engine, name));
        const bool within = distance.beyond <= distance.allowed &&
                            distance.mean <= distance.mean_allowed;
        if (!within && agrees)
            snprintf(because, size,
                     "%s: %zu pixels beyond the bound, %zu allowed; means %.2g of the largest "
                     "value apart, %.2g allowed",
                     name, distance.beyond, distance.allowed, distance.mean, distance.mean_allowed);
        agrees = agrees && within;
        neph_json_add(channels, json_pack("{s:s, s:b, s:f, s:I, s:I, s:f, s:f}", "channel", name,
                                          "within", within, "worst", distance.worst, "beyond",
                                          (json_int_t)distance.beyond, "allowed",
                                          (json_int_t)distance.allowed, "mean", distance.mean,
                                          "mean_allowed", distance.mean_allowed));
    }
    return agrees;
}

/* Compares the properties that both entries must share; returns the difference, or NULL. */
static const char *find_difference(const json_t *a, const json_t *b)
{
    static const char *const keys[] = {"outcome", "engine", "settings", "size_px", "pictures"};
    static const char *const differences[] = {"one rendered it and the other did not",
                                              "the engines differ", "the settings differ",
                                              "the sizes differ", "the sequences differ in length"};
    for (size_t k = 0; k < sizeof(keys) / sizeof(keys[0]); k++)
        if (!json_equal(json_object_get(a, keys[k]), json_object_get(b, keys[k])))
            return differences[k];
    return strcmp(neph_json_text(a, "outcome"), "rendered") != 0 ? "both failed" : NULL;
}

/* On NEPH_OK `*agrees` is set. */
static enum neph_status compare_pixel_grids(const char *const folders[2], const char *name,
                                            const json_t *const entries[2], json_t **channels,
                                            bool *agrees, char *because, size_t size,
                                            struct neph_diag *diag)
{
    struct neph_image *a = NULL, *b = NULL;
    enum neph_status status = neph_exr_read(neph_path_format("%s/%s.exr", folders[0], name).text,
                                            &a, diag);
    if (!status)
        status = neph_exr_read(neph_path_format("%s/%s.exr", folders[1], name).text, &b, diag);
    if (!status)
        status = neph_validity_same_size(a, b, diag);
    if (!status)
        status = neph_validity_same_channels(a, b, diag);
    if (!status) {
        const struct pair pair = {
            neph_json_text(entries[0], "engine"), {entries[0], entries[1]}, {a, b}};
        *agrees = compare_channels(&pair, channels, because, size);
    }
    neph_image_destroy(a);
    neph_image_destroy(b);
    return status;
}

static bool is_expected(const json_t *entry)
{
    return strcmp(neph_json_text(entry, "outcome"), "cannot") != 0;
}

/* Compares a frame that both folders have, or reports one of a single folder (the other entry is
 * NULL). */
static enum neph_status compare_picture(const char *const folders[2],
                                        const json_t *const entries[2], bool same_scene,
                                        json_t *pictures, struct neph_diag *diag)
{
    char because[512] = "";
    const json_t *any = entries[0] ? entries[0] : entries[1];
    const char *name = json_string_value(json_object_get(any, "picture"));
    bool agrees = false;
    json_t *channels = json_array();
    enum neph_status status = name ? NEPH_OK
                                   : neph_fail(diag, NEPH_ERR_INPUT, "a frame without a name");
    const char *difference = NULL;
    if (!entries[0] || !entries[1])
        difference = entries[0] ? "only the first folder has it" : "only the second folder has it";
    else
        difference = same_scene ? find_difference(entries[0], entries[1])
                                : "the scenes of that name differ";
    if (difference)
        snprintf(because, sizeof(because), "%s", difference);
    else if (!status)
        status = compare_pixel_grids(folders, name, entries, &channels, &agrees, because,
                                     sizeof(because), diag);
    if (!status)
        return neph_json_append(pictures,
                                json_pack("{s:s, s:b, s:o, s:s}", "picture", name, "agrees", agrees,
                                          "channels", channels, "because", because),
                                diag);
    json_decref(channels);
    return status;
}

/* --- all frames --------------------------------------------------------------------------- */

static bool is_wanted_scene(const struct neph_conform_part *part, const json_t *scene)
{
    bool wanted = part->scene_count == 0;
    for (int i = 0; i < part->scene_count; i++)
        wanted = wanted || strcmp(part->scenes[i], neph_json_text(scene, "scene")) == 0;
    return wanted;
}

static bool is_wanted(const struct neph_conform_part *part, const json_t *entry)
{
    const char *engine = json_string_value(json_object_get(entry, "engine"));
    bool wanted = part->engine_count == 0 || !engine;
    for (int i = 0; i < part->engine_count && engine; i++)
        wanted = wanted || strcmp(part->engines[i], engine) == 0;
    return wanted;
}

/* Compares the frames of `scene`, from folder `which`, with the other folder's. Frames of both
 * folders are compared once, in the pass over the first folder. */
static enum neph_status compare_scene(const char *const folders[2], const json_t *scene,
                                      const json_t *other, int which,
                                      const struct neph_conform_part *part, json_t *pictures,
                                      struct neph_diag *diag)
{
    const bool same_scene = other && json_equal(json_object_get(scene, "scene_hash"),
                                                json_object_get(other, "scene_hash"));
    enum neph_status status = NEPH_OK;
    size_t i;
    json_t *entry;
    json_array_foreach(json_object_get(scene, "pictures"), i, entry)
    {
        const char *name = json_string_value(json_object_get(entry, "picture"));
        const json_t *beside = name
                                   ? find_named(json_object_get(other, "pictures"), "picture", name)
                                   : NULL;
        if (status || !is_wanted(part, entry) || (which == 1 && beside) ||
            (!is_expected(entry) && (!beside || !is_expected(beside))))
            continue;
        const json_t *const entries[2] = {which == 0 ? entry : NULL, which == 0 ? beside : entry};
        status = compare_picture(folders, entries, same_scene, pictures, diag);
    }
    return status;
}

static enum neph_status compare_all(const char *const folders[2], json_t *const scenes[2],
                                    const struct neph_conform_part *part, json_t *pictures,
                                    struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int which = 0; which < 2; which++) {
        const char *file;
        json_t *scene;
        json_object_foreach(scenes[which], file, scene)
        {
            if (!status && is_wanted_scene(part, scene))
                status = compare_scene(folders, scene, json_object_get(scenes[1 - which], file),
                                       which, part, pictures, diag);
        }
    }
    return status;
}

static json_t *first_device(json_t *scenes)
{
    return json_object_get(json_object_iter_value(json_object_iter(scenes)), "device");
}

static int count_agreeing(const json_t *pictures)
{
    int count = 0;
    size_t i;
    json_t *picture;
    json_array_foreach(pictures, i, picture)
        count += json_is_true(json_object_get(picture, "agrees"));
    return count;
}

enum neph_status neph_conform_compare(const char *folder_a, const char *folder_b,
                                      const struct neph_conform_part *part, json_t **report,
                                      struct neph_diag *diag)
{
    const char *const folders[2] = {folder_a, folder_b};
    json_t *scenes[2] = {NULL, NULL}, *pictures = json_array(), *made = NULL;
    enum neph_status status = read_folder(folder_a, &scenes[0], diag);
    if (!status)
        status = read_folder(folder_b, &scenes[1], diag);
    if (!status)
        status = compare_all(folders, scenes, part, pictures, diag);
    if (!status) {
        made = json_pack("{s:[O,O], s:i, s:i, s:O}", "devices", first_device(scenes[0]),
                         first_device(scenes[1]), "expected", (int)json_array_size(pictures),
                         "agreeing", count_agreeing(pictures), "pictures", pictures);
        status = neph_json_check(made, diag);
    }
    json_decref(pictures);
    json_decref(scenes[0]);
    json_decref(scenes[1]);
    if (!status)
        *report = made;
    return status;
}
