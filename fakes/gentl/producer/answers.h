/* Answers of GenTL's information calls: a size is asked for first, with a null pointer, then the value. */
#ifndef FAKE_ANSWERS_H
#define FAKE_ANSWERS_H

#include "gentl.h"

GC_ERROR answer(INFO_DATATYPE type, const void *value, size_t bytes, INFO_DATATYPE *type_out, void *out, size_t *size);
GC_ERROR answer_text(const char *text, INFO_DATATYPE *type_out, void *out, size_t *size);
GC_ERROR answer_i32(int32_t value, INFO_DATATYPE *type_out, void *out, size_t *size);
GC_ERROR answer_u32(uint32_t value, INFO_DATATYPE *type_out, void *out, size_t *size);
GC_ERROR answer_u64(uint64_t value, INFO_DATATYPE *type_out, void *out, size_t *size);
GC_ERROR answer_size(size_t value, INFO_DATATYPE *type_out, void *out, size_t *size);
GC_ERROR answer_bool(int value, INFO_DATATYPE *type_out, void *out, size_t *size);
GC_ERROR answer_pointer(void *value, INFO_DATATYPE *type_out, void *out, size_t *size);
GC_ERROR answer_id(const char *text, char *out, size_t *size);

#endif
