/* SPDX-License-Identifier: MIT
 *
 * The server through libmicrohttpd, which is opened at run time: linked, it and the nine libraries
 * that it brings would lengthen each start of neph by a tenth or more. No other file includes it.
 */
#include "harness/serve/http.h"

#include "base/interrupt.h"
#include "harness/serve/secret.h"

#include <arpa/inet.h>
#include <dlfcn.h>
#include <errno.h>
#include <microhttpd.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
    TOKEN_CHARS = NEPH_SECRET_TEXT_SIZE - 1,
    CONNECTIONS_MAX = 64,
    IDLE_S = 10,                /* a connection that is silent for so long is closed */
    CONNECTION_BYTES = 1 << 15, /* of memory; the head of a request must fit */
    WAIT_MS = 1000,
};

/* Every answer has these: no other page may embed it, read it or be told its address, and no
 * browser keeps it. */
static const char *const headers[][2] = {
    {"Cache-Control", "no-store"},
    {"Content-Security-Policy", "frame-ancestors 'none'"},
    {"Cross-Origin-Opener-Policy", "same-origin"},
    {"Cross-Origin-Resource-Policy", "same-origin"},
    {"Referrer-Policy", "no-referrer"},
    {"X-Content-Type-Options", "nosniff"},
    {"X-Frame-Options", "DENY"},
};

static const char library_name[] = "libmicrohttpd.so.12";

/* The used functions. */
/* clang-format off */
#define MHD_FUNCTIONS(of) \
    of(start_daemon) of(stop_daemon) of(get_daemon_info) of(get_timeout) of(run) \
    of(lookup_connection_value) of(create_response_from_fd) of(create_response_from_buffer) \
    of(add_response_header) of(queue_response) of(destroy_response)
/* clang-format on */

struct mhd {
#define POINTER(name) __typeof__(MHD_##name) *name;
    MHD_FUNCTIONS(POINTER)
#undef POINTER
};

struct neph_http {
    struct mhd mhd;
    struct MHD_Daemon *daemon;
    neph_http_answer *answer;
    void *context;
    char token[NEPH_SECRET_TEXT_SIZE];
    char hosts[2][32]; /* values of "Host" that name this server */
    char url[NEPH_HTTP_URL_BYTES];
    struct neph_http_counts counts;
};

/* The body of a request while it arrives. */
struct upload {
    char *text;
    size_t size;
};

/* ---- the library ----------------------------------------------------------------------------- */

static const struct {
    const char *name;
    size_t at;
} functions[] = {
#define ROW(name) {"MHD_" #name, offsetof(struct mhd, name)},
    MHD_FUNCTIONS(ROW)
#undef ROW
};

bool neph_http_has_library(void)
{
    void *library = dlopen(library_name, RTLD_LAZY | RTLD_LOCAL);
    if (library)
        dlclose(library);
    return library != NULL;
}

/* The library stays loaded. */
static enum neph_status load(struct mhd *mhd, struct neph_diag *diag)
{
    void *library = dlopen(library_name, RTLD_NOW | RTLD_LOCAL);
    bool complete = library != NULL;
    for (size_t i = 0; i < sizeof(functions) / sizeof(functions[0]) && complete; i++) {
        void *function = dlsym(library, functions[i].name);
        memcpy((char *)mhd + functions[i].at, &function, sizeof(function));
        complete = function != NULL;
    }
    if (complete)
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_UNAVAILABLE, "libmicrohttpd cannot be opened: %s", dlerror());
    neph_hint(diag, "apt-get install libmicrohttpd12");
    return NEPH_ERR_UNAVAILABLE;
}

/* ---- answers --------------------------------------------------------------------------------- */

static enum MHD_Result send_reply(const struct mhd *mhd, struct MHD_Connection *connection,
                                  const struct neph_http_reply *reply)
{
    struct MHD_Response *response =
        reply->file >= 0
            ? mhd->create_response_from_fd(reply->file_bytes, reply->file)
            : mhd->create_response_from_buffer(
                  reply->text ? strlen(reply->text) : 0, reply->text ? reply->text : (char *)"",
                  reply->text ? MHD_RESPMEM_MUST_FREE : MHD_RESPMEM_PERSISTENT);
    if (!response) {
        if (reply->file >= 0)
            close(reply->file);
        free(reply->text);
        return MHD_NO;
    }
    bool complete = !reply->type ||
                    mhd->add_response_header(response, "Content-Type", reply->type) == MHD_YES;
    if (reply->location[0])
        complete &= mhd->add_response_header(response, "Location", reply->location) == MHD_YES;
    for (size_t i = 0; i < sizeof(headers) / sizeof(headers[0]); i++)
        complete &= mhd->add_response_header(response, headers[i][0], headers[i][1]) == MHD_YES;
    const enum MHD_Result sent =
        complete ? mhd->queue_response(connection, (unsigned)reply->code, response) : MHD_NO;
    mhd->destroy_response(response);
    return sent;
}

