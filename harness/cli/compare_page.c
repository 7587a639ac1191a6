/* SPDX-License-Identifier: MIT */
#include "harness/cli/compare_page.h"

#include "base/files.h"
#include "base/path.h"
#include "base/written.h"

#include <stdlib.h>

enum neph_status neph_cli_page_begin(const char *place, struct neph_cli_page *page,
                                     struct neph_diag *diag)
{
    if (!place)
        return NEPH_OK;
    page->place = place;
    page->maps = json_array();
    enum neph_status status = neph_report_folder_open(place, &page->folder, diag);
    if (!status)
        status = neph_dir_create(neph_path_in(neph_report_folder_work(page->folder), "maps").text,
                                 diag);
    return !status && !page->maps ? neph_fail_memory(diag) : status;
}

void neph_cli_page_add_comparison(struct neph_cli_page *page, enum neph_page_side side,
                                  struct neph_comparison *comparison)
{
    if (!page->folder)
        return;
    page->takers[side] = (struct neph_compare_maps){neph_report_folder_work(page->folder), side,
                                                    comparison->viewing, page->maps};
    comparison->take_map = neph_compare_page_take;
    comparison->map_context = &page->takers[side];
}

struct words {
    const struct neph_compared *compared;
    const struct neph_verdict_form *form;
};

static void write_words(const void *given, FILE *out)
{
    const struct words *words = given;
    neph_verdict(words->compared, words->form, out);
}

enum neph_status neph_cli_page_write(struct neph_cli_page *page, const char *verb,
                                     const struct neph_verdict_form *form,
                                     const struct neph_compared *compared,
                                     const struct neph_compared *beside, struct neph_diag *diag)
{
    const struct words words = {compared, form};
    char *verdict = NULL, told[512] = "";
    if (!page->folder)
        return NEPH_OK;
    enum neph_status status = neph_write_to_text(write_words, &words, &verdict, diag);
    const struct neph_compare_page made = {
        .verb = verb,
        .names = {form->test, form->other},
        .verdict = verdict,
        .tests = {&compared->asked->test, beside ? &beside->asked->test : NULL},
        .compared = {compared, beside},
        .maps = page->maps,
    };
    if (!status)
        status = neph_compare_page_write(&made, page->folder, told, diag);
    if (told[0])
        fprintf(stderr, "note: %s\n", told);
    if (!status)
        fprintf(stderr, "page: %s/index.html\n", page->place);
    free(verdict);
    return status;
}

void neph_cli_page_end(struct neph_cli_page *page)
{
    neph_report_folder_close(page->folder);
    json_decref(page->maps);
    *page = (struct neph_cli_page){.folder = NULL};
}
