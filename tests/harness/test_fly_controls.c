/* SPDX-License-Identifier: MIT
 *
 * Keys and mouse of `neph fly`, and key presses written as text.
 */
#include "harness/engines/engines.h"
#include "harness/fly/controls.h"
#include "harness/fly/script.h"
#include "tests/neph_test.h"

#include <string.h>

static void key(struct neph_controls *controls, int which, bool is_down)
{
    neph_controls_add_event(
        controls, &(struct neph_fly_event){.kind = is_down ? NEPH_FLY_KEY_DOWN : NEPH_FLY_KEY_UP,
                                           .key = which});
}

static void button(struct neph_controls *controls, enum neph_fly_button which, bool is_down,
                   double x_share)
{
    neph_controls_add_event(
        controls,
        &(struct neph_fly_event){.kind = is_down ? NEPH_FLY_BUTTON_DOWN : NEPH_FLY_BUTTON_UP,
                                 .button = which,
                                 .x_share = x_share});
}

static void mouse(struct neph_controls *controls, double x_share, double dx_share, double dy_share)
{
    neph_controls_add_event(controls, &(struct neph_fly_event){.kind = NEPH_FLY_MOUSE_MOVED,
                                                               .x_share = x_share,
                                                               .dx_share = dx_share,
                                                               .dy_share = dy_share});
}

static void test_pressed_keys_fly_until_released(void **state)
{
    struct neph_controls controls = {.split_share = 0.5};
    key(&controls, 'w', true);
    key(&controls, 'a', true);
    key(&controls, 'e', true);
    struct neph_fly_motion motion = neph_controls_read_motion(&controls, 0.25, 1.0);
    assert_true(motion.forward == 1.0 && motion.right == -1.0 && motion.up == 1.0);
    assert_true(motion.time_s == 0.25 && motion.speed_factor == 1.0);
    key(&controls, 'd', true); /* opposite to A */
    key(&controls, NEPH_FLY_KEY_SHIFT, true);
    motion = neph_controls_read_motion(&controls, 0.25, 1.0);
    assert_true(motion.forward == 4.0 && motion.right == 0.0);
    key(&controls, 'w', false);
    assert_true(neph_controls_read_motion(&controls, 0.25, 1.0).forward == 0.0);
}

/* A window without the focus gets no key-up events. */
static void test_keys_are_released_without_focus(void **state)
{
    struct neph_controls controls = {.split_share = 0.5};
    key(&controls, 's', true);
    neph_controls_add_event(&controls, &(struct neph_fly_event){.kind = NEPH_FLY_FOCUS_LOST});
    assert_true(neph_controls_read_motion(&controls, 0.25, 1.0).forward == 0.0);
}

static void test_the_mouse_turns_with_the_right_button_or_captured(void **state)
{
    struct neph_controls controls = {.split_share = 0.5};
    mouse(&controls, 0.5, 0.25, 0.5);
    struct neph_fly_motion motion = neph_controls_read_motion(&controls, 0.1, 2.0);
    assert_true(motion.turn_right_rad == 0.0 && motion.turn_up_rad == 0.0);
    button(&controls, NEPH_FLY_BUTTON_RIGHT, true, 0.5);
    mouse(&controls, 0.5, 0.25, 0.5);
    mouse(&controls, 0.5, 0.25, 0.25);
    motion = neph_controls_read_motion(&controls, 0.1, 2.0);
    assert_true(motion.turn_right_rad == 1.0 && motion.turn_up_rad == -1.5);
    motion = neph_controls_read_motion(&controls, 0.1, 2.0);
    assert_true(motion.turn_right_rad == 0.0 && motion.turn_up_rad == 0.0);
    button(&controls, NEPH_FLY_BUTTON_RIGHT, false, 0.5);
    controls.is_captured = true;
    mouse(&controls, 0.5, -0.5, 0.0);
    assert_true(neph_controls_read_motion(&controls, 0.1, 2.0).turn_right_rad == -1.0);
}

