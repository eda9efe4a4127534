/* The stream of a camera: a thread that exposes into queued buffers. */
#include <string.h>
#include <time.h>

#include "camera.h"
#include "cell_images.h"

static uint16_t deep_value(uint32_t level) { return (uint16_t)((16 * level + 5) & 0x0FFF); }

static void draw_8(uint8_t *line, uint32_t width, uint32_t level) {
    for (uint32_t x = 0; x < width; x++) line[x] = (uint8_t)(level + x);
}

static void draw_16(uint8_t *line, uint32_t width, uint32_t level) {
    for (uint32_t x = 0; x < width; x++) {
        uint16_t value = deep_value(level + x);
        memcpy(line + 2 * x, &value, sizeof value);
    }
}

/* Two pixels in three bytes, their low nibbles in the middle one. */
static void draw_packed(uint8_t *line, uint32_t width, uint32_t level) {
    for (uint32_t x = 0; x < width; x += 2) {
        uint16_t one = deep_value(level + x), two = deep_value(level + x + 1);
        uint8_t *triple = line + x / 2 * 3;
        triple[0] = (uint8_t)(one >> 4);
        triple[1] = (uint8_t)((one & 15) | (two & 15) << 4);
        triple[2] = (uint8_t)(two >> 4);
    }
}

/* Any image tells its camera and its frame number, so that a test knows every pixel: see fakes/gentl/cameras.py. */
static void draw(camera *self, frame_buffer *buffer, uint64_t frame_id) {
    uint32_t width = camera_u32(self, REG_WIDTH), height = camera_u32(self, REG_HEIGHT);
    uint32_t left = camera_u32(self, REG_OFFSET_X), top = camera_u32(self, REG_OFFSET_Y);
    uint32_t format = camera_u32(self, REG_PIXEL_FORMAT);
    size_t line_bytes = camera_line_bytes(self);
    for (uint32_t y = 0; y < height; y++) {
        uint8_t *line = buffer->base + y * line_bytes;
        uint32_t level = left + 3 * (y + top) + 37 * (uint32_t)frame_id + 11 * (uint32_t)self->index;
        if (format == PFNC_MONO12 || format == PFNC_BAYER_RG12)
            draw_16(line, width, level);
        else if (format == PFNC_MONO12_PACKED)
            draw_packed(line, width, level);
        else
            draw_8(line, format == PFNC_RGB8 ? 3 * width : width, level);
    }
}

static frame_buffer *first(camera *self, place where) {
    frame_buffer *found = NULL;
    for (int i = 0; i < MAX_BUFFERS; i++) {
        frame_buffer *one = &self->buffers[i];
        if (one->announced && one->where == where && (!found || one->order < found->order)) found = one;
    }
    return found;
}

static bool due(const camera *self) {
    if (!self->acquiring || !self->stream_running) return false;
    return camera_u32(self, REG_TRIGGER_MODE) ? self->triggers > 0 : true;
}

/* A stop ends the exposure, and what was begun before it is not part of the next acquisition. */
static bool exposing(const camera *self, uint32_t starts) { return self->acquiring && self->starts == starts && !self->ending; }

static void wait_until(camera *self, uint32_t starts, uint64_t until_ns) {
    struct timespec until = {.tv_sec = (time_t)(until_ns / 1000000000u), .tv_nsec = (long)(until_ns % 1000000000u)};
    while (exposing(self, starts) && now_ns() < until_ns) pthread_cond_timedwait(&self->changed, &self->mutex, &until);
}

/* Once for each image that a test has asked for. */
static bool used(volatile uint32_t *count) {
    bool more = *count > 0;
    if (more) --*count;
    return more;
}

/* The image and its size; a piece of it for one that misses packets. */
static bool fill(camera *self, frame_buffer *buffer, const cell_image *image) {
    buffer->width = camera_u32(self, REG_WIDTH);
    buffer->height = camera_u32(self, REG_HEIGHT);
    buffer->filled = camera_payload(self);
    if (buffer->size < buffer->filled) return false;
    if (cell_is_there()) {
        if (!cell_fill(image, buffer)) return false;
        buffer->width = image->answer.width;
        buffer->height = image->answer.height;
        buffer->filled -= camera_image_bytes(self) - image->answer.size;
    } else
        draw(self, buffer, self->frame_id);
    if (used(&self->state->truncated)) buffer->filled /= 2;
    if (buffer->incomplete) memset(buffer->base + buffer->filled / 2, 0, buffer->filled - buffer->filled / 2);
    return true;
}

