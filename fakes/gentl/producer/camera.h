/* A camera of the fake: its registers, its stream, and the faults that a test has asked for. */
#ifndef FAKE_CAMERA_H
#define FAKE_CAMERA_H

#include <pthread.h>
#include <stdbool.h>

#include "gentl.h"

#define MAX_CAMERAS 8
#define MAX_BUFFERS 64
#define REGISTER_BYTES 1024
#define TEXT_BYTES 64
#define ADDRESS_BYTES 64
#define XML_ADDRESS 0x10000u
#define INTERFACE_ADDRESS 0xC0A80A01u /* 192.168.10.1 */
#define INTERFACE_MASK 0xFFFFFF00u

/* What the test shares with the producer: a file that both have mapped, all words little-endian.
 * fakes/gentl/cameras.py has the same layout. */
typedef struct {
    volatile uint32_t present, width, height, pixel_format, exposures;
    volatile uint32_t drop;       /* so many triggers are overheard */
    volatile uint32_t lost;       /* 1: the camera is gone from the network */
    volatile uint32_t incomplete; /* so many images miss packets */
    volatile uint32_t stale;      /* so many images are delivered twice */
    volatile uint32_t slow_ms;    /* exposures take so much longer */
    volatile uint32_t hang;       /* 1: register accesses do not return */
    volatile uint32_t crash;      /* 1: the next register access ends the process */
    volatile uint32_t busy;       /* 1: another program has the camera */
    volatile uint32_t opened;     /* process that has it, 0 for none */
    volatile uint32_t buffers;    /* announced now */
    volatile uint32_t pulses;     /* on Line1, so far; whoever maps the file counts up */
    volatile uint32_t wired_to;   /* Line1 is the exposure output of this camera, counted from 1; 0: none */
    volatile uint32_t strobes;    /* exposures begun, each a pulse on the exposure output */
    volatile uint32_t losses;     /* times that it has been lost: what was open before stays dead */
    volatile uint32_t address;    /* IPv4, as one number; in another subnet than INTERFACE_ADDRESS: out of reach */
    volatile uint32_t truncated;  /* so many images are shorter than they should be, and called complete */
    volatile uint32_t reserved[11];
    char serial[TEXT_BYTES], user_id[TEXT_BYTES];
} camera_state;

typedef struct {
    uint32_t magic, count;
    char images[ADDRESS_BYTES]; /* abstract address of the socket where a fake cell exposes; empty: images are drawn here */
    uint32_t reserved[46];
    camera_state cameras[MAX_CAMERAS];
} shared_state;

#define STATE_MAGIC 0x46474331u /* "FGC1" */

enum {
    REG_WIDTH = 0x00, REG_HEIGHT = 0x04, REG_OFFSET_X = 0x08, REG_OFFSET_Y = 0x0C, REG_PIXEL_FORMAT = 0x10,
    REG_PAYLOAD_SIZE = 0x14, REG_START = 0x18, REG_STOP = 0x1C, REG_MODE = 0x20, REG_TRIGGER_MODE = 0x24,
    REG_TRIGGER_SOURCE = 0x28, REG_TRIGGER_SOFTWARE = 0x2C, REG_LOCKED = 0x30, REG_TRIGGER_SELECTOR = 0x34,
    REG_EXPOSURE_US = 0x40, REG_GAIN_DB = 0x48, REG_WIDTH_MAX = 0x50, REG_HEIGHT_MAX = 0x54, REG_PACKET_SIZE = 0x58,
    REG_PACKET_DELAY = 0x5C, REG_CHUNK_MODE = 0x64, REG_VENDOR = 0x80, REG_MODEL = 0xC0, REG_SERIAL = 0x100, REG_USER_ID = 0x140,
};
enum {
    PFNC_MONO8 = 0x01080001, PFNC_MONO12 = 0x01100005, PFNC_MONO12_PACKED = 0x010C0006, PFNC_BAYER_RG8 = 0x01080009,
    PFNC_BAYER_RG12 = 0x01100011, PFNC_RGB8 = 0x02180014,
};

/* Bytes that a producer leaves at the end of each line; a packed image has none. */
#ifndef LINE_PADDING
#define LINE_PADDING 0
#endif

enum { SOURCE_SOFTWARE, SOURCE_LINE1 };

/* What a camera appends to its images with ChunkModeActive; the image itself is the first chunk. */
enum { CHUNK_IMAGE = 1, CHUNK_EXPOSURE_US = 0x1001, CHUNK_GAIN_DB = 0x1002, CHUNK_FRAME_ID = 0x1003, CHUNKS = 4 };

typedef enum { FREE, INPUT, OUTPUT, OUT } place; /* of a buffer: nowhere, waiting, filled, with the user */

typedef struct {
    uint8_t *base;
    size_t size, filled, image_bytes;
    void *user;
    bool announced, owned, new_data, incomplete, has_chunks;
    place where;
    uint64_t order, time_ns, frame_id;
    uint32_t width, height, offset_x, offset_y, pixel_format, padding;
} frame_buffer;

typedef struct camera {
    int index;
    camera_state *state;
    uint8_t registers[REGISTER_BYTES];
    bool is_open, stream_open, acquiring, stream_running, ending, event_killed, event_registered;
    bool loss_registered;
    volatile bool loss_told, loss_killed; /* of the event that says that the camera is lost */
    int exposures; /* the socket where the fake cell exposes, -1 for none */
    uint32_t triggers, starts, line_seen, losses_seen;
    uint64_t frame_id, order, delivered, last_time_ns;
    frame_buffer buffers[MAX_BUFFERS];
    pthread_t thread;
    pthread_mutex_t mutex;
    pthread_cond_t changed;
} camera;

void camera_power_up(camera *self, int index, camera_state *state);
bool camera_lost(const camera *self);
GC_ERROR camera_read(camera *self, uint64_t address, void *data, size_t size);
GC_ERROR camera_write(camera *self, uint64_t address, const void *data, size_t size);
size_t camera_line_bytes(const camera *self);
size_t camera_image_bytes(const camera *self);
size_t camera_payload(const camera *self);
size_t chunks_bytes(const camera *self); /* beyond the image; 0 without chunks */
void chunks_append(const camera *self, frame_buffer *buffer);
GC_ERROR chunks_list(const frame_buffer *buffer, SINGLE_CHUNK_DATA *chunks, size_t *count);
uint32_t camera_line(const camera *self);
uint32_t camera_u32(const camera *self, uint32_t address);
double camera_f64(const camera *self, uint32_t address);

GC_ERROR stream_open(camera *self);
void stream_close(camera *self);
GC_ERROR stream_next(camera *self, uint64_t timeout_ms, frame_buffer **found);
uint64_t now_ns(void);

#endif