static void test_the_line_of_the_wipe_is_dragged(void **state)
{
    struct neph_controls controls = {.split_share = 0.5};
    mouse(&controls, 0.9, 0.0, 0.0);
    assert_true(controls.split_share == 0.5);
    button(&controls, NEPH_FLY_BUTTON_LEFT, true, 0.75);
    assert_true(controls.split_share == 0.75);
    mouse(&controls, 0.25, 0.0, 0.0);
    assert_true(controls.split_share == 0.25);
    mouse(&controls, -3.0, 0.0, 0.0); /* beyond the window */
    assert_true(controls.split_share == 0.0);
    button(&controls, NEPH_FLY_BUTTON_LEFT, false, 0.5);
    mouse(&controls, 0.9, 0.0, 0.0);
    assert_true(controls.split_share == 0.0);
}

static void test_the_wheel_changes_the_speed(void **state)
{
    struct neph_controls controls = {.split_share = 0.5};
    const struct neph_fly_event notch = {.kind = NEPH_FLY_WHEEL, .wheel = 1.0};
    neph_controls_add_event(&controls, &notch);
    neph_controls_add_event(&controls, &notch);
    assert_true(neph_controls_read_motion(&controls, 0.1, 1.0).speed_factor == 1.25 * 1.25);
    assert_true(neph_controls_read_motion(&controls, 0.1, 1.0).speed_factor == 1.0);
}

static void test_orders_come_in_their_order_and_not_without_end(void **state)
{
    struct neph_controls controls = {.split_share = 0.5};
    key(&controls, '3', true);
    key(&controls, 'x', true);
    key(&controls, 'w', true); /* not a command */
    neph_controls_add_event(&controls, &(struct neph_fly_event){.kind = NEPH_FLY_CLOSED});
    const struct neph_fly_command_event first = neph_controls_take_command(&controls);
    assert_true(first.command == NEPH_FLY_PRESET && first.number == 3);
    assert_int_equal(neph_controls_take_command(&controls).command, NEPH_FLY_ERROR);
    assert_int_equal(neph_controls_take_command(&controls).command, NEPH_FLY_LEAVE);
    assert_int_equal(neph_controls_take_command(&controls).command, NEPH_FLY_NOTHING);
    for (int i = 0; i < 2 * NEPH_FLY_ORDERS_MAX; i++)
        key(&controls, 'p', true);
    assert_int_equal(controls.order_count, NEPH_FLY_ORDERS_MAX);
}

/* A preset without a key could only be seen at the start. */
static void test_each_preset_has_a_key(void **state)
{
    for (int i = 0; neph_engine_realtime.presets[i].name; i++) {
        struct neph_controls controls = {.split_share = 0.5};
        assert_true(i < (int)strlen(neph_fly_preset_keys));
        key(&controls, neph_fly_preset_keys[i], true);
        const struct neph_fly_command_event order = neph_controls_take_command(&controls);
        assert_true(order.command == NEPH_FLY_PRESET && order.number == i);
    }
}

static void test_a_script_presses_keys_frame_by_frame(void **state)
{
    static const struct neph_fly_strokes expected[] = {
        {'w', 0}, {0, 0}, {'p', 'w'}, {0, 'p'}, {0, 0}, {' ', 0}, {'2', ' '}, {0, 0}, {0, '2'}};
    static const char script[] = " w*2 P\t.*2 space 2*2 ";
    neph_assert_ok(neph_fly_script_check(script, NULL), NULL);
    for (size_t i = 0; i < COUNT(expected); i++) {
        const struct neph_fly_strokes strokes = neph_fly_script_at(script, (int)i);
        assert_int_equal(strokes.down, expected[i].down);
        assert_int_equal(strokes.up, expected[i].up);
    }
}

static void test_invalid_scripts_name_the_word(void **state)
{
    static const char *const wrong[] = {"w60",    "w*0", "w*",   "w*-3",
                                        "p w*1x", "up",  "w**2", "shift"};
    for (size_t i = 0; i < COUNT(wrong); i++) {
        struct neph_diag diag = {0};
        assert_int_equal(neph_fly_script_check(wrong[i], &diag), NEPH_ERR_USAGE);
        const char *word = strrchr(wrong[i], ' ') ? strrchr(wrong[i], ' ') + 1 : wrong[i];
        assert_non_null(strstr(diag.message, word));
    }
    neph_assert_ok(neph_fly_script_check("", NULL), NULL);
}

#include "tests/main.h"
