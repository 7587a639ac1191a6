/* SPDX-License-Identifier: MIT */
#include "harness/night/accept.h"

#include "base/text.h"

#include <pwd.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static void name_user(char who[NEPH_ACCEPTANCE_WHO_BYTES])
{
    char host[128] = "";
    const struct passwd *user = getpwuid(geteuid());
    gethostname(host, sizeof(host) - 1);
    neph_text_format(who, NEPH_ACCEPTANCE_WHO_BYTES, "%s@%s", user ? user->pw_name : "unknown",
                     host);
}

static enum neph_status find_night(struct neph_database *index, int64_t asked, int64_t *night,
                                   struct neph_diag *diag)
{
    *night = asked;
    enum neph_status status = asked > 0 ? NEPH_OK : neph_history_last(index, night, diag);
    if (!status && *night < 1) {
        status = neph_fail(diag, NEPH_ERR_NOT_FOUND, "no nightly run has ended yet");
        neph_hint(diag, "`neph nightly` runs one");
    }
    return status;
}

enum neph_status neph_accept(struct neph_database *index, const char *store_folder,
                             const struct neph_acceptance *asked, struct neph_accepted *accepted,
                             struct neph_diag *diag)
{
    static const char *const all = "*";
    const char *const *series = asked->count > 0 ? asked->series : &all;
    const int count = asked->count > 0 ? asked->count : 1;
    struct neph_accepted made;
    if (asked->why[strspn(asked->why, " \t\r\n")] == '\0')
        return neph_fail(diag, NEPH_ERR_USAGE, "why is it accepted?");
    enum neph_status status = find_night(index, asked->night, &made.night, diag);
    name_user(made.who);
    if (asked->who)
        neph_text_format(made.who, sizeof(made.who), "%s", asked->who);
    for (int i = 0; i < count && !status; i++)
        status = neph_history_check_acceptable(index, series[i], made.night, diag);
    for (int i = 0; i < count && !status; i++)
        status = neph_history_accept(index, store_folder, series[i], made.night, made.who,
                                     asked->why, diag);
    if (!status)
        *accepted = made;
    return status;
}

void neph_accepted_print(const struct neph_accepted *accepted, const char *series)
{
    printf("nightly run %lld is the baseline of %s\n", (long long)accepted->night,
           strcmp(series, "*") == 0 ? "all series" : series);
}
