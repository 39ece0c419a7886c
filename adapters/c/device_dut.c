/* The example FS-Device as a DUT: what fsct asks for on one side, fs_device.h on the other. This is the file to look at
 * for an adapter of your own.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#include "fs_device.h"
#include "fsct_dut.h"

/* Event appears or disappears, error, of the Device, of its application: EventQualifier of the base standard. */
enum { APPEARS = 0xF4, DISAPPEARS = 0xB4 };

#define LATEST (UINT64_MAX / 2) /* the clock goes no further */

/* The application as fsct has been told of it. */
struct outputs {
    uint8_t PDout_D[FS_MAX_FS_PD];
    uint8_t setSD_DC, ChFAckReq_DC;
};

struct device_dut {
    struct fs_device device;
    struct outputs told;
    uint64_t now;
};

static const struct fsct_offer offers[] = {
    {FSCT_V1_1, FSCT_CRC16, 0, 3, 0, 3},
    {FSCT_V1_1, FSCT_CRC32, 0, 25, 0, 25},
    {FSCT_IEC2022, FSCT_CRC16, 0, 3, 0, 3},
    {FSCT_IEC2022, FSCT_CRC32, 0, 25, 0, 25},
};

static const struct fsct_description description = {
    FSCT_DEVICE,
    1,
    FSCT_PCO_POWER | FSCT_PCO_LINK | FSCT_PCO_ACYCLIC | FSCT_PCO_APP | FSCT_PCO_CLOCK,
    FSCT_VIRTUAL,
    1, /* ns */
    0,
    "fsct",
    "example FS-Device in C",
    "1.0",
    offers,
    sizeof offers / sizeof offers[0],
};

static const struct fsct_description *hello(void *self)
{
    (void)self;
    return &description;
}

static int powered(const struct device_dut *dut)
{
    return dut->device.state != FS_DEVICE_OFF;
}

/* Outputs of the application: all of them at power-on, later those that have changed. */

static void tell_outputs(struct device_dut *dut, struct fsct_sink *sink, int all)
{
    const struct fs_device_scl *scl = &dut->device.scl;
    struct outputs *told = &dut->told;
    size_t length = dut->device.type.pd_out;
    if (all || memcmp(told->PDout_D, scl->PDout_D, length) != 0)
        fsct_service(sink, 1, FSCT_PDout_D, scl->PDout_D, length);
    if (all || told->setSD_DC != scl->setSD_DC)
        fsct_service_bit(sink, 1, FSCT_setSD_DC, scl->setSD_DC);
    if (all || told->ChFAckReq_DC != scl->ChFAckReq_DC)
        fsct_service_bit(sink, 1, FSCT_ChFAckReq_DC, scl->ChFAckReq_DC);
    if (all)
        fsct_service_bit(sink, 1, FSCT_SCL_Fault, 0); /* the software of this SCL knows no faults of its own */
    memcpy(told->PDout_D, scl->PDout_D, sizeof told->PDout_D);
    told->setSD_DC = scl->setSD_DC, told->ChFAckReq_DC = scl->ChFAckReq_DC;
}

static void tell_events(struct fsct_sink *sink, struct fs_device_events events)
{
    for (unsigned n = 0; n < 16; n++) {
        if (events.disappeared >> n & 1)
            fsct_event(sink, (uint16_t)(0xB000 + n), DISAPPEARS);
        if (events.appeared >> n & 1)
            fsct_event(sink, (uint16_t)(0xB000 + n), APPEARS);
    }
}

static void configure(struct device_dut *dut, const struct fsct_offer *variant, struct fsct_sink *sink)
{
    struct fs_device_type type;
    uint8_t most = variant->mode == FSCT_CRC16 ? 3 : 25;
    if (powered(dut) || variant->edition < FSCT_V1_1 || variant->edition > FSCT_IEC2022 || variant->mode < FSCT_CRC16
        || variant->mode > FSCT_CRC32 || variant->pd_out_max > most || variant->pd_in_max > most) {
        fsct_unsupported(sink);
        return;
    }
    type.edition = variant->edition, type.mode = variant->mode; /* the numbers are the same */
    type.pd_out = variant->pd_out_max, type.pd_in = variant->pd_in_max;
    fs_device_build(&dut->device, &type);
}

static void power(struct device_dut *dut, uint8_t on, struct fsct_sink *sink)
{
    if (on > 1) {
        fsct_unsupported(sink);
    } else if (!on) {
        fs_device_power_off(&dut->device);
    } else if (!powered(dut)) {
        fs_device_power_on(&dut->device);
        tell_outputs(dut, sink, 1);
    }
}

