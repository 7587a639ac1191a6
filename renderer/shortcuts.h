/* SPDX-License-Identifier: MIT
 *
 * Shortcuts of a march through media (struct neph_shortcuts): the rows of the tables of options
 * that two renderers share, and what is refused. Each is off unless asked for, and says what it
 * costs in docs/shortcuts.md.
 */
#ifndef NEPH_RENDERER_SHORTCUTS_H
#define NEPH_RENDERER_SHORTCUTS_H

#include "base/option.h"
#include "renderer/march_params.h"

/* Words of the choices. */
extern const char *const neph_sun_caches[], *const neph_skips[], *const neph_grid_samplings[],
                                                                     *const neph_texel_formats[];
extern const char *const neph_lights_ahead[], *const neph_cloud_shadows[];
extern const char *const neph_shadow_planes[], *const neph_skies[], *const neph_switches[];
extern const char *const neph_sky_refills[], *const neph_march_fogs[];

#define NEPH_OPTION_SUN_CACHE                                                                      \
    {                                                                                              \
        "sun_cache", NEPH_OPTION_CHOICE, 0, 0, 0, neph_sun_caches,                                 \
            "optical depth of clouds towards the sun: by a sun ray for each sample, or between "   \
            "the nodes of a lattice, filled anew when sun or clouds have moved; fogs and "         \
            "sunlight on solids are never from it"                                                 \
    }
#define NEPH_OPTION_SUN_CACHE_VOXELS                                                               \
    {                                                                                              \
        "sun_cache_voxels", NEPH_OPTION_INTEGER, 128, NEPH_SUN_CACHE_VOXELS_MIN,                   \
            NEPH_SUN_CACHE_VOXELS_MAX, NULL,                                                       \
            "nodes of that lattice along the longest side of all clouds' bounds"                   \
    }
#define NEPH_OPTION_SKIP                                                                           \
    {                                                                                              \
        "skip", NEPH_OPTION_CHOICE, 0, 0, 0, neph_skips,                                           \
            "majorant: nothing is asked of a cloud in cells where its majorant is 0; same bits, "  \
            "and with a marched transmittance no step is spent there"                              \
    }
#define NEPH_OPTION_EARLY_OUT                                                                      \
    {                                                                                              \
        "early_out", NEPH_OPTION_REAL, 0, 0, 1, NULL,                                              \
            "transmittance below which a view ray ends; 0: never"                                  \
    }
#define NEPH_OPTION_STEP_GROWTH                                                                    \
    {                                                                                              \
        "step_growth", NEPH_OPTION_REAL, 1, 1, NEPH_STEP_GROWTH_MAX, NULL,                         \
            "each step of a view ray is so many times as long as the one before, 1.001 or more; "  \
            "1: "                                                                                  \
            "all are equal"                                                                        \
    }
#define NEPH_OPTION_DEPTH_GROWTH                                                                   \
    {                                                                                              \
        "depth_growth", NEPH_OPTION_REAL, 0, 0, NEPH_DEPTH_GROWTH_MAX, NULL,                       \
            "behind an optical depth D the steps of a view ray are 1 + depth_growth * D times as " \
            "long, in whole steps and up to 16 of them; 0: by depth none grows"                    \
    }

#define NEPH_OPTION_SUN_GROWTH                                                                     \
    {                                                                                              \
        "sun_growth", NEPH_OPTION_REAL, 1, 1, NEPH_SUN_GROWTH_MAX, NULL,                           \
            "sun=marched: each step towards the sun is so many times as long as the one before; "  \
            "1: all are equal"                                                                     \
    }
#define NEPH_OPTION_SUN_CONE                                                                       \
    {                                                                                              \
        "sun_cone", NEPH_OPTION_REAL, 0, 0, NEPH_SUN_CONE_MAX, NULL,                               \
            "sun=marched: these steps lie within a cone around the ray, the tangent of its half "  \
            "angle; 0: on the ray"                                                                 \
    }

#define NEPH_OPTION_GRID_SAMPLING                                                                  \
    {                                                                                              \
        "grid_sampling", NEPH_OPTION_CHOICE, 0, 0, 0, neph_grid_samplings,                         \
            "texture: sums over steps ask the texture unit for the density of voxel grids, whose " \
            "weights have few bits; closed forms read the voxels themselves, so transmittance or " \
            "sun must be marched"                                                                  \
    }
