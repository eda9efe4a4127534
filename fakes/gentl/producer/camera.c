/* Registers of a camera, and what writing them does. */
#include "camera.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

uint64_t now_ns(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

uint32_t camera_u32(const camera *self, uint32_t address) {
    uint32_t value;
    memcpy(&value, self->registers + address, sizeof value);
    return value;
}

double camera_f64(const camera *self, uint32_t address) {
    double value;
    memcpy(&value, self->registers + address, sizeof value);
    return value;
}

static void set_u32(camera *self, uint32_t address, uint32_t value) {
    memcpy(self->registers + address, &value, sizeof value);
}

static void set_f64(camera *self, uint32_t address, double value) {
    memcpy(self->registers + address, &value, sizeof value);
}

static void set_text(camera *self, uint32_t address, const char *text) {
    memset(self->registers + address, 0, TEXT_BYTES);
    size_t size = strnlen(text, TEXT_BYTES - 1);
    memcpy(self->registers + address, text, size);
}

size_t camera_line_bytes(const camera *self) {
    uint32_t format = camera_u32(self, REG_PIXEL_FORMAT);
    size_t width = camera_u32(self, REG_WIDTH);
    if (format == PFNC_MONO12_PACKED) return width / 2 * 3; /* widths are multiples of four */
    size_t pixel = format == PFNC_RGB8 ? 3 : format == PFNC_MONO12 || format == PFNC_BAYER_RG12 ? 2 : 1;
    return width * pixel + LINE_PADDING;
}

size_t camera_image_bytes(const camera *self) { return camera_line_bytes(self) * camera_u32(self, REG_HEIGHT); }

size_t camera_payload(const camera *self) { return camera_image_bytes(self) + chunks_bytes(self); }

void camera_power_up(camera *self, int index, camera_state *state) {
    memset(self, 0, sizeof *self);
    self->index = index;
    self->state = state;
    self->losses_seen = state->losses;
    self->exposures = -1;
    pthread_mutex_init(&self->mutex, NULL);
    /* Waits are measured on the clock that nobody sets. */
    pthread_condattr_t attributes;
    pthread_condattr_init(&attributes);
    pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
    pthread_cond_init(&self->changed, &attributes);
    set_u32(self, REG_WIDTH, state->width);
    set_u32(self, REG_HEIGHT, state->height);
    set_u32(self, REG_WIDTH_MAX, state->width);
    set_u32(self, REG_HEIGHT_MAX, state->height);
    set_u32(self, REG_PIXEL_FORMAT, state->pixel_format);
    set_u32(self, REG_PAYLOAD_SIZE, (uint32_t)camera_payload(self));
    set_u32(self, REG_PACKET_SIZE, 1500);
    set_f64(self, REG_EXPOSURE_US, 5000.0);
    set_text(self, REG_VENDOR, "cellctl");
    set_text(self, REG_MODEL, "fake GigE camera");
    set_text(self, REG_SERIAL, state->serial);
    set_text(self, REG_USER_ID, state->user_id);
}

/* Gone from the network, or gone since it was opened: the makers' libraries do not take it up again. */
bool camera_lost(const camera *self) {
    return self->state->lost || !self->state->present || self->state->losses != self->losses_seen;
}

/* A camera that hangs, dies with its driver, or is gone. */
static GC_ERROR obstacle(camera *self) {
    if (self->state->crash) {
        self->state->crash = 0; /* a program that is started again finds a library that works */
        abort();
    }
    while (self->state->hang) usleep(1000);
    return camera_lost(self) ? GC_ERR_IO : GC_ERR_SUCCESS;
}

GC_ERROR camera_read(camera *self, uint64_t address, void *data, size_t size) {
    GC_ERROR error = obstacle(self);
    if (error) return error;
    if (address + size > REGISTER_BYTES) return GC_ERR_INVALID_ADDRESS;
    pthread_mutex_lock(&self->mutex);
    memcpy(data, self->registers + address, size);
    pthread_mutex_unlock(&self->mutex);
    return GC_ERR_SUCCESS;
}

/* Pulses on Line1 so far. */
uint32_t camera_line(const camera *self) {
    uint32_t wired_to = self->state->wired_to;
    if (!wired_to) return self->state->pulses;
    return (self->state - self->index + (wired_to - 1))->strobes;
}

static bool is(uint64_t address, size_t size, uint32_t place) { return address == place && size == 4; }

GC_ERROR camera_write(camera *self, uint64_t address, const void *data, size_t size) {
    GC_ERROR error = obstacle(self);
    if (error) return error;
    if (address + size > REGISTER_BYTES || address >= REG_VENDOR) return GC_ERR_INVALID_ADDRESS;
    pthread_mutex_lock(&self->mutex);
    bool shape = address <= REG_PIXEL_FORMAT || address == REG_CHUNK_MODE;
    if (shape && self->stream_running) {
        pthread_mutex_unlock(&self->mutex);
        return GC_ERR_ACCESS_DENIED;
    }
    memcpy(self->registers + address, data, size);
    if (shape) set_u32(self, REG_PAYLOAD_SIZE, (uint32_t)camera_payload(self));
    if (is(address, size, REG_START)) {
        self->acquiring = true;
        self->starts++;
        self->triggers = 0;
        self->line_seen = camera_line(self);
    } else if (is(address, size, REG_STOP)) {
        self->acquiring = false;
    } else if (is(address, size, REG_TRIGGER_SOFTWARE)) {
        /* A trigger that comes before the acquisition is started is overheard, as by real cameras. */
        if (self->state->drop)
            self->state->drop--;
        else if (self->acquiring && camera_u32(self, REG_TRIGGER_SOURCE) == SOURCE_SOFTWARE)
            self->triggers++;
    }
    pthread_cond_broadcast(&self->changed);
    pthread_mutex_unlock(&self->mutex);
    return GC_ERR_SUCCESS;
}
