/* SPDX-License-Identifier: MIT */
#include "harness/fly/fly.h"

#include "base/arena.h"
#include "base/clock.h"
#include "base/exr.h"
#include "base/interrupt.h"
#include "base/png.h"
#include "base/text.h"
#include "harness/engines/engines.h"
#include "harness/fly/camera.h"
#include "harness/fly/canvas.h"
#include "harness/fly/controls.h"
#include "harness/fly/overlay.h"
#include "harness/fly/path.h"
#include "harness/fly/script.h"
#include "harness/fly/times.h"
#include "harness/fly/view.h"
#include "harness/fly/window.h"
#include "scenes/display.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_VIEW_KIND_COUNT == 4, "a new kind");
_Static_assert(NEPH_FLY_COMMAND_COUNT == 17, "a new kind");

enum { NOTICE_SIZE = 256, NOTICE_FRAMES = 120 };

/* Limit of the camera's time step: a slow frame must not make the camera jump. */
static const double step_max_s = 0.25;
static const double exposure_step_ev = 0.5, exposure_max_ev = 40.0;

struct fly {
    const struct neph_fly_params *params;
    struct neph_window *window;
    struct neph_studio *studio;
    struct neph_controls controls;
    struct neph_fly_camera camera;
    struct neph_camera_key shown; /* camera of the last frame */
    struct neph_view view;
    struct neph_canvas canvas;
    struct neph_image *image; /* last frame; owned */
    struct neph_fly_times frame_times, render_times;
    struct neph_fly_passes passes;
    double frame_start_s, frame_s, render_s;
    int frame_count;
    int scene_frame;         /* frame number of the scene, for sun and wind */
    double scene_part;       /* elapsed part of the next scene frame, 0..1 */
    bool is_scene_frame_new; /* since the last rendered frame */
    bool is_paused, shows_help, shows_passes, takes_screenshot, leaves;
    bool records;
    struct neph_fly_path path;
    char notice[NOTICE_SIZE];
    int notice_frames;          /* frames left to show it */
    json_t *files;              /* owned */
    enum neph_status unwritten; /* the first error of writing a file, and its message */
    struct neph_diag why_unwritten;
};

static const struct neph_scene *scene_of(const struct fly *fly)
{
    return fly->params->studio.scene;
}

/* ---- notices ----------------------------------------------------------------------------- */

static void notice(struct fly *fly, const char *what, const char *text)
{
    neph_text_format(fly->notice, sizeof(fly->notice), "%s%s", what, text ? text : "");
    fly->notice_frames = NOTICE_FRAMES;
}

static void retitle(struct fly *fly)
{
    char title[NOTICE_SIZE];
    snprintf(title, sizeof(title), "neph fly %s: %s", scene_of(fly)->name,
             neph_studio_name(fly->studio));
    neph_window_set_title(fly->window, title);
}

/* ---- files ----------------------------------------------------------------------------------- */

static void note_file(struct fly *fly, const char *file, enum neph_status status,
                      const struct neph_diag *diag)
{
    if (status) {
        notice(fly, "not written: ", diag->message);
        if (!fly->unwritten) {
            fly->unwritten = status;
            fly->why_unwritten = *diag;
        }
        return;
    }
    notice(fly, "written: ", file);
    neph_json_add(&fly->files, json_string(file));
}

static void end_recording(struct fly *fly)
{
    struct neph_diag diag = {.line = 0};
    struct neph_arena arena = {0};
    const char *file = NULL;
    if (fly->records && fly->path.frame_count > 0) {
        const enum neph_status status = neph_fly_path_write(
            &fly->path, scene_of(fly), fly->params->folder, &arena, &file, &diag);
        note_file(fly, file, status, &diag);
    }
    fly->records = false;
    neph_arena_finish(&arena);
}

/* Start or end a recording. The scene restarts at its first frame, as it will in the recorded
 * file. */