#define NEPH_OPTION_GRID_FORMAT                                                                    \
    {                                                                                              \
        "grid_format", NEPH_OPTION_CHOICE, NEPH_TEXEL_R16F, 0, 0, neph_texel_formats,              \
            "grid_sampling=texture: what a texel holds, the density over the grid's largest"       \
    }

#define NEPH_OPTION_CLOUD_SHADOW                                                                   \
    {                                                                                              \
        "cloud_shadow", NEPH_OPTION_CHOICE, 0, 0, 0, neph_cloud_shadows,                           \
            "map: sunlight on solids, and on fog where no cloud is, has come through a shadow map" \
            " of the clouds, in place of a ray for each point"                                     \
    }
#define NEPH_OPTION_CLOUD_SHADOW_TEXELS                                                            \
    {                                                                                              \
        "cloud_shadow_texels", NEPH_OPTION_INTEGER, 512, NEPH_SHADOW_TEXELS_MIN,                   \
            NEPH_SHADOW_TEXELS_MAX, NULL, "texels of that map along each side"                     \
    }
#define NEPH_OPTION_CLOUD_SHADOW_LAYERS                                                            \
    {                                                                                              \
        "cloud_shadow_layers", NEPH_OPTION_INTEGER, 1, 1, NEPH_SHADOW_LAYERS_MAX, NULL,            \
            "optical depths of a texel between the clouds' far side and near side, for what is "   \
            "between clouds; 1: a beer shadow map, linear in between"                              \
    }
#define NEPH_OPTION_CLOUD_SHADOW_LEVELS                                                            \
    {                                                                                              \
        "cloud_shadow_levels", NEPH_OPTION_INTEGER, 1, 1, NEPH_SHADOW_LEVELS_MAX, NULL,            \
            "such maps around the camera, each a quarter as wide as the next"                      \
    }
#define NEPH_OPTION_CLOUD_SHADOW_EXTENT                                                            \
    {                                                                                              \
        "cloud_shadow_extent_m", NEPH_OPTION_REAL, 0, 0, NEPH_SHADOW_EXTENT_MAX_M, NULL,           \
            "side of the widest of them, around the camera; beyond it sun rays go on as ever; 0: " \
            "all clouds"                                                                           \
    }
#define NEPH_OPTION_CLOUD_SHADOW_PLANE                                                             \
    {                                                                                              \
        "cloud_shadow_plane", NEPH_OPTION_CHOICE, NEPH_SHADOW_LEVEL, 0, 0, neph_shadow_planes,     \
            "what texels lie on: a level plane through the clouds, with which they stay, or the "  \
            "plane across the sunlight, which turns with the sun"                                  \
    }

/* The sky is no shortcut, but its rows are shared as well. */
#define NEPH_OPTION_SKY                                                                            \
    {                                                                                              \
        "sky", NEPH_OPTION_CHOICE, 0, 0, 0, neph_skies,                                            \
            "tables: layers around the ball that is the first solid are the air of a planet, and " \
            "come from tables, behind, before and between all else; their light is that of the "   \
            "sun and the sky; off: they are media to be marched"                                   \
    }
#define NEPH_OPTION_SKY_COLUMNS                                                                    \
    {                                                                                              \
        "sky_columns", NEPH_OPTION_INTEGER, 32, 2, 512, NULL,                                      \
            "sky=tables: nodes of the table of air before the camera, from left to right"          \
    }
#define NEPH_OPTION_SKY_ROWS                                                                       \
    {                                                                                              \
        "sky_rows", NEPH_OPTION_INTEGER, 32, 2, 512, NULL, "and from top to bottom"                \
    }
#define NEPH_OPTION_SKY_SLICES                                                                     \
    {                                                                                              \
        "sky_slices", NEPH_OPTION_INTEGER, 32, 1, 512, NULL,                                       \
            "and distances, which grow as squares"                                                 \
    }
#define NEPH_OPTION_SKY_FAR                                                                        \
    {                                                                                              \
        "sky_far_m", NEPH_OPTION_REAL, 2e5, 1, 1e8, NULL,                                          \
            "the last of them: air behind it does not veil media and solids"                       \
    }

#define NEPH_OPTION_SKY_SHADOWS                                                                    \
    {                                                                                              \
        "sky_shadows", NEPH_OPTION_CHOICE, 1, 0, 0, neph_switches,                                 \
            "sky=tables: media and solids throw shadows on the air of that table; off: the sun "   \
            "is seen from all of it"                                                               \
    }

