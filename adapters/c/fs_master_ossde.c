/* The OSSDe port of fs_master_ossde.h.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#include "fs_master_ossde.h"

#include <string.h>

#include "fs_master_scl.h"

/* Longest test pulse, and Ready pulse, that changes nothing: 5.3.4, Table 8. */
#define FILTER (1 * FS_MS)
/* tdisM: discrepancy that is accepted, Table 8. */
#define DISCREPANCY (3 * FS_MS)
/* The first port diagnosis: longer than filter and discrepancy together. */
#define FIRST_DIAGNOSIS (10 * FS_MS)

#define ON 0x03u

void fs_ossde_stop(struct fs_ossde *ossde)
{
    memset(ossde, 0, sizeof *ossde);
    ossde->state = FS_OSSDE_INACTIVE;
    ossde->settled[FS_OSSDE_CQ] = ossde->settled[FS_OSSDE_IQ] = FS_NEVER;
    ossde->tolerated = ossde->checked = FS_NEVER;
}

void fs_ossde_start(struct fs_ossde *ossde, uint8_t cq, uint8_t iq, uint64_t now)
{
    fs_ossde_stop(ossde);
    ossde->state = FS_OSSDE_CHECK;
    ossde->level[FS_OSSDE_CQ] = ossde->filtered[FS_OSSDE_CQ] = cq;
    ossde->level[FS_OSSDE_IQ] = ossde->filtered[FS_OSSDE_IQ] = iq;
    ossde->checked = now + FIRST_DIAGNOSIS;
    fs_ossde_run(ossde, now);
}

void fs_ossde_drive(struct fs_ossde *ossde, uint8_t line, uint8_t level, uint64_t now)
{
    if (ossde->state == FS_OSSDE_INACTIVE || ossde->level[line] == level)
        return;
    ossde->level[line] = level;
    ossde->settled[line] = level == ossde->filtered[line] ? FS_NEVER : now + FILTER;
}

static void filter(struct fs_ossde *ossde, uint8_t line, uint64_t now)
{
    if (ossde->settled[line] > now)
        return;
    ossde->filtered[line] = ossde->level[line];
    ossde->settled[line] = FS_NEVER;
}

/* Port diagnosis: antivalent lines are a fault once the discrepancy time is over, and until they are equal again. */
static void diagnose(struct fs_ossde *ossde, uint64_t now)
{
    if (ossde->filtered[FS_OSSDE_CQ] == ossde->filtered[FS_OSSDE_IQ]) {
        ossde->tolerated = FS_NEVER;
        ossde->faulty = 0;
    } else if (ossde->faulty) {
        return;
    } else if (ossde->tolerated == FS_NEVER) {
        ossde->tolerated = now + DISCREPANCY;
    } else if (ossde->tolerated <= now) {
        ossde->tolerated = FS_NEVER;
        ossde->faulty = 1;
    }
}

static void handle_qualifier(struct fs_ossde *ossde, uint64_t now)
{
    switch (ossde->state) {
    case FS_OSSDE_CHECK:
        if (ossde->checked > now)
            break;
        ossde->checked = FS_NEVER;
        if (ossde->tolerated == FS_NEVER) /* else a running discrepancy has to end first */
            ossde->state = ossde->faulty ? FS_OSSDE_BAD : FS_OSSDE_GOOD; /* T2, T1 */
        else
            ossde->checked = ossde->tolerated;
        break;
    case FS_OSSDE_GOOD:
    case FS_OSSDE_AWAIT_ACKQ:
        if (ossde->faulty)
            ossde->state = FS_OSSDE_BAD; /* T3, T6 */
        break;
    case FS_OSSDE_BAD:
        if (!ossde->faulty)
            ossde->state = FS_OSSDE_AWAIT_ACKQ; /* T4 */
        break;
    case FS_OSSDE_INACTIVE:
        break;
    }
}

void fs_ossde_run(struct fs_ossde *ossde, uint64_t now)
{
    if (ossde->state == FS_OSSDE_INACTIVE)
        return;
    filter(ossde, FS_OSSDE_CQ, now);
    filter(ossde, FS_OSSDE_IQ, now);
    diagnose(ossde, now);
    handle_qualifier(ossde, now);
}

void fs_ossde_acknowledge(struct fs_ossde *ossde)
{
    if (ossde->state == FS_OSSDE_AWAIT_ACKQ)
        ossde->state = FS_OSSDE_GOOD; /* T5 */
}

static uint64_t earlier(uint64_t one, uint64_t other)
{
    return one < other ? one : other;
}

uint64_t fs_ossde_due(const struct fs_ossde *ossde)
{
    return earlier(earlier(ossde->settled[FS_OSSDE_CQ], ossde->settled[FS_OSSDE_IQ]),
                   earlier(ossde->tolerated, ossde->checked));
}

uint8_t fs_ossde_lines(const struct fs_ossde *ossde)
{
    return (uint8_t)(ossde->filtered[FS_OSSDE_CQ] | ossde->filtered[FS_OSSDE_IQ] << 1);
}

uint8_t fs_ossde_PDin(const struct fs_ossde *ossde)
{
    return ossde->state == FS_OSSDE_GOOD && fs_ossde_lines(ossde) == ON ? ON : 0;
}