static void record(struct fly *fly)
{
    if (fly->records) {
        end_recording(fly);
        return;
    }
    fly->records = true;
    fly->path.frame_count = 0;
    fly->scene_frame = 0;
    fly->scene_part = 0.0;
    fly->is_scene_frame_new = true;
    fly->is_paused = false;
}

/* Write the rendered frame as EXR, and the view without text as PNG. */
static void take_screenshot(struct fly *fly)
{
    static const char *const suffixes[] = {".exr", ".png", NULL};
    struct neph_diag diag = {.line = 0};
    struct neph_arena arena = {0};
    const struct neph_view *view = &fly->view;
    const char *stem = neph_fly_free_name(fly->params->folder,
                                          neph_arena_format(&arena, "%s_fly", scene_of(fly)->name),
                                          suffixes, &arena);
    const char *exr = neph_arena_format(&arena, "%s.exr", stem);
    const char *png = neph_arena_format(&arena, "%s.png", stem);
    enum neph_status status = neph_arena_check(&arena, &diag);
    if (!status)
        status = neph_exr_write(exr, fly->image, &diag);
    note_file(fly, exr, status, &diag);
    if (!status)
        note_file(fly, png,
                  neph_png_write_rgb8(png, view->width_px, view->height_px, view->rgb, &diag),
                  &diag);
    neph_arena_finish(&arena);
}

/* ---- commands ---------------------------------------------------------------------------- */

/* Finish a change of engine or preset. If the new one cannot render the scene, a notice says so and
 * the old one stays. */
static enum neph_status settle(struct fly *fly, enum neph_status status, struct neph_diag *diag)
{
    if (status == NEPH_ERR_UNSUPPORTED || status == NEPH_ERR_USAGE) {
        notice(fly, "", diag->message);
        return NEPH_OK;
    }
    fly->passes.count = 0;
    neph_view_forget(&fly->view);
    if (!status)
        retitle(fly);
    return status;
}

static enum neph_status choose_preset(struct fly *fly, int number, struct neph_diag *diag)
{
    const struct neph_preset *presets = neph_engine_realtime.presets;
    for (int i = 0; presets[i].name; i++)
        if (i == number)
            return settle(fly, neph_studio_choose_preset(fly->studio, presets[i].name, diag), diag);
    return NEPH_OK;
}

/* Show a view; a second call of the same kind returns to the plain frame. */
static void show(struct fly *fly, enum neph_view_kind kind)
{
    fly->view.kind = fly->view.kind == kind ? NEPH_VIEW_PICTURE : kind;
    neph_view_forget(&fly->view);
}

static void expose(struct fly *fly, double step_ev)
{
    const double exposure_ev = fly->view.exposure_ev + step_ev;
    fly->view.exposure_ev = fmin(exposure_max_ev, fmax(-exposure_max_ev, exposure_ev));
    neph_view_forget(&fly->view);
}

/* Pause sun and wind. Refused while recording: the recorded camera has a key for each frame, and a
 * scene file cannot pause only sun and wind. */
static void pause_time(struct fly *fly)
{
    if (fly->records)
        notice(fly, "time goes on while a path is recorded", "");
    else
        fly->is_paused = !fly->is_paused;
}

static void capture(struct fly *fly)
{
    fly->controls.is_captured = !fly->controls.is_captured;
    neph_window_capture(fly->window, fly->controls.is_captured);
}

