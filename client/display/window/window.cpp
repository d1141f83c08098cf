#include "client/display/window/window.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "client/display/window/glfw.h"
#include "client/display/window/input_tracker.h"
#include "client/display/window/layout.h"
#include "shared/base/check.h"

namespace macula::display {
namespace {

const std::vector<std::string> kKeys = {
    "cursor      gaze",
    "right drag  turn the head",
    "w a s d     move",
    "q e         move down, up",
    "r           back to the start",
    "f           freeze the gaze, release it",
    "b           both eyes, left, right",
    "g           rings at 5, 10, 25 degrees",
    "o           stage times and figures",
    "p           screenshot",
    "c           freeze and compare: wipe, flip, difference",
    "x           swap what is compared",
    "1 2         another first, second to compare",
    "h           this help",
    "esc         close",
};

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

/// What keys change; the window's user pointer.
struct Controls {
  InputTracker input;
  Choices choices;
};

Choices::Eyes next(Choices::Eyes eyes) {
  switch (eyes) {
    case Choices::Eyes::Both:
      return Choices::Eyes::Left;
    case Choices::Eyes::Left:
      return Choices::Eyes::Right;
    case Choices::Eyes::Right:
      break;
  }
  return Choices::Eyes::Both;
}

void on_key(GLFWwindow* window, int key, int /*scancode*/, int action, int /*modifiers*/) {
  if (action != GLFW_PRESS) return;
  auto& [input, choices] = *static_cast<Controls*>(glfwGetWindowUserPointer(window));
  switch (key) {
    case GLFW_KEY_ESCAPE:
      return glfwSetWindowShouldClose(window, GLFW_TRUE);
    case GLFW_KEY_F:
      return input.toggle_freeze();
    case GLFW_KEY_R:
      return input.request_reset();
    case GLFW_KEY_P:
      return input.request_screenshot();
    case GLFW_KEY_B:
      choices.eyes = next(choices.eyes);
      return;
    case GLFW_KEY_G:
      choices.rings = !choices.rings;
      return;
    case GLFW_KEY_O:
      choices.dashboard = !choices.dashboard;
      return;
    case GLFW_KEY_H:
      choices.help = !choices.help;
      return;
    case GLFW_KEY_C:
      choices.comparison = next(choices.comparison);
      return;
    case GLFW_KEY_X:
      choices.swapped = !choices.swapped;
      return;
    case GLFW_KEY_1:
    case GLFW_KEY_2:
      ++choices.ways[key == GLFW_KEY_1 ? 0 : 1];
      return;
    default:
      return;
  }
}

bool is_chosen(Choices::Eyes eyes, std::size_t eye, std::size_t count) {
  if (eyes == Choices::Eyes::Both || count == 1) return true;
  return (eyes == Choices::Eyes::Left) == (eye == 0);
}

/// One picture of two, as chosen; `wipe`: where the cursor stands, in widths of the picture.
image::Plane<Rgb8> composed(const Choices& choices, float wipe, const image::Plane<Rgb8>& first,
                            const image::Plane<Rgb8>& second) {
  const auto& left = choices.swapped ? second : first;
  const auto& right = choices.swapped ? first : second;
  switch (choices.comparison) {
    case ComparisonView::Wipe:
      return wiped(left, right, wipe);
    case ComparisonView::Difference:
      return difference_map(left, right);
    case ComparisonView::Flip:
    case ComparisonView::Off:
      break;
  }
  return left;
}

/// Letters grow with the window, so that they can be read on any.
int dot_size_px(const PictureSize& framebuffer) {
  constexpr int kHeightPerDot_px = 600;
  return std::max(1, framebuffer.height_px / kHeightPerDot_px);
}

}  // namespace

/// Destroyed from the last to the first: the pass while its context lives, GLFW at the very end.
struct Window::Parts {
  GlfwLibrary library;
  GlfwWindow window;
  Controls controls;
  std::unique_ptr<PicturePass> pass;
  // Of the last show: the eyes first, then the panels over them.
  std::vector<std::size_t> eyes;  ///< which
  std::vector<PictureSize> pictures;
  std::vector<PictureMarks> marks;
  std::vector<image::Plane<Rgb8>> panels;
  std::array<image::Plane<Rgb8>, 2> composed;  ///< of a comparison, by eye
  float wipe = 0.5F;                           ///< where the cursor last was, in widths

