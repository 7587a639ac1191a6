/* SPDX-License-Identifier: MIT
 *
 * `neph serve`: the page of the last nightly run for a browser of this machine, where a person can
 * accept changes.
 */
#include "harness/cli/cli.h"

#include "base/path.h"
#include "harness/serve/approval.h"
#include "harness/serve/files.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct request {
    struct neph_cli_shared shared;
    int port;
};

static const struct neph_cli_option options[] = {
    {"port", 0, "N", "Port of the loopback address (default: a free one)", NEPH_CLI_INTEGER,
     .at = offsetof(struct request, port), .minimum = 1024, .maximum = 65535},
    {.name = "output", .help = "Folder of the nightly runs", .otherwise = "out/nightly"},
    {.name = "json"},
    {.name = "quiet"},
    {.name = NULL},
};

static const struct neph_cli_syntax syntax = {
    .options = options,
    .doc = "Serve the page of the last nightly run to a browser of this machine, for accepting its "
           "changes.\v"
           "Prints the address of the page. It has a secret token that is new each time: only who "
           "has the address can read the page, and no page of another origin can use it. On the "
           "page each change can be accepted as the baseline with a reason, as `neph baseline "
           "accept` does. Ctrl-C ends the server. Acceptances are printed, with --json as one "
           "object a line. From another machine: ssh -L 8123:127.0.0.1:8123 HOST, and --port "
           "8123.\n\n"
           "Examples:\n"
           "  neph serve\n"
           "  neph serve -o out/nightly --port 8123",
};

struct service {
    struct neph_approval approval;
    int folder; /* OUTPUT/nightly */
    bool json;
};

static void answer(void *service_, const struct neph_http_request *request,
                   struct neph_http_reply *reply)
{
    struct service *service = service_;
    if (strcmp(request->path, "approval") == 0) {
        neph_approval_answer(&service->approval, request, reply);
    } else if (request->is_post) {
        neph_http_reply_text(reply, 405, "text/plain; charset=utf-8",
                             strdup("405: only approval takes a POST\n"));
    } else if (request->path[0] == '\0') {
        neph_http_reply_text(reply, 302, NULL, strdup(""));
        snprintf(reply->location, sizeof(reply->location), "report/");
    } else {
        neph_serve_file(service->folder, request->path, reply);
    }
}

static void tell(void *service_, const struct neph_accepted *accepted, const json_t *series,
                 const char *why)
{
    const struct service *service = service_;
    char *line = NULL;
    json_t *json = service->json
                       ? json_pack("{s:I, s:O, s:s, s:s}", "night", (json_int_t)accepted->night,
                                   "accepted", series, "who", accepted->who, "why", why)
                       : NULL;
    if (json && (line = json_dumps(json, JSON_COMPACT)))
        printf("%s\n", line);
    for (size_t i = 0; !service->json && i < json_array_size(series); i++)
        neph_accepted_print(accepted, json_string_value(json_array_get(series, i)));
    fflush(stdout);
    free(line);
    json_decref(json);
}

static enum neph_status open_folder(const char *output, int *folder, struct neph_diag *diag)
{
    const struct neph_path path = neph_path_in(output, "nightly");
    *folder = open(path.text, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (*folder >= 0)
        return NEPH_OK;
    neph_fail(diag, errno == ENOENT ? NEPH_ERR_NOT_FOUND : NEPH_ERR_IO, "'%s': %s", path.text,
              strerror(errno));
    neph_hint(diag, "`neph nightly -o FOLDER` writes it; -o names the same folder here");
    return errno == ENOENT ? NEPH_ERR_NOT_FOUND : NEPH_ERR_IO;
}

static enum neph_status serve(const struct request *request, struct service *service,
                              struct neph_diag *diag)
{
    struct neph_http *http = NULL;
    enum neph_status status = neph_http_open(request->port > 0 ? request->port : 0, answer, service,
                                             &http, diag);
    if (status)
        return status;
    signal(SIGPIPE, SIG_IGN); /* a browser that closes its connection */
    printf(request->shared.json ? "{\"url\": \"%sreport/\"}\n" : "%sreport/\n",
           neph_http_url(http));
    fflush(stdout);
    if (!request->shared.quiet)
        fprintf(stderr, "neph serve: Ctrl-C ends it\n");
    status = neph_http_run(http, diag);
    const struct neph_http_counts counts = neph_http_counts(http);
    if (!request->shared.quiet)
        fprintf(stderr, "neph serve: %lld requests answered, %lld refused\n", counts.answered,
                counts.refused);
    neph_http_close(http);
    return status;
}

enum neph_status neph_cli_serve(int argc, char **argv, struct neph_diag *diag)
{
    struct request request = {0};
    neph_cli_parse(&syntax, argc, argv, &request);
    struct service service = {.folder = -1, .json = request.shared.json};
    struct neph_store *store = NULL;
    enum neph_status status = open_folder(request.shared.output, &service.folder, diag);
    if (!status)
        status = neph_cli_open_store(request.shared.output, &store, diag);
    service.approval = (struct neph_approval){.store = store, .tell = tell, .context = &service};
    if (!status)
        status = neph_approval_begin(&service.approval, diag);
    if (!status)
        status = serve(&request, &service, diag);
    if (service.folder >= 0)
        close(service.folder);
    neph_store_close(store);
    return status;
}