static enum neph_status obey(struct fly *fly, struct neph_fly_order order, struct neph_diag *diag)
{
    switch (order.command) {
    case NEPH_FLY_PRESET:
        return choose_preset(fly, order.number, diag);
    case NEPH_FLY_MARCH:
    case NEPH_FLY_REALTIME:
        return settle(fly,
                      neph_studio_choose_march(fly->studio, order.command == NEPH_FLY_MARCH, diag),
                      diag);
    case NEPH_FLY_WIPE:
        show(fly, NEPH_VIEW_WIPE);
        break;
    case NEPH_FLY_ERROR:
        show(fly, NEPH_VIEW_ERROR);
        break;
    case NEPH_FLY_FLICKER:
        show(fly, NEPH_VIEW_FLICKER);
        break;
    case NEPH_FLY_DARKER:
    case NEPH_FLY_BRIGHTER:
        expose(fly, order.command == NEPH_FLY_DARKER ? -exposure_step_ev : exposure_step_ev);
        break;
    case NEPH_FLY_PAUSE:
        pause_time(fly);
        break;
    case NEPH_FLY_HOME:
        fly->camera.key = neph_fly_camera_of(scene_of(fly)).key;
        break;
    case NEPH_FLY_RECORD:
        record(fly);
        break;
    case NEPH_FLY_SCREENSHOT:
        fly->takes_screenshot = true;
        break;
    case NEPH_FLY_PASSES:
        fly->shows_passes = !fly->shows_passes;
        break;
    case NEPH_FLY_CAPTURE:
        capture(fly);
        break;
    case NEPH_FLY_HELP:
        fly->shows_help = !fly->shows_help;
        break;
    case NEPH_FLY_LEAVE:
        fly->leaves = true;
        break;
    case NEPH_FLY_NOTHING:
    case NEPH_FLY_COMMAND_COUNT:
        break;
    }
    return NEPH_OK;
}

/* ---- a frame --------------------------------------------------------------------------------- */

static void press_scripted_keys(struct fly *fly)
{
    if (!fly->params->keys)
        return;
    const struct neph_fly_strokes strokes = neph_fly_script_at(fly->params->keys, fly->frame_count);
    if (strokes.up)
        neph_window_push_key(fly->window, strokes.up, false);
    if (strokes.down)
        neph_window_push_key(fly->window, strokes.down, true);
}

static enum neph_status follow_orders(struct fly *fly, struct neph_diag *diag)
{
    struct neph_fly_event event;
    enum neph_status status = NEPH_OK;
    press_scripted_keys(fly);
    while (neph_window_next(fly->window, &event))
        neph_controls_take(&fly->controls, &event);
    for (struct neph_fly_order order = neph_controls_next(&fly->controls);
         order.command != NEPH_FLY_NOTHING && !status; order = neph_controls_next(&fly->controls))
        status = obey(fly, order, diag);
    return status;
}

/* Time since the last frame [s], limited to step_max_s. Frame times include only frames that were
 * shown and followed by another frame. */
static double tick(struct fly *fly)
{
    const double now_s = neph_wall_s();
    if (fly->frame_count > 0) {
        fly->frame_s = now_s - fly->frame_start_s;
        neph_fly_times_add(&fly->frame_times, fly->frame_s);
    }
    fly->frame_start_s = now_s;
    return fly->params->keys ? 1.0 / scene_of(fly)->frame_rate_hz : fmin(step_max_s, fly->frame_s);
}

/* Render; where the engine cannot render the new camera, return to the last one. */
static enum neph_status render_or_turn_back(struct fly *fly, struct neph_image **image,
                                            struct neph_cost *cost, struct neph_diag *diag)
{
    enum neph_status status = neph_studio_render(fly->studio, &fly->camera.key, fly->scene_frame,
                                                 image, cost, diag);
    if (status != NEPH_ERR_UNSUPPORTED || fly->frame_count == 0)
        return status;
    notice(fly, "", diag->message);
    fly->camera.key = fly->shown;
    return neph_studio_render(fly->studio, &fly->camera.key, fly->scene_frame, image, cost, diag);
}

/* Draw the view; without a ray-marched reference, draw the plain frame. */
static enum neph_status draw(struct fly *fly, bool rests, struct neph_diag *diag)
{
    enum neph_status status = neph_view_draw(&fly->view, fly->studio, fly->image, rests, diag);
    if (status != NEPH_ERR_UNSUPPORTED)
        return status;
    notice(fly, "", diag->message);
    fly->view.kind = NEPH_VIEW_PICTURE;
    return neph_view_draw(&fly->view, fly->studio, fly->image, rests, diag);
}

