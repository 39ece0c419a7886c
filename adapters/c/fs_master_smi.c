/* SMI services (10.2, Table 15) of both editions: which ArgBlock each takes and gives, and what is refused in which
 * order.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#include <string.h>

#include "fs_master_internal.h"

/* ArgBlockIDs that are the same in both editions, and lengths. */
enum { VOID_BLOCK = 0xFFF0, JOB_ERROR = 0xFFFF, DEVICE_WRITE = 0x3000 };
enum { ID_LENGTH = 2, POWER_LENGTH = 5, ACCESS_LENGTH = 11, ACCESS_LENGTH_V1_1 = 5, WRITE_HEAD = 5 };

/* ErrorCodes of the JobError (base standard); 0 = Result(+). */
enum {
    OK = 0, ARGBLOCK_NOT_SUPPORTED = 0x4001, ARGBLOCK_INCONSISTENT = 0x4002, DEVICE_NOT_ACCESSIBLE = 0x4003,
    SERVICE_NOT_SUPPORTED = 0x4004, DEVICE_NOT_IN_OPERATE = 0x4005, PORT_NUM_INVALID = 0x4011,
    ARGBLOCK_LENGTH_INVALID = 0x4034, SERVICE_TEMP_UNAVAILABLE = 0x4036
};

/* MasterIdent (base standard) */
enum { MASTER_TYPE_FS = 3, PORT_TYPE_FS_OSSDE = 4 };
#define MASTER_VENDOR_ID 0xFFFFu /* of an example, nobody's */
#define MASTER_ID 1u

/* FSPDInOut: Port Qualifier Information (base standard) and Output Enable. */
enum { PQI_VALID = 0x80, PQI_COMMUNICATES = 0x20, OE_VALID = 0x01 };

struct call {
    struct fs_master *master;
    struct fs_port *port; /* null: the whole FS-Master */
    const uint8_t *block;
    size_t length;
    struct fs_smi_result *result;
};

static int is_v1_1(const struct call *call)
{
    return call->master->setup.edition == FS_V1_1;
}

static uint16_t u16(const uint8_t *at)
{
    return (uint16_t)(at[0] << 8 | at[1]);
}

static uint32_t u32(const uint8_t *at)
{
    return (uint32_t)u16(at) << 16 | u16(at + 2);
}

static void put(const struct call *call, const uint8_t *octets, size_t length)
{
    memcpy(call->result->block + call->result->length, octets, length);
    call->result->length += length;
}

static void put8(const struct call *call, uint8_t value)
{
    put(call, &value, 1);
}

static void put16(const struct call *call, uint16_t value)
{
    put8(call, (uint8_t)(value >> 8));
    put8(call, (uint8_t)value);
}

static void put32(const struct call *call, uint32_t value)
{
    put16(call, (uint16_t)(value >> 16));
    put16(call, (uint16_t)value);
}

/* Nothing to give: a VoidBlock, or nothing in v1.1. */
static uint16_t done(const struct call *call)
{
    if (!is_v1_1(call))
        put16(call, VOID_BLOCK);
    return OK;
}

static uint16_t master_identification(const struct call *call)
{
    put16(call, is_v1_1(call) ? 0x0000 : 0x0001);
    put16(call, MASTER_VENDOR_ID);
    put32(call, MASTER_ID);
    put8(call, MASTER_TYPE_FS);
    put8(call, 0); /* Features_1 */
    put8(call, 0); /* Features_2 */
    put8(call, FS_PORTS);
    for (size_t i = 0; i < FS_PORTS; i++)
        put8(call, PORT_TYPE_FS_OSSDE);
    return OK;
}

/* No password is kept, so the default 0 gets in and any other does not (10.3.2). */
static int access_is_granted(const struct call *call)
{
    return is_v1_1(call) || (u32(call->block + 2) == 0 && u32(call->block + 6) == 0);
}

static uint16_t master_access(const struct call *call)
{
    if (!access_is_granted(call))
        return ARGBLOCK_INCONSISTENT;
    put16(call, is_v1_1(call) ? 0x0001 : 0x0101);
    put32(call, call->master->authenticity[0]);
    put32(call, call->master->authenticity[1]);
    return OK;
}

