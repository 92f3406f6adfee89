/* picture MODEL FILE.png [ADDRESS]: a picture of the model's reflection lines, from the daemon at
 * ADDRESS or a private one.
 *
 *     cc picture.c $(pkg-config --cflags --libs sheen) -o picture */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <sheen.h>

static int write_file(const char *path, const void *bytes, size_t n_bytes)
{
    FILE *file = fopen(path, "wb");
    int is_good = file && fwrite(bytes, 1, n_bytes, file) == n_bytes;
    return file && fclose(file) == 0 && is_good;
}

int main(int argc, char **argv)
{
    struct sheen_error error;
    struct sheen_connect_options options = SHEEN_CONNECT_DEFAULTS;
    struct sheen_request request = SHEEN_REQUEST_DEFAULTS;
    struct sheen_frame frame = SHEEN_FRAME_DEFAULTS;
    struct sheen_session *session = NULL;
    uint8_t *bytes;
    size_t n_bytes;
    int code = 0;

    if (argc < 3) {
        fprintf(stderr, "usage: picture MODEL FILE.png [ADDRESS]\n");
        return 2;
    }
    if (sheen_read_file(SHEEN_FILE_MODEL, argv[1], &bytes, &n_bytes, &error)) {
        fprintf(stderr, "picture: %s\n", error.text);
        return sheen_status_exit_code(error.status);
    }
    sheen_file_id(bytes, n_bytes, request.model_id);
    options.address = argc > 3 ? argv[3] : NULL;
    memcpy(options.model_id, request.model_id, SHEEN_ID_BYTES);
    request.width_px = 320;
    request.height_px = 240;
    if (sheen_connect(&session, &options, &error) ||
        sheen_upload(session, SHEEN_FILE_MODEL, request.model_id, bytes, n_bytes, argv[1], NULL,
                     &error) ||
        sheen_render(session, &request, NULL, &frame, &error)) {
        fprintf(stderr, "picture: %s\n", error.text);
        code = sheen_status_exit_code(error.status);
    } else if (!write_file(argv[2], frame.data, frame.data_bytes)) {
        fprintf(stderr, "picture: cannot write %s\n", argv[2]);
        code = 3;
    }
    free(bytes);
    sheen_frame_finish(&frame);
    sheen_close(session);
    return code;
}
