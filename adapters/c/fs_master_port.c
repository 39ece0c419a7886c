/* One port from its supply to OPERATE: L+, WaitOnReadyPulse_10 (7.2, T20 to T22), wake-up, identification, the
 * FSP_VerifyRecord (clause 8, T17 and T18), loss of the Device and what follows it.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#include <string.h>

#include "fs_master_internal.h"

#define US UINT64_C(1000)

/* tRP, and a wake-up between tRW (50 us) and the least tRO (700 us) behind it: Table 7. */
#define READY_PULSE_MIN (500 * US)
#define READY_PULSE_MAX (1000 * US)
#define WAKE_UP_DELAY (100 * US)

/* Base standard: TRDL, TDWU, the number of wake-ups of a sequence, TSD, and how long an ISDU may take. */
#define POWER_UP_DELAY (300 * FS_MS)
#define WAKE_UP_RETRY (40 * FS_MS)
#define WAKE_UPS 3u
#define SEQUENCE_DELAY (1000 * FS_MS)
#define REQUEST_TIME (5000 * FS_MS)

/* Time of a state in which nothing but the base system works. */
#define STATE_TIME (1 * FS_MS)

static void go(struct fs_port *port, enum fs_port_state state, uint64_t due)
{
    port->state = state;
    port->due = due;
}

static void go_for(struct fs_port *port, enum fs_port_state state, uint64_t time)
{
    go(port, state, port->master->now + time);
}

static void set_mode(struct fs_port *port, uint8_t mode)
{
    const struct fs_environment *environment = &port->master->environment;
    if (port->mode == mode)
        return;
    port->mode = mode;
    environment->mode(environment->self, port->number, mode);
}

static void set_supply(struct fs_port *port, uint8_t on)
{
    const struct fs_environment *environment = &port->master->environment;
    if (port->supplied == on)
        return;
    port->supplied = on;
    if (!on)
        port->off_since = port->master->now;
    environment->supply(environment->self, port->number, on);
}

/* T8, T9, T13, T14 of the DL-mode handler. The SCL goes on: it finds out by its MTimer. */
static void end_communication(struct fs_port *port)
{
    port->open = FS_NO_REQUEST;
    port->given_up = FS_NEVER;
    port->identified = 0;
    port->diag_count = 0;
    set_mode(port, FS_INACTIVE);
}

/* T20 */
static void wait_for_ready_pulse(struct fs_port *port)
{
    port->pulse_since = FS_NEVER;
    go_for(port, FS_PORT_WAIT_READY, port->config.time_to_ready * 10 * FS_MS);
}

/* L+ is on: the port starts as its PortMode says. */
static void begin(struct fs_port *port, uint64_t power_up_delay)
{
    port->retry = 0;
    port->switched_off = 0;
    set_supply(port, 1);
    if (fs_config_is_safety(&port->config)) {
        wait_for_ready_pulse(port);
    } else if (fs_config_is_iolink(&port->config)) {
        go_for(port, FS_PORT_DELAY, power_up_delay);
    } else if (port->config.port_mode == FS_OSSDE) {
        go(port, FS_PORT_OSSDE, FS_NEVER);
        fs_ossde_start(&port->ossde, port->cq, port->iq, port->master->now);
    } else {
        go(port, FS_PORT_SIO, FS_NEVER);
    }
}

/* Only an FS-Device needs its FSP_MinShutDownTime (10.3.4). */
static uint64_t shut_down_time(const struct fs_port *port)
{
    return fs_config_is_safety(&port->config) ? port->config.min_shut_down_time * 10 * FS_MS : 0;
}

static void power_up(struct fs_port *port)
{
    uint64_t now = port->master->now, least = shut_down_time(port);
    if (port->off_since != FS_NEVER && now - port->off_since < least)
        go(port, FS_PORT_POWER_OFF, port->off_since + least);
    else
        begin(port, POWER_UP_DELAY);
}

/* T22: another Ready pulse needs another power-on. */
static void cycle_power(struct fs_port *port)
{
    set_supply(port, 0);
    power_up(port);
}

void fs_port_configured(struct fs_port *port)
{
    end_communication(port);
    fs_scl_stop(&port->scl);
    fs_ossde_stop(&port->ossde);
    port->switched_off = 0;
    if (port->config.port_mode == FS_DEACTIVATED) {
        set_supply(port, 0);
        go(port, FS_PORT_OFF, FS_NEVER);
    } else if (!port->supplied) {
        power_up(port);
    } else if (fs_config_is_safety(&port->config)) {
        cycle_power(port);
    } else {
        begin(port, STATE_TIME);
    }
    fs_gateway_publish(port);
}

