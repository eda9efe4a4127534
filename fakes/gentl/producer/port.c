/* Ports: registers of a camera, and the descriptions by which a program finds its way in them. */
#include <stdio.h>
#include <string.h>

#include "library.h"

__asm__(
    ".section .rodata\n"
    "camera_xml: .incbin \"" CAMERA_XML "\"\ncamera_xml_end: .byte 0\n"
    "interface_xml: .incbin \"" INTERFACE_XML "\"\ninterface_xml_end: .byte 0\n"
    "module_xml: .incbin \"" MODULE_XML "\"\nmodule_xml_end: .byte 0\n"
    ".text\n");
extern const char camera_xml[], camera_xml_end[], interface_xml[], interface_xml_end[], module_xml[], module_xml_end[];

typedef struct { const char *name, *xml; size_t size; } description;

static bool known(PORT_HANDLE port) {
    return port == &system_handle || port == &interface_handle || of_handle(port, device_handles) ||
           of_handle(port, port_handles) || of_handle(port, stream_handles);
}

static description described(PORT_HANDLE port) {
    if (of_handle(port, port_handles))
        return (description){"fake_gige_camera.xml", camera_xml, (size_t)(camera_xml_end - camera_xml)};
    if (port == &interface_handle)
        return (description){"fake_interface.xml", interface_xml, (size_t)(interface_xml_end - interface_xml)};
    return (description){"fake_module.xml", module_xml, (size_t)(module_xml_end - module_xml)};
}

GC_API GCReadPort(PORT_HANDLE port, uint64_t address, void *data, size_t *size) {
    if (!known(port)) return fail(GC_ERR_INVALID_HANDLE, "no port");
    description what = described(port);
    if (address >= XML_ADDRESS && address < XML_ADDRESS + what.size) {
        size_t left = what.size - (size_t)(address - XML_ADDRESS);
        if (*size > left) *size = left;
        memcpy(data, what.xml + (address - XML_ADDRESS), *size);
        return GC_ERR_SUCCESS;
    }
    camera *self = of_handle(port, port_handles);
    if (!self && port != &interface_handle) return fail(GC_ERR_INVALID_ADDRESS, "a module without registers");
    GC_ERROR error = self ? camera_read(self, address, data, *size) : interface_read(address, data, *size);
    return error ? fail(error, "the camera does not answer, or there is no such register") : error;
}

GC_API GCWritePort(PORT_HANDLE port, uint64_t address, const void *data, size_t *size) {
    camera *self = of_handle(port, port_handles);
    if (!self && port != &interface_handle)
        return fail(known(port) ? GC_ERR_INVALID_ADDRESS : GC_ERR_INVALID_HANDLE, "a port without registers");
    GC_ERROR error = self ? camera_write(self, address, data, *size) : interface_write(address, data, *size);
    return error ? fail(error, "the camera refuses or does not answer") : error;
}

GC_API GCReadPortStacked(PORT_HANDLE port, PORT_REGISTER_STACK_ENTRY *entries, size_t *count) {
    for (size_t i = 0; i < *count; i++) {
        size_t size = entries[i].size;
        GC_ERROR error = GCReadPort(port, entries[i].address, entries[i].data, &size);
        if (error) {
            *count = i;
            return error;
        }
    }
    return GC_ERR_SUCCESS;
}

GC_API GCWritePortStacked(PORT_HANDLE port, PORT_REGISTER_STACK_ENTRY *entries, size_t *count) {
    for (size_t i = 0; i < *count; i++) {
        size_t size = entries[i].size;
        GC_ERROR error = GCWritePort(port, entries[i].address, entries[i].data, &size);
        if (error) {
            *count = i;
            return error;
        }
    }
    return GC_ERR_SUCCESS;
}

static void url_of(PORT_HANDLE port, char *url, size_t size) {
    description what = described(port);
    snprintf(url, size, "Local:%s;%X;%zX", what.name, XML_ADDRESS, what.size);
}

GC_API GCGetPortURL(PORT_HANDLE port, char *text, size_t *size) {
    char url[128];
    if (!known(port)) return fail(GC_ERR_INVALID_HANDLE, "no port");
    url_of(port, url, sizeof url);
    return answer_id(url, text, size);
}

GC_API GCGetNumPortURLs(PORT_HANDLE port, uint32_t *count) {
    if (!known(port)) return fail(GC_ERR_INVALID_HANDLE, "no port");
    *count = 1;
    return GC_ERR_SUCCESS;
}

GC_API GCGetPortURLInfo(PORT_HANDLE port, uint32_t index, int32_t what, INFO_DATATYPE *type, void *out, size_t *size) {
    char url[128];
    if (!known(port)) return fail(GC_ERR_INVALID_HANDLE, "no port");
    if (index) return fail(GC_ERR_INVALID_INDEX, "one description only");
    description one = described(port);
    url_of(port, url, sizeof url);
    switch (what) {
        case URL_INFO_URL: return answer_text(url, type, out, size);
        case URL_INFO_SCHEMA_VER_MAJOR:
        case URL_INFO_SCHEMA_VER_MINOR:
        case URL_INFO_FILE_VER_MAJOR: return answer_i32(1, type, out, size);
        case URL_INFO_FILE_VER_MINOR:
        case URL_INFO_FILE_VER_SUBMINOR:
        case URL_INFO_SCHEME: return answer_i32(0, type, out, size);
        case URL_INFO_FILE_REGISTER_ADDRESS: return answer_u64(XML_ADDRESS, type, out, size);
        case URL_INFO_FILE_SIZE: return answer_u64(one.size, type, out, size);
        case URL_INFO_FILENAME: return answer_text(one.name, type, out, size);
        default: return fail(GC_ERR_NOT_AVAILABLE, "information about a description");
    }
}

static const char *module_of(PORT_HANDLE port) {
    if (port == &system_handle) return "TLSystem";
    if (port == &interface_handle) return "TLInterface";
    if (of_handle(port, device_handles)) return "TLDevice";
    return of_handle(port, stream_handles) ? "TLDataStream" : "Device";
}

GC_API GCGetPortInfo(PORT_HANDLE port, int32_t what, INFO_DATATYPE *type, void *out, size_t *size) {
    if (!known(port)) return fail(GC_ERR_INVALID_HANDLE, "no port");
    bool camera_port = of_handle(port, port_handles) != NULL;
    switch (what) {
        case PORT_INFO_ID: return answer_text(module_of(port), type, out, size);
        case PORT_INFO_VENDOR: return answer_text("cellctl", type, out, size);
        case PORT_INFO_MODEL: return answer_text("fake", type, out, size);
        case PORT_INFO_TLTYPE: return answer_text("GEV", type, out, size);
        case PORT_INFO_MODULE: return answer_text(module_of(port), type, out, size);
        case PORT_INFO_LITTLE_ENDIAN:
        case PORT_INFO_ACCESS_READ: return answer_bool(1, type, out, size);
        case PORT_INFO_ACCESS_WRITE: return answer_bool(camera_port || port == &interface_handle, type, out, size);
        case PORT_INFO_BIG_ENDIAN:
        case PORT_INFO_ACCESS_NA:
        case PORT_INFO_ACCESS_NI: return answer_bool(0, type, out, size);
        case PORT_INFO_VERSION: return answer_text("1.0", type, out, size);
        case PORT_INFO_PORTNAME: return answer_text(camera_port ? "Device" : "TLPort", type, out, size);
        default: return fail(GC_ERR_NOT_AVAILABLE, "information about a port");
    }
}