static enum MHD_Result refuse(struct neph_http *http, struct MHD_Connection *connection, int code,
                              const char *words)
{
    struct neph_http_reply reply = {0};
    char *text = NULL;
    http->counts.refused++;
    if (asprintf(&text, "%d: %s\n", code, words) < 0)
        text = NULL;
    neph_http_reply_text(&reply, code, "text/plain; charset=utf-8", text);
    return send_reply(&http->mhd, connection, &reply);
}

/* ---- who may ask ----------------------------------------------------------------------------- */

static const char *get_header(const struct neph_http *http, struct MHD_Connection *connection,
                              const char *name)
{
    return http->mhd.lookup_connection_value(connection, MHD_HEADER_KIND, name);
}

static bool is_this_host(const struct neph_http *http, const char *host)
{
    return host && (strcmp(host, http->hosts[0]) == 0 || strcmp(host, http->hosts[1]) == 0);
}

/* Whether the request comes from a page of this server, or from no page. */
static bool has_good_origin(const struct neph_http *http, struct MHD_Connection *connection,
                            bool is_post)
{
    static const char scheme[] = "http://";
    const char *origin = get_header(http, connection, "Origin"),
               *host = get_header(http, connection, "Host"),
               *site = get_header(http, connection, "Sec-Fetch-Site");
    if (site && strcmp(site, "same-origin") != 0 && strcmp(site, "none") != 0)
        return false;
    if (!origin)
        return !is_post;
    return strncmp(origin, scheme, strlen(scheme)) == 0 &&
           strcmp(origin + strlen(scheme), host) == 0;
}

/* Compares all characters, so that the time tells nothing about the right ones. Returns the path
 * behind the token, or NULL. */
static const char *path_behind_token(const struct neph_http *http, const char *url)
{
    unsigned differ = 0;
    if (url[0] != '/' || strlen(url) < TOKEN_CHARS + 2 || url[TOKEN_CHARS + 1] != '/')
        return NULL;
    for (int i = 0; i < TOKEN_CHARS; i++)
        differ |= (unsigned char)url[1 + i] ^ (unsigned char)http->token[i];
    return differ == 0 ? url + TOKEN_CHARS + 2 : NULL;
}

/* The reason to refuse a request by its head, and the code; NULL: none. */
static const char *find_refusal(const struct neph_http *http, struct MHD_Connection *connection,
                                const char *url, const char *method, int *code)
{
    const bool is_post = strcmp(method, "POST") == 0;
    const char *length = get_header(http, connection, "Content-Length");
    *code = 403;
    if (!is_this_host(http, get_header(http, connection, "Host")))
        return "this server answers to 127.0.0.1 only";
    if (!has_good_origin(http, connection, is_post))
        return "a page of another origin may not ask";
    if (!path_behind_token(http, url))
        return "the address needs the token that `neph serve` has printed";
    *code = 405;
    if (!is_post && strcmp(method, "GET") != 0 && strcmp(method, "HEAD") != 0)
        return "GET, HEAD or POST";
    *code = 413;
    return length && strtod(length, NULL) > NEPH_HTTP_BODY_MAX ? "the body is too large" : NULL;
}

/* ---- requests -------------------------------------------------------------------------------- */

static enum MHD_Result take_body(struct upload *upload, const char *data, size_t *size)
{
    if (upload->size + *size > NEPH_HTTP_BODY_MAX)
        return MHD_NO; /* closes the connection: its length was a lie, or not told */
    char *grown = realloc(upload->text, upload->size + *size + 1);
    if (!grown)
        return MHD_NO;
    memcpy(grown + upload->size, data, *size);
    upload->text = grown;
    upload->size += *size;
    grown[upload->size] = '\0';
    *size = 0;
    return MHD_YES;
}

/* Called once when the head is there (`*upload_` is NULL), for each part of the body, and at its
 * end (`*size` is 0). */
