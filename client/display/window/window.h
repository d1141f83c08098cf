// Window: a desktop window that shows the warped pictures of one or two eyes side by side, and
// tells what the person did. Pictures are display-encoded and shown as they are. Belongs to the
// thread that created it (the main thread, where the platform insists); one Window at a time.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "client/display/gl/picture_pass.h"
#include "client/display/window/comparison.h"
#include "client/display/window/dashboard.h"
#include "client/display/window/input.h"
#include "shared/base/result.h"
#include "shared/image/color.h"
#include "shared/image/plane.h"

namespace macula::display {

enum class Vsync { On, Off };

struct WindowOptions {
  std::string title = "Macula";
  int width_px = 1280, height_px = 720;  ///< of its inside, in screen units
  Vsync vsync = Vsync::On;
};

/// What may be drawn over the pictures; the person chooses by keys.
struct Overlay {
  std::array<PictureMarks, 2> marks;     ///< by eye; eccentricity rings come with key G
  const Dashboard* dashboard = nullptr;  ///< comes with key O; null: there is nothing to tell
  const Compared* compared = nullptr;    ///< comes with key C; null: nothing to compare with yet
};

/// What the person chose to see.
struct Choices {
  enum class Eyes { Both, Left, Right };
  Eyes eyes = Eyes::Both;                           ///< key B takes the next
  bool rings = false;                               ///< key G: eccentricity rings
  bool dashboard = false;                           ///< key O
  bool help = false;                                ///< key H: the keys, on the screen
  ComparisonView comparison = ComparisonView::Off;  ///< key C takes the next
  bool swapped = false;       ///< key X: the second picture of a comparison where the first was
  std::array<int, 2> ways{};  ///< how often keys 1 and 2 asked for another of what is compared
};

class Window {
 public:
  /// An Error where there is no display or no OpenGL 3.3; it says to use --display headless.
  static Result<std::unique_ptr<Window>> create(const WindowOptions& options);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// One or two pictures, left eye first; letterboxed, aspect kept. Returns after the swap, which
  /// with vsync waits for the display. The pictures may be released afterwards.
  void show(std::span<const image::Plane<Rgb8>* const> eyes, const Overlay& overlay = {});
  /// Lets the window system have its say and returns what happened since the last call. Keys that
  /// choose what to see take effect with the next show(); Esc closes.
  Input poll();
  const Choices& choices() const;
  bool should_close() const;
  /// What show() last drew, the whole inside of the window, top row first.
  image::Plane<Rgb8> capture();

 private:
  struct Parts;
  explicit Window(std::unique_ptr<Parts> parts);

  std::unique_ptr<Parts> parts_;
};

}  // namespace macula::display
