/* Process data of a port (10.5): splitter and composer between the line, the SCL and the non-safety data, and the
 * outputs towards the gateway with their qualifier (11.11).
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#include <string.h>

#include "fs_master_internal.h"

size_t fs_gateway_spdu_in(const struct fs_port *port)
{
    if (port->state == FS_PORT_OSSDE)
        return 1;
    return fs_config_is_safety(&port->config) ? port->config.spdu_in : 0;
}

size_t fs_gateway_spdu_out(const struct fs_port *port)
{
    return fs_config_is_safety(&port->config) ? port->config.spdu_out : 0;
}

int fs_gateway_valid(const struct fs_port *port)
{
    return port->state == FS_PORT_OPERATE;
}

static uint8_t rest(size_t total, size_t spdu)
{
    return (uint8_t)(total > spdu ? total - spdu : 0);
}

/* v1.1 writes the lengths of non-safety data into the configuration, IEC 61139-2 takes what the SPDU leaves. */
void fs_gateway_lay_out(struct fs_port *port)
{
    const struct fs_port_config *config = &port->config;
    if (fs_config_is_safety(config) && port->master->setup.edition == FS_V1_1) {
        port->nsr_in_length = config->input_length;
        port->nsr_out_length = config->output_length;
    } else {
        port->nsr_in_length = rest(port->device.pd_in, fs_gateway_spdu_in(port));
        port->nsr_out_length = rest(port->device.pd_out, fs_gateway_spdu_out(port));
    }
    memset(port->spdu_in, 0, sizeof port->spdu_in);
    memset(port->nsr_in, 0, sizeof port->nsr_in);
    memset(port->nsr_out, 0, sizeof port->nsr_out);
}

/* Splitter: the SPDU comes first. */
static void split(struct fs_port *port, const uint8_t *in, size_t length)
{
    size_t spdu = fs_gateway_spdu_in(port);
    uint8_t FAULTS_S_before = port->scl.FAULTS_S;
    if (length != spdu + port->nsr_in_length)
        return;
    memcpy(port->spdu_in, in, spdu);
    memcpy(port->nsr_in, in + spdu, port->nsr_in_length);
    if (port->scl.state == FS_SCL_INACTIVE)
        return;
    fs_scl_received(&port->scl, in, port->master->now);
    fs_event_of_scl(port, FAULTS_S_before);
    fs_gateway_publish(port);
}

/* Composer: all octets of the SPDU are 0 until the SCL sends. */
static int compose(const struct fs_port *port, uint8_t *out)
{
    size_t spdu = fs_gateway_spdu_out(port);
    memset(out, 0, FS_PORT_PD_MAX);
    if (port->scl.state != FS_SCL_INACTIVE)
        memcpy(out, port->scl.spdu, spdu);
    memcpy(out + spdu, port->nsr_out, port->nsr_out_length);
    return (int)(spdu + port->nsr_out_length);
}

int fs_master_cycle(struct fs_master *master, uint8_t number, const uint8_t *in, size_t length, uint8_t *out)
{
    struct fs_port *port = fs_port_of(master, number);
    if (!fs_gateway_valid(port))
        return -1;
    if (in != NULL)
        split(port, in, length);
    return compose(port, out);
}

int fs_master_PDout(struct fs_master *master, uint8_t number, const uint8_t *octets, size_t length)
{
    struct fs_port *port = fs_port_of(master, number);
    size_t expected = port->scl.state != FS_SCL_INACTIVE ? port->scl.parameters.pd_out : master->setup.pd_out;
    if (length != expected)
        return 0;
    if (length > 0)
        memcpy(port->scl.PDout_M, octets, length);
    return 1;
}

/* 11.11.4: FAULTS_S or SDset_S make the qualifier BAD. Without SCL there is nothing GOOD. */
static void outputs_of_scl(const struct fs_port *port, struct fs_told *outputs)
{
    const struct fs_scl *scl = &port->scl;
    outputs->pd_length = scl->state != FS_SCL_INACTIVE ? scl->parameters.pd_in : port->master->setup.pd_in;
    memcpy(outputs->PDin_M, scl->PDin_M, outputs->pd_length);
    outputs->flags[FS_SDset_S] = scl->SDset_S;
    outputs->flags[FS_ChFAckReq_S] = scl->ChFAckReq_S;
    outputs->flags[FS_FAULTS_S] = scl->FAULTS_S;
    outputs->flags[FS_qualifier] = scl->state != FS_SCL_INACTIVE && !scl->FAULTS_S && !scl->SDset_S;
}

/* Table 43 */
static void outputs_of_ossde(const struct fs_port *port, struct fs_told *outputs)
{
    enum fs_ossde_state state = port->ossde.state;
    outputs->pd_length = 1;
    outputs->PDin_M[0] = fs_ossde_PDin(&port->ossde);
    outputs->flags[FS_SDset_S] = state != FS_OSSDE_GOOD;
    outputs->flags[FS_ChFAckReq_S] = state == FS_OSSDE_AWAIT_ACKQ;
    outputs->flags[FS_qualifier] = state == FS_OSSDE_GOOD;
}

static void tell(struct fs_port *port, uint8_t output, const uint8_t *octets, size_t length)
{
    const struct fs_environment *environment = &port->master->environment;
    environment->output(environment->self, port->number, output, octets, length);
}

void fs_gateway_publish(struct fs_port *port)
{
    struct fs_told outputs, before = port->told;
    memset(&outputs, 0, sizeof outputs);
    outputs.valid = 1;
    if (port->state == FS_PORT_OSSDE)
        outputs_of_ossde(port, &outputs);
    else
        outputs_of_scl(port, &outputs);
    port->told = outputs;
    if (!before.valid || before.pd_length != outputs.pd_length ||
        memcmp(before.PDin_M, outputs.PDin_M, outputs.pd_length) != 0)
        tell(port, FS_PDin_M, outputs.PDin_M, outputs.pd_length);
    for (uint8_t output = FS_SDset_S; output <= FS_qualifier; output++)
        if (!before.valid || before.flags[output] != outputs.flags[output])
            tell(port, output, &outputs.flags[output], 1);
}
