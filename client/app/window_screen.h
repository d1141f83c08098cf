// WindowScreen: the desktop window as a Screen. Cursor, drag and keys become the viewer's head and
// gaze. Belongs to the main thread.
#pragma once

#include <memory>

#include "client/app/screen.h"

namespace macula::client_app {

/// Errors: no display, or no OpenGL 3.3.
Result<std::unique_ptr<Screen>> make_window_screen(const ClientConfig& config,
                                                   const base::Clock& clock);

}  // namespace macula::client_app
