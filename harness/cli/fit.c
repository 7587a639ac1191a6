/* SPDX-License-Identifier: MIT
 *
 * `neph fit FRAME SCENE`: which medium explains a frame of any renderer, and which known mistake.
 */
#include "harness/cli/cli.h"

#include "harness/compare/frame.h"
#include "harness/data.h"
#include "harness/fit/answer.h"
#include "harness/fit/fit.h"
#include "scenes/motion.h"

#include <limits.h>
#include <string.h>

struct request {
    struct neph_cli_shared shared;
    struct neph_frame_choice choice;
    struct neph_cli_list unknowns;
    const char *transmittance;
    int frame, pixels;
};

#define AT(member) .at = offsetof(struct request, member)
static const struct neph_cli_option options[] = {
    {"free", 0, "NAME[,NAME]",
     "What is fitted: extinction, albedo, asymmetry, falloff (default: all that the scene has); "
     "the rest is held at the scene's values",
     NEPH_CLI_NAMES, AT(unknowns)},
    {"frame", 0, "N", "Which frame of a moving scene it is, 0-based", NEPH_CLI_INTEGER, AT(frame),
     "0", 0, INT_MAX},
    {"pixels", 0, "N", "About as many pixels, on a regular grid", NEPH_CLI_INTEGER, AT(pixels),
     "600", 16, 1000000},
    {"part", .kind = NEPH_CLI_WORD, AT(choice.part)},
    {"layer", .kind = NEPH_CLI_WORD, AT(choice.layer)},
    {"depth", .kind = NEPH_CLI_WORD, AT(choice.depth)},
    {"transmittance", 0, "NAME",
     "The channel NAME, or NAME.R G B, is the transmittance to the first solid; A: 1 - alpha, "
     "where "
     "the scene has no solid (default: transmittance.R G B, where a file has them)",
     NEPH_CLI_WORD, AT(transmittance)},
    {"convert", .kind = NEPH_CLI_FLAG, AT(choice.convert)},
    {.name = "json"},
    {.name = "quiet"},
    {.name = NULL},
};
#undef AT

static const struct neph_cli_operands operands = {
    .shown = "FRAME SCENE",
    .minimum = 2,
    .maximum = 2,
    .missing = "which frame, and which scene?",
    .surplus = "one frame and one scene",
};

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &operands,
    .doc =
        "Which medium explains FRAME, a file of any renderer: the factors of extinction, albedo "
        "and "
        "falloff, and the asymmetry, by least squares on the exact light of SCENE and its "
        "camera.\v"
        "SCENE says what the frame should show. Its media are homogeneous, height fog or Gaussian, "
        "with single scattering or none; the fit changes all of them alike. From R G B only it "
        "may not tell extinction from albedo, or albedo from asymmetry: then it says \"not "
        "determined\", and which combination is. A transmittance in the frame determines the "
        "extinction; Z, compared with the scene's, leaves out pixels that show something else.\n\n"
        "Mistakes are named whose factors, within 3 %, explain the frame as well as the best ones: "
        "exp2 or 10^x for exp, extinction for scattering, 4 pi, 1/km, opacity applied twice, sRGB "
        "codes. Intervals are of "
        "95 %, from the residuals, plus what an error of 0.1 % of each value could do. Exit code "
        "0: "
        "the frame agrees with the scene; 1: it differs.\n\n"
        "Examples:\n"
        "  neph fit fog.exr my_fog.yaml\n"
        "  neph fit fog.exr my_fog.yaml --free extinction,albedo --json\n"
        "  neph fit fog.exr my_fog.yaml --transmittance transmittance --pixels 2000",
};

