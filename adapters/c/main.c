/* Serves the DUT of fsct_dut() on POSIX: on standard input and output, for `fsct run --dut exec:./this`, or on a serial
 * line named as the only argument, which keeps the speed that `stty` has given it.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#define _POSIX_C_SOURCE 200809L

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include "fsct_client.h"

#define IDLE_MS 200

static struct fsct_client client;

struct line {
    int in, out;
    int idle_ms; /* -1: a line that loses nothing */
};

/* A frame is one write() where the system takes it at once. */
static void send_all(void *to, const uint8_t *octets, size_t length)
{
    const struct line *line = to;
    while (length > 0) {
        ssize_t sent = write(line->out, octets, length);
        if (sent < 0 && errno == EINTR)
            continue;
        if (sent < 0)
            exit(1); /* nobody is there any more */
        octets += sent, length -= (size_t)sent;
    }
}

/* Octets as they are: no line ends, no echo, no signals. */
static int set_raw(int device)
{
    struct termios line;
    if (tcgetattr(device, &line) != 0)
        return -1;
    line.c_iflag &= ~(tcflag_t)(BRKINT | ICRNL | IGNBRK | IGNCR | INLCR | INPCK | ISTRIP | IXOFF | IXON | PARMRK);
    line.c_oflag &= ~(tcflag_t)OPOST;
    line.c_lflag &= ~(tcflag_t)(ECHO | ECHONL | ICANON | IEXTEN | ISIG);
    line.c_cflag = (line.c_cflag & ~(tcflag_t)(CSIZE | PARENB)) | CS8 | CREAD | CLOCAL;
    line.c_cc[VMIN] = 1, line.c_cc[VTIME] = 0;
    return tcsetattr(device, TCSANOW, &line);
}

static int serve(struct line *line)
{
    static uint8_t octets[4096];
    struct pollfd input;
    input.fd = line->in, input.events = POLLIN, input.revents = 0;
    fsct_client_init(&client, fsct_dut(), send_all, line);
    for (;;) {
        int ready = poll(&input, 1, line->idle_ms);
        ssize_t length;
        if (ready == 0)
            fsct_client_idle(&client);
        if (ready == 0 || (ready < 0 && errno == EINTR))
            continue;
        length = read(line->in, octets, sizeof octets);
        if (length < 0 && errno == EINTR)
            continue;
        if (length <= 0)
            return length == 0 ? 0 : 1;
        fsct_client_take(&client, octets, (size_t)length);
    }
}

int main(int argc, char **argv)
{
    struct line line = {STDIN_FILENO, STDOUT_FILENO, -1};
    if (argc > 2) {
        fprintf(stderr, "usage: %s [SERIAL-DEVICE]\n", argv[0]);
        return 2;
    }
    if (argc == 2) {
        line.in = line.out = open(argv[1], O_RDWR | O_NOCTTY);
        line.idle_ms = IDLE_MS;
        if (line.in < 0 || set_raw(line.in) != 0) {
            perror(argv[1]);
            return 2;
        }
    }
    return serve(&line);
}
