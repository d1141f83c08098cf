#include "client/reprojection/hidden_picture.h"

#include <algorithm>

namespace macula::reprojection {

HiddenPicture make_hidden_picture(const image::Plane<Rgb8>& color,
                                  const image::Plane<float>& inverse_depth_per_m,
                                  const image::Plane<std::uint8_t>& band,
                                  const image::Plane<Rgb8>& hidden_color,
                                  const image::Plane<float>& hidden_inverse_depth_per_m) {
  HiddenPicture picture{color, inverse_depth_per_m,
                        image::Plane<std::uint8_t>(color.width() + 1, color.height() + 1)};
  for (int y = 0; y < band.height(); ++y) {
    const auto marks = band.row(y);
    for (int x = 0; x < band.width(); ++x) {
      if (marks[x] == 0) continue;
      picture.color(x, y) = hidden_color(x, y);
      picture.inverse_depth_per_m(x, y) = hidden_inverse_depth_per_m(x, y);
      for (const int row : {y, y + 1}) {  // cell i is vertex i + 1
        picture.cells(x, row) = picture.cells(x + 1, row) = 1;
      }
    }
  }
  return picture;
}

}  // namespace macula::reprojection
