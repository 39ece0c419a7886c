/* See fsct_client.h. Frames in, stimuli to the DUT, its observations out; the layouts are those of PROTOCOL.md.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#include "fsct_client.h"

#if FSCT_CLIENT_PAYLOAD < 512 || FSCT_CLIENT_PAYLOAD > 65535
#error "FSCT_CLIENT_PAYLOAD is 512 to 65535"
#endif

enum message { HELLO = 0x01, APPLY = 0x02, DESCRIPTION = 0x81, OBSERVED = 0x82, ERROR = 0xFF };
enum { SYNC_1 = 0xF5, SYNC_2 = 0xC7, HEADER = 6, CRC = 4, VERSION = 1, MORE = 1, LIMITS = 6, STAMP = 10, TLV = 3 };

/* Numbers, most significant octet first. */

static uint64_t get(const uint8_t *octets, size_t length)
{
    uint64_t number = 0;
    while (length--)
        number = number << 8 | *octets++;
    return number;
}

static uint8_t *put(uint8_t *to, uint64_t number, size_t length)
{
    for (size_t i = length; i-- > 0; number >>= 8)
        to[i] = (uint8_t)number;
    return to + length;
}

static uint32_t crc32(const uint8_t *octets, size_t length)
{
    uint32_t crc = 0xFFFFFFFFu;
    while (length--) {
        crc ^= *octets++;
        for (int bit = 0; bit < 8; bit++)
            crc = crc >> 1 ^ (crc & 1u ? 0xEDB88320u : 0u);
    }
    return ~crc & 0xFFFFFFFFu;
}

/* Answers. The payload grows in `out` behind the room for the header; `filled` octets of it are there. */

static void send(struct fsct_client *client, uint8_t type)
{
    uint8_t *out = client->out;
    size_t length = client->filled;
    out[0] = SYNC_1, out[1] = SYNC_2, out[2] = type, out[3] = client->sequence;
    put(out + 4, length, 2);
    put(out + HEADER + length, crc32(out + 2, HEADER - 2 + length), CRC);
    client->write(client->to, out, HEADER + length + CRC);
    client->filled = 0;
}

static void add(struct fsct_client *client, const void *octets, size_t length)
{
    if (length > 0)
        memcpy(client->out + HEADER + client->filled, octets, length);
    client->filled += length;
}

static void add_number(struct fsct_client *client, uint64_t number, size_t length)
{
    put(client->out + HEADER + client->filled, number, length);
    client->filled += length;
}

static void error(struct fsct_client *client, const char *text)
{
    client->filled = 0;
    add(client, text, strlen(text));
    send(client, ERROR);
}

static void unknown_message(struct fsct_client *client, uint8_t type)
{
    static const char digit[] = "0123456789ABCDEF";
    char text[] = "unknown message ..";
    text[sizeof text - 3] = digit[type >> 4];
    text[sizeof text - 2] = digit[type & 15];
    error(client, text);
}

/* DESCRIPTION. What finds no room is left out, but no required tag and not the limits: `keep` octets stay free for them. */

static void add_tag(struct fsct_client *client, uint8_t tag, const void *value, size_t length, size_t keep)
{
    if (client->filled + TLV + length + keep > FSCT_CLIENT_PAYLOAD)
        return;
    add_number(client, tag, 1);
    add_number(client, length, 2);
    add(client, value, length);
}

static void add_text(struct fsct_client *client, uint8_t tag, const char *text)
{
    size_t length = text != NULL ? strlen(text) : 0;
    if (length <= 255)
        add_tag(client, tag, text, length, LIMITS);
}

static void describe(struct fsct_client *client)
{
    const struct fsct_description *is = client->dut->hello(client->dut->self);
    uint8_t value[17];
    add_tag(client, 1, &is->role, 1, 0);
    add_tag(client, 2, &is->ports, 1, 0);
    add_tag(client, 3, &is->pcos, 1, 0);
    for (size_t i = 0; i < is->offer_count; i++) {
        const struct fsct_offer *offer = &is->offers[i];
        value[0] = offer->edition, value[1] = offer->mode;
        value[2] = offer->pd_out_min, value[3] = offer->pd_out_max;
        value[4] = offer->pd_in_min, value[5] = offer->pd_in_max;
        add_tag(client, 4, value, 6, sizeof value + TLV + LIMITS);
    }
    value[0] = is->clock;
    put(put(value + 1, is->resolution_ns, 8), is->uncertainty_ns, 8);
    add_tag(client, 5, value, sizeof value, LIMITS);
    add_text(client, 6, is->vendor);
    add_text(client, 7, is->product);
    add_text(client, 8, is->version);
    put(put(value, FSCT_CLIENT_PAYLOAD, 2), 1, 1); /* one request at a time: there is one buffer */
    add_tag(client, 9, value, LIMITS - TLV, 0);
}

