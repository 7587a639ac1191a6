/* SPDX-License-Identifier: MIT
 *
 * A scene file's way into memory: read, parse, check along the schema, fill the structs, check the
 * rules between values, build, check the camera, hash.
 */
#include "base/files.h"
#include "scenes/build.h"
#include "scenes/check.h"

#include <locale.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The first two lines of libcyaml's complaint: what, and where. */
struct complaint {
    char message[256];
    int line, column;
};

static void log_cyaml(cyaml_log_t level, void *context, const char *format, va_list arguments)
    __attribute__((format(printf, 3, 0)));

static void log_cyaml(cyaml_log_t level, void *context, const char *format, va_list arguments)
{
    struct complaint *complaint = context;
    char text[256];
    (void)level;
    vsnprintf(text, sizeof(text), format, arguments);
    const char *place = strstr(text, "(line: ");
    if (place && !complaint->line)
        sscanf(place, "(line: %d, column: %d)", &complaint->line, &complaint->column);
    if (!place && !*complaint->message)
        snprintf(complaint->message, sizeof(complaint->message), "%.*s", (int)strcspn(text, "\n"),
                 text);
}

static cyaml_config_t configure(struct complaint *complaint)
{
    return (cyaml_config_t){
        .log_fn = log_cyaml,
        .log_ctx = complaint,
        .mem_fn = cyaml_mem,
        .log_level = CYAML_LOG_WARNING,
        .flags = CYAML_CFG_NO_ALIAS,
    };
}

/* neph_check_document() has refused what libcyaml would refuse, with better words; what is left
 * is a schema that the two read differently. */
static enum neph_status fail_cyaml(cyaml_err_t error, const struct complaint *complaint,
                                   const char *file, struct neph_diag *diag)
{
    if (error == CYAML_ERR_OOM)
        return neph_fail_memory(diag);
    neph_fail(diag, NEPH_ERR_INPUT, "%s: %s", cyaml_strerror(error), complaint->message);
    if (diag)
        neph_locate(diag, file, complaint->line, complaint->column);
    return NEPH_ERR_INPUT;
}

static enum neph_status load_raw(const char *file, const char *text, size_t size,
                                 struct neph_raw_scene **raw, struct neph_diag *diag)
{
    struct complaint complaint = {0};
    cyaml_config_t config = configure(&complaint);
    cyaml_data_t *data = NULL;
    cyaml_err_t error = cyaml_load_data((const uint8_t *)text, size, &config, neph_schema_root(),
                                        &data, NULL);
    if (error)
        return fail_cyaml(error, &complaint, file, diag);
    *raw = data;
    return NEPH_OK;
}

static void free_raw(struct neph_raw_scene *raw)
{
    struct complaint complaint = {0};
    cyaml_config_t config = configure(&complaint);
    cyaml_free(&config, neph_schema_root(), raw, 0);
}

char *neph_scene_name_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    const char *start = slash ? slash + 1 : path;
    const char *dot = strrchr(start, '.');
    return dot ? strndup(start, (size_t)(dot - start)) : strdup(start);
}

static void set_gate_lines(struct neph_document *document, struct neph_scene *scene)
{
    for (int i = 0; i < scene->gate_count; i++) {
        char path[NEPH_SCENE_PATH_MAX];
        snprintf(path, sizeof(path), "gates[%d]", i);
        scene->gates[i].line = (int)neph_document_find(document, path)->start_mark.line + 1;
    }
}

static enum neph_status build_checked(struct neph_document *document,
                                      const struct neph_raw_scene *raw, const char *path,
                                      struct neph_scene **scene, struct neph_diag *diag)
{
    struct neph_scene *made = NULL;
    char *stem = neph_scene_name_of(path);
    enum neph_status status = stem ? neph_check_rules(document, raw, stem, diag)
                                   : neph_fail_memory(diag);
    free(stem);
    if (!status)
        status = neph_scene_build(raw, document, path, &made, diag);
    if (!status)
        status = neph_check_scene(document, made, diag);
    if (!status)
        status = neph_scene_hash(made, diag);
    if (status) {
        neph_scene_destroy(made);
        return status;
    }
    set_gate_lines(document, made);
    *scene = made;
    return NEPH_OK;
}

static enum neph_status load_text(const char *path, const char *text, size_t size,
                                  struct neph_scene **scene, struct neph_diag *diag)
{
    struct neph_document document;
    enum neph_status status = neph_document_init(&document, path, text, size, NEPH_SCENE_DEPTH_MAX,
                                                 diag);
    if (status)
        return status;
    struct neph_raw_scene *raw = NULL;
    status = neph_check_document(&document, diag);
    if (!status)
        status = load_raw(path, text, size, &raw, diag);
    if (!status)
        status = build_checked(&document, raw, path, scene, diag);
    free_raw(raw);
    neph_document_finish(&document);
    return status;
}

enum neph_status neph_scene_load(const char *path, struct neph_scene **scene,
                                 struct neph_diag *diag)
{
    char *text = NULL;
    size_t size = 0;
    enum neph_status status = neph_file_read(path, NEPH_SCENE_FILE_MAX_BYTES, &text, &size, diag);
    if (status)
        return status;
    /* Numbers have a decimal point, whatever the locale of whoever called. */
    locale_t c_locale = newlocale(LC_NUMERIC_MASK, "C", (locale_t)0);
    if (c_locale) {
        locale_t before = uselocale(c_locale);
        status = load_text(path, text, size, scene, diag);
        uselocale(before);
        freelocale(c_locale);
    } else {
        status = neph_fail_memory(diag);
    }
    free(text);
    return status;
}
