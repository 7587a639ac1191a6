/* SPDX-License-Identifier: MIT */
#include "harness/report/marched_scene.h"

#include "renderer/march.h"
#include "scenes/motion.h"

int neph_shot_choice(const struct neph_shot *shot, const struct neph_engine *engine,
                     const char *name)
{
    const int option = neph_option_find(engine->options, name);
    return option < 0 ? 0 : (int)shot->settings.values[option];
}

static bool is_veiled(const struct neph_shot *shot, const struct neph_engine *engine,
                      struct neph_scene *rest)
{
    const struct neph_march_veils veils = {
        neph_shot_choice(shot, engine, "sky") != 0,
        neph_march_fog_choose(neph_shot_choice(shot, engine, "fog"))};
    char reason[256];
    return (veils.sky || veils.fog.is_look) &&
           neph_march_remove_veils(shot->scene, veils, rest, reason, sizeof(reason));
}

bool neph_marched_scene_init(const struct neph_shot *shot, const struct neph_engine *engine,
                             struct neph_marched_scene *marched)
{
    marched->still = NULL;
    marched->scene = is_veiled(shot, engine, &marched->rest) ? &marched->rest : shot->scene;
    if (!neph_scene_moves(marched->scene))
        return true;
    if (neph_scene_at(marched->scene, shot->frame, &marched->still, NULL))
        return false;
    marched->scene = marched->still;
    return true;
}

void neph_marched_scene_finish(struct neph_marched_scene *marched)
{
    neph_scene_destroy(marched->still);
}
