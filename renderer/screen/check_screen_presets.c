/* SPDX-License-Identifier: MIT
 *
 * Tests that presets of the screen do not change, because published tables have frames under their
 * names. The defaults come from the article.
 */
#include "tests/renderer/renderer_test.h"

#include "renderer/screen/options.h"

#include <stdlib.h>
#include <string.h>

/* All settings, in the order of the table. */
static const char defaults[] =
    "ao=unreal ao_resolution=full ao_radius_m=2 ao_falloff=0 ao_directions=6 ao_steps=3 "
    "ao_step_power=2 ao_thickness=0 ao_slices=ray ao_noise=on ao_bias=0.001 ao_blur_px=2 "
    "ao_power=2 ao_intensity=0.5 ao_places=pixel ao_sum=ratio ray_thickness_m=0.25 "
    "ray_refine=4 ray_step_power=1 ray_metal=relit ray_noise=on ray_pixel=first gi=on "
    "gi_resolution=full gi_rays=4 gi_steps=24 gi_reach_m=0 gi_bounces=all gi_history=16 "
    "gi_smooth=3 ssr=on ssr_resolution=full ssr_rays=4 ssr_steps=64 ssr_roughest=1 "
    "ssr_history=16 ssr_smooth=2 targets=float16 warm_up=31";

/* The settings in which presets differ. */
static const struct {
    const char *name, *settings;
} frozen[] = {
    {"unreal", ""},
    {"ours", "ao=gtao ao_radius_m=1 ao_directions=3 ao_steps=6 ao_power=1 ao_intensity=1 "
             "ao_places=plane targets=float32"},
    {"fast",
     "ao=gtao ao_resolution=half ao_radius_m=1 ao_directions=2 ao_blur_px=1 ao_power=1 "
     "ao_intensity=1 ao_places=plane gi_resolution=half gi_rays=1 gi_steps=12 gi_history=32 "
     "gi_smooth=1 ssr_resolution=half ssr_rays=1 ssr_steps=24 ssr_history=32 ssr_smooth=1"},
    {"slices", "ao=gtao ao_radius_m=1 ao_directions=32 ao_steps=64 ao_noise=off ao_blur_px=0 "
               "ao_power=1 ao_intensity=1 ao_places=plane targets=float32"},
    {"paper", "ao=gtao ao_radius_m=1 ao_falloff=0.6 ao_directions=1 ao_steps=6 ao_thickness=0.1 "
              "ao_slices=axis ao_power=1 ao_intensity=1 ao_sum=mean"},
};

static void test_defaults_are_the_article_s(void **state)
{
    const struct neph_settings settings = neph_options_default(neph_screen_options);
    OWNED(memory) char *text = neph_options_text(neph_screen_options, &settings);
    assert_non_null(text);
    assert_string_equal(text, defaults);
}

static void test_presets_are_what_they_were(void **state)
{
    size_t count = 0;
    while (neph_screen_presets[count].name)
        count++;
    assert_int_equal(count, COUNT(frozen));
    for (size_t i = 0; i < COUNT(frozen); i++) {
        struct neph_settings settings, expected = neph_options_default(neph_screen_options);
        struct neph_diag diag = {0};
        neph_assert_ok(neph_options_preset(neph_screen_options, "the screen", neph_screen_presets,
                                           frozen[i].name, &settings, &diag),
                       &diag);
        test_assign(neph_screen_options, frozen[i].settings, &expected);
        assert_memory_equal(settings.values, expected.values, sizeof(settings.values));
    }
}

#include "tests/main.h"
