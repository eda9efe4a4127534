/* Registers of the interface: its address, and those of the cameras on it. */
#include <string.h>

#include "library.h"

enum {
    REG_DEVICE_SELECTOR = 0x00, REG_DEVICE_LAST = 0x04, REG_SUBNET_ADDRESS = 0x08, REG_SUBNET_MASK = 0x0C,
    REG_DEVICE_ADDRESS = 0x10, REG_DEVICE_MASK = 0x14, REG_DEVICE_ID = 0x40,
};

static uint32_t selected;

static uint32_t last_device(void) {
    uint32_t count = 0;
    while (seen_camera(count) >= 0) count++;
    return count ? count - 1 : 0;
}

GC_ERROR interface_read(uint64_t address, void *data, size_t size) {
    int found = seen_camera(selected);
    if (address == REG_DEVICE_ID && size == TEXT_BYTES && found >= 0) {
        memcpy(data, shared()->cameras[found].serial, size);
        return GC_ERR_SUCCESS;
    }
    if (size != sizeof(uint32_t)) return GC_ERR_INVALID_ADDRESS;
    uint32_t value;
    switch (address) {
        case REG_DEVICE_SELECTOR: value = selected; break;
        case REG_DEVICE_LAST: value = last_device(); break;
        case REG_SUBNET_ADDRESS: value = INTERFACE_ADDRESS; break;
        case REG_DEVICE_ADDRESS: value = found < 0 ? 0 : shared()->cameras[found].address; break;
        case REG_SUBNET_MASK:
        case REG_DEVICE_MASK: value = INTERFACE_MASK; break;
        default: return GC_ERR_INVALID_ADDRESS;
    }
    memcpy(data, &value, sizeof value);
    return GC_ERR_SUCCESS;
}

GC_ERROR interface_write(uint64_t address, const void *data, size_t size) {
    if (address != REG_DEVICE_SELECTOR || size != sizeof selected) return GC_ERR_INVALID_ADDRESS;
    memcpy(&selected, data, sizeof selected);
    return GC_ERR_SUCCESS;
}
