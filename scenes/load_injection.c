/* SPDX-License-Identifier: MIT
 *
 * Fault injection into a running renderer (scenes/injection.h), from a scene file.
 */
#include "scenes/load.h"
#include "scenes/media.h"

#include "scenes/words.h"

#include <stddef.h>

#define ALL(member) offsetof(struct neph_injections, member)
#define HISTORY(member) offsetof(struct neph_injected_history, member)
#define RAYS(member) offsetof(struct neph_injected_rays, member)
#define SIZE(member) offsetof(struct neph_injected_size, member)
#define VIEW(member) offsetof(struct neph_injected_view, member)
#define MIRROR(member) offsetof(struct neph_injected_mirror, member)
#define ORIGIN(member) offsetof(struct neph_injected_origin, member)
#define EXPOSURE(member) offsetof(struct neph_injected_exposure, member)

enum { FRAME_MAX = 100000, MARGIN_MAX_PX = 4096, LIST_MAX = 64 };

static const char picture_note[] = "not of the keys";

static const struct neph_field history_fields[] = {
    {"frame", NEPH_WHOLE, HISTORY(frame), "", 0, FRAME_MAX, .note = picture_note},
    {"value", NEPH_WORD, HISTORY(value), .words = neph_injected_value_words},
    {"first", NEPH_FLAG, HISTORY(first), .note = "and the frame has no history, like the first one",
     .standard = "`false`"},
    {0},
};
static const struct neph_record history_record = {.size = sizeof(struct neph_injected_history),
                                                  .fields = history_fields};

static const struct neph_field ray_fields[] = {
    {"frame", NEPH_WHOLE, RAYS(frame), "", 0, FRAME_MAX, .note = picture_note},
    {"count", NEPH_WHOLE, RAYS(count), "", 1, 1000000, .note = "of rays, evenly spread",
     .standard = "1"},
    {"value", NEPH_WORD, RAYS(value), .words = neph_injected_value_words},
    {0},
};
static const struct neph_record ray_record = {.size = sizeof(struct neph_injected_rays),
                                              .fields = ray_fields};

static const struct neph_field view_fields[] = {
    {"left_px", NEPH_WHOLE, VIEW(left_px), "px", 0, MARGIN_MAX_PX, .note = "a multiple of 4",
     .standard = "0"},
    {"top_px", NEPH_WHOLE, VIEW(top_px), "px", 0, MARGIN_MAX_PX, .note = "a multiple of 4",
     .standard = "0"},
    {"right_px", NEPH_WHOLE, VIEW(right_px), "px", 0, MARGIN_MAX_PX, .standard = "0"},
    {"bottom_px", NEPH_WHOLE, VIEW(bottom_px), "px", 0, MARGIN_MAX_PX, .standard = "0"},
    {"value", NEPH_WORD, VIEW(value), .note = "of all texels outside the view",
     .words = neph_injected_value_words},
    {0},
};

static enum neph_status read_view(struct neph_reader *reader, const yaml_node_t *node,
                                  const struct neph_record *record, void *target)
{
    const struct neph_injected_view *view = target;
    const enum neph_status status = neph_read_fields(reader, node, record->fields, target);
    if (status)
        return status;
    if (view->left_px % 4 != 0)
        return neph_refuse(reader, "left_px", "%d is no multiple of 4: a view begins with a tile",
                           view->left_px);
    if (view->top_px % 4 != 0)
        return neph_refuse(reader, "top_px", "%d is no multiple of 4: a view begins with a tile",
                           view->top_px);
    if (view->left_px + view->top_px + view->right_px + view->bottom_px == 0)
        return neph_refuse(reader, "", "give a margin: left_px, top_px, right_px or bottom_px");
    return NEPH_OK;
}

static const struct neph_record view_record = {
    .size = sizeof(struct neph_injected_view), .fields = view_fields, .read = read_view};

static const struct neph_field mirror_fields[] = {
    {"frame", NEPH_WHOLE, MIRROR(frame), "", 0, FRAME_MAX, .note = picture_note, .standard = "0"},
    {"count", NEPH_WHOLE, MIRROR(count), "pictures", 1, FRAME_MAX, .note = "from there on"},
    {"height_m", NEPH_NUMBER, MIRROR(height_m), "m", -NEPH_FAR_M, NEPH_FAR_M,
     .note = "of the water's surface"},
    {0},
};

