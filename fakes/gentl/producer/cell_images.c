/* The producer's end of the socket where a fake cell exposes. */
#include "cell_images.h"

#include <poll.h>
#include <stddef.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "library.h"

/* How soon a stop is noticed while the cell renders. */
#define LOOK_MS 10

bool cell_is_there(void) { return shared()->images[0] != 0; }

void cell_hang_up(camera *self) {
    if (self->exposures >= 0) close(self->exposures);
    self->exposures = -1;
}

/* Each request has its answer or the end of the connection, so an answer is never that of an older request. */
static int connected(void) {
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    size_t length = strnlen(shared()->images, ADDRESS_BYTES);
    memcpy(address.sun_path + 1, shared()->images, length);
    int file = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
    socklen_t size = (socklen_t)(offsetof(struct sockaddr_un, sun_path) + 1 + length);
    if (file >= 0 && connect(file, (struct sockaddr *)&address, size)) {
        close(file);
        file = -1;
    }
    return file;
}

static cell_request asked(const camera *self, uint64_t begun_ns) {
    return (cell_request){
        .magic = REQUEST_MAGIC,
        .camera = (uint32_t)self->index,
        .offset_x = camera_u32(self, REG_OFFSET_X),
        .offset_y = camera_u32(self, REG_OFFSET_Y),
        .width = camera_u32(self, REG_WIDTH),
        .height = camera_u32(self, REG_HEIGHT),
        .pixel_format = camera_u32(self, REG_PIXEL_FORMAT),
        .exposure_us = camera_f64(self, REG_EXPOSURE_US),
        .gain_db = camera_f64(self, REG_GAIN_DB),
        .begun_ns = begun_ns,
    };
}

/* 1: there is an answer, 0: not yet, -1: the connection has ended. */
static int looked(int file) {
    struct pollfd one = {.fd = file, .events = POLLIN};
    return poll(&one, 1, LOOK_MS) < 0 ? 0 : one.revents & POLLIN ? 1 : one.revents ? -1 : 0;
}

static bool received(int file, cell_image *image) {
    char control[CMSG_SPACE(sizeof(int))];
    struct iovec place = {.iov_base = &image->answer, .iov_len = sizeof image->answer};
    struct msghdr message = {.msg_iov = &place, .msg_iovlen = 1, .msg_control = control, .msg_controllen = sizeof control};
    ssize_t size = recvmsg(file, &message, MSG_CMSG_CLOEXEC);
    struct cmsghdr *sent = size > 0 ? CMSG_FIRSTHDR(&message) : NULL;
    if (sent && sent->cmsg_type == SCM_RIGHTS) memcpy(&image->block, CMSG_DATA(sent), sizeof image->block);
    return size == sizeof image->answer && image->answer.magic == ANSWER_MAGIC;
}

static bool wanted(const camera *self, uint32_t starts) {
    return self->acquiring && !self->ending && self->starts == starts && !camera_lost(self);
}

bool cell_expose(camera *self, uint32_t starts, uint64_t begun_ns, cell_image *image) {
    cell_request request = asked(self, begun_ns);
    if (self->exposures < 0) self->exposures = connected();
    int file = self->exposures;
    bool answered = false, open = file >= 0 && send(file, &request, sizeof request, MSG_NOSIGNAL) == sizeof request;
    while (open && !answered && wanted(self, starts)) {
        pthread_mutex_unlock(&self->mutex);
        int seen = looked(file);
        if (seen > 0) answered = received(file, image);
        pthread_mutex_lock(&self->mutex);
        open = seen == 0 || (seen > 0 && answered);
    }
    if (!answered) cell_hang_up(self);
    if (!open || (answered && image->answer.outcome == CELL_LOST)) self->state->losses++;
    return answered;
}

bool cell_fill(const cell_image *image, frame_buffer *buffer) {
    size_t size = image->answer.size;
    return size <= buffer->size && pread(image->block, buffer->base, size, 0) == (ssize_t)size;
}

void cell_let_go(cell_image *image) {
    if (image->block >= 0) close(image->block);
    image->block = -1;
}
