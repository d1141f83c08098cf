// OpenXR with what this room uses of the platform, once. Internal to this room.
#pragma once

#define XR_USE_PLATFORM_XLIB
#define XR_USE_GRAPHICS_API_OPENGL
#define XR_USE_TIMESPEC
#include <GL/glx.h>
#include <X11/Xlib.h>
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>
#include <time.h>

// Xlib's names for plain numbers stand in the way of enumerators.
#undef None
#undef Success
#undef Status
#undef Always
#undef Bool

namespace macula::display {

/// One of OpenXR's structures with its type set and the rest zero.
template <class Structure>
Structure xr_struct(XrStructureType type) {
  Structure structure{};
  structure.type = type;
  return structure;
}

}  // namespace macula::display