void fs_port_switch_off(struct fs_port *port, uint64_t time)
{
    end_communication(port);
    fs_ossde_stop(&port->ossde);
    set_supply(port, 0);
    port->switched_off = 1;
    if (time == FS_NEVER)
        go(port, FS_PORT_DOWN, FS_NEVER);
    else
        go_for(port, FS_PORT_POWER_OFF, time > shut_down_time(port) ? time : shut_down_time(port));
    fs_gateway_publish(port);
}

void fs_port_switch_on(struct fs_port *port)
{
    if (port->supplied)
        return;
    port->switched_off = 0;
    power_up(port);
    fs_gateway_publish(port);
}

/* State WURQ_5: one pulse, then the test messages at COM3, COM2 and COM1. */
static void wake_up(struct fs_port *port)
{
    static const uint8_t answer_ms[] = {0, 8, 3, 1}; /* by COM */
    const struct fs_environment *environment = &port->master->environment;
    environment->wake_up(environment->self, port->number);
    port->retry++;
    go_for(port, FS_PORT_WAKE_UP, port->plugged ? answer_ms[port->device.com] * FS_MS : WAKE_UP_RETRY);
}

static void end_wake_up(struct fs_port *port)
{
    if (port->plugged) { /* T2, T3, T4 */
        set_mode(port, FS_STARTUP);
        go_for(port, FS_PORT_STARTUP, STATE_TIME);
    } else if (port->retry < WAKE_UPS) { /* T19 */
        wake_up(port);
    } else if (fs_config_is_safety(&port->config)) { /* T5: the FS-Device may have gone to OSSDe */
        cycle_power(port);
    } else {
        port->retry = 0;
        go_for(port, FS_PORT_DELAY, SEQUENCE_DELAY);
    }
}

static void fail(struct fs_port *port, uint16_t code)
{
    go(port, FS_PORT_FAULT, FS_NEVER);
    fs_event_of_port(port, FS_APPEARS, FS_ERROR, code);
}

int fs_port_request(struct fs_port *port, const struct fs_request *request)
{
    const struct fs_environment *environment = &port->master->environment;
    if (port->open != FS_NO_REQUEST)
        return 0;
    port->open = FS_CLIENT_REQUEST;
    port->given_up = port->master->now + REQUEST_TIME;
    environment->request(environment->self, port->number, request);
    return 1;
}

/* State Send_VerifyRecord_9 */
static void send_verify_record(struct fs_port *port)
{
    struct fs_request request = {1, 0, FS_VERIFY_RECORD_INDEX, FS_VERIFY_RECORD_LENGTH, {0}};
    memcpy(request.octets, port->config.record, FS_VERIFY_RECORD_LENGTH);
    go(port, FS_PORT_PREOPERATE, FS_NEVER);
    fs_port_request(port, &request);
    port->open = FS_VERIFY_RECORD;
}

static void preoperate(struct fs_port *port)
{
    fs_gateway_lay_out(port);
    set_mode(port, FS_PREOPERATE);
    if (fs_config_is_safety(&port->config))
        send_verify_record(port); /* T17 of the Configuration Manager */
    else
        go_for(port, FS_PORT_PREOPERATE, STATE_TIME); /* T5 */
}

/* STARTUP: the Device found against the configuration. */
static void identify(struct fs_port *port)
{
    const struct fs_port_config *config = &port->config;
    const struct fs_device *device = &port->device;
    unsigned cycle_time = fs_cycle_time(config->port_cycle_time);
    port->identified = 1;
    if (fs_config_validates(config) && device->vendor_id != config->vendor_id)
        fail(port, FS_EVENT_VENDOR);
    else if (fs_config_validates(config) && device->device_id != config->device_id)
        fail(port, FS_EVENT_DEVICE);
    else if (config->port_cycle_time != 0 && cycle_time < fs_cycle_time(device->min_cycle_time))
        fail(port, FS_EVENT_CYCLE_TIME);
    else
        preoperate(port);
}

/* The process data of the Device have room for the SPDUs and, in v1.1, are as long as configured. */
static int device_fits(const struct fs_port *port)
{
    return port->device.pd_in == fs_gateway_spdu_in(port) + port->nsr_in_length &&
           port->device.pd_out == fs_gateway_spdu_out(port) + port->nsr_out_length;
}

/* 11.7: all parameters verified, the SCL starts. One that runs already goes on: a Device that was lost and is back
 * needs the acknowledgment of the operator. */
static void start_scl(struct fs_port *port)
{
    const struct fs_port_config *config = &port->config;
    unsigned deviations = fs_config_deviations(config, port->number, port->master->authenticity);
    struct fs_scl_parameters parameters;
    if (deviations != 0 || !device_fits(port)) {
        fs_scl_stop(&port->scl);
        fs_event_of_deviations(port, deviations);
        return;
    }
    if (port->scl.state != FS_SCL_INACTIVE)
        return;
    parameters.prot_mode = config->prot_mode;
    parameters.port = config->port;
    parameters.pd_in = (uint8_t)(config->spdu_in - fs_scl_code_length(config->prot_mode));
    parameters.pd_out = (uint8_t)(config->spdu_out - fs_scl_code_length(config->prot_mode));
    parameters.watchdog = config->watchdog * FS_MS;
    fs_scl_start(&port->scl, &parameters);
}

