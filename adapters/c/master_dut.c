/* The FS-Master stack as a DUT of fsct: hands each stimulus to the stack and tells what the stack does. Everything that
 * is peculiar to being tested is here, nothing of the standard.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#include "fs_master.h"
#include "fsct_dut.h"

static const struct fsct_offer offers[] = {
    {FSCT_V1_1, FSCT_CRC16, 0, 3, 0, 3},
    {FSCT_V1_1, FSCT_CRC32, 0, 25, 0, 25},
    {FSCT_IEC2022, FSCT_CRC16, 0, 3, 0, 3},
    {FSCT_IEC2022, FSCT_CRC32, 0, 25, 0, 25},
};
#define OFFERS (sizeof offers / sizeof offers[0])

static const struct fsct_description description = {
    FSCT_MASTER, FS_PORTS,
    FSCT_PCO_POWER | FSCT_PCO_LINK | FSCT_PCO_ACYCLIC | FSCT_PCO_APP | FSCT_PCO_LINE | FSCT_PCO_CLOCK,
    FSCT_VIRTUAL, 1, 0,
    "fsct", "example FS-Master in C", "0.1.0",
    offers, OFFERS,
};

struct dut {
    struct fs_master master;
    struct fs_setup setup;
    struct fsct_sink *sink; /* of the stimulus being carried out */
    uint64_t now;
    int powered;
    /* What is connected stays so while the power is off. */
    int plugged[FS_PORTS];
    struct fs_device devices[FS_PORTS];
};

static struct dut dut = {.setup = {FS_V1_1, 2, 2}};

/* What the stack does by itself. */

static struct fsct_sink *sink_of(void *self)
{
    struct dut *of = self;
    of->sink->now = of->master.now;
    return of->sink;
}

static void on_supply(void *self, uint8_t port, int on)
{
    fsct_line(sink_of(self), port, FSCT_LPLUS, on);
}

static void on_wake_up(void *self, uint8_t port)
{
    fsct_line(sink_of(self), port, FSCT_WAKE_UP, 1);
}

static void on_mode(void *self, uint8_t port, uint8_t mode)
{
    fsct_mode(sink_of(self), port, mode);
}

static void on_request(void *self, uint8_t port, const struct fs_request *request)
{
    fsct_request(sink_of(self), port, request->index, request->subindex, request->write ? request->octets : NULL,
                 request->length);
}

static void on_event(void *self, uint8_t port, uint8_t source, uint8_t qualifier, uint16_t code)
{
    fsct_indication(sink_of(self), port, source, qualifier, code);
}

static void on_output(void *self, uint8_t port, uint8_t output, const uint8_t *octets, size_t length)
{
    static const uint8_t services[] = {
        [FS_PDin_M] = FSCT_PDin_M,         [FS_SDset_S] = FSCT_SDset_S,     [FS_ChFAckReq_S] = FSCT_ChFAckReq_S,
        [FS_FAULTS_S] = FSCT_FAULTS_S,     [FS_qualifier] = FSCT_qualifier,
    };
    fsct_service(sink_of(self), port, services[output], octets, length);
}

static const struct fs_environment environment = {
    &dut, on_supply, on_wake_up, on_mode, on_request, on_event, on_output,
};

/* Stimuli. Each returns 0 when it is not served. */

static int is_offered(const struct fsct_offer *variant)
{
    for (size_t i = 0; i < OFFERS; i++)
        if (variant->edition == offers[i].edition && variant->mode == offers[i].mode &&
            variant->pd_out_max <= offers[i].pd_out_max && variant->pd_in_max <= offers[i].pd_in_max)
            return 1;
    return 0;
}

static int configure(const struct fsct_stimulus *stimulus)
{
    const struct fsct_offer *variant = &stimulus->variant;
    if (dut.powered || !is_offered(variant))
        return 0;
    dut.setup.edition = variant->edition == FSCT_V1_1 ? FS_V1_1 : FS_IEC2022;
    dut.setup.pd_in = variant->pd_in_max;
    dut.setup.pd_out = variant->pd_out_max;
    return 1;
}

static int power(const struct fsct_stimulus *stimulus)
{
    if (stimulus->flag && !dut.powered) {
        fs_master_init(&dut.master, &dut.setup, &environment, dut.now);
        for (uint8_t port = 1; port <= FS_PORTS; port++)
            if (dut.plugged[port - 1])
                fs_master_plug(&dut.master, port, &dut.devices[port - 1]);
    }
    dut.powered = stimulus->flag;
    return 1;
}

/* Each FSP_Watchdog in it is carried out, so there is an end to what is worth while. */
#define ADVANCE_MAX (UINT64_C(24) * 3600 * 1000 * FS_MS)

static int advance(const struct fsct_stimulus *stimulus)
{
    if (stimulus->ns > ADVANCE_MAX || dut.now > FS_NEVER / 2)
        return 0;
    dut.now += stimulus->ns;
    if (dut.powered)
        fs_master_run(&dut.master, dut.now);
    return 1;
}

/* An exchange always has its image, and it comes last. */
static int exchange(const struct fsct_stimulus *stimulus, struct fsct_sink *sink)
{
    const uint8_t *in = stimulus->flag ? stimulus->octets : NULL;
    uint8_t out[FS_PORT_PD_MAX];
    int there = stimulus->port >= 1 && stimulus->port <= FS_PORTS, length = -1;
    if (there && dut.powered)
        length = fs_master_cycle(&dut.master, stimulus->port, in, stimulus->length, out);
    if (!there)
        fsct_unsupported(sink);
    sink->now = dut.now;
    fsct_image(sink, stimulus->port, length >= 0 ? out : NULL, length >= 0 ? (size_t)length : 0);
    return 1;
}

