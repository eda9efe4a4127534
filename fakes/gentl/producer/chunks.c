/* Chunks: what a camera says of an image behind it, in the layout of GigE Vision 1.2. Each chunk is its data, then its
 * number and its length with the high byte first; a program reads them from the end of the buffer on. */
#include <string.h>

#include "camera.h"

enum { TAG_BYTES = 8, VALUE_BYTES = 8 };

static const uint32_t values[CHUNKS - 1] = {CHUNK_EXPOSURE_US, CHUNK_GAIN_DB, CHUNK_FRAME_ID};

size_t chunks_bytes(const camera *self) {
    return camera_u32(self, REG_CHUNK_MODE) ? TAG_BYTES + (CHUNKS - 1) * (VALUE_BYTES + TAG_BYTES) : 0;
}

static uint8_t *put_32(uint8_t *place, uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8) *place++ = (uint8_t)(value >> shift);
    return place;
}

static uint64_t bits_of(const camera *self, const frame_buffer *buffer, uint32_t chunk) {
    if (chunk == CHUNK_FRAME_ID) return buffer->frame_id;
    uint64_t bits;
    memcpy(&bits, self->registers + (chunk == CHUNK_GAIN_DB ? REG_GAIN_DB : REG_EXPOSURE_US), sizeof bits);
    return bits;
}

void chunks_append(const camera *self, frame_buffer *buffer) {
    buffer->image_bytes = camera_image_bytes(self);
    buffer->has_chunks = camera_u32(self, REG_CHUNK_MODE) && buffer->filled >= buffer->image_bytes; /* not behind a piece */
    if (!buffer->has_chunks) return;
    buffer->filled = camera_payload(self);
    uint8_t *place = put_32(put_32(buffer->base + buffer->image_bytes, CHUNK_IMAGE), (uint32_t)buffer->image_bytes);
    for (int i = 0; i < CHUNKS - 1; i++) {
        uint64_t bits = bits_of(self, buffer, values[i]);
        place = put_32(put_32(place, (uint32_t)(bits >> 32)), (uint32_t)bits);
        place = put_32(put_32(place, values[i]), VALUE_BYTES);
    }
}

GC_ERROR chunks_list(const frame_buffer *buffer, SINGLE_CHUNK_DATA *chunks, size_t *count) {
    if (!buffer->has_chunks) return GC_ERR_NO_DATA;
    if (chunks && *count < CHUNKS) return GC_ERR_BUFFER_TOO_SMALL;
    *count = CHUNKS;
    if (!chunks) return GC_ERR_SUCCESS;
    chunks[0] = (SINGLE_CHUNK_DATA){CHUNK_IMAGE, 0, buffer->image_bytes};
    for (int i = 0; i < CHUNKS - 1; i++) {
        size_t offset = buffer->image_bytes + TAG_BYTES + (size_t)i * (VALUE_BYTES + TAG_BYTES);
        chunks[i + 1] = (SINGLE_CHUNK_DATA){values[i], (ptrdiff_t)offset, VALUE_BYTES};
    }
    return GC_ERR_SUCCESS;
}
