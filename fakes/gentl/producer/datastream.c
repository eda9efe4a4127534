/* Data streams, their buffers, and the event that says that one is full. */
#include <stdlib.h>
#include <string.h>

#include "library.h"

static camera *stream_of(DS_HANDLE stream) {
    camera *self = of_handle(stream, stream_handles);
    return self && self->stream_open ? self : NULL;
}

static frame_buffer *buffer_of(camera *self, BUFFER_HANDLE handle) {
    for (int i = 0; self && i < MAX_BUFFERS; i++)
        if (handle == &self->buffers[i] && self->buffers[i].announced) return &self->buffers[i];
    return NULL;
}

GC_API DevGetNumDataStreams(DEV_HANDLE device, uint32_t *count) {
    if (!of_handle(device, device_handles)) return fail(GC_ERR_INVALID_HANDLE, "no camera");
    *count = 1;
    return GC_ERR_SUCCESS;
}

GC_API DevGetDataStreamID(DEV_HANDLE device, uint32_t index, char *id, size_t *size) {
    if (!of_handle(device, device_handles)) return fail(GC_ERR_INVALID_HANDLE, "no camera");
    return index ? fail(GC_ERR_INVALID_INDEX, "no such stream") : answer_id("stream", id, size);
}

GC_API DevOpenDataStream(DEV_HANDLE device, const char *id, DS_HANDLE *stream) {
    camera *self = of_handle(device, device_handles);
    if (!self || !self->is_open) return fail(GC_ERR_INVALID_HANDLE, "no open camera");
    if (strcmp(id, "stream")) return fail(GC_ERR_INVALID_ID, "no such stream");
    *stream = &stream_handles[self->index];
    GC_ERROR error = stream_open(self);
    return error ? fail(error, "the stream is open") : error;
}

static void revoke(camera *self, frame_buffer *buffer) {
    if (buffer->owned) free(buffer->base);
    memset(buffer, 0, sizeof *buffer);
    self->state->buffers--;
}

GC_API DSClose(DS_HANDLE stream) {
    camera *self = stream_of(stream);
    if (!self) return fail(GC_ERR_INVALID_HANDLE, "no open stream");
    stream_close(self);
    for (int i = 0; i < MAX_BUFFERS; i++)
        if (self->buffers[i].announced) revoke(self, &self->buffers[i]);
    return GC_ERR_SUCCESS;
}

GC_API DSGetParentDev(DS_HANDLE stream, DEV_HANDLE *device) {
    camera *self = stream_of(stream);
    if (!self) return fail(GC_ERR_INVALID_HANDLE, "no open stream");
    *device = &device_handles[self->index];
    return GC_ERR_SUCCESS;
}

static GC_ERROR announce(camera *self, void *base, size_t size, bool owned, void *user, BUFFER_HANDLE *handle) {
    GC_ERROR error = GC_ERR_ERROR;
    pthread_mutex_lock(&self->mutex);
    for (int i = 0; i < MAX_BUFFERS && error; i++) {
        frame_buffer *buffer = &self->buffers[i];
        if (buffer->announced) continue;
        *buffer = (frame_buffer){.base = base, .size = size, .owned = owned, .user = user, .announced = true};
        self->state->buffers++;
        *handle = buffer;
        error = GC_ERR_SUCCESS;
    }
    pthread_mutex_unlock(&self->mutex);
    return error ? fail(error, "too many buffers") : error;
}

GC_API DSAnnounceBuffer(DS_HANDLE stream, void *base, size_t size, void *user, BUFFER_HANDLE *handle) {
    camera *self = stream_of(stream);
    if (!self) return fail(GC_ERR_INVALID_HANDLE, "no open stream");
    return announce(self, base, size, false, user, handle);
}

