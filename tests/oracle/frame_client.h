/* Frames of a model as the planes that libsheen decodes: what `sheen render` would store in an EXR file, without the
 * file. */
#ifndef SHEEN_TESTS_ORACLE_FRAME_CLIENT_H
#define SHEEN_TESTS_ORACLE_FRAME_CLIENT_H

#include <string>

#include "client/lib/sheen.h"
#include "tests/oracle/render.h"
#include "tests/oracle/view.h"

class frame_client
{
  public:
    /* Connects to the daemon at $SHEEN_SERVER, and uploads the model file. Throws std::runtime_error
     * with the library's message. */
    explicit frame_client(const std::string &model_path);
    ~frame_client();
    frame_client(const frame_client &) = delete;
    frame_client &operator=(const frame_client &) = delete;

    /* Positions, normals and Ptex coordinates of a view. The camera of a view that sheen chooses is
     * the frame's. Throws as the constructor. */
    planes draw(view *view);

  private:
    sheen_session *session = nullptr;
    sheen_request request = sheen_request_defaults();
    sheen_frame frame = sheen_frame_defaults();
    sheen_error error = {};
};

#endif
