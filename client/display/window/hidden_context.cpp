#include "client/display/window/hidden_context.h"

#include <utility>

#include "client/display/window/glfw.h"

namespace macula::display {

struct HiddenContext::Parts {
  GlfwLibrary library;
  GlfwWindow window;
};

Result<std::unique_ptr<HiddenContext>> HiddenContext::create() {
  if (glfwInit() != GLFW_TRUE) return glfw_error("no window system");
  auto parts = std::make_unique<Parts>();
  parts->window = open_window(64, 64, "Macula", Visibility::Hidden);
  if (!parts->window) return glfw_error("no OpenGL 3.3");
  glfwMakeContextCurrent(parts->window.get());
  return std::unique_ptr<HiddenContext>(new HiddenContext(std::move(parts)));
}

HiddenContext::HiddenContext(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}

HiddenContext::~HiddenContext() = default;

}  // namespace macula::display