static enum MHD_Result on_request(void *http_, struct MHD_Connection *connection, const char *url,
                                  const char *method, const char *version, const char *data,
                                  size_t *size, void **upload_)
{
    struct neph_http *http = http_;
    struct upload *upload = *upload_;
    int code;
    (void)version;
    if (!upload) {
        const char *words = find_refusal(http, connection, url, method, &code);
        *upload_ = calloc(1, sizeof(*upload));
        return words ? refuse(http, connection, code, words) : *upload_ ? MHD_YES : MHD_NO;
    }
    if (*size > 0)
        return take_body(upload, data, size);
    const struct neph_http_request request = {.is_post = strcmp(method, "POST") == 0,
                                              .path = path_behind_token(http, url),
                                              .body = upload->text ? upload->text : "",
                                              .body_size = upload->size};
    struct neph_http_reply reply = {.file = -1};
    http->answer(http->context, &request, &reply);
    *(reply.code < 400 ? &http->counts.answered : &http->counts.refused) += 1;
    return send_reply(&http->mhd, connection, &reply);
}

static void on_end(void *http, struct MHD_Connection *connection, void **upload_,
                   enum MHD_RequestTerminationCode why)
{
    struct upload *upload = *upload_;
    (void)http;
    (void)connection;
    (void)why;
    if (upload)
        free(upload->text);
    free(upload);
    *upload_ = NULL;
}

/* ---- the server ------------------------------------------------------------------------------ */

static enum neph_status listen_at(struct neph_http *http, int port, struct neph_diag *diag)
{
    struct sockaddr_in address = {.sin_family = AF_INET,
                                  .sin_port = htons((uint16_t)port),
                                  .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    http->daemon = http->mhd.start_daemon(
        MHD_USE_EPOLL, 0, NULL, NULL, on_request, http, MHD_OPTION_SOCK_ADDR, &address,
        MHD_OPTION_NOTIFY_COMPLETED, on_end, http, MHD_OPTION_CONNECTION_LIMIT,
        (unsigned)CONNECTIONS_MAX, MHD_OPTION_CONNECTION_TIMEOUT, (unsigned)IDLE_S,
        MHD_OPTION_CONNECTION_MEMORY_LIMIT, (size_t)CONNECTION_BYTES, MHD_OPTION_STRICT_FOR_CLIENT,
        1, MHD_OPTION_SIGPIPE_HANDLED_BY_APP, 1, MHD_OPTION_END);
    if (http->daemon)
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_IO, "cannot listen at 127.0.0.1:%d: %s", port, strerror(errno));
    neph_hint(diag, "without --port a free one is taken");
    return NEPH_ERR_IO;
}

static void name_server(struct neph_http *http)
{
    const unsigned port = http->mhd.get_daemon_info(http->daemon, MHD_DAEMON_INFO_BIND_PORT)->port;
    snprintf(http->hosts[0], sizeof(http->hosts[0]), "127.0.0.1:%u", port);
    snprintf(http->hosts[1], sizeof(http->hosts[1]), "localhost:%u", port);
    snprintf(http->url, sizeof(http->url), "http://%s/%s/", http->hosts[0], http->token);
}

enum neph_status neph_http_open(int port, neph_http_answer *answer, void *context,
                                struct neph_http **opened, struct neph_diag *diag)
{
    struct neph_http *http = calloc(1, sizeof(*http));
    if (!http)
        return neph_fail_memory(diag);
    *http = (struct neph_http){.answer = answer, .context = context};
    enum neph_status status = load(&http->mhd, diag);
    if (!status)
        status = neph_secret_draw(http->token, diag);
    if (!status)
        status = listen_at(http, port, diag);
    if (status) {
        neph_http_close(http);
        return status;
    }
    name_server(http);
    *opened = http;
    return NEPH_OK;
}

void neph_http_close(struct neph_http *http)
{
    if (http && http->daemon)
        http->mhd.stop_daemon(http->daemon);
    free(http);
}

const char *neph_http_url(const struct neph_http *http)
{
    return http->url;
}

enum neph_status neph_http_run(struct neph_http *http, struct neph_diag *diag)
{
    struct pollfd ready[2] = {
        {.fd = http->mhd.get_daemon_info(http->daemon, MHD_DAEMON_INFO_EPOLL_FD)->epoll_fd,
         .events = POLLIN},
        {.fd = neph_interrupt_fd(), .events = POLLIN}};
    while (!neph_interrupted()) {
        MHD_UNSIGNED_LONG_LONG due_ms = WAIT_MS;
        if (http->mhd.get_timeout(http->daemon, &due_ms) == MHD_YES && due_ms > WAIT_MS)
            due_ms = WAIT_MS;
        if (poll(ready, 2, (int)due_ms) < 0 && errno != EINTR)
            return neph_fail(diag, NEPH_ERR_IO, "cannot wait for requests: %s", strerror(errno));
        if (http->mhd.run(http->daemon) != MHD_YES)
            return neph_fail(diag, NEPH_ERR_IO, "cannot answer requests");
    }
    return NEPH_OK;
}

struct neph_http_counts neph_http_counts(const struct neph_http *http)
{
    return http->counts;
}