#define NEPH_OPTION_SKY_REFILL                                                                     \
    {                                                                                              \
        "sky_refill", NEPH_OPTION_CHOICE, 0, 0, 0, neph_sky_refills,                               \
            "sky=tables: what is filled for each picture: what is stale, or, to measure it, also " \
            "what is of a camera and a sun, or all tables"                                         \
    }

/* Nor is the look of a fog. */
#define NEPH_OPTION_FOG                                                                            \
    {                                                                                              \
        "fog", NEPH_OPTION_CHOICE, 0, 0, 0, neph_march_fogs,                                       \
            "unreal, filament: the height fog of a scene with fog_look is drawn by that engine's " \
            "formula and these controls, before, between and behind all else: a look; medium: it " \
            "is marched"                                                                           \
    }

/* Traced light is no shortcut, but its rows are shared as well. */
#define NEPH_OPTION_LIGHT_TEXEL                                                                    \
    {                                                                                              \
        "light_texel_px", NEPH_OPTION_INTEGER, 8, 1, NEPH_LIGHT_TEXEL_PX_MAX, NULL,                \
            "lighting=traced: pixels along the side of a texel, which shares its paths"            \
    }
#define NEPH_OPTION_LIGHT_PATHS(value)                                                             \
    {                                                                                              \
        "light_paths", NEPH_OPTION_INTEGER, value, 1, NEPH_LIGHT_PATHS_MAX, NULL,                  \
            "lighting=traced: paths under way at a time for each texel"                            \
    }
#define NEPH_OPTION_LIGHT_ROUNDS(value)                                                            \
    {                                                                                              \
        "light_rounds", NEPH_OPTION_INTEGER, value, 1, NEPH_LIGHT_ROUNDS_MAX, NULL,                \
            "lighting=traced: rounds of them in a picture, each 64 turns of a path"                \
    }
#define NEPH_OPTION_LIGHT_BLUR                                                                     \
    {                                                                                              \
        "light_blur", NEPH_OPTION_REAL, 1, 0, NEPH_LIGHT_BLUR_MAX, NULL,                           \
            "lighting=traced: standard deviation of the blur in texels; 0: none"                   \
    }

#define NEPH_OPTION_LIGHT_SIMILAR                                                                  \
    {                                                                                              \
        "light_similar", NEPH_OPTION_REAL, 0, 0, 1, NULL,                                          \
            "lighting=traced: paths go on from their second event in media of a smaller mean "     \
            "cosine and less extinction, on the way to delta-Eddington's similar ones: less "      \
            "noise, and a bias; 0: in the media themselves"                                        \
    }
#define NEPH_OPTION_LIGHT_AHEAD                                                                    \
    {                                                                                              \
        "light_ahead", NEPH_OPTION_CHOICE, 0, 0, 0, neph_lights_ahead,                             \
            "lighting=traced: diffusion: paths under way count what light that diffuses says "     \
            "they will bring home, and take it back as they do; after a cut, light that has come " \
            "through much is there at once; end: they end with the picture, in that light: less "  \
            "noise and lag, and its bias"                                                          \
    }

/* Nor is diffused light. */
#define NEPH_OPTION_DIFFUSION_CELLS                                                                \
    {                                                                                              \
        "diffusion_cells", NEPH_OPTION_INTEGER, 64, NEPH_DIFFUSION_CELLS_MIN,                      \
            NEPH_DIFFUSION_CELLS_MAX, NULL,                                                        \
            "lighting=diffused, light_ahead: cells along the longest side of all "                 \
            "clouds' bounds; a column of fog has eight times as many"                              \
    }
#define NEPH_OPTION_DIFFUSION_CYCLES(value)                                                        \
    {                                                                                              \
        "diffusion_cycles", NEPH_OPTION_INTEGER, value, 1, NEPH_DIFFUSION_CYCLES_MAX, NULL,        \
            "lighting=diffused, light_ahead: multigrid cycles in a picture, until light is at "    \
            "rest; in the first, 16 at least"                                                      \
    }

/* NEPH_ERR_USAGE: a number out of range, or a last step beyond NEPH_STEP_GROWTH_WHOLE_MAX of the
 * first. NEPH_ERR_UNSUPPORTED: the light of Horizon's clouds with a sun cache, which it has no use
 * for, or with skipping: it shines in clear air. */
enum neph_status neph_shortcuts_check(const struct neph_march_params *params,
                                      struct neph_diag *diag);

#endif
