/* SPDX-License-Identifier: MIT */
#include "harness/cli/compare_z.h"

#include "base/files.h"
#include "harness/compare/frame_windows.h"
#include "harness/compare/maps.h"
#include "harness/compare/noise_verdict.h"

static const struct neph_map score_map = {
    .name = "z", .unit = "standard errors", .plane_count = 1, .is_signed = true, .scale = 4.0};

static enum neph_status write_map(const char *folder, const struct neph_image *image,
                                  struct neph_diag *diag)
{
    const struct neph_viewing viewing = NEPH_VIEWING_DEFAULTS;
    const struct neph_path exr = neph_path_in(folder, "z.exr"), png = neph_path_in(folder, "z.png");
    const enum neph_status status = neph_dir_create(folder, diag);
    return status ? status : neph_map_write(exr.text, png.text, &score_map, &viewing, image, diag);
}

/* The map must not replace an input. */
static enum neph_status check_map(const struct neph_cli_z *request, struct neph_diag *diag)
{
    const struct neph_sequence *sides[2] = {request->reference, request->test};
    const struct neph_path exr = neph_path_in(request->maps, "z.exr");
    for (int s = 0; s < 2; s++)
        for (int f = 0; f < sides[s]->count; f++)
            if (neph_path_is_same(sides[s]->paths[f], exr.text)) {
                neph_fail(diag, NEPH_ERR_USAGE, "a map would be written over the frame '%s'",
                          sides[s]->paths[f]);
                neph_hint(diag, "name another folder with --maps");
                return NEPH_ERR_USAGE;
            }
    return NEPH_OK;
}

static enum neph_status print_json(const struct neph_noise_verdict *verdict,
                                   const struct neph_windows *windows, struct neph_diag *diag)
{
    json_t *json = neph_noise_json(verdict);
    neph_json_set(&json, "window", neph_windows_json(windows));
    return neph_json_print(json, diag);
}

static enum neph_status report(const struct neph_cli_z *request,
                               const struct neph_noise_verdict *verdict,
                               const struct neph_windows *windows, struct neph_junit *junit,
                               struct neph_diag *diag)
{
    char text[768];
    enum neph_status status = NEPH_OK;
    neph_noise_sentence(verdict, text, sizeof(text));
    neph_junit_add(junit, request->group, "no more than noise",
                   verdict->is_bias ? NEPH_JUNIT_FAILED : NEPH_JUNIT_PASSED,
                   verdict->is_bias ? text : "");
    if (request->json)
        status = print_json(verdict, windows, diag);
    else
        neph_noise_print(verdict, request->quiet, request->all, stdout);
    neph_windows_sentence(windows, text, sizeof(text));
    if (text[0] && !request->json && !request->quiet)
        printf("%s\n", text);
    fflush(stdout);
    if (status || !verdict->is_bias)
        return status;
    return neph_fail(diag, NEPH_ERR_GATE, "the test is biased against the reference, p = %.2g",
                     verdict->p);
}

static enum neph_status judge(const struct neph_cli_z *request,
                              const struct neph_noisy_render renders[2],
                              const struct neph_windows *windows, struct neph_junit *junit,
                              struct neph_diag *diag)
{
    struct neph_noise_verdict verdict;
    struct neph_image *image = NULL;
    float *scores = NULL;
    enum neph_status status = neph_image_create(renders[1].width_px, renders[1].height_px, &image,
                                                diag);
    if (!status)
        status = neph_image_add_channel(image, "Y", &scores, diag);
    if (!status)
        status = neph_noise_judge(&renders[0], &renders[1], scores, &verdict, diag);
    if (!status && request->maps)
        status = write_map(request->maps, image, diag);
    neph_image_destroy(image);
    return status ? status : report(request, &verdict, windows, junit, diag);
}

enum neph_status neph_cli_z_run(const struct neph_cli_z *request, struct neph_junit *junit,
                                struct neph_diag *diag)
{
    const struct neph_sequence *sides[2] = {request->reference, request->test};
    struct neph_noisy_render renders[2] = {{.file_count = 0}, {.file_count = 0}};
    struct neph_frame_form form = {.path = NULL};
    struct neph_noisy_reading reading = request->reading;
    struct neph_windows windows;
    reading.form = &form;
    enum neph_status status = request->maps ? check_map(request, diag) : NEPH_OK;
    if (!status)
        status = neph_windows_find(sides, 2, request->window, &reading.choice, &windows, diag);
    for (int s = 0; s < 2 && !status; s++)
        status = neph_noisy_render_read(sides[s], &reading, &renders[s], diag);
    if (!status)
        status = judge(request, renders, &windows, junit, diag);
    for (int s = 0; s < 2; s++)
        neph_noisy_render_finish(&renders[s]);
    neph_frame_form_finish(&form);
    return status;
}
