/* SPDX-License-Identifier: MIT */
#include "harness/night/scene_copy.h"

#include "base/files.h"
#include "base/path.h"
#include "harness/data.h"
#include "scenes/display.h"
#include "scenes/failing.h"
#include "scenes/gates.h"
#include "scenes/injection.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- values that are not in the hash --------------------------------------------------------- */

static void put_gates(FILE *text, const struct neph_scene *scene)
{
    const struct neph_gates *gates = neph_scene_gates(scene);
    for (int i = 0; i < gates->count; i++) {
        const struct neph_gate *gate = &gates->list[i];
        fprintf(text, "gate %s %d %s %s %.17g\n", gate->engine, (int)gate->quantity, gate->metric,
                gate->mask, gate->maximum);
    }
}

static void put_axis(FILE *text, const struct neph_failing_axis *axis)
{
    fprintf(text, "axis %s %s", axis->name, axis->paths);
    for (int i = 0; i < axis->to_count; i++)
        fprintf(text, " to %.17g", axis->to[i]);
    for (int i = 0; i < axis->by_count; i++)
        fprintf(text, " by %.17g", axis->by[i]);
    fputc('\n', text);
}

static void put_failing(FILE *text, const struct neph_failing *failing)
{
    if (!failing->fails)
        return;
    fprintf(text, "failing %dx%d frames %d steps %d event %d truth %s engines %d presets %s\n",
            failing->width_px, failing->height_px, failing->frame_count, failing->steps,
            failing->event_frame, neph_failing_reference_name(failing->truth), failing->engines,
            failing->presets ? failing->presets : "");
    for (int i = 0; i < failing->limit_count; i++)
        fprintf(text, "limit %s %s %.17g\n", neph_failing_measure_name(failing->limits[i].measure),
                failing->limits[i].over, failing->limits[i].limit);
    for (int i = 0; i < failing->axis_count; i++)
        put_axis(text, &failing->axes[i]);
}

enum neph_status neph_scene_terms(const struct neph_scene *scene, char terms[NEPH_HASH_HEX_SIZE],
                                  struct neph_diag *diag)
{
    char *data = NULL, *injections = neph_injections_text(neph_scene_injections(scene));
    size_t size = 0;
    FILE *text = injections ? open_memstream(&data, &size) : NULL;
    const struct neph_scene_display *display = neph_scene_display(scene);
    const char *slash = display->chain ? strrchr(display->chain, '/') : NULL;
    const char *chain = slash ? slash + 1 : display->chain ? display->chain : "";
    int failed = !text;
    if (text) {
        fprintf(text, "neph-scene-terms-1\nexposure_ev %.17g\nchain %s\ninject %s\n",
                display->exposure_ev, chain, injections);
        put_gates(text, scene);
        put_failing(text, scene->failing);
        failed = ferror(text);
        failed |= fclose(text);
    }
    const enum neph_status status = failed ? neph_fail_memory(diag)
                                           : neph_hash(data, size, terms, diag);
    free(injections);
    free(data);
    return status;
}

/* ---- copies ---------------------------------------------------------------------------------- */

const char *neph_scene_copy_path(const char *store_folder, const struct neph_history_scene *scene,
                                 struct neph_arena *arena)
{
    return neph_arena_format(arena, "%s/scenes/%.8s-%.8s/%s.yaml", store_folder, scene->hash,
                             scene->terms, scene->scene);
}

static enum neph_status write_copy(const char *from, const char *to, struct neph_diag *diag)
{
    static const size_t scene_limit_bytes = 64 << 20;
    char *text = NULL;
    size_t size = 0;
    enum neph_status status = neph_dir_create(
        neph_path_format("%.*s", (int)(strrchr(to, '/') - to), to).text, diag);
    if (!status)
        status = neph_file_read(from, scene_limit_bytes, &text, &size, diag);
    if (!status)
        status = neph_file_write(to, text, size, diag);
    free(text);
    return status;
}

enum neph_status neph_scene_copy_keep(const char *store_folder, const char *name,
                                      struct neph_arena *arena, struct neph_history_scene *row,
                                      struct neph_diag *diag)
{
    char terms[NEPH_HASH_HEX_SIZE];
    struct neph_scene *scene = NULL;
    enum neph_status status = neph_data_load_scene(name, &scene, diag);
    if (!status)
        status = neph_scene_terms(scene, terms, diag);
    if (!status) {
        row->scene = neph_arena_copy_text(arena, scene->name);
        row->hash = neph_arena_copy_text(arena, scene->hash);
        row->terms = neph_arena_copy_text(arena, terms);
        const char *path = neph_scene_copy_path(store_folder, row, arena);
        status = neph_arena_check(arena, diag);
        if (!status && !neph_path_exists(path))
            status = write_copy(scene->path, path, diag);
    }
    neph_scene_destroy(scene);
    return status;
}
