/* Checks the client against the dumps of PROTOCOL.md and against what a line can do to a frame. Prints what it has checked;
 * exit code 1 when something is wrong.
 *
 *     cc -std=c99 -o test_client test_client.c fsct_client.c && ./test_client
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fsct_client.h"

#if FSCT_CLIENT_PAYLOAD != 512
#error "the dumps are those of a client with 512 octets of payload"
#endif

/* The DUT of the worked examples, and made-up kinds that lead to many or long observations. */

enum { MANY = 201, LONG = 202 };

static struct fsct_stimulus last;
static int stimuli;
static uint64_t now;

static const struct fsct_description *hello(void *self)
{
    static const struct fsct_offer offer = {FSCT_IEC2022, FSCT_CRC16, 0, 3, 0, 3};
    static struct fsct_description is;
    (void)self;
    is.role = FSCT_DEVICE, is.ports = 1, is.pcos = 0x2F, is.clock = FSCT_VIRTUAL, is.resolution_ns = 1000;
    is.vendor = "Example", is.product = "demo", is.version = "1.0", is.offers = &offer, is.offer_count = 1;
    return &is;
}

static void apply(void *self, const struct fsct_stimulus *stimulus, struct fsct_sink *sink)
{
    static const uint8_t answer[] = {0x44, 0x55, 0x66, 0xFE, 0xC0, 0xB1, 0x4D};
    static const uint8_t long_block[600];
    (void)self;
    stimuli++, last = *stimulus, sink->now = now;
    switch (stimulus->kind) {
    case FSCT_ADVANCE: now += stimulus->ns, sink->now = now; break;
    case FSCT_EXCHANGE:
        fsct_service(sink, 1, FSCT_PDout_D, stimulus->octets, 3);
        fsct_image(sink, 1, answer, sizeof answer);
        break;
    case MANY:
        for (unsigned i = 0; i < stimulus->octets[0]; i++)
            fsct_service(sink, 1, FSCT_PDin_M, long_block, FSCT_MAX_PD);
        break;
    case LONG: fsct_result(sink, 1, 1, 2, 3, 4, long_block, (size_t)stimulus->octets[0] << 8 | stimulus->octets[1]); break;
    case 200: fsct_unsupported(sink); break;
    default: break;
    }
}

static const struct fsct_dut dut = {FSCT_ABI, NULL, hello, apply};

/* What the client sends. */

static uint8_t sent[65536];
static size_t sent_length;
static int sent_frames, failures;

static void keep(void *to, const uint8_t *octets, size_t length)
{
    (void)to;
    memcpy(sent + sent_length, octets, length);
    sent_length += length, sent_frames++;
}

static void check(const char *what, int met)
{
    printf("%-4s %s\n", met ? "ok" : "FAIL", what);
    failures += !met;
}

/* Hexadecimal text as octets. */
static size_t octets_of(const char *hex, uint8_t *to)
{
    static const char digits[] = "0123456789ABCDEF";
    size_t nibbles = 0;
    for (; *hex; hex++) {
        const char *digit = strchr(digits, *hex);
        if (digit == NULL)
            continue;
        to[nibbles / 2] = (uint8_t)(nibbles % 2 ? to[nibbles / 2] << 4 | (digit - digits) : digit - digits);
        nibbles++;
    }
    return nibbles / 2;
}

/* A frame with its CRC, which is computed here bit by bit from the other end: msb first over reflected octets. */
static unsigned long reflect(unsigned long value, int bits)
{
    unsigned long mirrored = 0;
    for (int i = 0; i < bits; i++)
        mirrored = mirrored << 1 | (value >> i & 1);
    return mirrored;
}

static size_t frame(uint8_t *to, uint8_t type, uint8_t sequence, const uint8_t *payload, size_t length)
{
    unsigned long crc = 0xFFFFFFFFul;
    to[0] = 0xF5, to[1] = 0xC7, to[2] = type, to[3] = sequence;
    to[4] = (uint8_t)(length >> 8), to[5] = (uint8_t)length;
    if (length > 0)
        memcpy(to + 6, payload, length);
    for (size_t i = 2; i < 6 + length; i++) {
        crc ^= reflect(to[i], 8) << 24;
        for (int bit = 0; bit < 8; bit++)
            crc = (crc << 1 ^ (crc & 0x80000000ul ? 0x04C11DB7ul : 0)) & 0xFFFFFFFFul;
    }
    crc = reflect(crc ^ 0xFFFFFFFFul, 32);
    for (int i = 0; i < 4; i++)
        to[6 + length + (size_t)i] = (uint8_t)(crc >> (24 - 8 * i));
    return length + 10;
}

