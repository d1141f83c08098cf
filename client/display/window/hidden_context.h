// HiddenContext: an OpenGL 3.3 core context without anything to see, for displays that only need a
// place for their textures. Current on the thread that created it until it is destroyed.
#pragma once

#include <memory>

#include "shared/base/result.h"

namespace macula::display {

class HiddenContext {
 public:
  /// An Error where there is no X server or no OpenGL 3.3.
  static Result<std::unique_ptr<HiddenContext>> create();
  ~HiddenContext();
  HiddenContext(const HiddenContext&) = delete;
  HiddenContext& operator=(const HiddenContext&) = delete;

 private:
  struct Parts;
  explicit HiddenContext(std::unique_ptr<Parts> parts);

  std::unique_ptr<Parts> parts_;
};

}  // namespace macula::display