static const struct neph_record mirror_record = {.size = sizeof(struct neph_injected_mirror),
                                                 .fields = mirror_fields};

static const struct neph_field size_fields[] = {
    {"frame", NEPH_WHOLE, SIZE(frame), "", 0, FRAME_MAX, .note = picture_note},
    {"scale", NEPH_NUMBER, SIZE(scale), "", 0.05, 4, .note = "factor of the frame's size"},
    {0},
};
static const struct neph_record size_record = {.size = sizeof(struct neph_injected_size),
                                               .fields = size_fields};

static const struct neph_field origin_fields[] = {
    {"frame", NEPH_WHOLE, ORIGIN(frame), "", 0, FRAME_MAX, .note = "the first frame with it"},
    {"by_m", NEPH_THREE, ORIGIN(by_m), "m", -1e7, 1e7,
     .note = "displacement of the world, with the camera, from its place in the file"},
    {0},
};
static const struct neph_record origin_record = {.size = sizeof(struct neph_injected_origin),
                                                 .fields = origin_fields};

static const struct neph_field exposure_fields[] = {
    {"frame", NEPH_WHOLE, EXPOSURE(frame), "", 0, FRAME_MAX, .note = "the first frame with it"},
    {"factor", NEPH_NUMBER, EXPOSURE(factor), "", 1e-4, 1e4,
     .note = "factor of the camera on light before it is stored; output frames are still radiance"},
    {0},
};
static const struct neph_record exposure_record = {.size = sizeof(struct neph_injected_exposure),
                                                   .fields = exposure_fields};

static const struct neph_field injection_fields[] = {
    {"history", NEPH_LIST, ALL(histories),
     .note = "the history of a frame: colours, ages and depths", .is_ascending = true, .least = 1,
     .most = LIST_MAX, .count_at = ALL(history_count), .record = &history_record,
     .standard = "none"},
    {"rays", NEPH_LIST, ALL(rays), .note = "rays of a frame's march", .is_ascending = true,
     .least = 1, .most = LIST_MAX, .count_at = ALL(ray_count), .record = &ray_record,
     .standard = "none"},
    {"sizes", NEPH_LIST, ALL(sizes),
     .note = "before a frame one of another size, then back to its own", .is_ascending = true,
     .least = 1, .most = LIST_MAX, .count_at = ALL(size_count), .record = &size_record,
     .standard = "none"},
    {"view", NEPH_RECORD, ALL(view), .note = "the frame is a rectangle of larger buffers",
     .record = &view_record, .standard = "none"},
    {"mirror", NEPH_RECORD, ALL(mirror),
     .note = "before each frame the view of a second camera, mirrored at a height, with one "
             "history for both",
     .record = &mirror_record, .standard = "none"},
    {"origin", NEPH_LIST, ALL(origins), .note = "the world's origin moves", .is_ascending = true,
     .least = 1, .most = LIST_MAX, .count_at = ALL(origin_count), .record = &origin_record,
     .standard = "none"},
    {"exposures", NEPH_LIST, ALL(exposures), .note = "the camera's exposure changes",
     .is_ascending = true, .least = 1, .most = LIST_MAX, .count_at = ALL(exposure_count),
     .record = &exposure_record, .standard = "none"},
    {0},
};

const struct neph_record neph_injection_record = {.size = sizeof(struct neph_injections),
                                                  .fields = injection_fields};

enum neph_status neph_check_injections(const struct neph_reader *reader,
                                       const struct neph_scene *scene)
{
    const struct neph_injections *injections = scene->injections;
    if (injections->mirror.count > 0 && scene->orthographic_height_m > 0.0)
        return neph_refuse(reader, "inject.mirror",
                           "an orthographic camera cannot be mirrored: motion vectors support only "
                           "perspective cameras");
    for (int i = 0; i < scene->medium_count && injections->origin_count > 0; i++)
        if (!neph_medium_can_shift(&scene->media[i]))
            return neph_refuse(reader, "inject.origin",
                               "media[%d], a %s, has a fixed place and cannot be moved", i,
                               neph_medium_facts(scene->media[i].kind)->name);
    return NEPH_OK;
}
