/* The one library of this process: which handle is which module. */
#ifndef FAKE_LIBRARY_H
#define FAKE_LIBRARY_H

#include "answers.h"
#include "camera.h"

extern camera cameras[MAX_CAMERAS];
/* Handles are addresses of these; their contents mean nothing. */
extern char system_handle, interface_handle;
extern char device_handles[MAX_CAMERAS], port_handles[MAX_CAMERAS], stream_handles[MAX_CAMERAS],
    event_handles[MAX_CAMERAS], loss_handles[MAX_CAMERAS];

shared_state *shared(void);
camera *of_handle(void *handle, char *handles); /* NULL for a handle of another kind */
int index_of_id(const char *id);                /* -1 for none */
int seen_camera(uint32_t number);               /* by its place in the list of the interface; -1 for none */
GC_ERROR interface_read(uint64_t address, void *data, size_t size);
GC_ERROR interface_write(uint64_t address, const void *data, size_t size);
size_t stream_filled(camera *self);             /* buffers that wait to be fetched */
GC_API DSFlushQueue(DS_HANDLE stream, int32_t how);
GC_ERROR fail(GC_ERROR error, const char *what);

#endif
