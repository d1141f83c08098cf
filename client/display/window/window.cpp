#include "client/display/window/window.h"

#include <cstdio>
#include <utility>
#include <vector>

#include "client/display/gl/picture_pass.h"
#include "client/display/window/glfw.h"
#include "client/display/window/input_tracker.h"
#include "client/display/window/layout.h"
#include "shared/base/check.h"

namespace macula::display {
namespace {

constexpr const char* kHelp =
    "cursor        gaze\n"
    "right drag    turn the head\n"
    "W A S D       move forward, left, back, right\n"
    "Q E           move down, up\n"
    "F             freeze the gaze where it is, and release it\n"
    "R             back to the start\n"
    "H             this help\n"
    "Esc           close\n";

PictureSize framebuffer_size(GLFWwindow* window) {
  PictureSize size;
  glfwGetFramebufferSize(window, &size.width_px, &size.height_px);
  return size;
}

bool is_down(GLFWwindow* window, int key) {
  return glfwGetKey(window, key) == GLFW_PRESS;
}

/// Cursor positions come in screen units, which are not pixels on every display.
Devices read_devices(GLFWwindow* window) {
  double x = 0.0, y = 0.0;
  int width = 0, height = 0;
  glfwGetCursorPos(window, &x, &y);
  glfwGetWindowSize(window, &width, &height);
  const auto framebuffer = framebuffer_size(window);
  Devices devices;
  if (width > 0 && height > 0) {
    devices.cursor_x_px = static_cast<float>(x * framebuffer.width_px / width);
    devices.cursor_y_px = static_cast<float>(y * framebuffer.height_px / height);
  }
  devices.drag_button = glfwGetMouseButton(window, GLFW_MOUSE_BUTTON_RIGHT) == GLFW_PRESS;
  devices.left = is_down(window, GLFW_KEY_A);
  devices.right = is_down(window, GLFW_KEY_D);
  devices.down = is_down(window, GLFW_KEY_Q);
  devices.up = is_down(window, GLFW_KEY_E);
  devices.back = is_down(window, GLFW_KEY_S);
  devices.forward = is_down(window, GLFW_KEY_W);
  return devices;
}

void on_key(GLFWwindow* window, int key, int /*scancode*/, int action, int /*modifiers*/) {
  if (action != GLFW_PRESS) return;
  auto& input = *static_cast<InputTracker*>(glfwGetWindowUserPointer(window));
  switch (key) {
    case GLFW_KEY_ESCAPE:
      return glfwSetWindowShouldClose(window, GLFW_TRUE);
    case GLFW_KEY_F:
      return input.toggle_freeze();
    case GLFW_KEY_R:
      return input.request_reset();
    case GLFW_KEY_H:
      std::fputs(kHelp, stdout);
      std::fflush(stdout);
      return;
    default:
      return;
  }
}

}  // namespace

/// Destroyed from the last to the first: the pass while its context lives, GLFW at the very end.
struct Window::Parts {
  GlfwLibrary library;
  GlfwWindow window;
  InputTracker input;
  std::unique_ptr<PicturePass> pass;
  std::vector<PictureSize> pictures;  ///< of the last show
  Overlay overlay;

  std::vector<image::Rect> places() const {
    return place_side_by_side(pictures, framebuffer_size(window.get()));
  }
  void draw() { pass->draw(framebuffer_size(window.get()), places(), overlay.gaze); }
};

Result<std::unique_ptr<Window>> Window::create(const WindowOptions& options) {
  if (glfwInit() != GLFW_TRUE) return glfw_error("no window system");
  auto parts = std::make_unique<Parts>();
  parts->window =
      open_window(options.width_px, options.height_px, options.title, Visibility::Shown);
  if (!parts->window) return glfw_error("no window with OpenGL 3.3");
  GLFWwindow* window = parts->window.get();
  glfwMakeContextCurrent(window);
  glfwSwapInterval(options.vsync == Vsync::On ? 1 : 0);
  auto pass = PicturePass::create();
  if (!pass) return base::forward(pass);
  parts->pass = std::move(*pass);
  glfwSetWindowUserPointer(window, &parts->input);
  glfwSetKeyCallback(window, on_key);
  return std::unique_ptr<Window>(new Window(std::move(parts)));
}

Window::Window(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}

Window::~Window() = default;

void Window::show(std::span<const image::Plane<Rgb8>* const> eyes, const Overlay& overlay) {
  MACULA_CHECK(eyes.size() == 1 || eyes.size() == 2, "a window shows one or two eyes");
  parts_->pictures.clear();
  for (const auto* eye : eyes) parts_->pictures.push_back({eye->width(), eye->height()});
  parts_->overlay = overlay;
  parts_->pass->upload(eyes);
  parts_->draw();
  glfwSwapBuffers(parts_->window.get());
}

Input Window::poll() {
  glfwPollEvents();
  return parts_->input.poll(read_devices(parts_->window.get()), parts_->places());
}

bool Window::should_close() const {
  return glfwWindowShouldClose(parts_->window.get()) == GLFW_TRUE;
}

image::Plane<Rgb8> Window::capture() {
  // After a swap the back buffer is anyone's, so the pictures are drawn into it again.
  parts_->draw();
  return PicturePass::read_back(framebuffer_size(parts_->window.get()));
}

}  // namespace macula::display