static size_t frame_of(uint8_t *to, uint8_t type, uint8_t sequence, const char *hex)
{
    uint8_t payload[1024];
    return frame(to, type, sequence, payload, octets_of(hex, payload));
}

/* The client gets its octets from the heap, cut to their length, so that a read beyond them is found. */
static struct fsct_client client;

static void take(const uint8_t *octets, size_t length)
{
    uint8_t *exact = malloc(length > 0 ? length : 1);
    if (exact == NULL)
        exit(2);
    memcpy(exact, octets, length);
    fsct_client_take(&client, exact, length);
    free(exact);
}

static void forget(void)
{
    sent_length = 0, sent_frames = 0, stimuli = 0;
}

static void restart(void)
{
    fsct_client_init(&client, &dut, keep, NULL);
    forget();
    now = 0;
}

/* Answers to `hex` are exactly `answer`. */
static int answers(const char *hex, const char *answer)
{
    uint8_t octets[1024], expected[1024];
    size_t length = octets_of(answer, expected);
    forget();
    take(octets, octets_of(hex, octets));
    return sent_length == length && memcmp(sent, expected, length) == 0;
}

/* A request of this type and payload is answered by one frame of type `answer` with the same sequence. */
static int request(uint8_t type, const char *hex, uint8_t answer)
{
    static uint8_t sequence;
    uint8_t octets[1100];
    forget();
    take(octets, frame_of(octets, type, ++sequence, hex));
    return sent_frames == 1 && sent_length >= 10 && sent[2] == answer && sent[3] == sequence;
}

#define HELLO "F5 C7 01 00 00 02 01 01 17 06 A7 BF"
#define DESCRIPTION                                                                                                    \
    "F5 C7 81 00 00 47 01 01 00 01 01 02 00 01 01 03 00 01 2F 04 00 06 02 01 00 03 00 03"                              \
    "05 00 11 01 00 00 00 00 00 00 03 E8 00 00 00 00 00 00 00 00 06 00 07 45 78 61 6D 70 6C 65"                        \
    "07 00 04 64 65 6D 6F 08 00 03 31 2E 30 09 00 03 02 00 01 C9 DC 9D 09"
#define APPLY "F5 C7 02 01 00 19 00 02 07 00 08 00 00 00 00 00 0F 42 40 03 00 09 01 01 11 22 33 01 20 A5 91 FE B5 B0 90"
#define OBSERVED                                                                                                       \
    "F5 C7 82 01 00 29 00 00 01 00 00 00 00 00 0F 42 40 02 00 05 01 03 11 22 33"                                       \
    "00 01 00 00 00 00 00 0F 42 40 01 00 09 01 01 44 55 66 FE C0 B1 4D D5 E4 F0 02"
#define MADE_UP "F5 C7 02 02 00 08 00 01 C8 00 03 01 02 03 97 DE 22 A5"
#define UNSUPPORTED "F5 C7 82 02 00 0E 00 00 00 00 00 00 00 00 0F 42 40 07 00 00 B8 D5 3D B9"
#define UNKNOWN "F5 C7 FF 03 00 12 75 6E 6B 6E 6F 77 6E 20 6D 65 73 73 61 67 65 20 34 34 CE 06 5A B4"

static void worked_examples(void)
{
    uint8_t octets[16];
    restart();
    check("hello is answered by the description of PROTOCOL.md", answers(HELLO, DESCRIPTION));
    check("apply: two observations of the exchange", answers(APPLY, OBSERVED));
    check("a made-up stimulus reaches the DUT with its octets", answers(MADE_UP, UNSUPPORTED)
          && last.kind == 200 && last.length == 3 && last.octets != NULL);
    forget();
    take(octets, frame(octets, 0x44, 3, NULL, 0));
    sent_length = sent_frames == 1 ? sent_length : 0;
    check("an unknown message is an error with the text of PROTOCOL.md",
          sent_length == octets_of(UNKNOWN, sent + 1024) && memcmp(sent, sent + 1024, sent_length) == 0);
    check("a range without version 1: the own version and nothing else", request(0x01, "02 03", 0x81)
          && sent_length == 11 && sent[6] == 1);
    check("a longer hello is a hello", request(0x01, "00 FF 12 34 56", 0x81) && sent_length > 11);
}