static uint16_t port_configuration(const struct call *call)
{
    struct fs_port_config config;
    if (!fs_config_parse(&config, call->block, call->master->setup.edition))
        return ARGBLOCK_INCONSISTENT;
    call->port->config = config;
    fs_port_configured(call->port);
    return done(call);
}

/* A port that was never configured reads as DEACTIVATED. */
static uint16_t readback_port_configuration(const struct call *call)
{
    const struct fs_port_config *config = &call->port->config;
    put16(call, fs_config_id(call->master->setup.edition));
    if (config->length != 0)
        put(call, config->octets + ID_LENGTH, config->length - ID_LENGTH);
    else
        call->result->length = fs_config_length(call->master->setup.edition);
    return OK;
}

static uint16_t port_status(const struct call *call)
{
    call->result->length = fs_port_status(call->port, call->result->block);
    return OK;
}

static uint16_t port_power_off_on(const struct call *call)
{
    uint8_t mode = call->block[2];
    uint16_t time = u16(call->block + 3);
    if (mode > 2 || time == 0)
        return ARGBLOCK_INCONSISTENT;
    if (call->port->config.port_mode == FS_DEACTIVATED)
        return DEVICE_NOT_ACCESSIBLE;
    if (mode == 2)
        fs_port_switch_on(call->port);
    else
        fs_port_switch_off(call->port, mode == 1 ? FS_NEVER : time * FS_MS);
    return done(call);
}

/* ArgBlock of the base standard: Index, Subindex, octets. The result says that the request is on its way. */
static uint16_t device_write(const struct call *call)
{
    struct fs_request request = {1, call->block[4], u16(call->block + 2), (uint16_t)(call->length - WRITE_HEAD), {0}};
    if (call->port->mode != FS_PREOPERATE && call->port->mode != FS_OPERATE)
        return DEVICE_NOT_ACCESSIBLE;
    memcpy(request.octets, call->block + WRITE_HEAD, request.length);
    return fs_port_request(call->port, &request) ? done(call) : SERVICE_TEMP_UNAVAILABLE;
}

static uint16_t pd_in(const struct call *call)
{
    if (!fs_gateway_valid(call->port))
        return DEVICE_NOT_IN_OPERATE;
    put16(call, 0x1001);
    put(call, call->port->nsr_in, call->port->nsr_in_length);
    return OK;
}

static uint16_t pd_out(const struct call *call)
{
    if (!fs_gateway_valid(call->port))
        return DEVICE_NOT_IN_OPERATE;
    if (call->length - ID_LENGTH != call->port->nsr_out_length)
        return ARGBLOCK_LENGTH_INVALID;
    memcpy(call->port->nsr_out, call->block + ID_LENGTH, call->port->nsr_out_length);
    return done(call);
}

static uint16_t pd_in_out(const struct call *call)
{
    if (!fs_gateway_valid(call->port))
        return DEVICE_NOT_IN_OPERATE;
    put16(call, 0x1003);
    put(call, call->port->nsr_in, call->port->nsr_in_length);
    put(call, call->port->nsr_out, call->port->nsr_out_length);
    return OK;
}

static uint16_t spdu_in(const struct call *call)
{
    if (!fs_gateway_valid(call->port))
        return DEVICE_NOT_IN_OPERATE;
    if (!fs_config_is_safety(&call->port->config))
        return SERVICE_NOT_SUPPORTED;
    put16(call, 0x1004);
    put(call, call->port->spdu_in, fs_gateway_spdu_in(call->port));
    return OK;
}

/* The SPDU belongs to the SCL. */
static uint16_t spdu_out(const struct call *call)
{
    return fs_gateway_valid(call->port) ? SERVICE_NOT_SUPPORTED : DEVICE_NOT_IN_OPERATE;
}

