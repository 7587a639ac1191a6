/* SPDX-License-Identifier: MIT
 *
 * A program of one library and those below it: the test is that it links.
 */
int main(void)
{
    return 0;
}
