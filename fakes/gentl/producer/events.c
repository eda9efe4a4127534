/* Events: that a buffer of a stream is full, and that a camera is lost. */
#include <stdio.h>
#include <unistd.h>

#include "library.h"

/* The number of the event that a camera is lost; 0x9000 and up are each maker's own. */
#define LOSS_ID 0x9001u
#define LOOK_US 1000

typedef struct { camera *stream, *device; } source;

static source source_of(EVENTSRC_HANDLE handle, int32_t type) {
    return (source){
        .stream = type == EVENT_NEW_BUFFER ? of_handle(handle, stream_handles) : NULL,
        .device = type == EVENT_MODULE ? of_handle(handle, device_handles) : NULL,
    };
}

static bool set_registered(bool *flag, bool value) {
    bool changes = *flag != value;
    *flag = value;
    return changes;
}

GC_API GCRegisterEvent(EVENTSRC_HANDLE handle, int32_t type, EVENT_HANDLE *event) {
    source from = source_of(handle, type);
    if (from.stream ? !from.stream->stream_open : !from.device || !from.device->is_open)
        return fail(GC_ERR_NOT_IMPLEMENTED, "events of full buffers and of lost cameras only");
    bool *flag = from.stream ? &from.stream->event_registered : &from.device->loss_registered;
    if (!set_registered(flag, true)) return fail(GC_ERR_RESOURCE_IN_USE, "registered already");
    *event = from.stream ? &event_handles[from.stream->index] : &loss_handles[from.device->index];
    return GC_ERR_SUCCESS;
}

GC_API GCUnregisterEvent(EVENTSRC_HANDLE handle, int32_t type) {
    source from = source_of(handle, type);
    if (!from.stream && !from.device) return fail(GC_ERR_INVALID_HANDLE, "no such event");
    set_registered(from.stream ? &from.stream->event_registered : &from.device->loss_registered, false);
    return GC_ERR_SUCCESS;
}

static bool loss_waits(const camera *self) { return camera_lost(self) && !self->loss_told; }

/* A loss is said in a file that another process writes, which wakes nobody. */
static GC_ERROR loss_next(camera *self, uint64_t timeout_ms) {
    uint64_t begun_ns = now_ns();
    while (!loss_waits(self)) {
        if (self->loss_killed) {
            self->loss_killed = false;
            return GC_ERR_ABORT;
        }
        if ((now_ns() - begun_ns) / 1000000 >= timeout_ms) return GC_ERR_TIMEOUT;
        usleep(LOOK_US);
    }
    self->loss_told = true;
    return GC_ERR_SUCCESS;
}

GC_API EventGetData(EVENT_HANDLE event, void *out, size_t *size, uint64_t timeout_ms) {
    camera *lost = of_handle(event, loss_handles), *self = of_handle(event, event_handles);
    if (lost) {
        GC_ERROR error = loss_next(lost, timeout_ms);
        uint64_t id = LOSS_ID;
        return error ? fail(error, "the camera is there") : answer(INFO_BUFFER, &id, sizeof id, NULL, out, size);
    }
    if (!self) return fail(GC_ERR_INVALID_HANDLE, "no event");
    frame_buffer *buffer;
    GC_ERROR error = stream_next(self, timeout_ms, &buffer);
    if (error) return fail(error, "no image");
    EVENT_NEW_BUFFER_DATA data = {buffer, buffer->user};
    return answer(INFO_BUFFER, &data, sizeof data, NULL, out, size);
}

GC_API EventGetDataInfo(EVENT_HANDLE event, const void *in, size_t in_size, int32_t what, INFO_DATATYPE *type, void *out,
                        size_t *size) {
    (void)in, (void)in_size;
    if (!of_handle(event, loss_handles)) return fail(GC_ERR_NOT_IMPLEMENTED, "information about full buffers");
    char text[16];
    snprintf(text, sizeof text, "%X", LOSS_ID);
    switch (what) {
        case EVENT_DATA_ID: return answer_text(text, type, out, size);
        case EVENT_DATA_NUMID: return answer_u64(LOSS_ID, type, out, size);
        case EVENT_DATA_VALUE: return answer(INFO_BUFFER, text, 0, type, out, size);
        default: return fail(GC_ERR_NOT_AVAILABLE, "information about a lost camera");
    }
}

GC_API EventGetInfo(EVENT_HANDLE event, int32_t what, INFO_DATATYPE *type, void *out, size_t *size) {
    camera *lost = of_handle(event, loss_handles), *self = lost ? lost : of_handle(event, event_handles);
    if (!self) return fail(GC_ERR_INVALID_HANDLE, "no event");
    switch (what) {
        case EVENT_EVENT_TYPE: return answer_i32(lost ? EVENT_MODULE : EVENT_NEW_BUFFER, type, out, size);
        case EVENT_NUM_IN_QUEUE: return answer_size(lost ? loss_waits(self) : stream_filled(self), type, out, size);
        case EVENT_NUM_FIRED: return answer_u64(lost ? camera_lost(self) : self->delivered, type, out, size);
        case EVENT_SIZE_MAX:
        case EVENT_INFO_DATA_SIZE_MAX: return answer_size(sizeof(EVENT_NEW_BUFFER_DATA), type, out, size);
        default: return fail(GC_ERR_NOT_AVAILABLE, "information about an event");
    }
}

GC_API EventFlush(EVENT_HANDLE event) {
    camera *lost = of_handle(event, loss_handles), *self = of_handle(event, event_handles);
    if (lost) lost->loss_told = camera_lost(lost);
    if (lost) return GC_ERR_SUCCESS;
    return self ? DSFlushQueue(&stream_handles[self->index], ACQ_QUEUE_OUTPUT_DISCARD)
                : fail(GC_ERR_INVALID_HANDLE, "no event");
}

GC_API EventKill(EVENT_HANDLE event) {
    camera *lost = of_handle(event, loss_handles), *self = of_handle(event, event_handles);
    if (lost) lost->loss_killed = true;
    if (lost) return GC_ERR_SUCCESS;
    if (!self) return fail(GC_ERR_INVALID_HANDLE, "no event");
    pthread_mutex_lock(&self->mutex);
    self->event_killed = true;
    pthread_cond_broadcast(&self->changed);
    pthread_mutex_unlock(&self->mutex);
    return GC_ERR_SUCCESS;
}
