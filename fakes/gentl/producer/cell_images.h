/* Images that a fake cell renders: for each exposure one request and one answer over a socket, and the image as a
 * descriptor of memory. fakes/gentl/exposures.py has the same layout. */
#ifndef FAKE_CELL_IMAGES_H
#define FAKE_CELL_IMAGES_H

#include "camera.h"

typedef struct {
    uint32_t magic, camera, offset_x, offset_y, width, height, pixel_format, reserved;
    double exposure_us, gain_db;
    uint64_t begun_ns;
} cell_request;

typedef struct {
    uint32_t magic, outcome, width, height, size, reserved;
} cell_answer;

#define REQUEST_MAGIC 0x51474346u /* "FCGQ" */
#define ANSWER_MAGIC 0x41474346u  /* "FCGA" */

enum { CELL_WHOLE, CELL_INCOMPLETE, CELL_STALE, CELL_LOST };

typedef struct {
    cell_answer answer;
    int block; /* descriptor of the memory with the image, -1 for none */
} cell_image;

/* Whether this camera looks into a fake cell. */
bool cell_is_there(void);
/* Have the cell expose. Called with the mutex, which is let go while the cell renders. False when the acquisition has
 * ended before an answer came, or the cell is gone. */
bool cell_expose(camera *self, uint32_t starts, uint64_t begun_ns, cell_image *image);
/* Copy an image into a buffer that is large enough. */
bool cell_fill(const cell_image *image, frame_buffer *buffer);
void cell_let_go(cell_image *image);
void cell_hang_up(camera *self);

#endif
