/* SPDX-License-Identifier: MIT
 *
 * 1,000 images on eight threads, by libneph_metrics: all share the reference and the task. Prints
 * one line when every number is the one of a single thread.
 *
 *     cc example_threads.c $(pkg-config --cflags --libs neph_metrics) -lpthread -o threads
 */
#include <neph_metrics.h>

#include <pthread.h>
#include <stdio.h>
#include <string.h>

enum { SIDE_PX = 32, THREADS = 8, IMAGES = 1000, NUMBERS_MAX = 64 };

struct work {
    const nephm_image *reference;
    const nephm_task *task;
    int first; /* this thread's images are first, first + THREADS, ... */
    int failures;
    double values[NUMBERS_MAX]; /* of its first image */
};

/* One of four images; NULL: an error. */
static nephm_image *make_image(int kind)
{
    float samples[SIDE_PX][SIDE_PX];
    nephm_image *image;
    for (int y = 0; y < SIDE_PX; y++)
        for (int x = 0; x < SIDE_PX; x++)
            samples[y][x] = 1.0f + (float)((x * (kind + 3) + y) % 17);
    if (nephm_image_create(SIDE_PX, SIDE_PX, &image, NULL))
        return NULL;
    if (!nephm_image_set_floats(image, "R", samples, sizeof(float), sizeof(samples[0]), NULL))
        return image;
    nephm_image_destroy(image);
    return NULL;
}

/* The numbers of one image; returns a status. */
static int measure(const struct work *work, int kind, double values[NUMBERS_MAX])
{
    nephm_image *test = make_image(kind);
    const nephm_image *tests[] = {test};
    nephm_result *result = NULL;
    struct nephm_error error;
    int status = test ? nephm_task_run(work->task, &work->reference, 1, tests, 1, &result, &error)
                      : NEPHM_ERR_MEMORY;
    memset(values, 0, NUMBERS_MAX * sizeof(*values));
    for (size_t i = 0; !status && i < nephm_result_count(result) && i < NUMBERS_MAX; i++) {
        struct nephm_number number;
        status = nephm_result_number(result, i, &number, &error);
        values[i] = status || !number.is_defined ? 0.0 : number.value;
    }
    nephm_result_destroy(result);
    nephm_image_destroy(test);
    return status;
}

static void *run(void *context)
{
    struct work *work = context;
    for (int i = work->first; i < IMAGES; i += THREADS) {
        double values[NUMBERS_MAX];
        work->failures += measure(work, work->first % 4, values) != 0;
        if (i == work->first)
            memcpy(work->values, values, sizeof(values));
        work->failures += memcmp(work->values, values, sizeof(values)) != 0;
    }
    return NULL;
}

int main(void)
{
    struct work works[THREADS], alone;
    pthread_t threads[THREADS];
    nephm_task *task = NULL;
    nephm_image *reference = make_image(4);
    int failures = !reference || nephm_task_create(NEPHM_COMPARE, &task, NULL);
    for (int t = 0; t < THREADS && !failures; t++) {
        works[t] = (struct work){.reference = reference, .task = task, .first = t};
        failures += pthread_create(&threads[t], NULL, run, &works[t]) != 0;
    }
    for (int t = 0; t < THREADS && !failures; t++)
        pthread_join(threads[t], NULL);
    for (int t = 0; t < THREADS && !failures; t++) {
        alone = works[t];
        failures += works[t].failures + (measure(&alone, t % 4, alone.values) != 0) +
                    (memcmp(alone.values, works[t].values, sizeof(alone.values)) != 0);
    }
    nephm_task_destroy(task);
    nephm_image_destroy(reference);
    printf("%d images on %d threads: %d failures\n", IMAGES, THREADS, failures);
    return failures != 0;
}
