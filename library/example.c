/* SPDX-License-Identifier: MIT
 *
 * The error of an image, by libneph_metrics:
 *
 *     cc example.c $(pkg-config --cflags --libs neph_metrics) -o example && ./example
 */
#include <neph_metrics.h>

#include <stdio.h>

enum { WIDTH_PX = 64, HEIGHT_PX = 36 };

/* A grey ramp times `gain`; NULL: the error has been printed. */
static nephm_image *make_ramp(float gain)
{
    static float samples[HEIGHT_PX][WIDTH_PX];
    struct nephm_error error;
    nephm_image *image;
    for (int y = 0; y < HEIGHT_PX; y++)
        for (int x = 0; x < WIDTH_PX; x++)
            samples[y][x] = gain * (float)(x + 1) / WIDTH_PX;
    if (nephm_image_create(WIDTH_PX, HEIGHT_PX, &image, &error)) {
        fprintf(stderr, "%s\n", error.text);
        return NULL;
    }
    if (nephm_image_set_floats(image, "R", samples, sizeof(float), sizeof(samples[0]), &error)) {
        fprintf(stderr, "%s\n", error.text);
        nephm_image_destroy(image);
        return NULL;
    }
    return image;
}

/* Print all numbers of the comparison; returns a status. */
static int compare(const nephm_image *reference, const nephm_image *test, struct nephm_error *error)
{
    nephm_task *task;
    nephm_result *result = NULL;
    int status = nephm_task_create(NEPHM_COMPARE, &task, error);
    if (status)
        return status;
    status = nephm_task_set(task, "metric", "error", error);
    if (!status)
        status = nephm_task_run(task, &reference, 1, &test, 1, &result, error);
    for (size_t i = 0; !status && i < nephm_result_count(result); i++) {
        struct nephm_number number;
        status = nephm_result_number(result, i, &number, error);
        if (!status)
            printf("%s of %s over %s: %.6g\n", number.metric, number.quantity, number.mask,
                   number.value);
    }
    nephm_result_destroy(result);
    nephm_task_destroy(task);
    return status;
}

int main(void)
{
    struct nephm_error error = {""};
    nephm_image *reference = make_ramp(1.0f), *test = make_ramp(1.01f);
    const int status = reference && test ? compare(reference, test, &error) : 1;
    if (status)
        fprintf(stderr, "%s\n", error.text);
    nephm_image_destroy(reference);
    nephm_image_destroy(test);
    return status;
}
