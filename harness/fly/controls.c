/* SPDX-License-Identifier: MIT */
#include "harness/fly/controls.h"

#include <math.h>
#include <string.h>

/* speed factor of a notch of the wheel */
static const double speed_per_notch = 1.25;
static const double fast_factor = 4.0;

/* The order of `held`: two opposite directions for each axis. */
static const char ways[NEPH_FLY_WAYS] = {'d', 'a', 'e', 'q', 'w', 's'};

const char neph_fly_preset_keys[] = "0123456789b";

static const struct {
    int key;
    struct neph_fly_command_event order;
} commands[] = {
    {'m', {NEPH_FLY_MARCH, 0}},
    {'r', {NEPH_FLY_REALTIME, 0}},
    {'c', {NEPH_FLY_WIPE, 0}},
    {'x', {NEPH_FLY_ERROR, 0}},
    {'f', {NEPH_FLY_FLICKER, 0}},
    {'[', {NEPH_FLY_DARKER, 0}},
    {']', {NEPH_FLY_BRIGHTER, 0}},
    {'-', {NEPH_FLY_DARKER, 0}},
    {'=', {NEPH_FLY_BRIGHTER, 0}},
    {NEPH_FLY_KEY_SPACE, {NEPH_FLY_PAUSE, 0}},
    {NEPH_FLY_KEY_HOME, {NEPH_FLY_HOME, 0}},
    {'k', {NEPH_FLY_RECORD, 0}},
    {'p', {NEPH_FLY_SCREENSHOT, 0}},
    {'t', {NEPH_FLY_PASSES, 0}},
    {NEPH_FLY_KEY_TAB, {NEPH_FLY_CAPTURE, 0}},
    {'h', {NEPH_FLY_HELP, 0}},
    {NEPH_FLY_KEY_ESCAPE, {NEPH_FLY_LEAVE, 0}},
};

const struct neph_fly_help neph_fly_help[] = {
    {"W A S D, Q E", "fly; E up, Q down; shift: four times as fast; wheel: the speed"},
    {"right button", "look around; tab: without the button"},
    {"0 .. 9, B", "a preset of realtime, named below"},
    {"R, M", "realtime; march"},
    {"C", "realtime left, march right; drag the line with the left button"},
    {"X", "error against march"},
    {"F", "flicker at the period of four frames, for a static camera"},
    {"[ ]", "exposure"},
    {"space", "stop the time of sun and wind"},
    {"home", "back to the camera of the scene"},
    {"K", "record the way as a scene file, and end it"},
    {"P", "save the frame as PNG and EXR"},
    {"T", "time of each pass"},
    {"H", "this help"},
    {"esc", "leave"},
    {0},
};

static void give(struct neph_controls *controls, struct neph_fly_command_event order)
{
    if (controls->order_count < NEPH_FLY_ORDERS_MAX)
        controls->orders[controls->order_count++] = order;
}

static void hold(struct neph_controls *controls, int key, bool is_down)
{
    const char *way = key < 128 ? memchr(ways, key, NEPH_FLY_WAYS) : NULL;
    if (way)
        controls->held[way - ways] = is_down;
    if (key == NEPH_FLY_KEY_SHIFT)
        controls->is_fast = is_down;
}

static void give_preset(struct neph_controls *controls, int key)
{
    const char *place = key > 0 && key < 128 ? strchr(neph_fly_preset_keys, key) : NULL;
    if (place)
        give(controls,
             (struct neph_fly_command_event){NEPH_FLY_PRESET, (int)(place - neph_fly_preset_keys)});
}

static void push_button(struct neph_controls *controls, const struct neph_fly_event *event,
                        bool is_down)
{
    if (event->button == NEPH_FLY_BUTTON_RIGHT)
        controls->turns = is_down;
    if (event->button == NEPH_FLY_BUTTON_LEFT)
        controls->drags = is_down;
    if (controls->drags)
        controls->split_share = fmin(1.0, fmax(0.0, event->x_share));
}

static void move_mouse(struct neph_controls *controls, const struct neph_fly_event *event)
{
    if (controls->turns || controls->is_captured) {
        controls->turn_right_share += event->dx_share;
        controls->turn_up_share -= event->dy_share;
    }
    if (controls->drags)
        controls->split_share = fmin(1.0, fmax(0.0, event->x_share));
}

void neph_controls_add_event(struct neph_controls *controls, const struct neph_fly_event *event)
{
    switch (event->kind) {
    case NEPH_FLY_KEY_DOWN:
        hold(controls, event->key, true);
        give_preset(controls, event->key);
        for (size_t i = 0; i < sizeof(commands) / sizeof(commands[0]); i++)
            if (commands[i].key == event->key)
                give(controls, commands[i].order);
        break;
    case NEPH_FLY_KEY_UP:
        hold(controls, event->key, false);
        break;
    case NEPH_FLY_BUTTON_DOWN:
    case NEPH_FLY_BUTTON_UP:
        push_button(controls, event, event->kind == NEPH_FLY_BUTTON_DOWN);
        break;
    case NEPH_FLY_MOUSE_MOVED:
        move_mouse(controls, event);
        break;
    case NEPH_FLY_WHEEL:
        controls->wheel += event->wheel;
        break;
    case NEPH_FLY_FOCUS_LOST:
        memset(controls->held, 0, sizeof(controls->held));
        controls->is_fast = controls->turns = controls->drags = false;
        break;
    case NEPH_FLY_CLOSED:
        give(controls, (struct neph_fly_command_event){NEPH_FLY_LEAVE, 0});
        break;
    }
}

struct neph_fly_command_event neph_controls_take_command(struct neph_controls *controls)
{
    if (controls->order_count == 0)
        return (struct neph_fly_command_event){NEPH_FLY_NOTHING, 0};
    const struct neph_fly_command_event order = controls->orders[0];
    controls->order_count--;
    memmove(controls->orders, controls->orders + 1,
            (size_t)controls->order_count * sizeof(controls->orders[0]));
    return order;
}

struct neph_fly_motion neph_controls_read_motion(struct neph_controls *controls, double time_s,
                                                 double vertical_fov_rad)
{
    const bool *held = controls->held;
    const double factor = controls->is_fast ? fast_factor : 1.0;
    const struct neph_fly_motion motion = {
        .right = factor * (held[0] - held[1]),
        .up = factor * (held[2] - held[3]),
        .forward = factor * (held[4] - held[5]),
        .turn_right_rad = controls->turn_right_share * vertical_fov_rad,
        .turn_up_rad = controls->turn_up_share * vertical_fov_rad,
        .speed_factor = pow(speed_per_notch, controls->wheel),
        .time_s = time_s,
    };
    controls->turn_right_share = controls->turn_up_share = controls->wheel = 0.0;
    return motion;
}
