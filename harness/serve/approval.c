/* SPDX-License-Identifier: MIT */
#include "harness/serve/approval.h"

#include <string.h>

enum { SERIES_MAX = 1024 };

static const char content_type[] = "application/json";

enum neph_status neph_approval_begin(struct neph_approval *approval, struct neph_diag *diag)
{
    return neph_secret_draw(approval->nonce, diag);
}

static void reply_json(struct neph_http_reply *reply, int code, json_t *json)
{
    neph_http_reply_text(reply, code, content_type, json ? json_dumps(json, JSON_COMPACT) : NULL);
    json_decref(json);
}

static void reply_error(struct neph_http_reply *reply, int code, const char *words)
{
    reply_json(reply, code, json_pack("{s:o}", "error", neph_json_cleaned(words)));
}

static void reply_status(struct neph_http_reply *reply, enum neph_status status,
                         const struct neph_diag *diag)
{
    reply_error(reply,
                status == NEPH_ERR_NOT_FOUND ? 404
                : status == NEPH_ERR_USAGE   ? 400
                                             : 500,
                diag->message);
}

/* ---- the state ------------------------------------------------------------------------------- */

/* Removes the acceptances of other runs. */
static void keep_night(json_t *acceptances, int64_t night)
{
    for (size_t i = json_array_size(acceptances); i-- > 0;)
        if (json_integer_value(json_object_get(json_array_get(acceptances, i), "night")) != night)
            json_array_remove(acceptances, i);
}

static void reply_state(const struct neph_approval *approval, struct neph_database *index,
                        struct neph_http_reply *reply)
{
    struct neph_diag diag = {.line = 0};
    int64_t night = 0;
    json_t *acceptances = NULL;
    enum neph_status status = neph_history_last(index, &night, &diag);
    if (!status)
        status = neph_history_acceptances(index, &acceptances, &diag);
    if (status) {
        reply_status(reply, status, &diag);
        return;
    }
    keep_night(acceptances, night);
    reply_json(reply, 200,
               json_pack("{s:s, s:I, s:s, s:o}", "format", "neph-approval-1", "night",
                         (json_int_t)night, "nonce", approval->nonce, "acceptances", acceptances));
}

/* ---- an acceptance --------------------------------------------------------------------------- */

struct asked {
    json_t *document; /* owns the texts */
    const char *nonce, *why;
    json_int_t night;
    json_t *series;
    const char *names[SERIES_MAX];
};

static bool is_printable(const char *text)
{
    for (; *text; text++)
        if (((unsigned char)*text < ' ' && *text != '\n' && *text != '\t') || *text == 127)
            return false;
    return true;
}

/* The text of the error, or NULL. */
static const char *read_request(const struct neph_http_request *request, struct asked *asked)
{
    asked->document = json_loadb(request->body, request->body_size, JSON_REJECT_DUPLICATES, NULL);
    if (!asked->document)
        return "the request is not JSON";
    if (json_unpack(asked->document, "{s:s, s:I, s:o, s:s !}", "nonce", &asked->nonce, "night",
                    &asked->night, "series", &asked->series, "why", &asked->why) != 0)
        return "an acceptance has nonce, night, series and why";
    const size_t count = json_array_size(asked->series);
    if (count == 0 || count > SERIES_MAX)
        return "series is a list of 1 to 1024 names, or [\"*\"]";
    for (size_t i = 0; i < count; i++)
        if (!(asked->names[i] = json_string_value(json_array_get(asked->series, i))))
            return "the name of a series is a text";
    if (asked->why[strspn(asked->why, " \t\r\n")] == '\0')
        return "why is it accepted? A reason is needed";
    if (strlen(asked->why) > NEPH_APPROVAL_WHY_MAX || !is_printable(asked->why))
        return "the reason has at most 1000 bytes, and no control characters";
    return NULL;
}

static const char *find_conflict(const struct neph_approval *approval, const struct asked *asked,
                                 int64_t last)
{
    if (strcmp(asked->nonce, approval->nonce) != 0)
        return "something was accepted since this page was loaded: load it again";
    return asked->night != last ? "this is not the last finished run: load the page again" : NULL;
}

static void accept(struct neph_approval *approval, struct neph_database *index,
                   const struct asked *asked, struct neph_http_reply *reply)
{
    struct neph_diag diag = {.line = 0};
    const struct neph_acceptance acceptance = {asked->names, (int)json_array_size(asked->series),
                                               asked->night, NULL, asked->why};
    struct neph_accepted accepted;
    enum neph_status status = neph_secret_draw(approval->nonce, &diag); /* the old one is used up */
    if (!status)
        status = neph_accept(index, neph_store_folder(approval->store), &acceptance, &accepted,
                             &diag);
    if (status) {
        reply_status(reply, status, &diag);
        return;
    }
    approval->tell(approval->context, &accepted, asked->series, asked->why);
    reply_state(approval, index, reply);
}

static void answer_post(struct neph_approval *approval, struct neph_database *index,
                        const struct neph_http_request *request, struct neph_http_reply *reply)
{
    struct neph_diag diag = {.line = 0};
    struct asked asked = {.document = NULL};
    int64_t last = 0;
    const enum neph_status status = neph_history_last(index, &last, &diag);
    const char *wrong = read_request(request, &asked);
    const char *conflict = status || wrong ? NULL : find_conflict(approval, &asked, last);
    if (status)
        reply_status(reply, status, &diag);
    else if (wrong)
        reply_error(reply, 400, wrong);
    else if (conflict)
        reply_error(reply, 409, conflict);
    else
        accept(approval, index, &asked, reply);
    json_decref(asked.document);
}

void neph_approval_answer(struct neph_approval *approval, const struct neph_http_request *request,
                          struct neph_http_reply *reply)
{
    struct neph_diag diag = {.line = 0};
    struct neph_database *index = NULL;
    const enum neph_status status = neph_store_index(approval->store, &index, &diag);
    if (status)
        reply_status(reply, status, &diag);
    else if (request->is_post)
        answer_post(approval, index, request, reply);
    else
        reply_state(approval, index, reply);
    neph_database_close(index);
}