/* T10 of the DL-mode handler */
static void operate(struct fs_port *port)
{
    go(port, FS_PORT_OPERATE, FS_NEVER);
    set_mode(port, FS_OPERATE);
    if (fs_config_is_safety(&port->config))
        start_scl(port);
}

/* T18 of the Configuration Manager; a record that was not taken ends in PortFault_3. */
static void end_request(struct fs_port *port, int done)
{
    int record = port->open == FS_VERIFY_RECORD;
    port->open = FS_NO_REQUEST;
    port->given_up = FS_NEVER;
    if (record && done)
        operate(port);
    else if (record)
        fail(port, FS_EVENT_STARTUP);
}

void fs_master_answer(struct fs_master *master, uint8_t number, int done)
{
    struct fs_port *port = fs_port_of(master, number);
    if (port->open == FS_NO_REQUEST)
        return;
    end_request(port, done);
    fs_gateway_publish(port);
}

static int same_device(const struct fs_device *one, const struct fs_device *other)
{
    return one->revision_id == other->revision_id && one->com == other->com &&
           one->min_cycle_time == other->min_cycle_time && one->pd_in == other->pd_in && one->pd_out == other->pd_out &&
           one->vendor_id == other->vendor_id && one->device_id == other->device_id;
}

void fs_master_plug(struct fs_master *master, uint8_t number, const struct fs_device *device)
{
    struct fs_port *port = fs_port_of(master, number);
    if (device != NULL && port->plugged && same_device(device, &port->device))
        return;
    port->plugged = device != NULL && device->com >= 1 && device->com <= 3;
    if (device != NULL)
        port->device = *device;
    if (port->mode == FS_INACTIVE)
        return;
    end_communication(port); /* COMLOST */
    if (fs_config_is_safety(&port->config))
        wait_for_ready_pulse(port);
    else
        go_for(port, FS_PORT_DELAY, SEQUENCE_DELAY);
    fs_gateway_publish(port);
}

/* T21 */
static void watch_ready_pulse(struct fs_port *port, uint8_t level)
{
    uint64_t now = port->master->now, since = port->pulse_since;
    port->pulse_since = level ? now : FS_NEVER;
    if (level || since == FS_NEVER || now - since < READY_PULSE_MIN || now - since > READY_PULSE_MAX)
        return;
    port->retry = 0;
    go_for(port, FS_PORT_DELAY, WAKE_UP_DELAY);
}

void fs_master_line(struct fs_master *master, uint8_t number, uint8_t line, uint8_t level)
{
    struct fs_port *port = fs_port_of(master, number);
    uint8_t *pin = line == FS_OSSDE_CQ ? &port->cq : &port->iq;
    if (*pin == level)
        return;
    *pin = level;
    if (line == FS_OSSDE_CQ && port->state == FS_PORT_WAIT_READY)
        watch_ready_pulse(port, level);
    fs_ossde_drive(&port->ossde, line, level, master->now);
}

uint64_t fs_port_due(const struct fs_port *port)
{
    uint64_t due = port->due, ossde = fs_ossde_due(&port->ossde);
    due = port->given_up < due ? port->given_up : due;
    due = port->scl.MTimer < due ? port->scl.MTimer : due;
    return ossde < due ? ossde : due;
}

static void end_state(struct fs_port *port)
{
    port->due = FS_NEVER;
    switch (port->state) {
    case FS_PORT_POWER_OFF:
        begin(port, POWER_UP_DELAY);
        break;
    case FS_PORT_WAIT_READY:
        cycle_power(port);
        break;
    case FS_PORT_DELAY:
        wake_up(port);
        break;
    case FS_PORT_WAKE_UP:
        end_wake_up(port);
        break;
    case FS_PORT_STARTUP:
        identify(port);
        break;
    case FS_PORT_PREOPERATE:
        operate(port);
        break;
    default:
        break;
    }
}

void fs_port_run(struct fs_port *port)
{
    uint64_t now = port->master->now;
    uint8_t FAULTS_S_before = port->scl.FAULTS_S;
    enum fs_ossde_state ossde_before = port->ossde.state;
    if (port->scl.MTimer <= now) {
        fs_scl_expired(&port->scl, now);
        fs_event_of_scl(port, FAULTS_S_before);
    }
    fs_ossde_run(&port->ossde, now);
    fs_event_of_ossde(port, ossde_before);
    if (port->given_up <= now)
        end_request(port, 0);
    if (port->due <= now)
        end_state(port);
    fs_gateway_publish(port);
}