static uint16_t fs_pd_in_out(const struct call *call)
{
    const struct fs_port *port = call->port;
    size_t in = fs_gateway_spdu_in(port), out = fs_gateway_spdu_out(port);
    uint8_t lines = fs_ossde_lines(&port->ossde);
    int ossde = port->state == FS_PORT_OSSDE;
    if (!fs_gateway_valid(port) && !ossde)
        return DEVICE_NOT_IN_OPERATE;
    put16(call, 0x1103);
    put8(call, ossde ? PQI_VALID : PQI_VALID | PQI_COMMUNICATES);
    put8(call, ossde ? 0 : OE_VALID);
    put8(call, (uint8_t)(in + port->nsr_in_length));
    put(call, ossde ? &lines : port->spdu_in, in);
    put(call, port->nsr_in, port->nsr_in_length);
    put8(call, (uint8_t)(out + port->nsr_out_length));
    if (port->scl.state != FS_SCL_INACTIVE)
        put(call, port->scl.spdu, out);
    else
        call->result->length += out; /* all octets 0 */
    put(call, port->nsr_out, port->nsr_out_length);
    return OK;
}

/* Level at I/Q where it is a digital input. */
static uint16_t pd_in_iq(const struct call *call)
{
    if (!fs_config_is_iolink(&call->port->config) || call->port->config.iq_behavior != 1)
        return SERVICE_NOT_SUPPORTED;
    put16(call, 0x1FFE);
    put8(call, call->port->iq);
    return OK;
}

static uint16_t not_supported(const struct call *call)
{
    (void)call;
    return SERVICE_NOT_SUPPORTED;
}

/* What each service takes: ArgBlock, its octets (most: ANY), and the ArgBlock it gives in IEC 61139-2. */
#define ANY 255u
#define WRITE_MAX (WRITE_HEAD + FS_RECORD_MAX)
struct service {
    uint8_t service;
    uint16_t block, least, most, gives;
    uint16_t (*carry_out)(const struct call *call);
};

/* V1.1: a block of 0 octets is none, and FSMasterAccess has two arguments in place of a block. */
static const struct service v1_1[] = {
    {FS_SMI_MasterIdentification, 0, 0, 0, 0, master_identification},
    {FS_SMI_FSMasterAccess, 0, ACCESS_LENGTH_V1_1, ACCESS_LENGTH_V1_1, 0, master_access},
    {FS_SMI_PortConfiguration, 0x8001, 48, 48, 0, port_configuration},
    {FS_SMI_ReadbackPortConfiguration, 0, 0, 0, 0, readback_port_configuration},
    {FS_SMI_PortStatus, 0, 0, 0, 0, port_status},
    {FS_SMI_DeviceWrite, DEVICE_WRITE, WRITE_HEAD, WRITE_MAX, 0, device_write},
    {FS_SMI_PortPowerOffOn, 0x7002, POWER_LENGTH, POWER_LENGTH, 0, port_power_off_on},
    {FS_SMI_PDIn, 0, 0, 0, 0, pd_in},
    {FS_SMI_PDOut, 0x1002, ID_LENGTH, ANY, 0, pd_out},
    {FS_SMI_PDInOut, 0, 0, 0, 0, pd_in_out},
    {FS_SMI_SPDUIn, 0, 0, 0, 0, spdu_in},
    {FS_SMI_SPDUOut, 0x1005, ID_LENGTH, ANY, 0, spdu_out},
};

static const struct service iec2022[] = {
    {FS_SMI_MasterIdentification, VOID_BLOCK, ID_LENGTH, ID_LENGTH, 0x0001, master_identification},
    {FS_SMI_FSMasterAccess, 0x0100, ACCESS_LENGTH, ACCESS_LENGTH, 0x0101, master_access},
    {FS_SMI_PortConfiguration, 0x8100, 50, 50, VOID_BLOCK, port_configuration},
    {FS_SMI_ReadbackPortConfiguration, VOID_BLOCK, ID_LENGTH, ID_LENGTH, 0x8100, readback_port_configuration},
    {FS_SMI_PortStatus, VOID_BLOCK, ID_LENGTH, ID_LENGTH, 0x9100, port_status},
    {FS_SMI_DeviceWrite, DEVICE_WRITE, WRITE_HEAD, WRITE_MAX, VOID_BLOCK, device_write},
    {FS_SMI_PortPowerOffOn, 0x7003, POWER_LENGTH, POWER_LENGTH, VOID_BLOCK, port_power_off_on},
    {FS_SMI_PDIn, VOID_BLOCK, ID_LENGTH, ID_LENGTH, 0x1001, pd_in},
    {FS_SMI_PDOut, 0x1002, ID_LENGTH, ANY, VOID_BLOCK, pd_out},
    {FS_SMI_PDInOut, VOID_BLOCK, ID_LENGTH, ID_LENGTH, 0x1003, pd_in_out},
    {FS_SMI_FSPDInOut, VOID_BLOCK, ID_LENGTH, ID_LENGTH, 0x1103, fs_pd_in_out},
    {FS_SMI_PDInIQ, VOID_BLOCK, ID_LENGTH, ID_LENGTH, 0x1FFE, pd_in_iq},
};