static uint32_t u32(const uint8_t *at)
{
    return (uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | at[3];
}

static int set(const struct fsct_stimulus *stimulus)
{
    const uint8_t *value = stimulus->octets;
    int flag = stimulus->number == FSCT_setSD_C || stimulus->number == FSCT_ChFAck_C;
    if (!dut.powered)
        return 0;
    if (stimulus->number == FSCT_FSCP_Authenticity) {
        if (stimulus->port != 0 || stimulus->length != 8)
            return 0;
        fs_master_authenticity(&dut.master, u32(value), u32(value + 4));
        return 1;
    }
    if (stimulus->port < 1 || stimulus->port > FS_PORTS)
        return 0;
    if (stimulus->number == FSCT_PDout_M)
        return fs_master_PDout(&dut.master, stimulus->port, value, stimulus->length);
    if (!flag || stimulus->length != 1 || value[0] > 1)
        return 0;
    fs_master_input(&dut.master, stimulus->port, stimulus->number == FSCT_setSD_C ? FS_setSD_C : FS_ChFAck_C,
                    value[0]);
    return 1;
}

/* A Device has process data and a transmission rate that there are. */
static int plug(const struct fsct_stimulus *stimulus)
{
    const struct fsct_identity *identity = &stimulus->identity;
    struct fs_device *device = &dut.devices[stimulus->port - 1];
    if (stimulus->flag && (identity->pd_in > FS_PORT_PD_MAX || identity->pd_out > FS_PORT_PD_MAX || identity->com < 1 ||
                           identity->com > 3))
        return 0;
    dut.plugged[stimulus->port - 1] = stimulus->flag;
    device->revision_id = identity->revision_id;
    device->com = identity->com;
    device->min_cycle_time = identity->min_cycle_time;
    device->pd_in = identity->pd_in;
    device->pd_out = identity->pd_out;
    device->vendor_id = identity->vendor_id;
    device->device_id = identity->device_id;
    fs_master_plug(&dut.master, stimulus->port, stimulus->flag ? device : NULL);
    return 1;
}

static int respond(const struct fsct_stimulus *stimulus)
{
    if (stimulus->number < FSCT_RESPONSE_VALUE || stimulus->number > FSCT_RESPONSE_REFUSED)
        return 0;
    fs_master_answer(&dut.master, stimulus->port, stimulus->number == FSCT_RESPONSE_WRITTEN);
    return 1;
}

static int raise_event(const struct fsct_stimulus *stimulus)
{
    fs_master_event(&dut.master, stimulus->port, stimulus->number, stimulus->code);
    return 1;
}

static int drive(const struct fsct_stimulus *stimulus)
{
    uint8_t line = stimulus->number == FSCT_CQ ? FS_OSSDE_CQ : FS_OSSDE_IQ;
    if (stimulus->number != FSCT_CQ && stimulus->number != FSCT_IQ)
        return 0;
    fs_master_line(&dut.master, stimulus->port, line, stimulus->flag);
    return 1;
}

/* The result of a read would be known only after the Device has answered, which this contract cannot wait for. */
static int smi(const struct fsct_stimulus *stimulus, struct fsct_sink *sink)
{
    struct fs_smi_request request;
    struct fs_smi_result result;
    if (stimulus->number < FSCT_SMI_MasterIdentification || stimulus->number > FSCT_SMI_PDOutIQ ||
        stimulus->number == FSCT_SMI_DeviceRead)
        return 0;
    request.service = stimulus->number; /* both number them as Table 15 lists them */
    request.port = stimulus->port;
    request.exp_block_id = stimulus->block_id;
    request.block = stimulus->octets;
    request.length = stimulus->length;
    fs_master_smi(&dut.master, &request, &result);
    sink->now = dut.now;
    fsct_result(sink, stimulus->port, result.positive, stimulus->client_id, result.ref_block_id, result.block_length,
                result.block, result.length);
    return 1;
}

/* Stimuli 8 to 12 want power, and all but smi a port. */
static int at_port(const struct fsct_stimulus *stimulus, struct fsct_sink *sink)
{
    if (!dut.powered)
        return 0;
    if (stimulus->kind == FSCT_SMI)
        return smi(stimulus, sink);
    if (stimulus->port < 1 || stimulus->port > FS_PORTS)
        return 0;
    switch (stimulus->kind) {
    case FSCT_PLUG:
        return plug(stimulus);
    case FSCT_RESPOND:
        return respond(stimulus);
    case FSCT_RAISE:
        return raise_event(stimulus);
    default:
        return drive(stimulus);
    }
}

static int carry_out(const struct fsct_stimulus *stimulus, struct fsct_sink *sink)
{
    switch (stimulus->kind) {
    case FSCT_CONFIGURE:
        return configure(stimulus);
    case FSCT_POWER:
        return power(stimulus);
    case FSCT_EXCHANGE:
        return exchange(stimulus, sink);
    case FSCT_SET:
        return set(stimulus);
    case FSCT_ADVANCE:
        return advance(stimulus);
    case FSCT_PLUG:
    case FSCT_RESPOND:
    case FSCT_RAISE:
    case FSCT_DRIVE:
    case FSCT_SMI:
        return at_port(stimulus, sink);
    default:
        return 0;
    }
}

static const struct fsct_description *hello(void *self)
{
    (void)self;
    return &description;
}

static void apply(void *self, const struct fsct_stimulus *stimulus, struct fsct_sink *sink)
{
    (void)self;
    dut.sink = sink;
    sink->now = dut.now;
    if (!carry_out(stimulus, sink)) {
        sink->now = dut.now;
        fsct_unsupported(sink);
    }
}

const struct fsct_dut *fsct_dut(void)
{
    static const struct fsct_dut served = {FSCT_ABI, NULL, hello, apply};
    return &served;
}
