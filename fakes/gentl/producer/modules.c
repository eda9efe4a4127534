/* Library, system, interface and device: what there is, and who may open it. */
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "library.h"

camera cameras[MAX_CAMERAS];
char system_handle, interface_handle;
char device_handles[MAX_CAMERAS], port_handles[MAX_CAMERAS], stream_handles[MAX_CAMERAS], event_handles[MAX_CAMERAS],
    loss_handles[MAX_CAMERAS];

static shared_state *state;
static bool initialised, system_open;
static __thread GC_ERROR last_error;
static __thread char last_text[160];

shared_state *shared(void) { return state; }

GC_ERROR fail(GC_ERROR error, const char *what) {
    last_error = error;
    snprintf(last_text, sizeof last_text, "%s", what);
    return error;
}

camera *of_handle(void *handle, char *handles) {
    char *place = handle;
    return place >= handles && place < handles + MAX_CAMERAS ? &cameras[place - handles] : NULL;
}

int index_of_id(const char *id) {
    for (uint32_t i = 0; state && i < state->count; i++)
        if (strcmp(id, state->cameras[i].serial) == 0) return (int)i;
    return -1;
}

int seen_camera(uint32_t number) {
    for (uint32_t i = 0; state && i < state->count; i++) {
        if (!state->cameras[i].present || state->cameras[i].lost) continue;
        if (number-- == 0) return (int)i;
    }
    return -1;
}

/* The file of a producer that was built for one set of cameras. */
#ifndef STATE_FILE
#define STATE_FILE NULL
#endif