static void cut_and_noise(void)
{
    uint8_t octets[1200], expected[128];
    size_t length = octets_of(HELLO, octets), description = octets_of(DESCRIPTION, expected);
    int met = 1;

    restart();
    for (size_t i = 0; i < length; i++) {
        met &= sent_frames == 0;
        take(octets + i, 1);
    }
    check("a frame cut octet by octet", met && sent_length == description && memcmp(sent, expected, description) == 0);

    restart();
    check("noise before a frame", answers("00 FF F5 F5 C6 42 6F 6F 74 C7 F5" HELLO, DESCRIPTION));
    restart();
    check("a false sync with a length no frame has", answers("F5 C7 55 55 FF FF" HELLO, DESCRIPTION));
    restart();
    check("a false sync right in front of a frame: 256 octets behind it are waited for",
          !answers("F5 F5 C7 F5 C7 F5 C7" HELLO, DESCRIPTION) && sent_frames == 0);
    memset(octets, 0, 256);
    take(octets, 256);
    check("and the frame is found when they have come", sent_length == description
          && memcmp(sent, expected, description) == 0);

    restart();
    check("a wrong CRC, then a right frame", answers("F5 C7 01 00 00 02 01 01 17 06 A7 BE" HELLO, DESCRIPTION));
    restart();
    check("a frame inside one with a wrong CRC", answers("F5 C7 02 00 00 0C" HELLO "00 00 00 00", DESCRIPTION));

    restart();
    memset(octets, 0xA5, sizeof octets);
    octets[0] = 0xF5, octets[1] = 0xC7, octets[2] = 2, octets[3] = 0, octets[4] = 2, octets[5] = 1;
    take(octets, 6 + 513 + 4);
    check("a frame of 513 octets of payload is no frame", sent_frames == 0);
    check("and the next one is found behind it", answers(HELLO, DESCRIPTION));

    restart();
    octets_of(HELLO, octets);
    take(octets, 9);
    fsct_client_idle(&client);
    check("an unfinished frame is forgotten when the line is idle", answers(HELLO, DESCRIPTION));
}

static void more(void)
{
    uint8_t position[] = {0, 1};
    size_t at = 0, observations = 0;
    int frames = 0, met;
    restart();
    answers(HELLO, DESCRIPTION);
    met = request(0x02, "00 02 C8 00 00 C9 00 01 20", 0x82);
    check("32 observations of 47 octets do not fit one frame", !met && sent_frames > 1);
    for (met = 1; at < sent_length; frames++) {
        size_t length = (size_t)sent[at + 4] << 8 | sent[at + 5], end = at + 6 + length;
        met &= sent[at + 2] == 0x82 && length > 1 && length <= FSCT_CLIENT_PAYLOAD;
        met &= sent[at + 6] == (end + 4 < sent_length); /* the more flag on all but the last */
        for (at += 7; at < end; observations++) {
            met &= observations == 0 || memcmp(sent + at, position, 2) == 0;
            at += 13u + ((size_t)sent[at + 11] << 8 | sent[at + 12]);
        }
        met &= at == end;
        at += 4;
    }
    check("all but the last frame say that more follow, no observation is cut", met && frames == sent_frames);
    check("none is lost", observations == 33);
    check("the longest result that fits", request(0x02, "00 01 CA 00 02 01 EA", 0x82) && sent_length == 512 + 10);
    check("one octet more is an error", request(0x02, "00 01 CA 00 02 01 EB", 0xFF));
    check("and nothing else follows it", request(0x02, "00 03 CA 00 02 02 58 C8 00 00 C8 00 00", 0xFF));
    check("the next request is answered as ever", request(0x02, "00 01 C8 00 00", 0x82));
    check("a request without observations", request(0x02, "00 00", 0x82) && sent_length == 11 && sent[6] == 0);
}

