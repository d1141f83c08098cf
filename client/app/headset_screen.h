// HeadsetScreen: an OpenXR headset as a Screen. The runtime paces the refreshes, knows the eyes and
// predicts the head. Belongs to the thread that made it.
#pragma once

#include <memory>

#include "client/app/screen.h"

namespace macula::client_app {

/// Errors: no X server, no OpenXR runtime, no headset.
Result<std::unique_ptr<Screen>> make_headset_screen(const ClientConfig& config,
                                                    const base::Clock& clock);

}  // namespace macula::client_app