static enum neph_status render(struct fly *fly, struct neph_diag *diag)
{
    struct neph_image *image = NULL;
    struct neph_cost cost;
    enum neph_status status = render_or_turn_back(fly, &image, &cost, diag);
    if (status)
        return status;
    neph_image_destroy(fly->image);
    fly->image = image;
    fly->render_s = cost.render_s;
    neph_fly_times_add(&fly->render_times, cost.render_s);
    neph_fly_passes_take(&fly->passes, image);
    const bool rests = fly->frame_count > 0 && neph_fly_is_same_view(&fly->shown, &fly->camera.key);
    fly->shown = fly->camera.key;
    fly->view.split_share = fly->controls.split_share;
    return draw(fly, rests, diag);
}

static enum neph_status present(struct fly *fly, struct neph_diag *diag)
{
    const struct neph_overlay overlay = {
        .scene = scene_of(fly)->name,
        .engine = neph_studio_name(fly->studio),
        .view = &fly->view,
        .speed_m_per_s = fly->camera.speed_m_per_s,
        .frame_s = fly->frame_s,
        .render_s = fly->render_s,
        .passes = fly->shows_passes ? &fly->passes : NULL,
        .is_paused = fly->is_paused,
        .shows_help = fly->shows_help,
        .recorded_frames = fly->records ? fly->path.frame_count : -1,
        .notice = fly->notice_frames-- > 0 ? fly->notice : NULL,
    };
    neph_canvas_show(&fly->canvas, fly->view.rgb);
    neph_overlay_draw(&overlay, &fly->canvas);
    return neph_window_show(fly->window, fly->canvas.rgb, diag);
}

/* Advance sun and wind by the clock, by at most one scene frame per rendered frame: a larger step
 * on a slow device would break the reprojection of the history. */
static void pass_time(struct fly *fly, double time_s)
{
    const double frames = time_s * scene_of(fly)->frame_rate_hz;
    if (!fly->is_paused)
        fly->scene_part += fly->params->keys ? 1.0 : fmin(1.0, frames);
    fly->is_scene_frame_new = fly->scene_part >= 1.0;
    fly->scene_frame += fly->is_scene_frame_new;
    fly->scene_part -= fly->is_scene_frame_new;
}

static enum neph_status next_frame(struct fly *fly, struct neph_diag *diag)
{
    const double time_s = tick(fly);
    if (fly->frame_count > 0)
        pass_time(fly, time_s);
    enum neph_status status = follow_orders(fly, diag);
    if (status || fly->leaves)
        return status;
    const struct neph_fly_motion motion = neph_controls_motion(&fly->controls, time_s,
                                                               scene_of(fly)->vertical_fov_rad);
    neph_fly_camera_move(&fly->camera, scene_of(fly), &motion);
    status = render(fly, diag);
    if (!status)
        status = present(fly, diag);
    if (status)
        return status;
    if (fly->records && fly->is_scene_frame_new && !neph_fly_path_add(&fly->path, &fly->camera.key))
        end_recording(fly);
    if (fly->takes_screenshot)
        take_screenshot(fly);
    fly->takes_screenshot = false;
    fly->frame_count++;
    return NEPH_OK;
}

/* Run until the end. Ctrl-C interrupts a frame; the recorded path is written after that. */
static enum neph_status loop(struct fly *fly, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    const int limit = fly->params->frame_limit;
    while (!status && !fly->leaves && !(limit > 0 && fly->frame_count >= limit))
        status = neph_interrupted() ? neph_fail(diag, NEPH_ERR_INTERRUPTED, "interrupted")
                                    : next_frame(fly, diag);
    if (status == NEPH_ERR_INTERRUPTED)
        neph_interrupt_acknowledge();
    end_recording(fly);
    if (!status && fly->unwritten && diag)
        *diag = fly->why_unwritten;
    return status ? status : fly->unwritten;
}

/* ---- the command ------------------------------------------------------------------------- */