static enum neph_status find_unknowns(const struct request *request, bool *is_free,
                                      struct neph_diag *diag)
{
    for (int k = 0; k < NEPH_FIT_UNKNOWN_COUNT; k++)
        is_free[k] = request->unknowns.count == 0;
    for (int i = 0; i < request->unknowns.count; i++) {
        int k = 0;
        while (neph_fit_unknown_names[k] &&
               strcmp(neph_fit_unknown_names[k], request->unknowns.words[i]) != 0)
            k++;
        if (!neph_fit_unknown_names[k])
            return neph_fail(diag, NEPH_ERR_USAGE,
                             "--free %s: extinction, albedo, asymmetry and falloff can be fitted",
                             request->unknowns.words[i]);
        is_free[k] = true;
    }
    return NEPH_OK;
}

/* Refuse unknowns that are named and that the scene does not have. */
static enum neph_status check_unknowns(const struct request *request,
                                       const struct neph_scene *scene, const bool *is_free,
                                       struct neph_diag *diag)
{
    for (int k = 0; k < NEPH_FIT_UNKNOWN_COUNT; k++) {
        const char *why = neph_fit_obstacle(scene, (enum neph_fit_unknown)k);
        if (request->unknowns.count > 0 && is_free[k] && why)
            return neph_fail(diag, NEPH_ERR_USAGE, "--free %s: %s", neph_fit_unknown_names[k], why);
    }
    return NEPH_OK;
}

static enum neph_status tell(const struct request *request, const struct neph_fit *fit,
                             const struct neph_fit_verdict *verdict, struct neph_diag *diag)
{
    const struct neph_fit_answer answer = {fit, verdict, request->shared.operands[0]};
    enum neph_status status = NEPH_OK;
    if (request->shared.json)
        status = neph_json_print(neph_fit_json(&answer), diag);
    else
        neph_fit_print(&answer, request->shared.quiet, stdout);
    fflush(stdout);
    return status || verdict->agrees
               ? status
               : neph_fail(diag, NEPH_ERR_GATE, "the frame differs from the scene");
}

static enum neph_status run(const struct request *request, const struct neph_scene *scene,
                            const struct neph_image *image, struct neph_diag *diag)
{
    struct neph_fit_pixels pixels = {.list = NULL};
    struct neph_fit fit = {.scene = scene, .pixels = &pixels};
    struct neph_fit_verdict verdict;
    const struct neph_fit_source source = {scene, image, request->transmittance, request->pixels};
    enum neph_status status = find_unknowns(request, fit.is_free, diag);
    if (!status)
        status = neph_fit_check_scene(scene, diag);
    if (!status)
        status = check_unknowns(request, scene, fit.is_free, diag);
    if (!status) {
        status = neph_fit_pixels_take(&source, &pixels, diag);
        if (status && status != NEPH_ERR_MEMORY)
            neph_prefix(diag, "'%s': ", request->shared.operands[0]);
    }
    if (!status)
        status = neph_fit_solve(&fit, diag);
    if (!status)
        status = neph_fit_judge(&fit, &verdict, diag);
    if (!status)
        status = tell(request, &fit, &verdict, diag);
    neph_fit_finish(&fit);
    neph_fit_pixels_finish(&pixels);
    return status;
}

enum neph_status neph_cli_fit(int argc, char **argv, struct neph_diag *diag)
{
    struct request request = {.frame = -1};
    struct neph_scene *scene = NULL, *still = NULL;
    struct neph_image *image = NULL;
    neph_cli_parse(&syntax, argc, argv, &request);
    /* Negative values are noise. */
    enum neph_status status = neph_oiio_server_create(&request.choice.server, diag);
    if (!status)
        status = neph_frame_read(request.shared.operands[0], &request.choice, SIZE_MAX, &image,
                                 diag);
    if (!status)
        status = neph_data_load_scene(request.shared.operands[1], &scene, diag);
    if (!status)
        status = neph_scene_at(scene, request.frame, &still, diag);
    if (!status)
        status = run(&request, still, image, diag);
    neph_scene_destroy(still);
    neph_scene_destroy(scene);
    neph_image_destroy(image);
    neph_oiio_server_destroy(request.choice.server);
    return status;
}
