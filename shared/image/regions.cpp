#include "shared/image/regions.h"

namespace macula::image {
namespace {

constexpr Radians kFive = Degrees{5};
constexpr Radians kTen = Degrees{10};
constexpr Radians kTwentyFive = Degrees{25};

[[noreturn]] void unknown_region() {
  base::check_failed("region", __FILE__, __LINE__, "not one of the six regions");
}

}  // namespace

const char* name(Region region) {
  switch (region) {
    case Region::All:
      return "all";
    case Region::F5:
      return "f5";
    case Region::F10:
      return "f10";
    case Region::F25:
      return "f25";
    case Region::Out10:
      return "out10";
    case Region::Out25:
      return "out25";
  }
  unknown_region();
}

bool contains(Region region, Radians eccentricity) {
  switch (region) {
    case Region::All:
      return true;
    case Region::F5:
      return eccentricity <= kFive;
    case Region::F10:
      return eccentricity <= kTen;
    case Region::F25:
      return eccentricity <= kTwentyFive;
    case Region::Out10:
      return eccentricity > kTen;
    case Region::Out25:
      return eccentricity > kTwentyFive;
  }
  unknown_region();
}

}  // namespace macula::image
