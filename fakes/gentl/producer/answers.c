#include "answers.h"

#include <string.h>

GC_ERROR answer(INFO_DATATYPE type, const void *value, size_t bytes, INFO_DATATYPE *type_out, void *out, size_t *size) {
    if (!size) return GC_ERR_INVALID_PARAMETER;
    if (type_out) *type_out = type;
    if (out) {
        if (*size < bytes) return GC_ERR_BUFFER_TOO_SMALL;
        memcpy(out, value, bytes);
    }
    *size = bytes;
    return GC_ERR_SUCCESS;
}

GC_ERROR answer_text(const char *text, INFO_DATATYPE *type_out, void *out, size_t *size) {
    return answer(INFO_STRING, text, strlen(text) + 1, type_out, out, size);
}

GC_ERROR answer_i32(int32_t value, INFO_DATATYPE *type_out, void *out, size_t *size) {
    return answer(INFO_INT32, &value, sizeof value, type_out, out, size);
}

GC_ERROR answer_u32(uint32_t value, INFO_DATATYPE *type_out, void *out, size_t *size) {
    return answer(INFO_UINT32, &value, sizeof value, type_out, out, size);
}

GC_ERROR answer_u64(uint64_t value, INFO_DATATYPE *type_out, void *out, size_t *size) {
    return answer(INFO_UINT64, &value, sizeof value, type_out, out, size);
}

GC_ERROR answer_size(size_t value, INFO_DATATYPE *type_out, void *out, size_t *size) {
    return answer(INFO_SIZET, &value, sizeof value, type_out, out, size);
}

GC_ERROR answer_bool(int value, INFO_DATATYPE *type_out, void *out, size_t *size) {
    bool8_t truth = value != 0;
    return answer(INFO_BOOL8, &truth, sizeof truth, type_out, out, size);
}

GC_ERROR answer_pointer(void *value, INFO_DATATYPE *type_out, void *out, size_t *size) {
    return answer(INFO_PTR, &value, sizeof value, type_out, out, size);
}

GC_ERROR answer_id(const char *text, char *out, size_t *size) {
    return answer(INFO_STRING, text, strlen(text) + 1, NULL, out, size);
}
