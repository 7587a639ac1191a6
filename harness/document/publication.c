/* SPDX-License-Identifier: MIT */
#include "harness/document/publication.h"

#include "base/files.h"
#include "harness/json_file.h"

#include <stdlib.h>
#include <string.h>

enum { TEXT, CSV, CHART };
_Static_assert(CHART + 1 == NEPH_PUBLICATION_STREAMS, "a new stream");

static FILE **select_stream(struct neph_publication *publication, int form)
{
    return form == TEXT  ? &publication->text
           : form == CSV ? &publication->csv
                         : &publication->chart;
}

enum neph_status neph_publication_begin(const struct neph_publication_places *places,
                                        struct neph_publication *publication,
                                        struct neph_diag *diag)
{
    *publication = (struct neph_publication){.places = places};
    const bool is_wanted[] = {!places->json || places->markdown, places->csv, places->chart};
    for (int form = 0; form < NEPH_PUBLICATION_STREAMS; form++) {
        if (!is_wanted[form])
            continue;
        FILE **stream = select_stream(publication, form);
        *stream = open_memstream(&publication->kept[form].text, &publication->kept[form].size);
        if (!*stream)
            return neph_fail_memory(diag);
    }
    return NEPH_OK;
}

void neph_publication_table(struct neph_publication *publication, struct neph_table *table)
{
    if (publication->text)
        neph_table_print(table, publication->text);
    publication->arena.is_short |= table->arena.is_short;
    neph_table_finish(table);
}

void neph_publication_csv(struct neph_publication *publication, const char *line_end,
                          struct neph_table *table)
{
    if (publication->csv)
        neph_table_print_csv(table, line_end, publication->csv);
    publication->arena.is_short |= table->arena.is_short;
    neph_table_finish(table);
}

/* Close the streams. False: a stream lost data. */
static bool close_streams(struct neph_publication *publication)
{
    bool is_whole = true;
    for (int form = 0; form < NEPH_PUBLICATION_STREAMS; form++) {
        FILE **stream = select_stream(publication, form);
        if (*stream) {
            is_whole = !ferror(*stream) && is_whole;
            is_whole = fclose(*stream) == 0 && is_whole;
        }
        *stream = NULL;
    }
    return is_whole;
}

static void print_text(const struct neph_publication *publication)
{
    const struct neph_publication_places *places = publication->places;
    if (publication->answer.count > 0 && !places->all)
        neph_answer_print(&publication->answer, &places->rest, places->quiet, stdout);
    else
        fputs(publication->kept[TEXT].text, stdout);
}

static enum neph_status print_results(struct neph_publication *publication, bool has_csv,
                                      struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    if (has_csv && fputs(publication->kept[CSV].text, stdout) < 0)
        return neph_fail(diag, NEPH_ERR_IO, "cannot write to stdout");
    if (publication->places->json) {
        status = neph_json_print(publication->json, diag);
        publication->json = NULL;
    } else if (!has_csv) {
        print_text(publication);
    }
    fflush(stdout); /* before the verdict on stderr */
    return status;
}

enum neph_status neph_publication_publish(struct neph_publication *publication,
                                          struct neph_diag *diag)
{
    const struct neph_publication_places *places = publication->places;
    const bool has_csv = places->csv && strcmp(places->csv, "-") == 0; /* on stdout */
    const struct {
        const char *path;
        int form;
    } files[] = {
        {places->markdown, TEXT}, {has_csv ? NULL : places->csv, CSV}, {places->chart, CHART}};
    const bool is_whole = close_streams(publication) && !publication->arena.is_short &&
                          !publication->answer.arena.is_short;
    enum neph_status status = is_whole ? NEPH_OK : neph_fail_memory(diag);
    if (!status && places->document)
        status = neph_json_check(publication->json, diag);
    if (!status && places->document)
        status = neph_json_write(publication->json, JSON_INDENT(1), places->document, diag);
    for (size_t i = 0; i < sizeof(files) / sizeof(files[0]) && !status; i++)
        if (files[i].path && (i != CHART || publication->kept[CHART].size > 0))
            status = neph_file_write(files[i].path, publication->kept[files[i].form].text,
                                     publication->kept[files[i].form].size, diag);
    if (!status)
        status = print_results(publication, has_csv, diag);
    if (!status && publication->broken_count > 0)
        status = neph_fail(diag, NEPH_ERR_ENGINE, "%d %s", publication->broken_count,
                           publication->broken_words);
    if (!status && publication->verdict) {
        status = publication->verdict;
        if (diag)
            *diag = publication->reason;
    }
    return status;
}

void neph_publication_finish(struct neph_publication *publication)
{
    close_streams(publication);
    for (int form = 0; form < NEPH_PUBLICATION_STREAMS; form++)
        free(publication->kept[form].text);
    json_decref(publication->json);
    neph_arena_finish(&publication->arena);
    neph_answer_finish(&publication->answer);
    *publication = (struct neph_publication){.places = NULL};
}
