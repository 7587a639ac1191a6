/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/light_history.h"

#include "base/vec3.h"

#include <math.h>

static const double unlike_part = 0.1, unlike_rad = 0.1;

const struct neph_rt_light_frame *
neph_rt_light_history_frame(const struct neph_rt_light_history *history, uint32_t frame_count)
{
    return &history->frames[(history->last - frame_count) % NEPH_RT_LIGHT_HISTORY_MAX];
}

static bool is_within_tolerance(double a, double b)
{
    return fabs(a - b) < unlike_part * fmax(a, b) || a == b;
}

static bool are_colors_similar(struct neph_rgb a, struct neph_rgb b)
{
    return is_within_tolerance(a.r, b.r) && is_within_tolerance(a.g, b.g) &&
           is_within_tolerance(a.b, b.b);
}

bool neph_rt_are_suns_similar(const struct neph_sun *a, const struct neph_sun *b)
{
    if (!a->present || !b->present)
        return a->present == b->present;
    return are_colors_similar(a->irradiance_w_per_m2, b->irradiance_w_per_m2) &&
           neph_vec3_dot(a->direction, b->direction) > cos(unlike_rad);
}

static bool are_lights_similar(const struct neph_light *a, const struct neph_light *b)
{
    return are_colors_similar(a->intensity_w_per_sr, b->intensity_w_per_sr) &&
           a->is_spot == b->is_spot &&
           (!a->is_spot || neph_vec3_dot(a->axis, b->axis) > cos(unlike_rad));
}

static bool are_frames_similar(const struct neph_rt_light_frame *a,
                               const struct neph_rt_light_frame *b)
{
    bool are_similar = neph_rt_are_suns_similar(&a->sun, &b->sun) &&
                       a->light_count == b->light_count;
    for (int i = 0; i < a->light_count && are_similar; i++)
        are_similar = are_lights_similar(&a->lights[i], &b->lights[i]);
    return are_similar;
}

void neph_rt_light_history_add(struct neph_rt_light_history *history, uint32_t number,
                               const struct neph_scene *static_scene)
{
    struct neph_rt_light_frame *frame = &history->frames[number % NEPH_RT_LIGHT_HISTORY_MAX];
    const bool is_again = history->count > 0 && number == history->last;
    const bool is_next = history->count > 0 && number == history->last + 1;
    if (is_next && history->count < NEPH_RT_LIGHT_HISTORY_MAX)
        history->count++;
    else if (!is_next && !is_again)
        history->count = 1;
    history->last = number;
    frame->sun = static_scene->sun;
    frame->light_count = static_scene->light_count;
    for (int i = 0; i < static_scene->light_count; i++)
        frame->lights[i] = static_scene->lights[i];
}

bool neph_rt_light_history_is_periodic(const struct neph_rt_light_history *history, uint32_t period)
{
    const struct neph_rt_light_frame *latest = neph_rt_light_history_frame(history, 0);
    bool is_steady = true;
    if (period > NEPH_RT_LIGHT_HISTORY_MAX / 2 || history->count < 2 * period)
        return false;
    for (uint32_t i = 0; i < period; i++) {
        const struct neph_rt_light_frame *frame = neph_rt_light_history_frame(history, i);
        if (!are_frames_similar(frame, neph_rt_light_history_frame(history, i + period)))
            return false;
        is_steady = is_steady && are_frames_similar(latest, frame);
    }
    return !is_steady;
}

bool neph_rt_light_history_has_jump(const struct neph_rt_light_history *history,
                                    uint32_t frame_count)
{
    for (uint32_t i = 0; i < frame_count && i + 1 < history->count; i++)
        if (!are_frames_similar(neph_rt_light_history_frame(history, i),
                                neph_rt_light_history_frame(history, i + 1)))
            return true;
    return false;
}