GC_API DSAllocAndAnnounceBuffer(DS_HANDLE stream, size_t size, void *user, BUFFER_HANDLE *handle) {
    camera *self = stream_of(stream);
    if (!self) return fail(GC_ERR_INVALID_HANDLE, "no open stream");
    void *base = malloc(size);
    GC_ERROR error = base ? announce(self, base, size, true, user, handle) : GC_ERR_ERROR;
    if (error) free(base);
    return error;
}

GC_API DSRevokeBuffer(DS_HANDLE stream, BUFFER_HANDLE handle, void **base, void **user) {
    camera *self = stream_of(stream);
    frame_buffer *buffer = buffer_of(self, handle);
    if (!buffer) return fail(GC_ERR_INVALID_HANDLE, "no such buffer");
    pthread_mutex_lock(&self->mutex);
    if (base) *base = buffer->owned ? NULL : buffer->base;
    if (user) *user = buffer->user;
    revoke(self, buffer);
    pthread_mutex_unlock(&self->mutex);
    return GC_ERR_SUCCESS;
}

GC_API DSQueueBuffer(DS_HANDLE stream, BUFFER_HANDLE handle) {
    camera *self = stream_of(stream);
    frame_buffer *buffer = buffer_of(self, handle);
    if (!buffer) return fail(GC_ERR_INVALID_HANDLE, "no such buffer");
    pthread_mutex_lock(&self->mutex);
    buffer->where = INPUT;
    buffer->new_data = false;
    buffer->order = ++self->order;
    pthread_cond_broadcast(&self->changed);
    pthread_mutex_unlock(&self->mutex);
    return GC_ERR_SUCCESS;
}

GC_API DSFlushQueue(DS_HANDLE stream, int32_t how) {
    camera *self = stream_of(stream);
    if (!self) return fail(GC_ERR_INVALID_HANDLE, "no open stream");
    pthread_mutex_lock(&self->mutex);
    for (int i = 0; i < MAX_BUFFERS; i++) {
        frame_buffer *buffer = &self->buffers[i];
        if (!buffer->announced) continue;
        if (how == ACQ_QUEUE_INPUT_TO_OUTPUT && buffer->where == INPUT) buffer->where = OUTPUT;
        if (how == ACQ_QUEUE_OUTPUT_DISCARD && buffer->where == OUTPUT) buffer->where = FREE;
        if (how == ACQ_QUEUE_ALL_TO_INPUT) buffer->where = INPUT;
        if (how == ACQ_QUEUE_UNQUEUED_TO_INPUT && (buffer->where == FREE || buffer->where == OUT)) buffer->where = INPUT;
        if (how == ACQ_QUEUE_ALL_DISCARD) buffer->where = FREE;
    }
    pthread_mutex_unlock(&self->mutex);
    return GC_ERR_SUCCESS;
}

static GC_ERROR set_running(DS_HANDLE stream, bool running) {
    camera *self = stream_of(stream);
    if (!self) return fail(GC_ERR_INVALID_HANDLE, "no open stream");
    pthread_mutex_lock(&self->mutex);
    bool was = self->stream_running;
    self->stream_running = running;
    pthread_cond_broadcast(&self->changed);
    pthread_mutex_unlock(&self->mutex);
    return was == running ? fail(GC_ERR_RESOURCE_IN_USE, "the stream runs, or does not, already") : GC_ERR_SUCCESS;
}

GC_API DSStartAcquisition(DS_HANDLE stream, int32_t flags, uint64_t count) {
    (void)flags, (void)count;
    return set_running(stream, true);
}

GC_API DSStopAcquisition(DS_HANDLE stream, int32_t flags) {
    (void)flags;
    return set_running(stream, false);
}

static size_t in_place(camera *self, place where) {
    size_t count = 0;
    for (int i = 0; i < MAX_BUFFERS; i++) count += self->buffers[i].announced && self->buffers[i].where == where;
    return count;
}

size_t stream_filled(camera *self) { return in_place(self, OUTPUT); }