  std::vector<image::Rect> places() const {
    return place_side_by_side(pictures, framebuffer_size(window.get()));
  }
  /// What is compared, where it is and something is chosen; else null.
  const Compared* compared(const Overlay& overlay) const {
    return controls.choices.comparison == ComparisonView::Off ? nullptr : overlay.compared;
  }
  void make_panels(const Overlay& overlay);
  void draw();
};

void Window::Parts::make_panels(const Overlay& overlay) {
  const int dot_px = dot_size_px(framebuffer_size(window.get()));
  panels.clear();
  if (controls.choices.dashboard && overlay.dashboard != nullptr)
    panels.push_back(draw_dashboard(*overlay.dashboard, dot_px));
  if (const Compared* both = compared(overlay)) {
    panels.push_back(draw_lines(both->lines, dot_px));
  }
  if (controls.choices.help) panels.push_back(draw_lines(kKeys, dot_px));
}

/// Panels lie one below the other in the upper left corner.
void Window::Parts::draw() {
  std::vector<image::Rect> all = places();
  int top_px = 0;
  for (const auto& panel : panels) {
    all.push_back({0, top_px, panel.width(), panel.height()});
    top_px += panel.height();
  }
  pass->draw(framebuffer_size(window.get()), all, marks);
}

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
  glfwSetWindowUserPointer(window, &parts->controls);
  glfwSetKeyCallback(window, on_key);
  return std::unique_ptr<Window>(new Window(std::move(parts)));
}

Window::Window(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}

Window::~Window() = default;

void Window::show(std::span<const image::Plane<Rgb8>* const> eyes, const Overlay& overlay) {
  MACULA_CHECK(eyes.size() == 1 || eyes.size() == 2, "a window shows one or two eyes");
  const Choices& choices = parts_->controls.choices;
  const Compared* const compared = parts_->compared(overlay);
  parts_->eyes.clear(), parts_->pictures.clear(), parts_->marks.clear();
  std::vector<const image::Plane<Rgb8>*> shown;
  for (std::size_t eye = 0; eye < eyes.size(); ++eye) {
    if (!is_chosen(choices.eyes, eye, eyes.size())) continue;
    parts_->eyes.push_back(eye);
    parts_->pictures.push_back({eyes[eye]->width(), eyes[eye]->height()});
    parts_->marks.push_back(overlay.marks[eye]);
    if (!choices.rings) parts_->marks.back().rings.reset();
    shown.push_back(eyes[eye]);
    if (compared == nullptr) continue;
    parts_->composed[eye] = composed(choices, parts_->wipe, *eyes[eye], *compared->second[eye]);
    shown.back() = &parts_->composed[eye];
  }
  parts_->make_panels(overlay);
  for (const auto& panel : parts_->panels) shown.push_back(&panel);
  parts_->pass->upload(shown);
  parts_->draw();
  glfwSwapBuffers(parts_->window.get());
}

Input Window::poll() {
  glfwPollEvents();
  Input input = parts_->controls.input.poll(read_devices(parts_->window.get()), parts_->places());
  if (input.gaze) {
    parts_->wipe = input.gaze->at.u;
    // The picture under the cursor is that of the eye shown there.
    const auto place = static_cast<std::size_t>(input.gaze->picture);
    if (place < parts_->eyes.size()) input.gaze->picture = static_cast<int>(parts_->eyes[place]);
  }
  return input;
}

const Choices& Window::choices() const {
  return parts_->controls.choices;
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