/* Data Storage objects, outputs at I/Q and, in IEC 61139-2, SPDUs are not for the client. */
static const struct service unknown = {0, 0, 0, 0, 0, not_supported};

static const struct service *find(const struct fs_master *master, uint8_t service)
{
    const struct service *table = master->setup.edition == FS_V1_1 ? v1_1 : iec2022;
    size_t count = master->setup.edition == FS_V1_1 ? sizeof v1_1 / sizeof v1_1[0] : sizeof iec2022 / sizeof iec2022[0];
    for (size_t i = 0; i < count; i++)
        if (table[i].service == service)
            return &table[i];
    return &unknown;
}

static int is_of_the_master(uint8_t service)
{
    return service == FS_SMI_MasterIdentification || service == FS_SMI_FSMasterAccess;
}

static int port_exists(const struct fs_smi_request *request)
{
    return request->port <= FS_PORTS && (request->port >= 1 || is_of_the_master(request->service));
}

/* The order of Tables 16 and 17: port, ArgBlock, its length; then its content. */
static uint16_t check(const struct service *service, const struct fs_smi_request *request, int v1_1_edition)
{
    int has_id = service->block != 0;
    if (!port_exists(request))
        return PORT_NUM_INVALID;
    if (service == &unknown)
        return SERVICE_NOT_SUPPORTED;
    if (has_id && (request->length < ID_LENGTH || u16(request->block) != service->block))
        return ARGBLOCK_NOT_SUPPORTED;
    if (!v1_1_edition && request->exp_block_id != service->gives)
        return ARGBLOCK_NOT_SUPPORTED;
    if (request->length < service->least || request->length > service->most)
        return ARGBLOCK_LENGTH_INVALID;
    return OK;
}

static uint16_t error_info(uint16_t error)
{
    switch (error) {
    case DEVICE_NOT_ACCESSIBLE:
    case DEVICE_NOT_IN_OPERATE:
        return FS_NO_COM;
    case SERVICE_NOT_SUPPORTED:
    case SERVICE_TEMP_UNAVAILABLE:
        return FS_STATE_CONFLICT;
    default:
        return FS_OUT_OF_RANGE;
    }
}

/* Result(-): JobError with the ExpArgBlockID, or ErrorInfo. */
static void refuse(const struct call *call, uint16_t exp_block_id, uint16_t error)
{
    memset(call->result->block, 0, sizeof call->result->block);
    call->result->length = 0;
    call->result->positive = 0;
    if (is_v1_1(call)) {
        put16(call, error_info(error));
        return;
    }
    put16(call, JOB_ERROR);
    put16(call, exp_block_id);
    put16(call, error);
}

void fs_master_smi(struct fs_master *master, const struct fs_smi_request *request, struct fs_smi_result *result)
{
    const struct service *service = find(master, request->service);
    struct call call = {master, NULL, request->block, request->length, result};
    uint16_t error = check(service, request, is_v1_1(&call));
    memset(result, 0, sizeof *result);
    result->positive = 1;
    if (request->port >= 1 && request->port <= FS_PORTS)
        call.port = fs_port_of(master, request->port);
    if (!is_v1_1(&call) && request->length >= ID_LENGTH)
        result->ref_block_id = u16(request->block);
    if (error == OK)
        error = service->carry_out(&call);
    if (error != OK)
        refuse(&call, request->exp_block_id, error);
    if (!is_v1_1(&call) || result->positive)
        result->block_length = (uint16_t)result->length;
}
