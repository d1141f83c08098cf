#include "client/display/window/glfw.h"

namespace macula::display {

tl::unexpected<Error> glfw_error(const std::string& what) {
  const char* reason = nullptr;
  glfwGetError(&reason);
  return base::runtime_error(reason ? what + ": " + reason : what, "window",
                             "without a display use --display headless");
}

GlfwWindow open_window(int width_px, int height_px, const std::string& title,
                       Visibility visibility) {
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  glfwWindowHint(GLFW_DEPTH_BITS, 0);
  glfwWindowHint(GLFW_STENCIL_BITS, 0);
  glfwWindowHint(GLFW_VISIBLE, visibility == Visibility::Shown ? GLFW_TRUE : GLFW_FALSE);
  return GlfwWindow(glfwCreateWindow(width_px, height_px, title.c_str(), nullptr, nullptr));
}

}  // namespace macula::display