GC_API DSGetInfo(DS_HANDLE stream, int32_t what, INFO_DATATYPE *type, void *out, size_t *size) {
    camera *self = stream_of(stream);
    if (!self) return fail(GC_ERR_INVALID_HANDLE, "no open stream");
    switch (what) {
        case STREAM_INFO_ID: return answer_text("stream", type, out, size);
        case STREAM_INFO_NUM_DELIVERED: return answer_u64(self->delivered, type, out, size);
        case STREAM_INFO_NUM_UNDERRUN: return answer_u64(0, type, out, size);
        case STREAM_INFO_NUM_ANNOUNCED: return answer_size(self->state->buffers, type, out, size);
        case STREAM_INFO_NUM_QUEUED: return answer_size(in_place(self, INPUT), type, out, size);
        case STREAM_INFO_NUM_AWAIT_DELIVERY: return answer_size(in_place(self, OUTPUT), type, out, size);
        case STREAM_INFO_NUM_STARTED: return answer_u64(self->delivered, type, out, size);
        case STREAM_INFO_PAYLOAD_SIZE: return answer_size(camera_payload(self), type, out, size);
        case STREAM_INFO_IS_GRABBING: return answer_bool(self->stream_running, type, out, size);
        case STREAM_INFO_DEFINES_PAYLOADSIZE: return answer_bool(0, type, out, size);
        case STREAM_INFO_TLTYPE: return answer_text("GEV", type, out, size);
        case STREAM_INFO_NUM_CHUNKS_MAX: return answer_size(CHUNKS, type, out, size);
        case STREAM_INFO_BUF_ANNOUNCE_MIN: return answer_size(1, type, out, size);
        case STREAM_INFO_BUF_ALIGNMENT: return answer_size(1, type, out, size);
        default: return fail(GC_ERR_NOT_AVAILABLE, "information about the stream");
    }
}

GC_API DSGetBufferID(DS_HANDLE stream, uint32_t index, BUFFER_HANDLE *handle) {
    camera *self = stream_of(stream);
    for (int i = 0; self && i < MAX_BUFFERS; i++) {
        if (!self->buffers[i].announced || index--) continue;
        *handle = &self->buffers[i];
        return GC_ERR_SUCCESS;
    }
    return fail(self ? GC_ERR_INVALID_INDEX : GC_ERR_INVALID_HANDLE, "no such buffer");
}

