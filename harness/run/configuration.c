/* SPDX-License-Identifier: MIT
 *
 * Reads and writes neph-configuration-1 files.
 */
#include "harness/run/configuration.h"

#include "base/files.h"
#include "harness/engines/engines.h"
#include "scenes/words.h"

#include <stdlib.h>
#include <string.h>

static const char format[] = "neph-configuration-1";
enum { SIZE_MAX_BYTES = 1 << 20 };

json_t *neph_configuration_json(const struct neph_configuration *configuration)
{
    char *settings = neph_settings_text(configuration->engine, &configuration->settings);
    json_t *json = json_pack(
        "{s:s, s:s, s:s?, s:s}", "format", format, "engine", configuration->engine->name,
        "scattering",
        configuration->rescatters ? neph_scattering_name(configuration->scattering) : NULL,
        "settings", settings ? settings : "");
    free(settings);
    return json;
}

static enum neph_status read_scattering(const char *path, const json_t *json,
                                        struct neph_configuration *configuration,
                                        struct neph_diag *diag)
{
    const char *word = neph_json_text(json, "scattering");
    int index = 0;
    configuration->rescatters = word[0] != '\0';
    if (!configuration->rescatters)
        return NEPH_OK;
    while (neph_scattering_words[index] && strcmp(neph_scattering_words[index], word) != 0)
        index++;
    if (!neph_scattering_words[index])
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "'%s': there is no scattering '%.40s'; it is none, single or multiple",
                         path, word);
    configuration->scattering = (enum neph_scattering)index;
    return NEPH_OK;
}

static enum neph_status read_settings(const char *path, const json_t *json,
                                      struct neph_configuration *configuration,
                                      struct neph_diag *diag)
{
    char *text = strdup(neph_json_text(json, "settings")), *rest = text;
    enum neph_status status = text ? NEPH_OK : neph_fail_memory(diag);
    configuration->settings = neph_settings_default(configuration->engine);
    for (char *word = NULL; !status && (word = strsep(&rest, " "));)
        if (word[0] &&
            neph_settings_set(configuration->engine, &configuration->settings, word, diag)) {
            neph_prefix(diag, "'%s': ", path);
            status = NEPH_ERR_INPUT;
        }
    free(text);
    return status;
}

enum neph_status neph_configuration_read(const char *path, struct neph_configuration *configuration,
                                         struct neph_diag *diag)
{
    char *text = NULL;
    size_t size = 0;
    json_error_t error;
    enum neph_status status = neph_file_read(path, SIZE_MAX_BYTES, &text, &size, diag);
    if (status)
        return status;
    json_t *json = json_loadb(text, size, 0, &error);
    if (!json)
        status = neph_fail(diag, NEPH_ERR_INPUT, "'%s', line %d: %s", path, error.line, error.text);
    else if (strcmp(neph_json_text(json, "format"), format) != 0)
        status = neph_fail(diag, NEPH_ERR_INPUT, "'%s' is no configuration: its format is not %s",
                           path, format);
    else if (!(configuration->engine = neph_engine_find(neph_json_text(json, "engine"))))
        status = neph_fail(diag, NEPH_ERR_INPUT, "'%s': there is no engine '%.40s'", path,
                           neph_json_text(json, "engine"));
    if (!status)
        status = read_scattering(path, json, configuration, diag);
    if (!status)
        status = read_settings(path, json, configuration, diag);
    json_decref(json);
    free(text);
    return status;
}