static json_t *error_json(const struct neph_view *view)
{
    return view->kind != NEPH_VIEW_ERROR || view->rays_per_px == 0
               ? json_null()
               : json_pack("{s:o, s:o, s:i}", "rel_bias", neph_json_number(view->error.bias),
                           "rel_rmse", neph_json_number(view->error.rmse), "rays_per_px",
                           view->rays_per_px);
}

static json_t *flicker_json(const struct neph_view *view)
{
    return view->kind != NEPH_VIEW_FLICKER || view->a4.frame_count == 0
               ? json_null()
               : json_pack("{s:i, s:f, s:f}", "frames", view->a4.frame_count, "a4_mean",
                           view->a4.mean, "a4_share_1", view->a4.share_1);
}

static json_t *result_of(const struct fly *fly)
{
    const struct neph_job *job = neph_studio_job(fly->studio);
    const struct neph_vec3 position_m = fly->camera.key.position_m;
    const struct neph_vec3 look_at_m = fly->camera.key.look_at_m;
    char *settings = neph_settings_text(job->engine, &job->shot.settings);
    json_t *result = json_pack(
        "{s:s, s:s, s:s, s:s, s:[i,i], s:i, s:o, s:o, s:{s:[f,f,f], s:[f,f,f]}, s:o, s:o, s:O}",
        "scene", scene_of(fly)->name, "engine", neph_studio_name(fly->studio), "settings",
        settings ? settings : "", "device", job->info->device, "size_px", fly->view.width_px,
        fly->view.height_px, "frames", fly->frame_count, "frame_median_s",
        neph_json_number(neph_fly_times_median_s(&fly->frame_times)), "render_median_s",
        neph_json_number(neph_fly_times_median_s(&fly->render_times)), "camera", "position_m",
        position_m.x, position_m.y, position_m.z, "look_at_m", look_at_m.x, look_at_m.y,
        look_at_m.z, "error", error_json(&fly->view), "flicker", flicker_json(&fly->view), "files",
        fly->files);
    free(settings);
    return result;
}

static enum neph_status check(const struct neph_fly_params *params, struct neph_diag *diag)
{
    if (params->studio.scene->orthographic_height_m > 0.0)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "%s has an orthographic camera, which neph fly cannot move",
                         params->studio.scene->name);
    return params->keys ? neph_fly_script_check(params->keys, diag) : NEPH_OK;
}

static void destroy(struct fly *fly)
{
    json_decref(fly->files);
    neph_image_destroy(fly->image);
    neph_window_close(fly->window);
    neph_studio_close(fly->studio);
    neph_canvas_finish(&fly->canvas);
    neph_view_finish(&fly->view);
    free(fly);
}

/* The window is opened before the device, so that a missing display is reported without delay. */
static enum neph_status open_all(struct fly *fly, struct neph_diag *diag)
{
    const struct neph_studio_params *studio = &fly->params->studio;
    enum neph_status status = neph_canvas_init(&fly->canvas, studio->width_px, studio->height_px,
                                               diag);
    if (!status)
        status = neph_view_init(&fly->view, studio->width_px, studio->height_px, diag);
    if (!status)
        status = neph_window_open("neph fly", fly->canvas.width_px, fly->canvas.height_px,
                                  &fly->window, diag);
    if (!status)
        status = neph_studio_open(studio, fly->params->preset, &fly->studio, diag);
    if (!status)
        retitle(fly);
    return status;
}

enum neph_status neph_fly(const struct neph_fly_params *params, json_t **result,
                          struct neph_diag *diag)
{
    enum neph_status status = check(params, diag);
    if (status)
        return status;
    struct fly *fly = calloc(1, sizeof(*fly));
    if (!fly)
        return neph_fail_memory(diag);
    fly->params = params;
    status = open_all(fly, diag);
    if (!status) {
        fly->controls.split_share = 0.5;
        fly->camera = neph_fly_camera_of(scene_of(fly));
        fly->view.exposure_ev = neph_scene_display(scene_of(fly))->exposure_ev;
        fly->files = json_array();
        status = loop(fly, diag);
        *result = result_of(fly);
    }
    destroy(fly);
    return status;
}