GC_API DSGetBufferInfo(DS_HANDLE stream, BUFFER_HANDLE handle, int32_t what, INFO_DATATYPE *type, void *out, size_t *size) {
    frame_buffer *one = buffer_of(stream_of(stream), handle);
    if (!one) return fail(GC_ERR_INVALID_HANDLE, "no such buffer");
    switch (what) {
        case BUFFER_INFO_BASE: return answer_pointer(one->base, type, out, size);
        case BUFFER_INFO_SIZE: return answer_size(one->size, type, out, size);
        case BUFFER_INFO_USER_PTR: return answer_pointer(one->user, type, out, size);
#ifdef TICKS_PER_S /* of a camera that counts ticks, and a producer that does not convert them */
        case BUFFER_INFO_TIMESTAMP:
            return answer_u64((uint64_t)((double)one->time_ns * 1e-9 * TICKS_PER_S), type, out, size);
#else
        case BUFFER_INFO_TIMESTAMP:
        case BUFFER_INFO_TIMESTAMP_NS: return answer_u64(one->time_ns, type, out, size);
#endif
        case BUFFER_INFO_NEW_DATA: return answer_bool(one->new_data, type, out, size);
        case BUFFER_INFO_IS_QUEUED: return answer_bool(one->where == INPUT || one->where == OUTPUT, type, out, size);
        case BUFFER_INFO_IS_ACQUIRING: return answer_bool(0, type, out, size);
        case BUFFER_INFO_IS_INCOMPLETE: return answer_bool(one->incomplete, type, out, size);
        case BUFFER_INFO_TLTYPE: return answer_text("GEV", type, out, size);
        case BUFFER_INFO_SIZE_FILLED:
        case BUFFER_INFO_DATA_SIZE: return answer_size(one->filled, type, out, size);
        case BUFFER_INFO_WIDTH: return answer_size(one->width, type, out, size);
        case BUFFER_INFO_HEIGHT:
        case BUFFER_INFO_DELIVERED_IMAGEHEIGHT: return answer_size(one->height, type, out, size);
        case BUFFER_INFO_XOFFSET: return answer_size(one->offset_x, type, out, size);
        case BUFFER_INFO_YOFFSET: return answer_size(one->offset_y, type, out, size);
        case BUFFER_INFO_XPADDING: return answer_size(one->padding, type, out, size);
        case BUFFER_INFO_YPADDING:
        case BUFFER_INFO_IMAGEOFFSET: return answer_size(0, type, out, size);
        case BUFFER_INFO_DELIVERED_CHUNKPAYLOADSIZE: return answer_size(one->has_chunks ? one->filled : 0, type, out, size);
        case BUFFER_INFO_FRAMEID: return answer_u64(one->frame_id, type, out, size);
        case BUFFER_INFO_IMAGEPRESENT: return answer_bool(one->new_data, type, out, size);
        case BUFFER_INFO_PAYLOADTYPE: return answer_size(PAYLOAD_TYPE_IMAGE, type, out, size);
        case BUFFER_INFO_PIXELFORMAT: return answer_u64(one->pixel_format, type, out, size);
        case BUFFER_INFO_PIXELFORMAT_NAMESPACE: return answer_u64(PIXELFORMAT_NAMESPACE_PFNC_32, type, out, size);
        case BUFFER_INFO_PIXEL_ENDIANNESS: return answer_i32(1, type, out, size);
        case BUFFER_INFO_DATA_LARGER_THAN_BUFFER: return answer_bool(0, type, out, size);
        case BUFFER_INFO_CONTAINS_CHUNKDATA: return answer_bool(one->has_chunks, type, out, size);
        default: return fail(GC_ERR_NOT_AVAILABLE, "information about the buffer");
    }
}

GC_API DSGetBufferChunkData(DS_HANDLE stream, BUFFER_HANDLE handle, SINGLE_CHUNK_DATA *chunks, size_t *count) {
    frame_buffer *one = buffer_of(stream_of(stream), handle);
    if (!one) return fail(GC_ERR_INVALID_HANDLE, "no such buffer");
    GC_ERROR error = chunks_list(one, chunks, count);
    return error ? fail(error, "no chunks, or no room for them") : error;
}

GC_API DSGetNumBufferParts(DS_HANDLE stream, BUFFER_HANDLE handle, uint32_t *count) {
    (void)stream, (void)handle;
    *count = 0;
    return fail(GC_ERR_NO_DATA, "no parts");
}

GC_API DSGetBufferPartInfo(DS_HANDLE stream, BUFFER_HANDLE handle, uint32_t part, int32_t what, INFO_DATATYPE *type,
                           void *out, size_t *size) {
    (void)stream, (void)handle, (void)part, (void)what, (void)type, (void)out, (void)size;
    return fail(GC_ERR_NO_DATA, "no parts");
}

/* Of GenTL 1.6: a consumer asks whether they are there, and gets along without them. */
GC_API DSAnnounceCompositeBuffer(void) { return fail(GC_ERR_NOT_IMPLEMENTED, "composite buffers"); }
GC_API DSGetNumFlows(void) { return fail(GC_ERR_NOT_IMPLEMENTED, "flows"); }
GC_API DSGetFlowInfo(void) { return fail(GC_ERR_NOT_IMPLEMENTED, "flows"); }
GC_API DSGetNumBufferSegments(void) { return fail(GC_ERR_NOT_IMPLEMENTED, "segments"); }
GC_API DSGetBufferSegmentInfo(void) { return fail(GC_ERR_NOT_IMPLEMENTED, "segments"); }
