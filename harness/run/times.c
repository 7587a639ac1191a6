/* SPDX-License-Identifier: MIT
 *
 * The file times.json.
 */
#include "harness/run/times.h"

#include "base/files.h"
#include "base/path.h"
#include "harness/json_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char format[] = "neph-times-1";

enum neph_status neph_times_open(const char *path, struct neph_times *times, struct neph_diag *diag)
{
    json_error_t error;
    *times = (struct neph_times){.path = strdup(path)};
    if (!times->path)
        return neph_fail_memory(diag);
    if (!neph_path_exists(path)) {
        times->list = json_pack("{s:s, s:{}}", "format", format, "times");
        return neph_json_check(times->list, diag);
    }
    times->list = json_load_file(path, 0, &error);
    if (times->list && strcmp(neph_json_text(times->list, "format"), format) == 0 &&
        json_is_object(json_object_get(times->list, "times")))
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_INPUT, "'%s' has no times%s%s", path, times->list ? "" : ": ",
              times->list ? "" : error.text);
    neph_hint(diag, "remove it: its times are measured again");
    neph_times_close(times);
    return NEPH_ERR_INPUT;
}

enum neph_status neph_times_open_in(const char *folder, struct neph_times *times,
                                    struct neph_diag *diag)
{
    return neph_times_open(neph_path_in(folder, "times.json").text, times, diag);
}

void neph_times_close(struct neph_times *times)
{
    json_decref(times->list);
    free(times->path);
    *times = (struct neph_times){NULL};
}

static double number_at(const json_t *entry, const char *key)
{
    return json_number_value(json_object_get(entry, key));
}

bool neph_times_find(const struct neph_times *times, const struct neph_job *job,
                     struct neph_spread *time, int *pictures, double *start_s)
{
    char key[NEPH_HASH_HEX_SIZE];
    if (neph_job_key(job, key, NULL))
        return false;
    const json_t *entry = json_object_get(json_object_get(times->list, "times"), key);
    if (!entry || !(number_at(entry, "median") > 0.0))
        return false;
    *time = (struct neph_spread){number_at(entry, "median"), number_at(entry, "low"),
                                 number_at(entry, "high")};
    *pictures = (int)json_integer_value(json_object_get(entry, "pictures"));
    if (start_s)
        *start_s = json_is_number(json_object_get(entry, "start_s")) ? number_at(entry, "start_s")
                                                                     : NAN;
    return true;
}

enum neph_status neph_times_put(struct neph_times *times, const struct neph_job *job,
                                struct neph_spread time, int pictures, double start_s, double load,
                                struct neph_diag *diag)
{
    char key[NEPH_HASH_HEX_SIZE];
    enum neph_status status = neph_job_key(job, key, diag);
    if (status)
        return status;
    json_t *entry = json_pack("{s:f, s:f, s:f, s:i, s:o, s:s, s:o}", "median", time.median, "low",
                              time.low, "high", time.high, "pictures", pictures, "start_s",
                              neph_json_number(start_s), "device", job->info->device, "load",
                              neph_json_number(load));
    return neph_json_put(json_object_get(times->list, "times"), key, entry, diag);
}

enum neph_status neph_times_save(const struct neph_times *times, struct neph_diag *diag)
{
    return neph_json_write(times->list, JSON_INDENT(1) | JSON_SORT_KEYS, times->path, diag);
}
