// What every use of GLFW begins with. Internal to this room.
#pragma once

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <memory>
#include <string>

#include "shared/base/result.h"

namespace macula::display {

/// GLFW's initialisation: one of these at a time.
struct GlfwLibrary {
  ~GlfwLibrary() { glfwTerminate(); }
};

struct DestroyGlfwWindow {
  void operator()(GLFWwindow* window) const { glfwDestroyWindow(window); }
};
using GlfwWindow = std::unique_ptr<GLFWwindow, DestroyGlfwWindow>;

/// GLFW's own words for its last error.
tl::unexpected<Error> glfw_error(const std::string& what);

enum class Visibility { Shown, Hidden };
/// A window with a context of OpenGL 3.3 core; null where there is none.
GlfwWindow open_window(int width_px, int height_px, const std::string& title,
                       Visibility visibility);

}  // namespace macula::display
