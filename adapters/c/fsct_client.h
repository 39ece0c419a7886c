/* Serves a DUT (fsct_dut.h) to fsct over a stream of octets, as PROTOCOL.md describes it: no allocation, no operating
 * system, no state outside the struct.
 *
 *     static struct fsct_client client;
 *     fsct_client_init(&client, dut, uart_write, NULL);
 *     for (;;)
 *         if (uart_read(&octet)) fsct_client_take(&client, &octet, 1);
 *         else if (nothing came for 200 ms) fsct_client_idle(&client);
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef FSCT_CLIENT_H
#define FSCT_CLIENT_H

#include "fsct_dut.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Octets of payload taken in one frame, 512 or more, and put into one frame. More of them make batches longer, and a run
 * over a socket faster. */
#ifndef FSCT_CLIENT_PAYLOAD
#define FSCT_CLIENT_PAYLOAD 512u
#endif

/* Octets of a frame around its payload. */
#define FSCT_FRAME_OVERHEAD 10u

struct fsct_client {
    struct fsct_sink sink; /* first, so that it can be told from */
    const struct fsct_dut *dut;
    void (*write)(void *to, const uint8_t *octets, size_t length);
    void *to;
    uint8_t greeted;  /* a version has been agreed on */
    uint8_t sequence; /* of the request being answered */
    uint16_t position; /* of the stimulus being carried out */
    size_t received;  /* octets in `in` */
    size_t filled;    /* octets of payload in `out` */
    uint8_t in[FSCT_CLIENT_PAYLOAD + FSCT_FRAME_OVERHEAD];
    uint8_t out[FSCT_CLIENT_PAYLOAD + FSCT_FRAME_OVERHEAD];
};

/* A client that has seen nothing. `write` sends octets and returns when they are on their way; what it cannot send is
 * lost, and fsct runs into its time-out. */
void fsct_client_init(struct fsct_client *client, const struct fsct_dut *dut,
                      void (*write)(void *to, const uint8_t *octets, size_t length), void *to);

/* Takes the next octets of the stream, however they are cut, and answers each request as it is complete. */
void fsct_client_take(struct fsct_client *client, const uint8_t *octets, size_t length);

/* Forgets an unfinished frame: for lines that can lose octets, when nothing has come for 200 ms. */
void fsct_client_idle(struct fsct_client *client);

#ifdef __cplusplus
}
#endif

#endif