static void deliver(camera *self, uint64_t ended_ns, const cell_image *image) {
    if (!used(&self->state->stale) && image->answer.outcome != CELL_STALE) {
        self->frame_id++;
        self->last_time_ns = ended_ns;
        self->state->exposures++;
    }
    frame_buffer *buffer = first(self, INPUT);
    if (!buffer) return; /* nobody has given room: it is lost */
    buffer->incomplete = used(&self->state->incomplete) || image->answer.outcome == CELL_INCOMPLETE;
    if (!fill(self, buffer, image)) return;
    buffer->offset_x = camera_u32(self, REG_OFFSET_X);
    buffer->offset_y = camera_u32(self, REG_OFFSET_Y);
    buffer->pixel_format = camera_u32(self, REG_PIXEL_FORMAT);
    buffer->padding = buffer->pixel_format == PFNC_MONO12_PACKED ? 0 : LINE_PADDING;
    buffer->frame_id = self->frame_id;
    chunks_append(self, buffer);
    buffer->time_ns = self->last_time_ns;
    buffer->new_data = true;
    buffer->where = OUTPUT;
    buffer->order = ++self->order;
    self->delivered++;
    pthread_cond_broadcast(&self->changed);
}

static void take(camera *self) {
    bool triggered = camera_u32(self, REG_TRIGGER_MODE) != 0;
    if (triggered) self->triggers--;
    /* A free-running camera of 50 images a second. */
    uint64_t took_us = triggered ? (uint64_t)camera_f64(self, REG_EXPOSURE_US) : 20000;
    took_us += 1000ull * self->state->slow_ms;
    uint32_t starts = self->starts;
    self->state->strobes++;
    uint64_t begun_ns = now_ns(), ended_ns = begun_ns + 1000 * took_us; /* what a cell takes to render is no time of it */
    cell_image image = {.block = -1};
    bool exposed = !cell_is_there() || cell_expose(self, starts, begun_ns, &image);
    wait_until(self, starts, ended_ns);
    if (exposed && exposing(self, starts) && !camera_lost(self)) deliver(self, ended_ns, &image);
    cell_let_go(&image);
}

static bool by_wire(const camera *self) {
    return camera_u32(self, REG_TRIGGER_MODE) && camera_u32(self, REG_TRIGGER_SOURCE) == SOURCE_LINE1;
}

/* A wire wakes nobody in another process, so it is looked at each millisecond. */
static void watch_line(camera *self) {
    uint32_t now = camera_line(self);
    if (self->acquiring && self->stream_running) self->triggers += now - self->line_seen;
    self->line_seen = now;
    if (self->triggers) return;
    struct timespec until;
    clock_gettime(CLOCK_MONOTONIC, &until);
    until.tv_nsec += 1000000;
    if (until.tv_nsec >= 1000000000) {
        until.tv_sec++;
        until.tv_nsec -= 1000000000;
    }
    pthread_cond_timedwait(&self->changed, &self->mutex, &until);
}

static void *run(void *argument) {
    camera *self = argument;
    pthread_mutex_lock(&self->mutex);
    while (!self->ending) {
        if (due(self))
            take(self);
        else if (by_wire(self))
            watch_line(self);
        else
            pthread_cond_wait(&self->changed, &self->mutex);
    }
    pthread_mutex_unlock(&self->mutex);
    return NULL;
}

GC_ERROR stream_open(camera *self) {
    if (self->stream_open) return GC_ERR_RESOURCE_IN_USE;
    self->ending = self->event_killed = false;
    self->stream_open = pthread_create(&self->thread, NULL, run, self) == 0;
    return self->stream_open ? GC_ERR_SUCCESS : GC_ERR_ERROR;
}

void stream_close(camera *self) {
    if (!self->stream_open) return;
    pthread_mutex_lock(&self->mutex);
    self->ending = true;
    self->stream_running = self->acquiring = false;
    pthread_cond_broadcast(&self->changed);
    pthread_mutex_unlock(&self->mutex);
    pthread_join(self->thread, NULL);
    cell_hang_up(self);
    self->stream_open = false;
}

GC_ERROR stream_next(camera *self, uint64_t timeout_ms, frame_buffer **found) {
    struct timespec until;
    clock_gettime(CLOCK_MONOTONIC, &until);
    bool forever = timeout_ms > 86400000u;
    if (!forever) {
        uint64_t ns = (uint64_t)until.tv_nsec + (timeout_ms % 1000) * 1000000u;
        until.tv_sec += (time_t)(timeout_ms / 1000 + ns / 1000000000u);
        until.tv_nsec = (long)(ns % 1000000000u);
    }
    GC_ERROR error = GC_ERR_SUCCESS;
    pthread_mutex_lock(&self->mutex);
    while (!(*found = first(self, OUTPUT)) && !self->event_killed && !error) {
        if (forever)
            pthread_cond_wait(&self->changed, &self->mutex);
        else if (pthread_cond_timedwait(&self->changed, &self->mutex, &until))
            error = GC_ERR_TIMEOUT;
    }
    if (self->event_killed) {
        self->event_killed = false;
        *found = NULL;
        error = GC_ERR_ABORT;
    } else if (*found) {
        error = GC_ERR_SUCCESS;
        (*found)->where = OUT;
    }
    pthread_mutex_unlock(&self->mutex);
    return error;
}