static GC_ERROR map_state(void) {
    const char *path = getenv("FAKE_GENTL_STATE");
    if (!path) path = STATE_FILE;
    if (!path) return fail(GC_ERR_ERROR, "FAKE_GENTL_STATE does not name the file of the fake cameras");
    int file = open(path, O_RDWR | O_CLOEXEC);
    if (file < 0) return fail(GC_ERR_IO, "the file of the fake cameras cannot be opened");
    void *memory = mmap(NULL, sizeof *state, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    close(file);
    if (memory == MAP_FAILED) return fail(GC_ERR_IO, "the file of the fake cameras cannot be mapped");
    state = memory;
    if (state->magic != STATE_MAGIC || state->count > MAX_CAMERAS) {
        munmap(memory, sizeof *state);
        state = NULL;
        return fail(GC_ERR_ERROR, "the file of the fake cameras is none");
    }
    return GC_ERR_SUCCESS;
}

GC_API GCInitLib(void) {
    if (initialised) return fail(GC_ERR_RESOURCE_IN_USE, "initialised already");
    GC_ERROR error = map_state();
    initialised = !error;
    return error;
}

GC_API GCCloseLib(void) {
    if (!initialised) return fail(GC_ERR_NOT_INITIALIZED, "not initialised");
    munmap(state, sizeof *state);
    state = NULL;
    initialised = false;
    return GC_ERR_SUCCESS;
}

GC_API GCGetLastError(GC_ERROR *code, char *text, size_t *size) {
    *code = last_error;
    return answer_id(last_text, text, size);
}

static GC_ERROR library_info(int32_t what, INFO_DATATYPE *type, void *out, size_t *size) {
    switch (what) {
        case TL_INFO_ID: return answer_text("cellctl-fake-gentl", type, out, size);
        case TL_INFO_VENDOR: return answer_text("cellctl", type, out, size);
        case TL_INFO_MODEL: return answer_text("fake GenTL producer", type, out, size);
        case TL_INFO_VERSION: return answer_text("1.0", type, out, size);
        case TL_INFO_TLTYPE: return answer_text("GEV", type, out, size);
        case TL_INFO_NAME: return answer_text("fake_gentl.cti", type, out, size);
        case TL_INFO_PATHNAME: return answer_text("fake_gentl.cti", type, out, size);
        case TL_INFO_DISPLAYNAME: return answer_text("fake GenTL producer of cellctl", type, out, size);
        case TL_INFO_CHAR_ENCODING: return answer_i32(0, type, out, size);
        case TL_INFO_GENTL_VER_MAJOR: return answer_u32(1, type, out, size);
        case TL_INFO_GENTL_VER_MINOR: return answer_u32(5, type, out, size);
        default: return fail(GC_ERR_NOT_IMPLEMENTED, "information about the system");
    }
}

GC_API GCGetInfo(int32_t what, INFO_DATATYPE *type, void *out, size_t *size) {
    return library_info(what, type, out, size);
}

GC_API TLGetInfo(TL_HANDLE tl, int32_t what, INFO_DATATYPE *type, void *out, size_t *size) {
    if (tl != &system_handle) return fail(GC_ERR_INVALID_HANDLE, "no system");
    return library_info(what, type, out, size);
}

GC_API TLOpen(TL_HANDLE *tl) {
    if (!initialised) return fail(GC_ERR_NOT_INITIALIZED, "not initialised");
    if (system_open) return fail(GC_ERR_RESOURCE_IN_USE, "the system is open");
    system_open = true;
    *tl = &system_handle;
    return GC_ERR_SUCCESS;
}

GC_API TLClose(TL_HANDLE tl) {
    if (tl != &system_handle) return fail(GC_ERR_INVALID_HANDLE, "no system");
    system_open = false;
    return GC_ERR_SUCCESS;
}

GC_API TLUpdateInterfaceList(TL_HANDLE tl, bool8_t *changed, uint64_t timeout_ms) {
    (void)timeout_ms;
    if (tl != &system_handle) return fail(GC_ERR_INVALID_HANDLE, "no system");
    if (changed) *changed = 1;
    return GC_ERR_SUCCESS;
}

GC_API TLGetNumInterfaces(TL_HANDLE tl, uint32_t *count) {
    if (tl != &system_handle) return fail(GC_ERR_INVALID_HANDLE, "no system");
    *count = 1;
    return GC_ERR_SUCCESS;
}

#define INTERFACE_ID "fake-network"

GC_API TLGetInterfaceID(TL_HANDLE tl, uint32_t index, char *id, size_t *size) {
    if (tl != &system_handle) return fail(GC_ERR_INVALID_HANDLE, "no system");
    if (index) return fail(GC_ERR_INVALID_INDEX, "no such interface");
    return answer_id(INTERFACE_ID, id, size);
}

static GC_ERROR interface_info(int32_t what, INFO_DATATYPE *type, void *out, size_t *size) {
    switch (what) {
        case INTERFACE_INFO_ID: return answer_text(INTERFACE_ID, type, out, size);
        case INTERFACE_INFO_DISPLAYNAME: return answer_text("fake network", type, out, size);
        case INTERFACE_INFO_TLTYPE: return answer_text("GEV", type, out, size);
        default: return fail(GC_ERR_NOT_IMPLEMENTED, "information about the interface");
    }
}

GC_API TLGetInterfaceInfo(TL_HANDLE tl, const char *id, int32_t what, INFO_DATATYPE *type, void *out, size_t *size) {
    if (tl != &system_handle) return fail(GC_ERR_INVALID_HANDLE, "no system");
    if (strcmp(id, INTERFACE_ID)) return fail(GC_ERR_INVALID_ID, "no such interface");
    return interface_info(what, type, out, size);
}

GC_API IFGetInfo(IF_HANDLE interface, int32_t what, INFO_DATATYPE *type, void *out, size_t *size) {
    if (interface != &interface_handle) return fail(GC_ERR_INVALID_HANDLE, "no interface");
    return interface_info(what, type, out, size);
}

GC_API TLOpenInterface(TL_HANDLE tl, const char *id, IF_HANDLE *interface) {
    if (tl != &system_handle) return fail(GC_ERR_INVALID_HANDLE, "no system");
    if (strcmp(id, INTERFACE_ID)) return fail(GC_ERR_INVALID_ID, "no such interface");
    *interface = &interface_handle;
    return GC_ERR_SUCCESS;
}

GC_API IFClose(IF_HANDLE interface) {
    return interface == &interface_handle ? GC_ERR_SUCCESS : fail(GC_ERR_INVALID_HANDLE, "no interface");
}

GC_API IFGetParentTL(IF_HANDLE interface, TL_HANDLE *tl) {
    if (interface != &interface_handle) return fail(GC_ERR_INVALID_HANDLE, "no interface");
    *tl = &system_handle;
    return GC_ERR_SUCCESS;
}

GC_API IFUpdateDeviceList(IF_HANDLE interface, bool8_t *changed, uint64_t timeout_ms) {
    (void)timeout_ms;
    if (interface != &interface_handle) return fail(GC_ERR_INVALID_HANDLE, "no interface");
    if (changed) *changed = 1;
    return GC_ERR_SUCCESS;
}

GC_API IFGetNumDevices(IF_HANDLE interface, uint32_t *count) {
    if (interface != &interface_handle) return fail(GC_ERR_INVALID_HANDLE, "no interface");
    for (*count = 0; seen_camera(*count) >= 0; ++*count) {}
    return GC_ERR_SUCCESS;
}

GC_API IFGetDeviceID(IF_HANDLE interface, uint32_t index, char *id, size_t *size) {
    if (interface != &interface_handle) return fail(GC_ERR_INVALID_HANDLE, "no interface");
    int found = seen_camera(index);
    if (found < 0) return fail(GC_ERR_INVALID_INDEX, "no such camera");
    return answer_id(state->cameras[found].serial, id, size);
}

/* A camera lets go of a program that is no longer there: the heartbeat of GigE Vision. */
static bool taken_by_other(const camera_state *one) {
    if (!one->opened || one->opened == (uint32_t)getpid()) return false;
    return kill((pid_t)one->opened, 0) == 0;
}

static bool in_reach(const camera_state *one) {
    return (one->address & INTERFACE_MASK) == (INTERFACE_ADDRESS & INTERFACE_MASK);
}

static GC_ERROR device_info(int index, int32_t what, INFO_DATATYPE *type, void *out, size_t *size) {
    camera_state *one = &state->cameras[index];
    int32_t access = !in_reach(one) ? DEVICE_ACCESS_STATUS_NOACCESS
                     : one->busy || taken_by_other(one) ? DEVICE_ACCESS_STATUS_BUSY
                     : cameras[index].is_open ? DEVICE_ACCESS_STATUS_OPEN_READWRITE
                                              : DEVICE_ACCESS_STATUS_READWRITE;
    switch (what) {
        case DEVICE_INFO_ID: return answer_text(one->serial, type, out, size);
        case DEVICE_INFO_VENDOR: return answer_text("cellctl", type, out, size);
        case DEVICE_INFO_MODEL: return answer_text("fake GigE camera", type, out, size);
        case DEVICE_INFO_TLTYPE: return answer_text("GEV", type, out, size);
        case DEVICE_INFO_DISPLAYNAME: return answer_text(one->serial, type, out, size);
        case DEVICE_INFO_ACCESS_STATUS: return answer_i32(access, type, out, size);
        case DEVICE_INFO_USER_DEFINED_NAME: return answer_text(one->user_id, type, out, size);
        case DEVICE_INFO_SERIAL_NUMBER: return answer_text(one->serial, type, out, size);
        case DEVICE_INFO_VERSION: return answer_text("1.0", type, out, size);
#ifdef TICKS_PER_S
        case DEVICE_INFO_TIMESTAMP_FREQUENCY: return answer_u64(TICKS_PER_S, type, out, size);
#else
        case DEVICE_INFO_TIMESTAMP_FREQUENCY: return answer_u64(1000000000u, type, out, size);
#endif
        default: return fail(GC_ERR_NOT_IMPLEMENTED, "information about the camera");
    }
}

GC_API IFGetDeviceInfo(IF_HANDLE interface, const char *id, int32_t what, INFO_DATATYPE *type, void *out, size_t *size) {
    if (interface != &interface_handle) return fail(GC_ERR_INVALID_HANDLE, "no interface");
    int index = index_of_id(id);
    return index < 0 ? fail(GC_ERR_INVALID_ID, "no such camera") : device_info(index, what, type, out, size);
}

GC_API DevGetInfo(DEV_HANDLE device, int32_t what, INFO_DATATYPE *type, void *out, size_t *size) {
    camera *self = of_handle(device, device_handles);
    return self ? device_info(self->index, what, type, out, size) : fail(GC_ERR_INVALID_HANDLE, "no camera");
}

GC_API IFOpenDevice(IF_HANDLE interface, const char *id, int32_t access, DEV_HANDLE *device) {
    (void)access;
    if (interface != &interface_handle) return fail(GC_ERR_INVALID_HANDLE, "no interface");
    int index = index_of_id(id);
    if (index < 0) return fail(GC_ERR_INVALID_ID, "no such camera");
    camera_state *one = &state->cameras[index];
    if (one->lost || !one->present) return fail(GC_ERR_IO, "the camera does not answer");
    if (!in_reach(one)) return fail(GC_ERR_ACCESS_DENIED, "the camera is in another subnet");
    if (cameras[index].is_open) return fail(GC_ERR_RESOURCE_IN_USE, "the camera is open");
    if (one->busy || taken_by_other(one))
        return fail(GC_ERR_RESOURCE_IN_USE, "the camera is controlled by another program");
    camera_power_up(&cameras[index], index, one);
    cameras[index].is_open = true;
    one->opened = (uint32_t)getpid();
    *device = &device_handles[index];
    return GC_ERR_SUCCESS;
}

GC_API DevClose(DEV_HANDLE device) {
    camera *self = of_handle(device, device_handles);
    if (!self || !self->is_open) return fail(GC_ERR_INVALID_HANDLE, "no open camera");
    stream_close(self);
    self->is_open = false;
    self->state->opened = 0;
    pthread_cond_destroy(&self->changed);
    pthread_mutex_destroy(&self->mutex);
    return GC_ERR_SUCCESS;
}

GC_API DevGetParentIF(DEV_HANDLE device, IF_HANDLE *interface) {
    if (!of_handle(device, device_handles)) return fail(GC_ERR_INVALID_HANDLE, "no camera");
    *interface = &interface_handle;
    return GC_ERR_SUCCESS;
}

GC_API DevGetPort(DEV_HANDLE device, PORT_HANDLE *port) {
    camera *self = of_handle(device, device_handles);
    if (!self || !self->is_open) return fail(GC_ERR_INVALID_HANDLE, "no open camera");
    *port = &port_handles[self->index];
    return GC_ERR_SUCCESS;
}