static void hello(struct fsct_client *client, const uint8_t *payload, size_t length)
{
    if (length < 2) {
        error(client, "HELLO without two versions");
        return;
    }
    client->greeted = payload[0] <= VERSION && VERSION <= payload[1];
    add_number(client, VERSION, 1);
    if (client->greeted)
        describe(client);
    send(client, DESCRIPTION);
}

/* OBSERVED. */

/* The fields of an observation in front of its octets, at most 10. */
static size_t observation_fields(const struct fsct_observation *seen, uint8_t *to)
{
    uint8_t *at = to;
    switch (seen->kind) {
    case FSCT_IMAGE: at = put(put(at, seen->port, 1), seen->flag, 1); break;
    case FSCT_SERVICE: at = put(put(at, seen->port, 1), seen->number, 1); break;
    case FSCT_REFUSED: at = put(at, seen->code, 2); break;
    case FSCT_EVENT: at = put(put(at, seen->code, 2), seen->number, 1); break;
    case FSCT_MODE: at = put(put(at, seen->port, 1), seen->number, 1); break;
    case FSCT_REQUEST:
        at = put(put(put(put(at, seen->port, 1), seen->flag, 1), seen->index, 2), seen->subindex, 1);
        break;
    case FSCT_LINE: at = put(put(put(at, seen->port, 1), seen->number, 1), seen->flag, 1); break;
    case FSCT_RESULT:
        at = put(put(put(at, seen->port, 1), seen->flag, 1), seen->client_id, 2);
        at = put(put(at, seen->block_id, 2), seen->block_length, 2);
        break;
    case FSCT_INDICATION:
        at = put(put(put(put(at, seen->port, 1), seen->flag, 1), seen->number, 1), seen->code, 2);
        break;
    default: break;
    }
    return (size_t)(at - to);
}

/* `filled` is 0 here only when an observation has been too long and an error has gone out in place of the answer. */
static void see(struct fsct_sink *sink, const struct fsct_observation *seen)
{
    struct fsct_client *client = (struct fsct_client *)sink;
    uint8_t fields[10];
    size_t length = observation_fields(seen, fields);
    size_t size = STAMP + TLV + length + seen->length;
    if (client->filled == 0)
        return;
    if (1 + size > FSCT_CLIENT_PAYLOAD) {
        error(client, "an observation is longer than a frame");
        return;
    }
    if (client->filled + size > FSCT_CLIENT_PAYLOAD) {
        client->out[HEADER] = MORE;
        send(client, OBSERVED);
        add_number(client, 0, 1);
    }
    add_number(client, client->position, 2);
    add_number(client, seen->ns, 8);
    add_number(client, seen->kind, 1);
    add_number(client, length + seen->length, 2);
    add(client, fields, length);
    add(client, seen->octets, seen->length);
}

/* APPLY. */

/* Octets of a value in front of those that vary in number, by kind; and whether there are such. */
static const uint8_t fixed[] = {0, 4, 1, 2, 3, 3, 2, 8, 1, 2, 4, 3, 6};
static const uint8_t varies[] = {1, 0, 0, 1, 0, 1, 1, 0, 0, 1, 0, 0, 1};

static int decode_plug(struct fsct_stimulus *to, const uint8_t *identity, size_t length)
{
    to->flag = length > 0;
    if (length == 0)
        return 1;
    if (length < 10)
        return 0;
    to->identity.revision_id = identity[0], to->identity.com = identity[1], to->identity.min_cycle_time = identity[2];
    to->identity.pd_in = identity[3], to->identity.pd_out = identity[4];
    to->identity.vendor_id = (uint16_t)get(identity + 5, 2);
    to->identity.device_id = (uint32_t)get(identity + 7, 3);
    return 1;
}

/* One TLV as a stimulus. 0 when its value is too short for its kind, or holds more octets than the contract allows, so
 * that a DUT can rely on FSCT_MAX_PD and FSCT_MAX_RECORD. Whether the numbers in it make sense, the DUT knows. */