static void exchange(struct device_dut *dut, const struct fsct_stimulus *stimulus, struct fsct_sink *sink)
{
    struct fs_device *device = &dut->device;
    const uint8_t *received = stimulus->flag ? stimulus->octets : NULL;
    if (stimulus->port != 1 || stimulus->flag > 1
        || (received != NULL && powered(dut) && stimulus->length != fs_device_scl_spdu_out(&device->scl.setup))) {
        fsct_unsupported(sink);
        fsct_image(sink, stimulus->port, NULL, 0);
        return;
    }
    if (!powered(dut)) {
        fsct_image(sink, 1, NULL, 0);
        return;
    }
    tell_events(sink, fs_device_exchange(device, received, dut->now));
    tell_outputs(dut, sink, 0);
    fsct_image(sink, 1, device->scl.answer, fs_device_scl_spdu_in(&device->scl.setup));
}

static void read(struct device_dut *dut, const struct fsct_stimulus *stimulus, struct fsct_sink *sink)
{
    uint8_t value[32];
    size_t length;
    enum fs_error_type error;
    if (!powered(dut)) {
        fsct_unsupported(sink);
        return;
    }
    error = fs_device_read(&dut->device, stimulus->index, stimulus->subindex, value, &length);
    if (error == FS_NO_ERROR)
        fsct_value(sink, value, length);
    else
        fsct_refused(sink, (uint16_t)error);
}

static void write(struct device_dut *dut, const struct fsct_stimulus *stimulus, struct fsct_sink *sink)
{
    struct fs_device_events events;
    enum fs_error_type error;
    if (!powered(dut)) {
        fsct_unsupported(sink);
        return;
    }
    error = fs_device_write(&dut->device, stimulus->index, stimulus->subindex, stimulus->octets, stimulus->length, &events);
    if (error == FS_NO_ERROR)
        fsct_written(sink);
    else
        fsct_refused(sink, (uint16_t)error);
    tell_events(sink, events);
    tell_outputs(dut, sink, 0);
}

/* The technology has its supply from the FS-Device: without it there are no inputs, and at power-on they are 0. */
static void set(struct device_dut *dut, const struct fsct_stimulus *stimulus, struct fsct_sink *sink)
{
    struct fs_device_scl *scl = &dut->device.scl;
    size_t length = stimulus->length;
    if (!powered(dut) || stimulus->port != 1)
        fsct_unsupported(sink);
    else if (stimulus->number == FSCT_PDin_D && length == dut->device.type.pd_in)
        memcpy(scl->PDin_D, stimulus->octets, length);
    else if (stimulus->number == FSCT_SDset_DS && length == 1 && stimulus->octets[0] <= 1)
        scl->SDset_DS = stimulus->octets[0];
    else
        fsct_unsupported(sink);
}

/* What falls due on the way is told at the time it happens. */
static void advance(struct device_dut *dut, uint64_t ns, struct fsct_sink *sink)
{
    uint64_t end;
    if (ns > LATEST - dut->now) {
        fsct_unsupported(sink);
        return;
    }
    end = dut->now + ns;
    while (fs_device_run(&dut->device, end, &sink->now))
        tell_outputs(dut, sink, 0);
    dut->now = end;
}

static void apply(void *self, const struct fsct_stimulus *stimulus, struct fsct_sink *sink)
{
    struct device_dut *dut = (struct device_dut *)self;
    sink->now = dut->now;
    switch (stimulus->kind) {
    case FSCT_CONFIGURE: configure(dut, &stimulus->variant, sink); break;
    case FSCT_POWER: power(dut, stimulus->flag, sink); break;
    case FSCT_EXCHANGE: exchange(dut, stimulus, sink); break;
    case FSCT_READ: read(dut, stimulus, sink); break;
    case FSCT_WRITE: write(dut, stimulus, sink); break;
    case FSCT_SET: set(dut, stimulus, sink); break;
    case FSCT_ADVANCE: advance(dut, stimulus->ns, sink); break;
    default: fsct_unsupported(sink); break;
    }
}

const struct fsct_dut *fsct_dut(void)
{
    static struct device_dut self;
    static const struct fsct_dut dut = {FSCT_ABI, &self, hello, apply};
    static int built;
    if (!built) {
        static const struct fs_device_type type = {FS_IEC2022, FS_MODE_CRC16, 2, 2};
        fs_device_build(&self.device, &type);
        built = 1;
    }
    return &dut;
}
