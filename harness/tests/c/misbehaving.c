/* Libraries that misbehave, around the example FS-Device (compiled with -Dfsct_dut=example_dut): FAULT says how, AT in which
 * exchange of the process. That -D renames the struct along with the function.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#include "fsct_client.h"
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>

enum { NONE, ABORT, CRASH, LOOP, EXIT, FLOOD, NULL_OBSERVATION, NULL_OCTETS, PRINT, UNKNOWN_KIND, KILL };

static const struct example_dut *inner;
static unsigned long exchanges;

static void misbehave(struct fsct_sink *sink)
{
    static volatile int forever = 1;
    static volatile int *volatile nowhere;
    switch (FAULT) {
    case ABORT: fputs("assertion failed: stack is sound\n", stderr); abort();
    case CRASH: *nowhere = 1; break;
    case LOOP: while (forever) { } break;
    case EXIT: exit(7);
    case FLOOD: while (forever) fsct_event(sink, 0x1800, 0x54); break;
    case NULL_OBSERVATION: sink->see(sink, NULL); break;
    case NULL_OCTETS: fsct_service(sink, 1, FSCT_PDout_D, NULL, 3); break;
    case PRINT: printf("\xF5\xC7 not a frame\n"); fflush(stdout); break;
    case KILL: raise(9); break;
    case UNKNOWN_KIND: fsct_see(sink, fsct_seen(99)); break;
    default: break;
    }
}

static const struct fsct_description *hello(void *self)
{
    return inner->hello(self);
}

static void apply(void *self, const struct fsct_stimulus *stimulus, struct fsct_sink *sink)
{
    if (stimulus->kind == FSCT_EXCHANGE && ++exchanges == AT) misbehave(sink);
    inner->apply(self, stimulus, sink);
}

#undef fsct_dut
FSCT_EXPORT const struct example_dut *fsct_dut(void);

FSCT_EXPORT const struct example_dut *fsct_dut(void)
{
    static struct example_dut outer;
    inner = example_dut();
    outer = *inner;
    outer.hello = hello;
    outer.apply = apply;
#ifdef OTHER_ABI
    outer.abi = FSCT_ABI + 1;
#endif
#ifdef NO_APPLY
    outer.apply = NULL;
#endif
    return &outer;
}

#ifdef PROGRAM
#include "main.c"
#endif