static int decode(struct fsct_stimulus *to, const uint8_t *tlv)
{
    const uint8_t *value = tlv + TLV;
    size_t length = (size_t)get(tlv + 1, 2), head;
    memset(to, 0, sizeof *to);
    to->kind = tlv[0];
    head = to->kind < sizeof fixed ? fixed[to->kind] : 0;
    if (length < head)
        return 0;
    if (to->kind >= sizeof varies || varies[to->kind])
        to->octets = value + head, to->length = (uint16_t)(length - head);
    switch (to->kind) {
    case FSCT_CONFIGURE:
        to->variant.edition = value[0], to->variant.mode = value[1];
        to->variant.pd_out_min = to->variant.pd_out_max = value[2];
        to->variant.pd_in_min = to->variant.pd_in_max = value[3];
        return 1;
    case FSCT_POWER: to->flag = value[0]; return 1;
    case FSCT_EXCHANGE: to->port = value[0], to->flag = value[1]; return to->length <= FSCT_MAX_PD;
    case FSCT_READ:
    case FSCT_WRITE: to->index = (uint16_t)get(value, 2), to->subindex = value[2]; return to->length <= FSCT_MAX_RECORD;
    case FSCT_SET: to->port = value[0], to->number = value[1]; return to->length <= FSCT_MAX_PD;
    case FSCT_ADVANCE: to->ns = get(value, 8); return 1;
    case FSCT_PLUG: to->port = value[0]; return decode_plug(to, value + 1, length - 1);
    case FSCT_RESPOND:
        to->port = value[0], to->number = value[1];
        if (to->number != FSCT_RESPONSE_REFUSED)
            return to->length <= FSCT_MAX_RECORD;
        if (to->length >= 2)
            to->code = (uint16_t)get(to->octets, 2);
        return to->length >= 2;
    case FSCT_RAISE: to->port = value[0], to->code = (uint16_t)get(value + 1, 2), to->number = value[3]; return 1;
    case FSCT_DRIVE: to->port = value[0], to->number = value[1], to->flag = value[2]; return 1;
    case FSCT_SMI:
        to->number = value[0], to->port = value[1];
        to->client_id = (uint16_t)get(value + 2, 2), to->block_id = (uint16_t)get(value + 4, 2);
        return 1;
    default: return 1;
    }
}

/* What is wrong with the `count` stimuli, or null. They are looked at before any is carried out. */
static const char *apply_error(const uint8_t *tlv, const uint8_t *end, size_t count)
{
    for (; count > 0; count--) {
        if (end - tlv < TLV || (size_t)(end - tlv) < TLV + get(tlv + 1, 2))
            return "stimuli do not end where the payload ends";
        tlv += TLV + get(tlv + 1, 2);
    }
    return tlv == end ? NULL : "more octets than stimuli";
}

static void apply(struct fsct_client *client, const uint8_t *payload, size_t length)
{
    const uint8_t *tlv = payload + 2;
    size_t count = length >= 2 ? (size_t)get(payload, 2) : 0;
    struct fsct_stimulus stimulus;
    const char *wrong = !client->greeted ? "stimuli before a hello"
                        : length < 2     ? "APPLY without a number of stimuli"
                                         : apply_error(tlv, payload + length, count);
    if (wrong != NULL) {
        error(client, wrong);
        return;
    }
    add_number(client, 0, 1);
    for (size_t i = 0; i < count && client->filled > 0; i++, tlv += TLV + get(tlv + 1, 2)) {
        client->position = (uint16_t)i;
        if (decode(&stimulus, tlv))
            client->dut->apply(client->dut->self, &stimulus, &client->sink);
        else
            fsct_unsupported(&client->sink);
    }
    if (client->filled > 0)
        send(client, OBSERVED);
}

/* Frames. */

static void answer(struct fsct_client *client, const uint8_t *frame)
{
    size_t length = (size_t)get(frame + 4, 2);
    client->sequence = frame[3];
    client->filled = 0;
    switch (frame[2]) {
    case HELLO: hello(client, frame + HEADER, length); break;
    case APPLY: apply(client, frame + HEADER, length); break;
    default: unknown_message(client, frame[2]); break;
    }
}

/* How many octets at `at` are done with: a frame that was answered, one that starts no frame, 0 to wait for more. */
static size_t next(struct fsct_client *client, const uint8_t *at, size_t have)
{
    size_t length;
    if (have > 0 && (at[0] != SYNC_1 || (have > 1 && at[1] != SYNC_2)))
        return 1;
    if (have < HEADER)
        return 0;
    length = (size_t)get(at + 4, 2);
    if (length > FSCT_CLIENT_PAYLOAD)
        return 1; /* beyond our limits, so nothing fsct has sent */
    if (have < HEADER + length + CRC)
        return 0;
    if (crc32(at + 2, HEADER - 2 + length) != get(at + HEADER + length, CRC))
        return 1;
    answer(client, at);
    return HEADER + length + CRC;
}

void fsct_client_init(struct fsct_client *client, const struct fsct_dut *dut,
                      void (*write)(void *to, const uint8_t *octets, size_t length), void *to)
{
    memset(client, 0, sizeof *client);
    client->sink.see = see;
    client->dut = dut, client->write = write, client->to = to;
}

void fsct_client_take(struct fsct_client *client, const uint8_t *octets, size_t length)
{
    while (length > 0) {
        size_t room = sizeof client->in - client->received; /* never 0: what fills `in` is a frame or is none */
        size_t taken = length < room ? length : room, done = 0, step;
        memcpy(client->in + client->received, octets, taken);
        client->received += taken, octets += taken, length -= taken;
        while ((step = next(client, client->in + done, client->received - done)) > 0)
            done += step;
        client->received -= done;
        memmove(client->in, client->in + done, client->received);
    }
}

void fsct_client_idle(struct fsct_client *client)
{
    client->received = 0;
}