static void nonsense(void)
{
    static const char *const wrong[] = {
        "", "00", "00 01", "00 01 C8", "00 01 C8 00 01", "00 01 C8 00 01 00 00", "00 00 00", "00 02 C8 00 00",
        "00 02 C8 00 00 02 00",
    };
    static const char *const misshapen[] = {
        "00 01 01 00 03 01 01 02", "00 01 02 00 00", "00 01 03 00 01 01", "00 01 04 00 02 42 01", "00 01 05 00 02 42 01",
        "00 01 06 00 01 01", "00 01 07 00 07 00 00 00 00 00 00 00", "00 01 08 00 00", "00 01 08 00 03 01 11 03",
        "00 01 09 00 01 01", "00 01 09 00 03 01 03 80", "00 01 0A 00 03 01 B0 02", "00 01 0B 00 02 01 02",
        "00 01 0C 00 05 02 00 12 34 01",
    };
    uint8_t octets[600] = {0}, payload[512] = {0, 1, 3, 0, 35, 1, 1};
    int met = 1;
    restart();
    check("stimuli before a hello are an error", request(0x02, "00 01 C8 00 00", 0xFF) && stimuli == 0);
    check("so is a hello without two versions", request(0x01, "01", 0xFF));
    answers(HELLO, DESCRIPTION);
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        if (!request(0x02, wrong[i], 0xFF) || stimuli != 0) {
            printf("     not an error: %s\n", wrong[i]);
            met = 0;
        }
    }
    check("what does not end where it should is an error, and nothing of it is carried out", met);
    for (size_t i = 0; i < sizeof misshapen / sizeof misshapen[0]; i++) {
        if (!request(0x02, misshapen[i], 0x82) || stimuli != 0 || sent[17] != FSCT_UNSUPPORTED) {
            printf("     not unsupported: %s\n", misshapen[i]);
            met = 0;
        }
    }
    check("a value too short for its kind is unsupported, and does not reach the DUT", met);
    forget();
    take(octets, frame(octets, 0x02, 9, payload, 5 + 35));
    check("so are more process data than a DUT has to expect",
          sent_frames == 1 && sent[2] == 0x82 && sent[17] == FSCT_UNSUPPORTED && stimuli == 0);
}

static void stimuli_decoded(void)
{
    restart();
    answers(HELLO, DESCRIPTION);
    check("configure", request(0x02, "00 01 01 00 04 02 01 03 02", 0x82) && last.variant.edition == 2
          && last.variant.mode == 1 && last.variant.pd_out_min == 3 && last.variant.pd_out_max == 3
          && last.variant.pd_in_max == 2 && last.octets == NULL);
    check("power", request(0x02, "00 01 02 00 01 01", 0x82) && last.flag == 1);
    check("read", request(0x02, "00 01 04 00 03 42 01 04", 0x82) && last.index == 0x4201 && last.subindex == 4);
    check("write", request(0x02, "00 01 05 00 05 42 00 00 AA BB", 0x82) && last.index == 0x4200 && last.length == 2);
    check("set", request(0x02, "00 01 06 00 03 01 02 01", 0x82) && last.number == 2 && last.length == 1);
    check("plug", request(0x02, "00 01 08 00 0B 01 11 03 0A 07 06 12 34 56 78 9A", 0x82) && last.flag == 1
          && last.identity.com == 3 && last.identity.pd_out == 6 && last.identity.vendor_id == 0x1234
          && last.identity.device_id == 0x56789A);
    check("plug nothing", request(0x02, "00 01 08 00 01 01", 0x82) && last.flag == 0 && last.port == 1);
    check("respond refused", request(0x02, "00 01 09 00 04 01 03 80 30", 0x82) && last.number == 3 && last.code == 0x8030);
    check("raise", request(0x02, "00 01 0A 00 04 01 B0 02 F4", 0x82) && last.code == 0xB002 && last.number == 0xF4);
    check("drive", request(0x02, "00 01 0B 00 03 01 02 01", 0x82) && last.number == 2 && last.flag == 1);
    check("smi", request(0x02, "00 01 0C 00 08 02 00 12 34 01 01 01 00", 0x82) && last.number == 2
          && last.client_id == 0x1234 && last.block_id == 0x0101 && last.length == 2);
}

int main(void)
{
    worked_examples();
    cut_and_noise();
    more();
    nonsense();
    stimuli_decoded();
    printf(failures == 0 ? "all right\n" : "%d wrong\n", failures);
    return failures != 0;
}
