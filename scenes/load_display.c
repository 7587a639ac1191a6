/* SPDX-License-Identifier: MIT
 *
 * Display settings of a scene's frames: the keys of `display` in its file. To add a field, add a
 * member in scenes/display.h and a row here.
 */
#include "scenes/display.h"
#include "scenes/load.h"

#include <stddef.h>
#include <string.h>

#define DISPLAY(member) offsetof(struct neph_scene_display, member)

const struct neph_scene_display *neph_scene_display(const struct neph_scene *scene)
{
    static const struct neph_scene_display plain = {.exposure_ev = 0.0};
    return scene->display ? scene->display : &plain;
}

static const struct neph_field display_fields[] = {
    {"exposure_ev", NEPH_NUMBER, DISPLAY(exposure_ev), "EV", -40, 40,
     .note = "displayed images are radiance times 2^ev; measured values are not", .standard = "0"},
    {"chain", NEPH_TEXT, DISPLAY(chain),
     .note = "a file, relative to the scene's folder: the post-processing chain with which `neph "
             "render` displays frames, docs/post.md; no frame depends on it",
     .least = 1, .most = 1000, .standard = "none"},
    {0},
};
const struct neph_record neph_display_record = {.size = sizeof(struct neph_scene_display),
                                                .fields = display_fields};

enum neph_status neph_finish_chain(struct neph_reader *reader, struct neph_written_scene *written)
{
    struct neph_scene_display *display = &written->display;
    const char *path = written->scene.path, *slash = strrchr(path, '/');
    if (!display->chain)
        return NEPH_OK;
    if (neph_has_control(display->chain, ""))
        return neph_refuse(reader, "display.chain", "control characters in the name of a file");
    if (!slash || display->chain[0] == '/')
        return NEPH_OK;
    display->chain = neph_arena_format(reader->arena, "%.*s/%s", (int)(slash - path), path,
                                       display->chain);
    return neph_arena_check(reader->arena, reader->diag);
}
